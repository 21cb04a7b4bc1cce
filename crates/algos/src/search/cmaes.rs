//! CMA-ES (Hansen 2016, "The CMA Evolution Strategy: A Tutorial", arXiv:1604.00772). Numbers in brackets are its equations.
//!
//! In the place of the tutorial's root of C, which takes all eigenvectors, stands the Cholesky factor: C = L·Lᵀ (Krause, Arbonès and
//! Igel 2016, "CMA-ES with optimal covariance update and storage complexity"). Samples L·z have the same distribution, and it takes a
//! tenth of the time. The path behind the step size sums z instead of C^(-1/2)·y, which is z turned.

mod bounds;
mod config;
mod constants;
mod matrix;
mod state;
mod stop;
#[cfg(test)]
mod tests;

use hwasp_core::{Purpose, stream};
use rand::RngExt;
use rand_distr::StandardNormal;

use self::bounds::Bounds;
pub use self::config::CmaesConfig;
use self::constants::{Constants, effective};
use self::state::{CmaesState, Scored};
pub use self::stop::Stop;
use super::{Search, SearchError, failed_last};
use crate::archive::{Exchange, Persist, StateError};

/// The candidate number whose stream draws the mean of a restart; no population is so large.
const RESTART: u64 = u64::MAX;
/// Means, steps and paths beyond this would overflow in squares.
const LARGEST: f64 = 1e150;

/// The covariance matrix adaptation evolution strategy.
///
/// Only the order of scores matters: any increasing function of them gives the same bits, `Stop` by differences of scores
/// ([`Stop::TolFun`], [`Stop::EqualFunValues`]) apart. Equal scores rank by the candidate's number. A score that is infinite
/// or NaN is a failure and ranks last; a failed candidate never pulls the mean, the weights of the others are scaled to
/// sum 1 in its stead.
///
/// A search that has stopped begins again as often as `restarts` allows, with twice the population; its mean is then drawn
/// uniformly where a coordinate has two finite bounds, and is the first mean elsewhere. After the last
/// restart [`stopped`](Search::stopped) says why, and the search can still be asked and told.
pub struct Cmaes {
    config: CmaesConfig,
    bounds: Bounds,
    constants: Constants,
    state: CmaesState,
    /// The generation at hand, once it was asked for: follows from the state.
    population: Option<Population>,
}

/// λ × n each, row-major.
struct Population {
    /// Standard normal.
    z: Vec<f64>,
    /// L·z.
    y: Vec<f64>,
}

impl Cmaes {
    /// A search around the candidate `mean`; `seed` names its random streams.
    ///
    /// # Errors
    /// [`SearchError::Setting`] where the settings or the mean are out of their limits.
    pub fn new(config: CmaesConfig, mean: &[f64], seed: u64) -> Result<Self, SearchError> {
        config.check(mean)?;
        let bounds = Bounds::new(&config, mean.len());
        let state = CmaesState::new(&config, mean.to_vec(), bounds.point(mean), seed);
        let constants = Constants::new(&config, mean.len(), config.first_popsize(mean.len()));
        Ok(Self { config, bounds, constants, state, population: None })
    }

    /// The best candidate ever told, with its score.
    pub fn best(&self) -> Option<(&[f64], f64)> {
        self.state.best.as_ref().map(|best| (&best.candidate[..], best.score))
    }

    /// λ, candidates of the generation at hand.
    pub fn popsize(&self) -> usize {
        self.constants.popsize
    }

    /// σ.
    pub fn sigma(&self) -> f64 {
        self.state.sigma
    }

    /// The samples of this generation; drawn from its streams, so that they can be thrown away.
    fn draw(&self) -> Population {
        let (n, lambda) = (self.dimension(), self.constants.popsize);
        let mut z = Vec::with_capacity(lambda * n);
        for k in 0..lambda as u64 {
            let normals = stream(self.state.seed, Purpose::Search, self.state.generation, k);
            z.extend(normals.sample_iter::<f64, _>(StandardNormal).take(n)); // (38)
        }
        let y = if self.config.separable {
            let mut scaled = z.clone();
            for row in scaled.chunks_exact_mut(n) {
                row.iter_mut().zip(&self.state.lengths).for_each(|(v, d)| *v *= d);
            }
            scaled
        } else {
            matrix::times(&self.state.factor, &z, n)
        }; // (39)
        Population { z, y }
    }

    /// The candidate m + σ·y.
    fn candidate(&self, y: &[f64]) -> Vec<f64> {
        let mut x: Vec<f64> = self.state.mean.iter().zip(y).map(|(m, y)| m + self.state.sigma * y).collect(); // (40)
        self.bounds.candidate(&mut x);
        x
    }

    /// Weights of the ranks where only the first `scored` have a score, and `μ_eff`.
    fn weights(&self, scored: usize) -> (Vec<f64>, f64) {
        let mut weights = self.constants.weights.clone();
        let positive = &mut weights[..self.constants.mu];
        if scored < positive.len() {
            positive[scored..].fill(0.0);
            let sum: f64 = positive.iter().sum();
            for w in positive.iter_mut() {
                *w /= sum;
            }
        }
        let mu_eff = effective(positive);
        (weights, mu_eff)
    }

    /// Equations (41) to (47) for the ranked candidates `order`, the first `scored` of which have a score. Gives whether
    /// the covariance could be decomposed where that was due; the state is as it was after an error.
    fn update(&mut self, population: &Population, order: &[usize], scored: usize) -> Result<bool, SearchError> {
        let (n, c) = (self.dimension(), &self.constants);
        let (weights, mu_eff) = self.weights(scored);
        let mut ranked = vec![0.0; order.len()];
        order.iter().zip(&weights).for_each(|(&k, &w)| ranked[k] = w.max(0.0));
        let mean_y = matrix::weighted_sum(&ranked, &population.y, n); // (41)
        let mean_z = matrix::weighted_sum(&ranked, &population.z, n); // L⁻¹·<y>

        let state = &self.state;
        let mean: Vec<f64> = (0..n).map(|i| state.mean[i] + c.c_m * state.sigma * mean_y[i]).collect(); // (42)
        let (keep, gain) = (1.0 - c.c_sigma, (c.c_sigma * (2.0 - c.c_sigma) * mu_eff).sqrt());
        let path_sigma: Vec<f64> = (0..n).map(|i| keep * state.path_sigma[i] + gain * mean_z[i]).collect(); // (43)
        let length = path_sigma.iter().map(|p| p * p).sum::<f64>().sqrt();
        // As in Hansen's program, never more than a factor e in a generation.
        let sigma = state.sigma * (c.c_sigma / c.d_sigma * (length / c.chi_n - 1.0)).min(1.0).exp(); // (44)
        let sigma = sigma.max(1.0 / LARGEST);

        let generations = i32::try_from(state.run_generation + 1).unwrap_or(i32::MAX);
        let unbiased = length / (1.0 - keep.powi(2).powi(generations)).sqrt();
        let stalled = unbiased >= (1.4 + 2.0 / (n as f64 + 1.0)) * c.chi_n;
        let gain = if stalled { 0.0 } else { (c.c_c * (2.0 - c.c_c) * mu_eff).sqrt() };
        let path_c: Vec<f64> = (0..n).map(|i| (1.0 - c.c_c) * state.path_c[i] + gain * mean_y[i]).collect(); // (45)

        let vectors = mean.iter().chain(&path_sigma).chain(&path_c).chain(&population.y);
        if !vectors.chain([&sigma]).all(|v| v.abs() < LARGEST) {
            return Err(SearchError::Diverged { generation: state.generation });
        }

        let mut outer = vec![0.0; order.len() + 1];
        for (&k, &w) in order.iter().zip(&weights) {
            let squared: f64 = population.z[k * n..(k + 1) * n].iter().map(|z| z * z).sum(); // ‖L⁻¹·y‖²
            outer[k] = c.c_mu * if w < 0.0 { w * n as f64 / squared } else { w }; // (46)
        }
        outer[order.len()] = c.c_1;
        let restored = if stalled { c.c_c * (2.0 - c.c_c) } else { 0.0 }; // δ(h_σ)
        let decay = 1.0 + c.c_1 * restored - c.c_1 - c.c_mu * c.weight_sum;
        let gap = c.eigen_gap;

        let state = &mut self.state;
        (state.mean, state.sigma) = (mean, sigma);
        (state.path_sigma, state.path_c) = (path_sigma, path_c);
        state.run_generation += 1;
        if self.config.separable {
            for (i, v) in state.covariance.iter_mut().enumerate() {
                let squares = outer.iter().zip(population.y.chunks_exact(n)).map(|(w, y)| w * y[i] * y[i]).sum::<f64>();
                *v = decay * *v + squares + c.c_1 * state.path_c[i].powi(2); // (47), its diagonal
            }
            return Ok(adopt(&mut state.lengths, &state.covariance));
        }
        let rows = [&population.y[..], &state.path_c].concat();
        matrix::add_outer(&mut state.covariance, decay, &outer, &rows, n); // (47)
        if state.run_generation - state.decomposed_at < gap {
            return Ok(true);
        }
        state.decomposed_at = state.run_generation;
        let Some(factor) = matrix::cholesky(&state.covariance, n) else { return Ok(false) };
        state.lengths = matrix::extremes(&factor, n).to_vec();
        state.factor = factor;
        Ok(true)
    }

    /// The next run, with twice the population.
    fn restart(&mut self) {
        let mut uniform = stream(self.state.seed, Purpose::Search, self.state.generation, RESTART);
        let mut start = self.state.start.clone();
        for (i, x) in start.iter_mut().enumerate() {
            let (lower, upper) = self.config.bound(i);
            if lower.is_finite() && upper.is_finite() {
                *x = (lower + uniform.random::<f64>() * (upper - lower)).clamp(lower, upper);
            }
        }
        let mean = self.bounds.point(&start);
        self.state.restarts += 1;
        self.state.begin_run(&self.config, mean);
        self.constants = Constants::new(&self.config, self.dimension(), 2 * self.constants.popsize);
    }
}

/// Takes the roots of variances, unless one of them is none; then the lengths stay.
fn adopt(lengths: &mut [f64], variances: &[f64]) -> bool {
    let possible = variances.iter().all(|&v| v > 0.0 && v.is_finite());
    if possible {
        lengths.iter_mut().zip(variances).for_each(|(d, v)| *d = v.sqrt());
    }
    possible
}

impl Persist for Cmaes {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        self.state.exchange(with)?;
        if self.state.restarts > self.config.restarts {
            return Err(with.refuse("restarts", f64::from(self.state.restarts), "within the settings' restarts"));
        }
        if with.loads() {
            let n = self.dimension();
            self.constants = Constants::new(&self.config, n, self.config.first_popsize(n) << self.state.restarts);
            self.population = None;
        }
        Ok(())
    }
}

impl Search for Cmaes {
    fn dimension(&self) -> usize {
        self.state.mean.len()
    }

    fn ask(&mut self) -> Vec<Vec<f64>> {
        let population = self.population.take().unwrap_or_else(|| self.draw());
        let candidates = population.y.chunks_exact(self.dimension()).map(|y| self.candidate(y)).collect();
        self.population = Some(population);
        candidates
    }

    fn tell(&mut self, scores: &[f64]) -> Result<(), SearchError> {
        let candidates = self.constants.popsize;
        let scores = failed_last(scores, candidates, self.state.generation)?;
        let mut order: Vec<usize> = (0..candidates).collect();
        // Stable; and -0 equals 0, as for any increasing function.
        order.sort_by(|&a, &b| scores[b].partial_cmp(&scores[a]).unwrap_or(std::cmp::Ordering::Equal));
        let scored = order.partition_point(|&k| scores[k].is_finite());
        let population = self.population.take().unwrap_or_else(|| self.draw());
        let n = self.dimension();
        let first = order[0];
        let better = self.state.best.as_ref().is_none_or(|best| scores[first] > best.score);
        // By the distribution it was drawn from, so before the update.
        let best = better.then(|| self.candidate(&population.y[first * n..(first + 1) * n]));
        let decomposed = match self.update(&population, &order, scored) {
            Ok(decomposed) => decomposed,
            Err(error) => {
                self.population = Some(population);
                return Err(error);
            }
        };
        if let Some(candidate) = best {
            self.state.best = Some(Scored { candidate, score: scores[first] });
        }
        self.state.generation += 1;
        let sorted: Vec<f64> = order.iter().map(|&k| scores[k].max(f64::MIN)).collect();
        stop::record(&mut self.state, &sorted);
        if self.stopped().is_none()
            && let Some(stop) = stop::test(&self.state, &self.config, &sorted, decomposed)
        {
            self.state.stops.push(stop);
            if self.stopped().is_none() {
                self.restart();
            }
        }
        Ok(())
    }

    fn center(&self) -> Vec<f64> {
        let mut center = self.state.mean.clone();
        self.bounds.candidate(&mut center);
        center
    }

    fn generation(&self) -> u64 {
        self.state.generation
    }

    /// All candidates of a generation are ranked against each other, so they share one group.
    /// `None` while restarts are left.
    fn stopped(&self) -> Option<Stop> {
        self.state.stops.get(self.config.restarts as usize).copied()
    }

    fn group(&self, _candidate: usize) -> u64 {
        0
    }
}
