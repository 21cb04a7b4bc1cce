//! Comparisons read back.

use std::path::{Path, PathBuf};

use hwasp_experiment::EXPERIMENT;
use hwasp_plot::MOST_RUNS;
use hwasp_runs::{RunError, SUMMARY, io_error, saved_json, saved_metrics, saved_summary};

use crate::cell::{CELLS, CellResult};
use crate::comparison::Comparison;
use crate::contender::folder_name;
use crate::figures::MethodFigures;
use crate::report::COMPARISON;

/// A comparison that was written before. Its cells are read without being put together: it needs no engine.
#[derive(Clone, Debug)]
pub struct SavedComparison {
    /// The figures.
    pub comparison: Comparison,
    /// The cells that finished, method by method as the figures have them.
    pub cells: Vec<CellResult>,
    /// A cell: the run folder of the best method's first seed; of one that did not finish, where none did.
    pub first: PathBuf,
}

impl SavedComparison {
    /// Reads the folder of a comparison.
    pub fn open(folder: &Path) -> Result<Self, RunError> {
        let file = folder.join(COMPARISON);
        let decode = |message: String| RunError::Decode { path: file.clone(), message };
        let comparison: Comparison = saved_json(&file)?.ok_or_else(|| RunError::Nothing { path: folder.to_owned() })?;
        let runs: usize = comparison.methods.iter().map(|method| method.seeds.min(MOST_RUNS + 1)).sum();
        let missing = comparison.methods.iter().any(|method| !method.missing.is_empty());
        if runs > MOST_RUNS || (runs == 0 && !missing) {
            return Err(decode(format!("it is about {runs} runs, and a comparison has 1 to {MOST_RUNS}")));
        }
        let found = found(&folder.join(CELLS))?;
        let mut cells = Vec::with_capacity(runs);
        let mut first = None;
        for method in &comparison.methods {
            let own: Vec<&Found> = found.iter().filter(|cell| cell.finished && cell.is_of(method)).collect();
            if own.len() != method.seeds {
                return Err(decode(format!(
                    "it is about {} runs of {}, and {CELLS} has {} that are finished",
                    method.seeds,
                    method.label,
                    own.len()
                )));
            }
            for cell in own {
                first.get_or_insert_with(|| cell.path.clone());
                let (summary, metrics) = (saved_summary(&cell.path)?, saved_metrics(&cell.path)?);
                let unchanged = method.unchanged_seeds.contains(&cell.seed);
                cells.push(CellResult { label: method.label.clone(), summary, metrics, unchanged });
            }
        }
        let begun = || found.iter().find(|cell| comparison.methods.iter().any(|method| cell.is_among(method)));
        let first = first.or_else(|| begun().map(|cell| cell.path.clone()));
        let first = first.ok_or_else(|| decode("none of its methods has a run".into()))?;
        Ok(Self { comparison, cells, first })
    }
}

/// A run in the folder of the cells.
struct Found {
    /// All of its name before `-seed`.
    method: String,
    seed: u64,
    path: PathBuf,
    finished: bool,
}

impl Found {
    /// Whether it is one of those that the figures of a method are of.
    fn is_of(&self, method: &MethodFigures) -> bool {
        // Old comparisons do not name their seeds: they are of all that there are.
        let unnamed = method.finished_seeds.len() != method.seeds;
        self.is_among(method) && (unnamed || method.finished_seeds.contains(&self.seed))
    }

    /// Whether it is of a method.
    fn is_among(&self, method: &MethodFigures) -> bool {
        self.method == folder_name(&method.label)
    }
}

/// The runs in a folder, by method and seed.
fn found(cells: &Path) -> Result<Vec<Found>, RunError> {
    let entries = cells.read_dir().map_err(|source| io_error("read", cells, source))?;
    let mut found = Vec::new();
    for entry in entries {
        let entry = entry.map_err(|source| io_error("read", cells, source))?;
        let (name, path) = (entry.file_name().to_string_lossy().into_owned(), entry.path());
        let Some((method, seed)) = name.rsplit_once("-seed") else { continue };
        let Ok(seed) = seed.parse() else { continue };
        if path.join(EXPERIMENT).is_file() {
            found.push(Found { method: method.to_owned(), seed, finished: path.join(SUMMARY).is_file(), path });
        }
    }
    found.sort_unstable_by(|a, b| (&a.method, a.seed).cmp(&(&b.method, b.seed)));
    Ok(found)
}
