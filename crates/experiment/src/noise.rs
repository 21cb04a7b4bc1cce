//! `[noise]`: standard deviations of the Gaussian that explores.

use hwasp_core::{Dimension, parse_quantity};
use hwasp_settings::{Fields, Item, Kind, Node, Section, Settings, with_unit};

use crate::design::DesignSettings;
use crate::task::Task;

/// `[noise]`: initial standard deviations, trained or annealed from there.
#[derive(Clone, Debug, PartialEq)]
pub struct NoiseSettings {
    /// Of the motor commands, as a fraction of their range.
    pub command: Vec<f64>,
    /// What that is annealed to.
    pub command_final: Option<Vec<f64>>,
    /// Of the effort, SI; none where no parameter sits in the graph, and the effort is no action.
    pub effort: Option<f64>,
    /// What that is annealed to.
    pub effort_final: Option<f64>,
    /// Of a parameter in the action, as a fraction of its range.
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
    effort_dimension: Dimension,
}

/// Limits of a fraction.
const FRACTION: std::ops::RangeInclusive<f64> = 1e-6..=10.0;
/// Limits of the effort's, SI.
const EFFORT: std::ops::RangeInclusive<f64> = 1e-6..=1e4;

impl NoiseSettings {
    /// The defaults for a task and the places of its parameters.
    pub(crate) fn new(task: &Task, design: &DesignSettings) -> Self {
        let dimension = task.effort_dimension();
        let usual = task.built().effort_std.unwrap_or(match dimension {
            Dimension::Force => 3.0,
            Dimension::Torque => 0.5,
            _ => 0.1,
        });
        Self { effort: design.is_in_graph().then_some(usual), ..Self::of(task.commands(), dimension) }
    }

    /// Of so many commands, without an effort.
    pub(crate) fn of(commands: usize, effort_dimension: Dimension) -> Self {
        Self {
            command: vec![0.3; commands],
            command_final: None,
            effort: None,
            effort_final: None,
            design: 0.3,
            design_final: None,
            anneal: [0.25, 0.75],
            train: true,
            learning_rate_scale: 1.0,
            effort_dimension,
        }
    }

    fn effort_fields(&mut self, fields: &mut Fields<'_, '_>) {
        let (dimension, usual) = (self.effort_dimension, self.effort);
        let written = |value: Option<f64>| value.map(|value| Item::Text(with_unit(value, dimension)));
        let read = |value: &mut Option<f64>, key: &str, example: f64, section: &Section<'_>, node: &Node| {
            if usual.is_none() {
                skim(section, key, node, dimension);
            } else if node.text() != Some("none") {
                *value = section.checked_quantity(key, node, dimension, example, &EFFORT).or(*value);
            }
        };
        let example = usual.unwrap_or(3.0);
        let (effort, last) = (&mut self.effort, &mut self.effort_final);
        fields
            .default("\"3 N\"; a torque: \"0.5 N·m\", else 0.1 in SI; grasps: \"0.02 N·m\"")
            .limits("1e-6 to 1e4")
            .kind(Kind::Optional(Box::new(Kind::AnyQuantity)))
            .open("effort", "of the effort, where a parameter sits in the graph", written(*effort), |section, node| {
                read(effort, "effort", example, section, node);
            });
        fields.limits("as above").kind(Kind::Optional(Box::new(Kind::AnyQuantity))).open(
            "effort_final",
            "annealed geometrically to this",
            written(*last),
            |section, node| {
                read(last, "effort_final", 0.01 * example, section, node);
            },
        );
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
        fields.number("design", &mut self.design, FRACTION, "of a parameter in the action, as a fraction of its range");
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

/// A key that says nothing here, because the effort is no action: a base table may have it for another method, whose
/// effort may even have another unit. It still has to be a quantity.
fn skim(section: &Section<'_>, key: &str, node: &Node, dimension: Dimension) {
    let any = [Dimension::Force, Dimension::Length, Dimension::Speed, Dimension::Torque, dimension];
    let fits = |text: &str| text == "none" || any.iter().any(|&d| parse_quantity(text, d).is_ok());
    if !node.text().is_some_and(fits) {
        section.wrong(key, node, "is not a quantity", Some("write it like \"3 N\"".into()));
    }
}
