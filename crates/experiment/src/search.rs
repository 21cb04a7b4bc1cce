//! `[search]`: how the candidates of methods without a gradient of the whole are scored.

use hwasp_settings::{Fields, Settings, choice};

use crate::train::TrainSettings;

/// The most parameters of a full covariance of CMA-ES: its matrices take 1 GB then, and each decomposition seconds.
pub const MOST_CORRELATED: usize = 5000;

/// The most candidates of a Bayesian search: each costs as much as the cube of those before it.
pub const MOST_MODELLED: u64 = 1000;

choice! {
    /// What a candidate is scored by.
    pub enum Score {
        /// The undiscounted return.
        Return = "return",
        /// The discounted return.
        DiscountedReturn = "discounted_return",
    }
}

/// `[search]`.
#[derive(Clone, Debug, PartialEq)]
pub struct SearchSettings {
    /// Episodes of a candidate.
    pub episodes: usize,
    /// What counts of them.
    pub score: Score,
    /// Whether candidates act with noise.
    pub noise: bool,
    /// Steps of a candidate's own training.
    pub inner_env_steps: u64,
    /// An iteration, in rows and in words; none where the settings of it are wrong.
    iteration: Option<(u64, String)>,
}

impl SearchSettings {
    /// The defaults for trainings of these iterations. `sound`: whether those are what the file asks for.
    pub(crate) fn new(train: &TrainSettings, sound: bool) -> Self {
        let rows = train.rows() as u64;
        Self {
            episodes: 4,
            score: Score::DiscountedReturn,
            noise: false,
            inner_env_steps: rows.max(train.env_steps / 40),
            iteration: sound.then(|| (rows, train.portion())),
        }
    }
}

impl Settings for SearchSettings {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        fields.count("episodes", &mut self.episodes, 1..=100_000, "episodes of a candidate (`cmaes` and `ars`)");
        fields.choice("score", &mut self.score, "what their mean is of");
        let about = "whether candidates act with noise, whose standard deviations are then searched too";
        fields.flag("noise", &mut self.noise, about);
        fields.default("a fortieth of `train.env_steps`").limits("one iteration to 1e12");
        let about = "steps of a candidate's own training (methods that end in `-rl`)";
        fields.integer("inner_env_steps", &mut self.inner_env_steps, 1..=1_000_000_000_000, about);
        if let Some((rows, portion)) = self.iteration.take() {
            let (given, sound) = (self.inner_env_steps, fields.sound(&["inner_env_steps"]));
            fields.check("inner_env_steps", given >= rows || !sound, || {
                (
                    format!("search.inner_env_steps = {given} is less than the {portion}"),
                    "train each candidate for at least one iteration".into(),
                )
            });
        }
    }
}
