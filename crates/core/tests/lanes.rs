//! Steps that lanes share: exactly as many rows as are asked for, in the same order and with the same bits for any number of
//! threads and any split.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use std::ops::Range;
use std::sync::Arc;

use hwasp_core::{
    Batch, End, EnvSpec, Environment, EpisodeKind, Episodes, Executor, LaneSteps, Purpose, Sampler, Serial, Step,
    Stream, Threads, stream,
};
use rand::RngExt;

/// Ends after seven steps, and shows where it started and how many steps it took. Where it started above `limit` its physics fail
/// in the third step.
struct Seven {
    spec: EnvSpec,
    limit: f64,
    start: f64,
    taken: usize,
}

impl Environment for Seven {
    fn spec(&self) -> &EnvSpec {
        &self.spec
    }

    fn reset(&mut self, rng: &mut Stream) {
        (self.start, self.taken) = (rng.random(), 0);
    }

    fn observe(&self, out: &mut [f64]) {
        out.copy_from_slice(&[self.start, self.taken as f64, 0.0]);
    }

    fn state(&self, out: &mut [f64]) {
        out.copy_from_slice(&[self.taken as f64, self.start]);
    }

    fn step(&mut self, _effort: &[f64], _command: &[f64]) -> Step {
        self.taken += 1;
        let late = (self.taken >= self.spec.horizon).then_some(End::Truncated);
        let over = (self.taken == 7).then_some(End::Terminated);
        let failed = (self.taken == 3 && self.start > self.limit).then_some(End::Faulted);
        Step { reward: self.start + self.taken as f64, end: failed.or(over).or(late) }
    }
}

fn sampler(limit: f64, horizon: Option<usize>) -> (Sampler, Vec<f32>) {
    let policy = Arc::new(common::policy(common::all_placements().remove(3)).unwrap());
    let params = policy.init(1, 1.0);
    let make = move |horizon: Option<usize>| -> Box<dyn Environment> {
        let spec = EnvSpec { horizon: horizon.unwrap_or(100), ..common::env_spec() };
        Box::new(Seven { spec, limit, start: 0.0, taken: 0 })
    };
    (Sampler::new(policy, Arc::new(make), horizon), params)
}

fn lanes(indices: Range<u64>) -> Episodes {
    Episodes { seed: 7, iteration: 3, indices, progress: 0.3, kind: EpisodeKind::Training }
}

/// Where the episode of this index starts.
fn start(index: u64) -> f64 {
    stream(7, Purpose::TrainingReset, 3, index).random()
}

fn executors() -> [Box<dyn Executor>; 3] {
    [Box::new(Serial), Box::new(Threads::new(2).unwrap()), Box::new(Threads::new(3).unwrap())]
}

/// 50 steps in 3 lanes are 17, 17 and 16: episodes of 7, 7 and 3, of 7, 7 and 3, of 7, 7 and 2 steps. The last of each lane
/// is cut, and what comes after it is there to be valued. The n-th episode of lane l has the streams of index l + 3·n.
#[test]
fn each_lane_takes_its_share() {
    let (sampler, params) = sampler(2.0, None);
    let steps = LaneSteps { lanes: 3, steps: 50 };
    assert_eq!([0, 1, 2].map(|lane| steps.share(lane)), [17, 17, 16]);
    let batch = sampler.collect_lanes(&Serial, &params, &lanes(0..3), steps).unwrap();
    assert_eq!((batch.rows(), batch.env_steps()), (50, 50));
    let lengths: Vec<usize> = batch.episodes.iter().map(|episode| episode.rows.len()).collect();
    assert_eq!(lengths, [7, 7, 3, 7, 7, 3, 7, 7, 2]);
    let mut at = 0;
    for (i, episode) in batch.episodes.iter().enumerate() {
        let (lane, before) = (i as u64 / 3, i as u64 % 3);
        let (start, cut) = (start(lane + 3 * before), before == 2);
        assert_eq!(episode.rows, at..at + lengths[i]);
        assert_eq!((episode.cut, episode.end), (cut, if cut { End::Truncated } else { End::Terminated }), "{i}");
        for (t, row) in episode.rows.clone().enumerate() {
            // Centred and scaled by the policy: (start - 0.1)/0.5 and t.
            assert_eq!(batch.obs[row * 3..][..2], [((start - 0.1) / 0.5) as f32, t as f32]);
            assert_eq!(batch.state[row * 2..][..2], [t as f32, start as f32]);
            assert_eq!(batch.reward[row], start + (t + 1) as f64);
        }
        assert_eq!(episode.last_obs[1], lengths[i] as f32);
        assert_eq!(episode.last_state, [lengths[i] as f32, start as f32]);
        at += lengths[i];
        // It is what it would be alone, as far as it goes.
        let alone = sampler.collect(&Serial, &params, &lanes(lane + 3 * before..lane + 3 * before + 1)).unwrap();
        let width = batch.action.len() / batch.rows();
        let rows = episode.rows.start * width..episode.rows.end * width;
        assert_eq!(batch.action[rows], alone.action[..lengths[i] * width]);
        assert_eq!(batch.log_prob[episode.rows.clone()], alone.log_prob[..lengths[i]]);
    }
}

#[test]
fn threads_and_splits_change_no_bit() {
    for limit in [2.0, 0.5] {
        let (sampler, params) = sampler(limit, None);
        let steps = LaneSteps { lanes: 40, steps: 40 * 16 + 3 };
        let collect = |executor: &dyn Executor, indices| {
            sampler.collect_lanes(executor, &params, &lanes(indices), steps).unwrap()
        };
        let reference = collect(&Serial, 0..40);
        for executor in executors() {
            assert_eq!(collect(&*executor, 0..40), reference, "{} workers", executor.workers());
            let parts = [0..1, 1..8, 8..40].map(|indices| collect(&*executor, indices));
            assert_eq!(Batch::join(parts.into()), reference, "{} workers", executor.workers());
        }
    }
}

/// The steps of an episode whose physics fail are taken all the same: its rows are missing, and the next one begins.
#[test]
fn failed_episodes_take_steps_too() {
    let (sampler, params) = sampler(0.5, None);
    let steps = LaneSteps { lanes: 8, steps: 8 * 50 };
    let batch = sampler.collect_lanes(&Serial, &params, &lanes(0..8), steps).unwrap();
    assert_eq!(batch.env_steps(), 400);
    assert_eq!(batch.rows(), 400 - 3 * batch.faults.iter().filter(|fault| fault.step == 2).count());
    assert!(batch.faults.len() > 10 && batch.episodes.iter().filter(|episode| !episode.cut).count() > 10);
    for fault in &batch.faults {
        assert!(start(fault.episode) > 0.5 && fault.step == 2, "{fault}");
    }
    // Lane by lane, and in each lane in time.
    let places: Vec<_> = batch.faults.iter().map(|fault| (fault.episode % 8, fault.episode / 8)).collect();
    assert!(places.is_sorted(), "{places:?}");
}

/// An episode that ends with the last step of its lane, by itself or by its horizon, is not cut.
#[test]
fn an_end_of_its_own_is_no_cut() {
    for (horizon, end, length) in [(None, End::Terminated, 7), (Some(5), End::Truncated, 5)] {
        let (sampler, params) = sampler(2.0, horizon);
        let steps = LaneSteps { lanes: 2, steps: 4 * length as u64 };
        let batch = sampler.collect_lanes(&Serial, &params, &lanes(0..2), steps).unwrap();
        assert_eq!(batch.episodes.len(), 4);
        assert!(batch.episodes.iter().all(|e| !e.cut && e.end == end && e.rows.len() == length), "{batch:?}");
    }
}

/// Fewer steps than lanes: those without a step have no episode.
#[test]
fn a_lane_may_have_nothing_to_do() {
    let (sampler, params) = sampler(2.0, None);
    let batch = sampler.collect_lanes(&Serial, &params, &lanes(0..5), LaneSteps { lanes: 5, steps: 3 }).unwrap();
    assert_eq!((batch.rows(), batch.episodes.len()), (3, 3));
    assert!(batch.episodes.iter().all(|episode| episode.cut));
}
