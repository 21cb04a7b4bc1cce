//! What a search knows, apart from its settings.

use serde::{Deserialize, Serialize};

use super::{CmaesConfig, Stop};
use crate::search::SearchError;

/// Everything that a search needs to go on, apart from its settings: plain numbers, all of them finite.
///
/// Saved and read again it has to keep its bits; with `serde_json` that takes its feature `float_roundtrip`. Vectors over
/// coordinates are of the unbounded space if there are bounds; only `start` and `best` are candidates.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CmaesState {
    /// Root seed; with the generation and the candidate it names the random stream.
    pub seed: u64,
    /// The mean that was given, a candidate.
    pub start: Vec<f64>,
    /// Generations told, over all restarts.
    pub generation: u64,
    /// Restarts done.
    pub restarts: u32,
    /// Generations told since the last restart.
    pub run_generation: u64,
    /// m.
    pub mean: Vec<f64>,
    /// σ.
    pub sigma: f64,
    /// The path behind the step size.
    pub path_sigma: Vec<f64>,
    /// The path behind the rank-one update.
    pub path_c: Vec<f64>,
    /// C, row-major: the lower triangle, zeros above. The diagonal alone if separable.
    pub covariance: Vec<f64>,
    /// Bᵀ of the last decomposition, row-major: each row an eigenvector. Empty if separable.
    pub axes: Vec<f64>,
    /// D of the last decomposition: standard deviations along the axes.
    pub lengths: Vec<f64>,
    /// `run_generation` at the last decomposition.
    pub decomposed_at: u64,
    /// Best score of each generation of this run, the newest last, as far back as stagnation looks.
    pub best_scores: Vec<f64>,
    /// Median score of each of these generations.
    pub median_scores: Vec<f64>,
    /// The best candidate ever told.
    pub best: Option<Scored>,
    /// Why each run ended, in their order.
    pub stops: Vec<Stop>,
}

/// A candidate with its score.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scored {
    /// The candidate.
    pub candidate: Vec<f64>,
    /// Its score.
    pub score: f64,
}

impl CmaesState {
    /// Before the first generation, with the mean at the point `mean` of the unbounded space.
    pub(super) fn new(config: &CmaesConfig, start: Vec<f64>, mean: Vec<f64>, seed: u64) -> Self {
        let n = mean.len();
        let mut state = Self {
            seed,
            start,
            generation: 0,
            restarts: 0,
            run_generation: 0,
            mean: vec![],
            sigma: 0.0,
            path_sigma: vec![],
            path_c: vec![],
            covariance: vec![],
            axes: vec![],
            lengths: vec![1.0; n],
            decomposed_at: 0,
            best_scores: vec![],
            median_scores: vec![],
            best: None,
            stops: vec![],
        };
        state.begin_run(config, mean);
        state
    }

    /// A new distribution around `mean`; what was found stays.
    pub(super) fn begin_run(&mut self, config: &CmaesConfig, mean: Vec<f64>) {
        let n = mean.len();
        let identity = |n: usize| (0..n * n).map(|i| if i % (n + 1) == 0 { 1.0 } else { 0.0 }).collect();
        self.run_generation = 0;
        self.mean = mean;
        self.sigma = config.sigma;
        self.path_sigma = vec![0.0; n];
        self.path_c = vec![0.0; n];
        self.covariance = if config.separable { vec![1.0; n] } else { identity(n) };
        self.axes = if config.separable { vec![] } else { identity(n) };
        self.lengths = vec![1.0; n];
        self.decomposed_at = 0;
        self.best_scores.clear();
        self.median_scores.clear();
    }

    /// Whether this is a state of a search with these settings.
    pub(super) fn check(&self, config: &CmaesConfig) -> Result<(), SearchError> {
        let n = self.start.len();
        let (covariance, axes) = if config.separable { (n, 0) } else { (n * n, n * n) };
        let lengths = [
            ("state.mean", &self.mean, n),
            ("state.path_sigma", &self.path_sigma, n),
            ("state.path_c", &self.path_c, n),
            ("state.covariance", &self.covariance, covariance),
            ("state.axes", &self.axes, axes),
            ("state.lengths", &self.lengths, n),
            ("state.median_scores", &self.median_scores, self.best_scores.len()),
        ];
        for (name, values, expected) in lengths {
            if values.len() != expected {
                let limits = "as long as the settings and the state's other vectors ask for";
                return Err(SearchError::Setting { name, value: values.len() as f64, limits });
            }
            if let Some(&value) = values.iter().find(|v| !v.is_finite()) {
                return Err(SearchError::Setting { name, value, limits: "finite" });
            }
        }
        if !(self.sigma.is_finite() && self.sigma > 0.0) {
            return Err(SearchError::Setting { name: "state.sigma", value: self.sigma, limits: "above 0 and finite" });
        }
        if self.restarts > config.restarts {
            let value = f64::from(self.restarts);
            return Err(SearchError::Setting {
                name: "state.restarts",
                value,
                limits: "within the settings' restarts",
            });
        }
        Ok(())
    }

    /// Variance of coordinate `i`, in units of σ².
    pub(super) fn variance(&self, i: usize) -> f64 {
        let n = self.mean.len();
        self.covariance[if self.covariance.len() == n { i } else { i * (n + 1) }]
    }
}
