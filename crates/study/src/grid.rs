//! Grids of methods and seeds.

use std::path::Path;

use hwasp_core::Executor;
use hwasp_experiment::{Catalogue, EXPERIMENT, Layers, resolve};
use hwasp_runs::RunFolder;
use hwasp_training::Assembly;

use crate::cell::{CELLS, Cell, CellAnswer, State, Work};
use crate::contender::Contender;
use crate::error::CompareError;
use crate::failure::MissingSeed;
use crate::outcome::{MissingCell, Outcome};

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
                RunFolder::check_names(&spec)?;
                let assembly = Assembly::new(&spec)
                    .map_err(|source| CompareError::Assemble { label: contender.label.clone(), source })?;
                let name = format!("{}-seed{seed}", contender.folder_name());
                let path = folder.join(CELLS).join(name);
                cells.push(Cell { label: contender.label.clone(), seed, path, assembly });
            }
        }
        check_apart(&cells)?;
        Ok(cells)
    }
}

/// Refuses contenders that would train the same.
fn check_apart(cells: &[Cell]) -> Result<(), CompareError> {
    // Seeds are the same for all of them.
    let of_a_seed: Vec<&Cell> = cells.iter().filter(|cell| cell.seed == cells[0].seed).collect();
    for (i, cell) in of_a_seed.iter().enumerate() {
        let same = |other: &&&Cell| other.assembly.experiment() == cell.assembly.experiment();
        if let Some(other) = of_a_seed[..i].iter().find(same) {
            return Err(CompareError::Same { one: other.label.clone(), other: cell.label.clone() });
        }
    }
    Ok(())
}

/// Names of the folders in `cells/` that are none of these cells.
fn others(cells: &[Cell]) -> Vec<String> {
    let Some(folder) = cells.first().and_then(|cell| cell.path.parent()) else { return Vec::new() };
    // A folder that is not there yet holds no others.
    let entries = folder.read_dir().into_iter().flatten().flatten().map(|entry| entry.path());
    let foreign = entries.filter(|path| path.join(EXPERIMENT).is_file() && cells.iter().all(|cell| cell.path != *path));
    let mut names: Vec<String> =
        foreign.filter_map(|path| Some(path.file_name()?.to_string_lossy().into_owned())).collect();
    names.sort_unstable();
    names
}

/// Runs what is not finished yet: as many cells at once as the executor has workers. A cell that failed is remembered and not tried again.
/// A cell that another process trains is waited for, after all that nobody trains. When `stop` is set, cells under way are
/// left as they are, to be resumed.
pub fn run(cells: &[Cell], executor: &dyn Executor, work: Work<'_>) -> Result<Outcome, CompareError> {
    let states = cells.iter().map(Cell::state).collect::<Result<Vec<_>, _>>()?;
    let known = cells.iter().zip(&states).map(|(cell, state)| {
        let label = format!("{} seed {}", cell.label, cell.seed);
        (label, cell.assembly.experiment().train.env_steps, !matches!(state, State::Open))
    });
    work.watch.grid(&known.collect::<Vec<_>>());
    for (i, state) in states.iter().enumerate() {
        if let State::Failed(failure) = state {
            work.watch.failed_before(i, &failure.reason);
        }
    }
    let mut worked =
        executor.map(cells.len(), |i| cells[i].work(i, work)).into_iter().collect::<Result<Vec<_>, _>>()?;
    let held: Vec<(usize, String)> = worked
        .iter()
        .enumerate()
        .filter_map(|(i, worked)| if let CellAnswer::Held(owner) = worked { Some((i, owner.clone())) } else { None })
        .collect();
    let waited = executor.map(held.len(), |k| cells[held[k].0].wait(held[k].0, &held[k].1, work));
    for ((i, _), waited) in held.iter().zip(waited) {
        worked[*i] = waited?;
    }
    let mut outcome = Outcome { others: others(cells), ..Outcome::of(cells) };
    for (cell, worked) in cells.iter().zip(worked) {
        let label = cell.label.clone();
        match worked {
            CellAnswer::Finished(result) => outcome.finished.push(*result),
            CellAnswer::Missing(seed) => outcome.missing.push(MissingCell { label, seed }),
            CellAnswer::Held(owner) => {
                let reason = format!("process {owner} trains it");
                outcome.missing.push(MissingCell { label, seed: MissingSeed::unfinished(cell.seed, &reason) });
            }
        }
    }
    Ok(outcome)
}
