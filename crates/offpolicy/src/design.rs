//! What befalls the design, and the replay for its sake, beside the critics' slope.

use std::ops::Range;

use hwasp_algos::{Cmaes, CmaesConfig, Exchange, Persist, Search, StateError};
use hwasp_core::{Executor, ParamKind, Policy, Purpose, stream};
use rand::RngExt;

use crate::learner::OffPolicy;
use crate::rule::Rule;
use crate::worker::Worker;

/// Generations of a search of designs.
const GENERATIONS: usize = 30;
/// How far a search goes from the middle of a parameter's limits, in u of p = lo + (hi - lo)·sigmoid(u): to 2 % of either limit.
const FARTHEST: f64 = 4.0;

/// What is remembered of the design.
#[derive(Clone, Debug, Default)]
pub(crate) struct Watch {
    /// The stand-ins of its parameters when the replay was last emptied; none before it first could be.
    then: Vec<f32>,
    /// Steps of the simulator since it was last searched.
    unsearched: u64,
}

impl Watch {
    /// Whether one of the stand-ins has moved by more than this share of its range since this was last so.
    pub(crate) fn moved(&mut self, design: &[f32], most: f64) -> bool {
        let share = |u: f32| 1.0 / (1.0 + f64::from(-u).exp());
        let beyond = self.then.iter().zip(design).any(|(&then, &now)| (share(now) - share(then)).abs() > most);
        if beyond || self.then.is_empty() {
            self.then = design.to_vec();
        }
        beyond
    }

    /// Whether a search is due after so many steps more.
    pub(crate) fn due(&mut self, steps: usize, every: usize) -> bool {
        self.unsearched += steps as u64;
        let due = every > 0 && self.unsearched >= every as u64;
        if due {
            self.unsearched = 0;
        }
        due
    }
}

impl Persist for Watch {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        with.series("then", &mut self.then)?;
        with.number("unsearched", &mut self.unsearched)
    }
}

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
                    self.sample.show_design(&*self.policy, &self.learned.params, &self.learned.params);
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

#[cfg(test)]
mod tests {
    use super::*;

    /// u of 0, 0.1 and 0.2 are 50, 52.5 and 55 % of a range.
    #[test]
    fn a_move_counts_from_where_it_was_last_noticed() {
        let mut watch = Watch::default();
        let moved = [0.0, 0.1, 0.2, 0.3, -0.1].map(|u| watch.moved(&[0.0, u], 0.04));
        assert_eq!(moved, [false, false, true, false, true]);
    }

    #[test]
    fn a_search_is_due_after_so_many_steps() {
        let mut watch = Watch::default();
        assert_eq!([400, 400, 400, 900].map(|steps| watch.due(steps, 1000)), [false, false, true, false]);
        assert!(!watch.due(1_000_000, 0));
    }
}
