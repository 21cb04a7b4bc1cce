//! What a comparison says: its figures, tables in three formats, and pictures.

use std::fs;
use std::path::Path;

use hwasp_plot::{Band, Curve, PlotOptions, XAxis, curves};
use hwasp_runs::files::{Disk, Files, json};
use hwasp_runs::io_error;
use serde::{Deserialize, Serialize};

use crate::cell::CellResult;
use crate::error::CompareError;
use crate::failure::MissingSeed;
use crate::figures::{MethodFigures, Pair, default_threshold};
use crate::outcome::Outcome;

/// The figures as JSON.
pub const COMPARISON: &str = "comparison.json";
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

    /// Writes `table.md`, `table.csv`, `comparison.json`, and where anything finished `curves.svg` and `time.svg`, into a
    /// folder that is created where it is missing. Each file is written whole, even where another process writes it too.
    pub fn write(&self, folder: &Path, cells: &[CellResult], options: &PlotOptions) -> Result<(), CompareError> {
        fs::create_dir_all(folder).map_err(|source| io_error("create", folder, source))?;
        let mut files = vec![
            ("table.md", self.markdown().into_bytes()),
            ("table.csv", self.csv().into_bytes()),
            (COMPARISON, json(COMPARISON, self)?),
        ];
        for (name, x_axis) in [("curves.svg", XAxis::EnvSteps), ("time.svg", XAxis::WallClock)] {
            if cells.is_empty() {
                continue;
            }
            let runs: Vec<Curve> =
                cells.iter().map(|cell| Curve::from_table(&cell.label, &cell.metrics, x_axis, 0)).collect();
            let title = self.experiment.clone();
            let options = PlotOptions { title, x_axis, band: Band::Bootstrap, asked: self.asked(), ..options.clone() };
            files.push((name, curves(&runs, &options)?.svg.into_bytes()));
        }
        for (name, contents) in files {
            // Beside its place under a name that no other process has.
            let (path, beside) = (folder.join(name), folder.join(format!(".{name}.{}.partial", std::process::id())));
            let written = Disk.write(&beside, &contents).and_then(|()| Disk.rename(&beside, &path));
            written.map_err(|source| io_error("write", &path, source))?;
        }
        Ok(())
    }
}
