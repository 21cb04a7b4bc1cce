//! The figures of a comparison.

use serde::{Deserialize, Serialize};

use crate::cell::CellResult;
use crate::error::CompareError;
use crate::failure::MissingSeed;
use crate::figures::{MethodFigures, Pair, default_threshold};
use crate::outcome::Outcome;

/// Cells beside those of a comparison that are named.
const MOST_NAMED: usize = 8;

/// The figures of all methods.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// The experiment.
    pub experiment: String,
    /// The training return whose steps are counted; none where nothing finished.
    pub threshold: Option<f64>,
    /// The methods, best evaluation first, those without any last.
    pub methods: Vec<MethodFigures>,
    /// Every two methods, the one with the better evaluation first.
    pub improvement: Vec<Pair>,
    /// Folders in `cells/` that are of other methods or seeds than these.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub other_cells: Vec<String>,
}

impl Comparison {
    /// Summarises cells. Without a threshold it is nine tenths of the way from the worst first to the best last training
    /// return of all runs.
    pub fn new(experiment: &str, outcome: &Outcome, threshold: Option<f64>) -> Result<Self, CompareError> {
        let threshold = threshold.or_else(|| default_threshold(&outcome.finished));
        let mut methods = Vec::with_capacity(outcome.contests.len());
        for contest in &outcome.contests {
            let cells: Vec<&CellResult> = outcome.finished.iter().filter(|cell| cell.label == contest.label).collect();
            let missing: Vec<MissingSeed> = outcome
                .missing
                .iter()
                .filter(|cell| cell.label == contest.label)
                .map(|cell| cell.seed.clone())
                .collect();
            methods.push(MethodFigures::of(contest, &cells, missing, threshold)?);
        }
        let worth = |m: &MethodFigures| m.evaluation.map_or(f64::NEG_INFINITY, |evaluation| evaluation.iqm);
        methods.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
        let pairs = (0..methods.len()).flat_map(|i| (i + 1..methods.len()).map(move |j| (i, j)));
        let improvement = pairs.map(|(i, j)| Pair::of(&methods[i], &methods[j])).collect::<Result<Vec<_>, _>>()?;
        let other_cells = outcome.others.clone();
        Ok(Self { experiment: experiment.to_owned(), threshold, methods, improvement, other_cells })
    }

    /// Labels with the seeds that there should be, where some did not finish: for the legends of pictures.
    pub fn asked(&self) -> Vec<(String, usize)> {
        let incomplete = self.methods.iter().filter(|method| !method.missing.is_empty());
        incomplete.filter_map(|method| Some((method.label.clone(), method.asked()?))).collect()
    }

    /// Which cells of the folder are not in this comparison, as a sentence; none where all are.
    pub fn others(&self) -> Option<String> {
        let named = self.other_cells.iter().take(MOST_NAMED).map(String::as_str).collect::<Vec<_>>().join(", ");
        match self.other_cells.len() {
            0 => None,
            n if n > MOST_NAMED => {
                Some(format!("Cells in this folder that are not in this comparison: {named}, … ({n} in all)."))
            }
            _ => Some(format!("Cells in this folder that are not in this comparison: {named}.")),
        }
    }
}
