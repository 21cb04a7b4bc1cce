//! Grids of methods and seeds.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use hwasp_core::Executor;
use hwasp_experiment::{Catalogue, Layers, resolve};
use hwasp_training::Assembly;

use crate::cell::{CELLS, Cell, CellResult, Watch};
use crate::contender::Contender;
use crate::error::CompareError;

/// What is compared.
#[derive(Clone, Debug)]
pub struct Grid {
    /// The experiment with its settings, before a method is chosen.
    pub layers: Layers,
    /// The methods.
    pub contenders: Vec<Contender>,
    /// The seeds of each.
    pub seeds: std::ops::Range<u64>,
}

impl Grid {
    /// The cells, contender by contender, every one checked.
    ///
    /// # Errors
    /// [`CompareError::Taken`] where `folder` holds something else, so that nothing is overwritten.
    pub fn cells(&self, folder: &Path, catalogue: &Catalogue) -> Result<Vec<Cell>, CompareError> {
        let is_empty = |mut entries: std::fs::ReadDir| entries.next().is_none();
        if folder.exists() && !folder.join(CELLS).is_dir() && !folder.read_dir().is_ok_and(is_empty) {
            return Err(CompareError::Taken { path: folder.to_owned() });
        }
        let mut cells = Vec::new();
        for (i, contender) in self.contenders.iter().enumerate() {
            if self.contenders[..i].iter().any(|other| other.label == contender.label) {
                return Err(CompareError::Twice(contender.label.clone()));
            }
            for seed in self.seeds.clone() {
                let layers = contender.apply(self.layers.clone()).with_override("seed", &seed.to_string());
                let spec = resolve(layers, Some(contender.method.name()), catalogue)?;
                let assembly = Assembly::new(&spec)
                    .map_err(|source| CompareError::Assemble { label: contender.label.clone(), source })?;
                let name = format!("{}-seed{seed}", contender.folder_name());
                let path = folder.join(CELLS).join(name);
                cells.push(Cell { label: contender.label.clone(), seed, path, assembly });
            }
        }
        Ok(cells)
    }
}

/// Runs what is not finished yet, cells in parallel, each on one thread, and returns what is. Cells that failed are told to
/// `watch` and missing from the result. When `stop` is set, cells under way are left as they are, to be resumed.
pub fn run(
    cells: &[Cell],
    executor: &dyn Executor,
    command_line: &[String],
    watch: &dyn Watch,
    stop: &AtomicBool,
) -> Result<Vec<CellResult>, CompareError> {
    let finished = cells.iter().map(Cell::is_finished).collect::<Result<Vec<_>, _>>()?;
    let known = cells.iter().zip(&finished).map(|(cell, &finished)| {
        (format!("{} seed {}", cell.label, cell.seed), cell.assembly.experiment().train.env_steps, finished)
    });
    watch.grid(&known.collect::<Vec<_>>());
    let results = executor.map(cells.len(), |i| {
        if finished[i] {
            return cells[i].result().map(Some);
        }
        if stop.load(Ordering::Relaxed) {
            return Ok(None);
        }
        cells[i].train(i, command_line, watch, stop)
    });
    results.into_iter().filter_map(Result::transpose).collect()
}
