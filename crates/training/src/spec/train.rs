//! `[train]`: how long, in which portions, and how the result is judged.

use serde::Serialize;

use super::section::Section;

/// The most rows of an iteration: they are all held in memory.
pub const MOST_ROWS: usize = 10_000_000;

/// `[train]`.
///
/// | key | default | meaning | limits |
/// |---|---|---|---|
/// | `env_steps` | 4 000 000 | simulator steps of the whole training | one iteration to 1e12 |
/// | `episodes_per_iteration` | 20 | episodes between updates | 1 to 100 000 |
/// | `episode_steps` | 200 | training episodes are cut to this | 1 to the horizon |
/// | `evaluation_episodes` | 1000 | episodes of an evaluation | 1 to 1 000 000 |
/// | `evaluation_seed` | 1 000 003 | root of their start states | 0 to 2^63 - 1 |
/// | `nominal_steps` | 0 | what the authors' plots count per iteration (`plot --axis nominal`); 0: the real steps | 0 to 1e12 |
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct TrainSpec {
    /// Simulator steps of the whole training.
    pub env_steps: u64,
    /// Episodes between updates.
    pub episodes_per_iteration: usize,
    /// Training episodes are truncated after so many steps.
    pub episode_steps: usize,
    /// Episodes of an evaluation.
    pub evaluation_episodes: usize,
    /// Root seed of an evaluation's start states.
    pub evaluation_seed: u64,
    /// What the authors' plots count per iteration; 0 for the real steps.
    pub nominal_steps: u64,
}

impl TrainSpec {
    /// Rows, which are steps, of an iteration.
    pub fn rows(&self) -> usize {
        self.episodes_per_iteration.saturating_mul(self.episode_steps)
    }

    /// An iteration in words.
    pub(super) fn portion(&self) -> String {
        let (episodes, steps) = (self.episodes_per_iteration, self.episode_steps);
        format!("{} rows of an iteration ({episodes} episodes of {steps} steps)", self.rows())
    }

    /// Reads the table for a task of this horizon.
    pub(super) fn read(mut s: Section<'_>, horizon: usize) -> Self {
        let mut spec = Self {
            env_steps: 0,
            episodes_per_iteration: s.count("episodes_per_iteration", 20, 1..=100_000),
            episode_steps: s.count("episode_steps", horizon.min(200), 1..=100_000),
            evaluation_episodes: s.count("evaluation_episodes", 1000, 1..=1_000_000),
            evaluation_seed: s.integer("evaluation_seed", 1_000_003, 0..=i64::MAX as u64),
            nominal_steps: s.integer("nominal_steps", 0, 0..=1_000_000_000_000),
        };
        let rows = spec.rows();
        spec.env_steps = s.integer("env_steps", 4_000_000.max(rows as u64), 1..=1_000_000_000_000);

        if spec.episode_steps > horizon && s.reader.sound(&["task.horizon"]) {
            let message = format!("train.episode_steps = {} is more than task.horizon = {horizon}", spec.episode_steps);
            s.clash("episode_steps", message, &format!("set train.episode_steps to at most {horizon}"));
        }
        let portion = spec.portion();
        if rows > MOST_ROWS {
            let hint = "take fewer or shorter episodes per iteration";
            s.clash("episodes_per_iteration", format!("the {portion} are more than {MOST_ROWS}"), hint);
        }
        if spec.env_steps < rows as u64
            && s.reader.sound(&["train.env_steps", "train.episodes_per_iteration", "train.episode_steps"])
        {
            let message = format!("train.env_steps = {} is less than the {portion}", spec.env_steps);
            s.clash("env_steps", message, "train for longer, or with fewer episodes per iteration");
        }
        s.finish();
        spec
    }
}
