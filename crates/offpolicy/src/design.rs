//! What befalls the design, and the replay for its sake, beside the critics' slope.

use std::ops::Range;

use hwasp_algos::{Cmaes, CmaesConfig, Search};
use hwasp_core::{Batch, Executor, ParamKind, Policy, Purpose, stream};
use hwasp_diff::Scalar;
use rand::RngExt;

use crate::earned::beyond_trend;
use crate::learner::OffPolicy;
use crate::rule::Rule;
use crate::worker::Worker;

/// Generations of a search of designs.
const GENERATIONS: usize = 30;
/// How far a search goes from the middle of a parameter's limits, in u of p = lo + (hi - lo)·sigmoid(u): to 2 % of either limit.
const FARTHEST: f64 = 4.0;
/// How near to a limit a design comes that follows returns, as a share of its range.
const NEAREST: f64 = 0.02;

#[allow(private_bounds)]
impl<P: Policy, R: Rule<P>> OffPolicy<P, R> {
    /// At the end of an update on a batch: moves and searches the design, and empties the replay, where it is time.
    pub(crate) fn attend_design(&mut self, executor: &dyn Executor, batch: &Batch, progress: f64, iteration: u64) {
        if self.learned.updates == 0 {
            return;
        }
        let (every, window, most, start) = {
            let settings = self.settings();
            (settings.design_search, settings.design_returns, settings.forget_beyond, settings.design_start)
        };
        if progress >= start {
            if self.learned.watch.due(batch.rows(), every) {
                self.search_design(executor, iteration);
            }
            self.follow_returns(window, batch.episodes.len());
        }
        if most > 0.0 && self.learned.watch.moved(&self.learned.params[self.design()], most) {
            self.replay.empty();
        }
    }

    /// Where the design's stand-ins lie among the parameters.
    fn design(&self) -> Range<usize> {
        let group = self.policy.groups().iter().find(|group| group.kind == ParamKind::Design);
        group.map_or(0..0, |group| group.range.clone())
    }

    /// Moves the means of what is drawn once an episode, after `new` episodes more: over a window of episodes by the covariance of draws
    /// and returns. That is the gradient of the expected return (Williams 1992), by which Schaff et al. (2019) move designs, in the
    /// metric of the draws (Wierstra et al. 2014): where less is drawn, it moves by less.
    pub(crate) fn follow_returns(&mut self, window: usize, new: usize) {
        if window == 0 {
            return;
        }
        let latest = self.replay.latest(window);
        let returns: Vec<f64> = latest.iter().map(|&(_, earned)| earned).collect();
        let Some(merits) = beyond_trend(&returns).filter(|_| latest.len() == window) else { return };
        let rate = self.design_lr_scale * new as f64 / window as f64;
        for (a, u) in self.policy.drawn_params().into_iter().enumerate() {
            let Some((lo, hi)) = self.limits[a] else { continue };
            let share = |first: usize| f64::from((self.replay.action(first)[a] - lo) / (hi - lo));
            let products = latest.iter().zip(&merits).map(|(&(first, _), merit)| merit * share(first));
            let covariance = products.sum::<f64>() / window as f64;
            let now = f64::from(self.learned.params[u]).sigmoid();
            let next = (now + rate * covariance).clamp(NEAREST, 1.0 - NEAREST);
            self.learned.params[u] = (next / (1.0 - next)).ln() as f32;
        }
    }

    /// Puts the design where the critics see the most value at the starts of episodes. No candidate is simulated (Luck et al. 2019,
    /// section 3.3; with CMA-ES for their particle swarm).
    fn search_design(&mut self, executor: &dyn Executor, iteration: u64) {
        let mut chance = stream(self.seed, Purpose::Replay, iteration, 1);
        let range = self.design();
        if range.is_empty() || !self.sample.draw_starts(&self.replay, &mut chance) {
            return;
        }
        let now: Vec<f64> =
            self.learned.params[range.clone()].iter().map(|&u| f64::from(u).clamp(-FARTHEST, FARTHEST)).collect();
        let limits = |limit| Some(vec![limit; now.len()]);
        let config =
            CmaesConfig { sigma: 1.0, lower: limits(-FARTHEST), upper: limits(FARTHEST), ..CmaesConfig::default() };
        // A search that cannot go on ends where it is.
        let Ok(mut search) = Cmaes::new(config, &now, chance.random()) else { return };
        for _ in 0..GENERATIONS {
            let scores: Vec<f64> = search
                .ask()
                .iter()
                .map(|candidate| {
                    self.put_design(range.clone(), candidate);
                    self.sample.show_candidate(&*self.policy, &self.learned.params);
                    self.run(executor, &[], Worker::value);
                    self.sum(|worker| worker.values)
                })
                .collect();
            if search.tell(&scores).is_err() {
                break;
            }
        }
        self.put_design(range, &search.center());
    }

    fn put_design(&mut self, range: Range<usize>, candidate: &[f64]) {
        for (u, &x) in self.learned.params[range].iter_mut().zip(candidate) {
            *u = x as f32;
        }
    }
}
