//! What a search knows, apart from its settings.

use super::{CmaesConfig, Stop};
use crate::archive::{Exchange, Persist, StateError};

/// Everything that a search needs to go on, apart from its settings: plain numbers, all of them finite. Vectors over
/// coordinates are of the unbounded space if there are bounds; only `start` and `best` are candidates.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CmaesState {
    /// Root seed; with the generation and the candidate it names the random stream. A setting.
    pub(super) seed: u64,
    /// The mean that was given, a candidate. A setting.
    pub(super) start: Vec<f64>,
    /// Generations told, over all restarts.
    pub(super) generation: u64,
    /// Restarts done.
    pub(super) restarts: u32,
    /// Generations told since the last restart.
    pub(super) run_generation: u64,
    /// m.
    pub(super) mean: Vec<f64>,
    /// σ.
    pub(super) sigma: f64,
    /// The path behind the step size.
    pub(super) path_sigma: Vec<f64>,
    /// The path behind the rank-one update.
    pub(super) path_c: Vec<f64>,
    /// C, row-major: the lower triangle, zeros above. The diagonal alone if separable.
    pub(super) covariance: Vec<f64>,
    /// L of the last decomposition, row-major: the lower triangle, zeros above. Empty if separable.
    pub(super) factor: Vec<f64>,
    /// Standard deviations, in units of σ: of the coordinates if separable, else about the shortest and the longest in any direction.
    pub(super) lengths: Vec<f64>,
    /// `run_generation` at the last decomposition.
    pub(super) decomposed_at: u64,
    /// Best score of each generation of this run, the newest last, as far back as stagnation looks.
    pub(super) best_scores: Vec<f64>,
    /// Median score of each of these generations.
    pub(super) median_scores: Vec<f64>,
    /// The best candidate ever told.
    pub(super) best: Option<Scored>,
    /// Why each run ended, in their order.
    pub(super) stops: Vec<Stop>,
}

/// A candidate with its score.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scored {
    /// The candidate.
    pub(super) candidate: Vec<f64>,
    /// Its score.
    pub(super) score: f64,
}

impl CmaesState {
    /// Before the first generation, with the mean at the point `mean` of the unbounded space.
    pub(super) fn new(config: &CmaesConfig, start: Vec<f64>, mean: Vec<f64>, seed: u64) -> Self {
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
            factor: vec![],
            lengths: vec![],
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
        self.factor = if config.separable { vec![] } else { identity(n) };
        self.lengths = vec![1.0; if config.separable { n } else { 2 }];
        self.decomposed_at = 0;
        self.best_scores.clear();
        self.median_scores.clear();
    }

    /// Variance of coordinate `i`, in units of σ².
    pub(super) fn variance(&self, i: usize) -> f64 {
        let n = self.mean.len();
        self.covariance[if self.covariance.len() == n { i } else { i * (n + 1) }]
    }
}

impl Persist for CmaesState {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        with.number("generation", &mut self.generation)?;
        with.number("run_generation", &mut self.run_generation)?;
        with.vector("mean", &mut self.mean)?;
        with.number("sigma", &mut self.sigma)?;
        if self.sigma <= 0.0 {
            return Err(with.refuse("sigma", self.sigma, "above 0"));
        }
        with.vector("path_sigma", &mut self.path_sigma)?;
        with.vector("path_c", &mut self.path_c)?;
        with.vector("covariance", &mut self.covariance)?;
        with.vector("factor", &mut self.factor)?;
        with.vector("lengths", &mut self.lengths)?;
        with.number("decomposed_at", &mut self.decomposed_at)?;
        if self.decomposed_at > self.run_generation {
            return Err(with.refuse("decomposed_at", self.decomposed_at as f64, "a generation of this run so far"));
        }
        with.series("best_scores", &mut self.best_scores)?;
        self.median_scores.resize(self.best_scores.len(), 0.0);
        with.vector("median_scores", &mut self.median_scores)?;
        // The best candidate and its score behind it; empty before the first.
        let mut best = self.best.take().map_or_else(Vec::new, |best| [best.candidate, vec![best.score]].concat());
        with.series("best", &mut best)?;
        if let Some(score) = best.pop() {
            if best.len() != self.mean.len() {
                return Err(with.refuse("best", best.len() as f64, "as many coordinates as the mean"));
            }
            self.best = Some(Scored { candidate: best, score });
        }
        let mut restarts = u64::from(self.restarts);
        with.number("restarts", &mut restarts)?;
        self.restarts = u32::try_from(restarts).unwrap_or(u32::MAX);
        let mut stops: Vec<u64> = self.stops.iter().map(|&stop| stop as u64).collect();
        with.series("stops", &mut stops)?;
        let named = |&code: &u64| Stop::ALL.get(code as usize).copied().ok_or(code);
        match stops.iter().map(named).collect() {
            Ok(stops) => self.stops = stops,
            Err(code) => return Err(with.refuse("stops", code as f64, "a reason to stop")),
        }
        Ok(())
    }
}
