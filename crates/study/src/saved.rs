//! Comparisons read back.

use std::path::{Path, PathBuf};

use hwasp_plot::MOST_RUNS;
use hwasp_runs::{RunError, SUMMARY, io_error, saved_json, saved_metrics, saved_summary};

use crate::cell::{CELLS, CellResult};
use crate::contender::folder_name;
use crate::report::{COMPARISON, Comparison};

/// A comparison that was written before. Its cells are read without being put together: it needs no engine.
#[derive(Clone, Debug)]
pub struct SavedComparison {
    /// The figures.
    pub comparison: Comparison,
    /// The cells that finished, method by method as the figures have them.
    pub cells: Vec<CellResult>,
    /// A cell: the run folder of the best method's first seed.
    pub first: PathBuf,
}

impl SavedComparison {
    /// Reads the folder of a comparison.
    pub fn open(folder: &Path) -> Result<Self, RunError> {
        let file = folder.join(COMPARISON);
        let decode = |message: String| RunError::Decode { path: file.clone(), message };
        let comparison: Comparison = saved_json(&file)?.ok_or_else(|| RunError::Nothing { path: folder.to_owned() })?;
        let runs: usize = comparison.methods.iter().map(|method| method.seeds.min(MOST_RUNS + 1)).sum();
        if !(1..=MOST_RUNS).contains(&runs) {
            return Err(decode(format!("it is about {runs} runs, and a comparison has 1 to {MOST_RUNS}")));
        }
        let finished = finished(&folder.join(CELLS))?;
        let mut cells = Vec::with_capacity(runs);
        let mut first = None;
        for method in &comparison.methods {
            let begin = format!("{}-seed", folder_name(&method.label));
            let seed = |name: &str| name.strip_prefix(&begin)?.parse::<u64>().ok();
            let mut own: Vec<(u64, &PathBuf)> =
                finished.iter().filter_map(|(name, path)| Some((seed(name)?, path))).collect();
            own.sort_unstable();
            if own.len() != method.seeds {
                return Err(decode(format!(
                    "it is about {} runs of {}, and {CELLS} has {} that are finished",
                    method.seeds,
                    method.label,
                    own.len()
                )));
            }
            for (_, path) in own {
                first.get_or_insert_with(|| path.clone());
                let (summary, metrics) = (saved_summary(path)?, saved_metrics(path)?);
                cells.push(CellResult { label: method.label.clone(), summary, metrics });
            }
        }
        let first = first.ok_or_else(|| decode("none of its methods has a run".into()))?;
        Ok(Self { comparison, cells, first })
    }
}

/// The finished runs in a folder, by name.
fn finished(cells: &Path) -> Result<Vec<(String, PathBuf)>, RunError> {
    let entries = cells.read_dir().map_err(|source| io_error("read", cells, source))?;
    let mut found = Vec::new();
    for entry in entries {
        let entry = entry.map_err(|source| io_error("read", cells, source))?;
        if entry.path().join(SUMMARY).is_file() {
            found.push((entry.file_name().to_string_lossy().into_owned(), entry.path()));
        }
    }
    Ok(found)
}
