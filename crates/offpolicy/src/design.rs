//! What befalls the design, and the replay for its sake, beside the critics' slope.

use std::ops::Range;

use hwasp_algos::{Cmaes, CmaesConfig, Search};
use hwasp_core::{Executor, ParamKind, Policy, Purpose, stream};
use rand::RngExt;

use crate::learner::OffPolicy;
use crate::rule::Rule;
use crate::worker::Worker;

/// Generations of a search of designs.
const GENERATIONS: usize = 30;
/// How far a search goes from the middle of a parameter's limits, in u of p = lo + (hi - lo)·sigmoid(u): to 2 % of either limit.
const FARTHEST: f64 = 4.0;

#[allow(private_bounds)]
impl<P: Policy, R: Rule<P>> OffPolicy<P, R> {
    /// At the end of an update on so many new steps: searches the design and empties the replay where it is time.
    pub(crate) fn attend_design(&mut self, executor: &dyn Executor, rows: usize, progress: f64, iteration: u64) {
        if self.learned.updates == 0 {
            return;
        }
        let (every, most, start) = {
            let settings = self.settings();
            (settings.design_search, settings.forget_beyond, settings.design_start)
        };
        if progress >= start && self.learned.watch.due(rows, every) {
            self.search_design(executor, iteration);
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
