//! One run as numbers to be drawn, and what they are drawn against.

use hwasp_runs::metrics::{MetricsTable, TERM};
use hwasp_training::MetricsRow;

/// The column of the return, whose panel comes first.
pub const RETURN: &str = "return";
/// The column of the discounted return, whose panel is the next.
pub const DISCOUNTED: &str = "discounted_return";

/// One run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// What the legend says; runs with the same label are summarised together.
    pub label: String,
    /// Where each row lies on the horizontal axis; never falling.
    pub x: Vec<f64>,
    /// Mean return of the training episodes, not discounted, one per row; where it is empty there is no panel of it.
    pub undiscounted_return: Vec<f64>,
    /// Mean discounted return of the training episodes, one per row.
    pub discounted_return: Vec<f64>,
    /// What each named term of the reward came to in these episodes, with its column name.
    pub terms: Vec<(String, Vec<f64>)>,
    /// The design totals, each with its column name and one SI value per row.
    pub totals: Vec<(String, Vec<f64>)>,
}

impl Curve {
    /// The curve of a run's table. A nominal axis counts `nominal_steps` per iteration.
    pub fn from_table(label: impl Into<String>, table: &MetricsTable, axis: XAxis, nominal_steps: u64) -> Self {
        let x = |row: &MetricsRow| match axis {
            XAxis::WallClock => row.wall_s,
            XAxis::Nominal if nominal_steps > 0 => ((row.iteration + 1) * nominal_steps) as f64,
            XAxis::EnvSteps | XAxis::Nominal => row.env_steps as f64,
        };
        let total = |(place, name): (usize, &String)| {
            (name.clone(), table.rows.iter().filter_map(|row| row.design_totals.get(place).copied()).collect())
        };
        let term = |(place, name): (usize, &String)| {
            (format!("{TERM}{name}"), table.rows.iter().filter_map(|row| row.terms.get(place).copied()).collect())
        };
        Self {
            label: label.into(),
            x: table.rows.iter().map(x).collect(),
            undiscounted_return: table.rows.iter().map(|row| row.undiscounted_return).collect(),
            discounted_return: table.rows.iter().map(|row| row.discounted_return).collect(),
            terms: table.terms.iter().enumerate().map(term).collect(),
            totals: table.design_totals.iter().enumerate().map(total).collect(),
        }
    }

    /// Without the return that is not discounted: where runs are compared by the discounted one, that is what is drawn.
    #[must_use]
    pub fn judged(self) -> Self {
        Self { undiscounted_return: Vec::new(), ..self }
    }

    pub(crate) fn column(&self, name: &str) -> Option<&[f64]> {
        match name {
            RETURN => return (!self.undiscounted_return.is_empty()).then_some(&self.undiscounted_return),
            DISCOUNTED => return Some(&self.discounted_return),
            _ => {}
        }
        self.columns().find(|(known, _)| known == name).map(|(_, values)| values.as_slice())
    }

    /// All but the returns.
    pub(crate) fn columns(&self) -> impl Iterator<Item = &(String, Vec<f64>)> {
        self.totals.iter().chain(&self.terms)
    }
}

/// What curves are drawn against.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum XAxis {
    /// Real simulator steps.
    #[default]
    EnvSteps,
    /// Time since training began, s.
    WallClock,
    /// Steps as the paper counts them: a nominal number per iteration, whatever an iteration took.
    Nominal,
}

impl XAxis {
    pub(crate) fn label(self) -> &'static str {
        match self {
            Self::EnvSteps => "real environment steps",
            Self::WallClock => "wall-clock time (s)",
            Self::Nominal => "nominal environment steps",
        }
    }
}
