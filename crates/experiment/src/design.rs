//! `[design]`: where each design parameter sits and where it begins.

use hwasp_settings::{Fields, Item, Kind, Settings};

use crate::group::{Group, Place};
use crate::initial::{InitialDesign, read_initial};
use crate::method::Method;
use crate::placements::{PlacedRange, read_placements, write_placements};

/// `[design]`.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignSettings {
    /// Where the parameters sit, unless `placements` says otherwise.
    pub placement: Place,
    /// Where every parameter begins.
    pub initial: InitialDesign,
    /// Half width of the uniform start before the squash.
    pub logit_half_width: f64,
    /// Times the policy's learning rate.
    pub learning_rate_scale: f64,
    /// Exceptions, in order and disjoint.
    pub placements: Vec<PlacedRange>,
    /// The parameters of the task.
    groups: Vec<Group>,
}

impl DesignSettings {
    /// The defaults for a method and the parameters of a task.
    pub(crate) fn new(method: Method, groups: Vec<Group>) -> Self {
        let placement = match method {
            Method::Hwasp => Place::Graph,
            Method::Episode => Place::Episode,
            Method::Fixed => Place::Fixed,
            // A search moves the parameter, and the plant evaluates the law.
            Method::Minimal
            | Method::Cmaes
            | Method::Ars
            | Method::CmaesRl
            | Method::ArsRl
            | Method::BoRl
            | Method::RandomRl => Place::Action,
        };
        Self {
            placement,
            initial: InitialDesign::Law,
            logit_half_width: 5.0,
            learning_rate_scale: 1.0,
            placements: Vec::new(),
            groups,
        }
    }

    /// Where parameter `i` sits. What the world's model is made from cannot change within an episode: it is drawn once an
    /// episode where the others are in the graph or in the action.
    pub fn place_of(&self, i: usize) -> Place {
        let here = |placed: &&PlacedRange| i >= placed.first && placed.range.contains(&(i - placed.first));
        if let Some(placed) = self.placements.iter().find(here) {
            return placed.place;
        }
        let shapes = |group: &Group| group.shapes_world && (group.first..group.first + group.count).contains(&i);
        match self.placement {
            Place::Graph | Place::Action if self.groups.iter().any(shapes) => Place::Episode,
            place => place,
        }
    }

    /// Whether any parameter sits in the graph, so that the effort is an action.
    pub fn is_in_graph(&self) -> bool {
        let count = self.groups.iter().map(|group| group.count).sum();
        (0..count).any(|i| self.place_of(i) == Place::Graph)
    }
}

impl Settings for DesignSettings {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        fields.default("hwasp: \"graph\", episode: \"episode\", fixed: \"fixed\", else \"action\"");
        let about = "where the parameters sit; those that the world's model is made from are drawn once an episode where this is \
                     `graph` or `action`";
        fields.choice("placement", &mut self.placement, about);
        // Who says how wide the start is wants it to be so.
        if fields.is_set("logit_half_width") {
            self.initial = InitialDesign::Logit;
        }
        let about = "`law` (as the problem's law says; of those that come with the program `logit`), `logit`, `middle`, a quantity, or \
                     one for each group, `{ thumb_distal_radius = \"6 mm\" }`; those left out begin where the problem says (`initial` in `[task.design]` of a robot), else in the middle";
        fields
            .default("\"law\", or \"logit\" where `logit_half_width` is set")
            .limits("inside of the parameter's limits")
            .kind(Kind::AnyOf(vec![
                Kind::Choice(vec!["law", "logit", "middle"]),
                Kind::AnyQuantity,
                Kind::Table(Box::new(Kind::AnyQuantity)),
            ]));
        let (initial, groups) = (&mut self.initial, &self.groups);
        fields.open("initial", about, Some(initial.item()), |section, node| {
            *initial = read_initial(section, node, groups);
        });
        let about = "half width of the uniform start before the squash, where `initial` is `logit`";
        fields.number("logit_half_width", &mut self.logit_half_width, 0.0..=20.0, about);
        let about = "times the policy's learning rate (PPO)";
        fields.number("learning_rate_scale", &mut self.learning_rate_scale, 0.0..=1000.0, about);
        let about = "where some of them sit: `{ \"stiffness[0]\" = \"action\", \"stiffness[3..5]\" = \"fixed\" }` (3 and 4), or a list of \
                     one place each";
        let place = Kind::Choice(Place::ALL.iter().map(|(name, _)| *name).collect());
        fields.default("none").limits(place.limits()).kind(Kind::AnyOf(vec![
            Kind::Table(Box::new(place.clone())),
            Kind::List { of: Box::new(place), length: [1, usize::MAX], single: false },
        ]));
        let placements = &mut self.placements;
        let item = (!placements.is_empty()).then(|| Item::Keys(write_placements(placements)));
        fields.open("placements", about, item, |section, node| {
            *placements = read_placements(section, node, groups);
        });
    }
}
