//! `[noise]`: standard deviations of the Gaussian that explores.

use hwasp_core::{Dimension, Port};
use hwasp_settings::{Fields, Item, Kind, Settings};

use crate::design::DesignSettings;
use crate::efforts::{Efforts, item, skim};
use crate::task::Task;

/// `[noise]`: initial standard deviations, trained or annealed from there.
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseSettings {
    /// Of the motor commands, as a fraction of their range.
    pub command: Vec<f64>,
    /// What that is annealed to.
    pub command_final: Option<Vec<f64>>,
    /// Of each effort, SI; none where no parameter sits in the graph, and efforts are no action.
    pub effort: Option<Vec<f64>>,
    /// What each is annealed to, SI; none where it is not.
    pub effort_final: Vec<Option<f64>>,
    /// Of a parameter in the action, at every step or once an episode, as a fraction of its range.
    pub design: f64,
    /// What that is annealed to.
    pub design_final: Option<f64>,
    /// Begin and end of annealing, as fractions of training.
    pub anneal: [f64; 2],
    /// Whether the standard deviations are trained.
    pub train: bool,
    /// Times the policy's learning rate.
    pub learning_rate_scale: f64,
    /// What the law hands to the plant.
    efforts: Vec<Port>,
}

/// Limits of a fraction.
const FRACTION: std::ops::RangeInclusive<f64> = 1e-6..=10.0;

/// What efforts are explored by where nobody says otherwise, SI.
fn usual(dimension: Dimension) -> f64 {
    match dimension {
        Dimension::Force => 3.0,
        Dimension::Torque => 0.5,
        _ => 0.1,
    }
}

impl NoiseSettings {
    /// The defaults for a task and the places of its parameters.
    pub(crate) fn new(task: &Task, design: &DesignSettings) -> Self {
        let (efforts, own) = (task.efforts(), &task.built().effort_std);
        let spread = |(i, port): (usize, &Port)| own.get(i).copied().flatten().unwrap_or_else(|| usual(port.dimension));
        let effort = design.is_in_graph().then(|| efforts.iter().enumerate().map(spread).collect());
        Self { effort, ..Self::of(task.commands(), efforts.to_vec()) }
    }

    /// Of so many commands, without efforts in the action.
    pub(crate) fn of(commands: usize, efforts: Vec<Port>) -> Self {
        Self {
            command: vec![0.3; commands],
            command_final: None,
            effort: None,
            effort_final: vec![None; efforts.len()],
            design: 0.3,
            design_final: None,
            anneal: [0.25, 0.75],
            train: true,
            learning_rate_scale: 1.0,
            efforts,
        }
    }

    fn effort_fields(&mut self, fields: &mut Fields<'_, '_>) {
        let (ports, effort, last) = (&self.efforts, &mut self.effort, &mut self.effort_final);
        let kind = || {
            let list = Kind::List { of: Box::new(Kind::AnyQuantity), length: [1, usize::MAX], single: true };
            Kind::Optional(Box::new(Kind::AnyOf(vec![list, Kind::Table(Box::new(Kind::AnyQuantity))])))
        };
        let written = effort.as_ref().map(|effort| effort.iter().copied().map(Some).collect::<Vec<_>>());
        let written = written.and_then(|effort| item(&effort, ports));
        let about = "of the efforts, where a parameter sits in the graph: one for all, a list of one each, or by name, `{ knee = \"0.5 \
                     N·m\", spring = \"3 N\" }`, where those left out keep their default";
        fields
            .default("\"3 N\"; a torque: \"0.5 N·m\", else 0.1 in SI; grasps: \"0.02 N·m\"; model: 0.15 of what the commands move it by")
            .limits("1e-6 to 1e4")
            .kind(kind())
            .open("effort", about, written, |section, node| {
                let Some(effort) = effort else { return skim(section, "effort", node, ports) };
                let read = Efforts { section, key: "effort", ports, examples: effort }.read(node);
                for (to, from) in effort.iter_mut().zip(read) {
                    *to = from.unwrap_or(*to);
                }
            });
        let (written, about) = (item(last, ports), "annealed geometrically to this; efforts left out stay as they are");
        fields.limits("as above").kind(kind()).open("effort_final", about, written, |section, node| {
            let Some(effort) = &self.effort else { return skim(section, "effort_final", node, ports) };
            let examples: Vec<f64> = effort.iter().map(|std| 0.01 * std).collect();
            *last = Efforts { section, key: "effort_final", ports, examples: &examples }.read(node);
        });
    }
}

impl Settings for NoiseSettings {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        let commands = self.command.len();
        fields.default("0.3");
        let about = "of the motor commands, as a fraction of their range; a list for one each";
        fields.each("command", &mut self.command, FRACTION, about);
        let about = "annealed geometrically to this";
        fields.optional_each("command_final", &mut self.command_final, (commands, FRACTION), about);
        self.effort_fields(fields);
        let about = "of a parameter in the action, at every step or once an episode, as a fraction of its range";
        fields.number("design", &mut self.design, FRACTION, about);
        let last = self.design_final.map(Item::Float);
        let design_final = &mut self.design_final;
        let fraction = Kind::Number([*FRACTION.start(), *FRACTION.end()]);
        fields.limits("as above").kind(Kind::Optional(Box::new(fraction)));
        fields.open("design_final", "annealed geometrically to this", last, |section, node| {
            *design_final = match node.text() {
                Some("none") => None,
                _ => section.checked_number_of("design_final", node, &FRACTION),
            };
        });
        fields.fractions("anneal", &mut self.anneal, "begin and end of annealing, fractions of training");
        fields.flag("train", &mut self.train, "whether the standard deviations are trained");
        let about = "times the policy's learning rate (PPO)";
        fields.number("learning_rate_scale", &mut self.learning_rate_scale, 0.0..=1000.0, about);
    }
}
