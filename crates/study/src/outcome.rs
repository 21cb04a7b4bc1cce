//! What a grid came to: cells that finished, and cells that did not, with the reason.

use hwasp_training::Piece;

use crate::cell::{Cell, CellResult};
use crate::failure::MissingSeed;

/// A cell without figures.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MissingCell {
    /// The contender.
    pub label: String,
    /// Its seed, and why.
    pub seed: MissingSeed,
}

/// What a contender may spend.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Contest {
    /// The contender.
    pub label: String,
    /// Real simulator steps of each of its trainings, at most.
    pub budget: u64,
    /// What of them it takes whole or not at all.
    pub piece: Piece,
}

/// What a grid came to.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// The contenders, in the order in which they were named.
    pub contests: Vec<Contest>,
    /// Cells that finished, contender by contender.
    pub finished: Vec<CellResult>,
    /// Cells that did not.
    pub missing: Vec<MissingCell>,
    /// Folders of cells beside those of this grid.
    pub others: Vec<String>,
}

impl Outcome {
    /// Of cells, before any of them is looked at.
    pub(crate) fn of(cells: &[Cell]) -> Self {
        let mut contests: Vec<Contest> = Vec::new();
        for cell in cells {
            if contests.iter().all(|contest| contest.label != cell.label) {
                contests.push(Contest {
                    label: cell.label.clone(),
                    budget: cell.assembly.experiment().train.env_steps,
                    piece: cell.assembly.piece(),
                });
            }
        }
        Self { contests, ..Self::default() }
    }

    /// How many cells failed, and would again.
    pub fn failed(&self) -> usize {
        self.missing.iter().filter(|cell| cell.seed.failed).count()
    }

    /// How many cells are not finished, and would go on.
    pub fn unfinished(&self) -> usize {
        self.missing.len() - self.failed()
    }
}
