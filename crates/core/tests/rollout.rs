//! Rollouts: the same bits for any number of threads and any split, episodes that end early, and numbers that are none.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use std::ops::Range;
use std::sync::Arc;

use hwasp_core::{
    Batch, End, EnvSpec, Environment, EpisodeKind, Episodes, Executor, Outcome, Purpose, Sampler, Serial, Step, Stream,
    Threads, stream,
};
use rand::RngExt;

fn episodes(indices: Range<u64>, kind: EpisodeKind) -> Episodes {
    Episodes { seed: 7, iteration: 3, indices, progress: 0.3, kind }
}

/// 40 episodes are two jobs of 32 and 8 on one thread, 20 and 20 on two, 14, 14 and 12 on three, and any other number when
/// the indices are split beforehand.
#[test]
fn threads_and_splits_change_no_bit() {
    let executors: Vec<Box<dyn Executor>> = vec![
        Box::new(Serial),
        Box::new(Threads::new(1).unwrap()),
        Box::new(Threads::new(2).unwrap()),
        Box::new(Threads::new(3).unwrap()),
    ];
    for placements in common::all_placements() {
        let policy = Arc::new(common::policy(placements).unwrap());
        let params = policy.init(1, 1.0);
        for kind in [EpisodeKind::Training, EpisodeKind::Evaluation, EpisodeKind::NoisyEvaluation] {
            let sampler = Sampler::new(Arc::clone(&policy), common::make(), None);
            let collect =
                |executor: &dyn Executor, indices| sampler.collect(executor, &params, &episodes(indices, kind));
            let reference = collect(&Serial, 0..40).unwrap();
            assert!(reference.rows() < 40 * common::HORIZON, "no episode ended early");
            for executor in &executors {
                let together = collect(&**executor, 0..40).unwrap();
                assert_eq!(common::bits(&together), common::bits(&reference), "{} workers", executor.workers());
                let parts = [0..1, 1..8, 8..40].map(|indices| collect(&**executor, indices).unwrap());
                for (e, (part, i)) in parts.iter().flat_map(|p| (0..p.episodes.len()).map(move |i| (p, i))).enumerate()
                {
                    assert_eq!(episode_bits(part, i), episode_bits(&reference, e), "episode {e}");
                }
            }
        }
    }
}

/// Everything about episode `e`, wherever it lies in its batch.
fn episode_bits(batch: &Batch, e: usize) -> Vec<u64> {
    let episode = &batch.episodes[e];
    let rows = episode.rows.clone();
    let narrow = [&batch.obs, &batch.state, &batch.action, &batch.log_prob].map(|column| {
        let width = column.len() / batch.rows();
        column[rows.start * width..rows.end * width].iter().map(|x| u64::from(x.to_bits())).collect::<Vec<_>>()
    });
    let mut bits = narrow.concat();
    bits.extend(batch.reward[rows].iter().map(|x| x.to_bits()));
    bits.extend(episode.last_obs.iter().map(|x| u64::from(x.to_bits())));
    bits.push(episode.end as u64);
    bits
}

#[test]
fn every_part_of_a_name_gives_other_episodes() {
    let policy = Arc::new(common::policy(common::all_placements().remove(0)).unwrap());
    let params = policy.init(1, 1.0);
    let sampler = Sampler::new(policy, common::make(), None);
    let bits = |episodes| common::bits(&sampler.collect(&Serial, &params, &episodes).unwrap());
    let base = episodes(0..2, EpisodeKind::Training);
    let reference = bits(base.clone());
    assert_ne!(reference, bits(Episodes { seed: 8, ..base.clone() }));
    assert_ne!(reference, bits(Episodes { iteration: 4, ..base.clone() }));
    assert_ne!(reference, bits(Episodes { indices: 1..3, ..base.clone() }));
    assert_ne!(reference, bits(Episodes { kind: EpisodeKind::NoisyEvaluation, ..base }));
}

#[test]
fn no_episodes_are_an_empty_batch() {
    let policy = Arc::new(common::policy(common::all_placements().remove(0)).unwrap());
    let params = policy.init(1, 1.0);
    let sampler = Sampler::new(policy, common::make(), None);
    for executor in [&Serial as &dyn Executor, &Threads::new(2).unwrap()] {
        let batch = sampler.collect(executor, &params, &episodes(5..5, EpisodeKind::Training)).unwrap();
        assert_eq!(batch, Batch::default());
    }
}

/// What a [`Clock`] does after its start.
#[derive(Clone, Copy, PartialEq)]
enum Habit {
    /// Ends after 1 + 16·start steps, rounded down, unless the horizon comes first.
    EndsEarly,
    /// Gives no number as reward in step 4 where it started above a half.
    LosesReward,
    /// The same, but later the earlier it started: in the last step where it started at a half.
    LosesRewardLate,
    /// Its physics fail there.
    Faults,
}

/// Shows where it started, in [0, 1), and how many steps it took; the reward is their sum.
struct Clock {
    spec: EnvSpec,
    habit: Habit,
    start: f64,
    taken: usize,
    /// What its episodes are called.
    kind: Arc<str>,
}

const HORIZON: usize = 10;
const BAD_STEP: usize = 4;

impl Clock {
    fn made(habit: Habit) -> Arc<dyn hwasp_core::MakeEnvironment> {
        Arc::new(move |horizon: Option<usize>| -> Box<dyn Environment> {
            let mut spec = Self::shown();
            spec.horizon = horizon.unwrap_or(HORIZON);
            Box::new(Self { spec, habit, start: 0.0, taken: 0, kind: format!("clock of {HORIZON}").into() })
        })
    }

    /// What it shows: the start is its context, too.
    fn shown() -> EnvSpec {
        let mut spec = common::env_spec();
        spec.context = vec![spec.state[1].clone()];
        spec
    }

    fn length(start: f64) -> usize {
        1 + (16.0 * start) as usize
    }
}

impl Environment for Clock {
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
        out.copy_from_slice(&[-(self.taken as f64), self.start]);
    }

    fn context(&self, out: &mut [f64]) {
        out.copy_from_slice(&[self.start]);
    }

    fn step(&mut self, _effort: &[f64], _command: &[f64]) -> Step {
        let bad = self.taken == BAD_STEP && self.start > 0.5;
        self.taken += 1;
        let (reward, end) = match self.habit {
            Habit::Faults => (1.0, bad.then_some(End::Faulted)),
            Habit::LosesReward => (if bad { f64::NAN } else { 1.0 }, None),
            Habit::LosesRewardLate => {
                let lost = self.start > 0.5 && self.taken == HORIZON - (16.0 * (self.start - 0.5)) as usize;
                (if lost { f64::NAN } else { 1.0 }, None)
            }
            Habit::EndsEarly => {
                let over = self.taken == Self::length(self.start);
                (self.start + self.taken as f64, over.then_some(End::Terminated))
            }
        };
        Step { reward, end: end.or((self.taken >= self.spec.horizon).then_some(End::Truncated)) }
    }

    fn outcome(&self) -> Option<Outcome> {
        Some(Outcome { kind: Arc::clone(&self.kind), success: self.start > 0.25 })
    }

    fn fault(&self) -> Option<String> {
        Some(format!("it started at {}", self.start))
    }
}

/// The policy of the winch, which sees the clock as it is.
fn sampler(habit: Habit) -> (Sampler, Vec<f32>) {
    let mut spec = common::policy_spec(common::all_placements().remove(3));
    spec.observation_center = vec![0.0; 3];
    spec.observation_scale = vec![1.0; 3];
    let policy = hwasp_core::HardwarePolicy::new(spec, &Clock::shown()).unwrap();
    let params = policy.init(1, 1.0);
    (Sampler::new(Arc::new(policy), Clock::made(habit), None), params)
}

/// Where the clock of this episode starts.
fn start(seed: u64, iteration: u64, episode: u64) -> f64 {
    stream(seed, Purpose::TrainingReset, iteration, episode).random()
}

#[test]
fn episodes_that_end_early_leave_no_gaps() {
    let (sampler, params) = sampler(Habit::EndsEarly);
    for executor in [&Serial as &dyn Executor, &Threads::new(2).unwrap()] {
        let batch = sampler.collect(executor, &params, &episodes(0..40, EpisodeKind::Training)).unwrap();
        let mut row = 0;
        let mut ends = [0, 0];
        for (e, episode) in batch.episodes.iter().enumerate() {
            let start = start(7, 3, e as u64);
            let length = Clock::length(start).min(HORIZON);
            assert_eq!(episode.rows, row..row + length);
            let end = if Clock::length(start) <= HORIZON { End::Terminated } else { End::Truncated };
            assert_eq!(episode.end, end);
            ends[end as usize] += 1;
            for t in 0..length {
                assert_eq!(batch.obs[row * 3..][..3], [start as f32, t as f32, 0.0]);
                assert_eq!(batch.state[row * 2..][..2], [-(t as f32), start as f32]);
                assert_eq!(batch.reward[row], start + (t + 1) as f64);
                row += 1;
            }
            assert_eq!(episode.last_obs, [start as f32, length as f32, 0.0]);
            assert_eq!(episode.context, [start as f32]);
        }
        assert!(ends[0] > 5 && ends[1] > 5, "both ends should be seen: {ends:?}");
        assert_eq!(batch.rows(), row);
        assert_eq!(batch.log_prob.len(), row);
        assert_eq!([batch.obs.len(), batch.state.len()], [3 * row, 2 * row]);
        assert_eq!(batch.action.len(), row * sampler.policy().action_names().len());
    }
}

/// The horizon of the sampler replaces the task's own.
#[test]
fn a_shorter_horizon_truncates() {
    let policy = Arc::new(common::policy(common::all_placements().remove(0)).unwrap());
    let params = policy.init(1, 1.0);
    let sampler = Sampler::new(policy, common::make(), Some(3));
    let batch = sampler.collect(&Serial, &params, &episodes(0..10, EpisodeKind::Training)).unwrap();
    assert!(batch.episodes.iter().any(|e| e.rows.len() == 3 && e.end == End::Truncated));
    assert!(batch.episodes.iter().all(|e| e.rows.len() <= 3));
}

#[test]
fn discounted_returns_by_hand() {
    let (sampler, params) = sampler(Habit::EndsEarly);
    let batch = sampler.collect(&Serial, &params, &episodes(0..6, EpisodeKind::Training)).unwrap();
    for (e, total) in batch.returns(0.5).into_iter().enumerate() {
        // Σ 0.5^t·(start + t + 1)
        let start = start(7, 3, e as u64);
        let wanted: f64 =
            (0..Clock::length(start).min(HORIZON)).map(|t| 0.5_f64.powi(t as i32) * (start + t as f64 + 1.0)).sum();
        assert!((total - wanted).abs() < 1e-12, "{total} against {wanted}");
    }
}

#[test]
fn a_reward_that_is_no_number_is_named() {
    let (sampler, params) = sampler(Habit::LosesReward);
    let first = (0..1000).find(|&e| start(7, 3, e) <= 0.5 && start(7, 3, e + 1) <= 0.5).unwrap();
    let bad = (first..1000).find(|&e| start(7, 3, e) > 0.5).unwrap();
    assert!(bad < first + 40);
    for executor in [&Serial as &dyn Executor, &Threads::new(2).unwrap()] {
        let training = episodes(first..first + 40, EpisodeKind::Training);
        let error = sampler.collect(executor, &params, &training).unwrap_err();
        assert_eq!(
            error.to_string(),
            format!("episode {bad} of iteration 3 (seed 7) failed at step 4: the reward is NaN")
        );
        // The environments are good for the next batch.
        let batch = sampler.collect(executor, &params, &episodes(first..first + 1, EpisodeKind::Training)).unwrap();
        assert_eq!(batch.reward, [1.0; HORIZON]);
    }
}

/// Which of two failing episodes was told depended on the number of threads: in one job the first in time, in several jobs
/// the first by index. Here the later episode fails in an earlier step, and both are lanes of the same job on one thread.
#[test]
fn the_first_failing_episode_is_told_for_any_number_of_workers() {
    let (sampler, params) = sampler(Habit::LosesRewardLate);
    let step = |episode| HORIZON - (16.0 * (start(7, 3, episode) - 0.5)) as usize - 1;
    let fails = |episode: &u64| start(7, 3, *episode) > 0.5;
    // Ten episodes, the first of which fails after another one of them.
    let from = (0..1000).find(|&from| {
        let failing: Vec<u64> = (from..from + 10).filter(fails).collect();
        failing.len() >= 2 && failing[0] > from && failing[1..].iter().any(|&other| step(other) < step(failing[0]))
    });
    let from = from.unwrap();
    let first = (from..from + 10).find(fails).unwrap();
    for executor in [&Serial as &dyn Executor, &Threads::new(2).unwrap(), &Threads::new(5).unwrap()] {
        let error = sampler.collect(executor, &params, &episodes(from..from + 10, EpisodeKind::Training)).unwrap_err();
        assert_eq!((error.episode, error.step), (first, step(first)), "{} workers", executor.workers());
    }
}

/// Episodes whose physics fail are thrown away, told by name and charged; the others are as they were without them. Their
/// kind had to be a text of the program, so that no task could name its kinds after its settings.
#[test]
fn episodes_that_fault_are_discarded_and_counted() {
    let (sampler, params) = sampler(Habit::Faults);
    let (sound, _) = self::sampler(Habit::LosesReward);
    let all = 0..40;
    let starts: Vec<f64> = all.clone().map(|e| start(7, 3, e)).collect();
    for executor in [&Serial as &dyn Executor, &Threads::new(2).unwrap()] {
        let batch = sampler.collect(executor, &params, &episodes(all.clone(), EpisodeKind::Training)).unwrap();
        let bad: Vec<u64> = all.clone().filter(|&e| starts[e as usize] > 0.5).collect();
        assert_eq!(batch.faults.iter().map(|f| f.episode).collect::<Vec<_>>(), bad);
        let fault = &batch.faults[0];
        let what = format!("it started at {}", starts[fault.episode as usize]);
        assert_eq!((fault.seed, fault.iteration, fault.step, &fault.what), (7, 3, BAD_STEP, &what));
        assert_eq!(batch.env_steps(), (batch.episodes.len() * HORIZON + bad.len() * (BAD_STEP + 1)) as u64);
        let good: Vec<u64> = all.clone().filter(|e| !bad.contains(e)).collect();
        assert_eq!(batch.episodes.len(), good.len());
        for (episode, &index) in batch.episodes.iter().zip(&good) {
            let alone = sound.collect(&Serial, &params, &episodes(index..index + 1, EpisodeKind::Training)).unwrap();
            let width = batch.action.len() / batch.rows();
            let rows = episode.rows.start * width..episode.rows.end * width;
            assert_eq!(batch.action[rows], alone.action[..]);
            let success = starts[index as usize] > 0.25;
            assert_eq!(episode.outcome, Some(Outcome { kind: "clock of 10".into(), success }));
        }
        let only = episodes(bad[0]..bad[0] + 1, EpisodeKind::Training);
        assert_eq!(sampler.collect(executor, &params, &only).unwrap_err(), *fault);
    }
}

/// An evaluation kept every row of every episode until the last was over: 32,000 episodes took 1.5 GB. What episodes come to
/// is known without their rows, to the same bits; and 1,100 of them are several rounds of jobs.
#[test]
fn what_episodes_come_to_is_what_their_rows_give() {
    for habit in [Habit::EndsEarly, Habit::Faults] {
        let (sampler, params) = sampler(habit);
        let asked = episodes(3..1103, EpisodeKind::Training);
        let batch = sampler.collect(&Serial, &params, &asked).unwrap();
        let (discounted, undiscounted) = (batch.returns(0.9), batch.returns(1.0));
        for executor in [&Serial as &dyn Executor, &Threads::new(2).unwrap()] {
            let results = sampler.outcomes(executor, &params, &asked, 0.9).unwrap();
            assert_eq!(results.len(), 1100);
            let faults: Vec<_> = results.iter().filter_map(|result| result.as_ref().err().cloned()).collect();
            assert_eq!(faults, batch.faults);
            let sound: Vec<_> = results.iter().flatten().collect();
            assert_eq!(sound.len(), batch.episodes.len());
            for (e, (result, episode)) in sound.into_iter().zip(&batch.episodes).enumerate() {
                let returns = [result.discounted_return, result.undiscounted_return];
                assert_eq!(returns.map(f64::to_bits), [discounted[e], undiscounted[e]].map(f64::to_bits));
                let (steps, end, outcome) = (result.steps, result.end, &result.outcome);
                assert_eq!((steps, end, outcome), (episode.rows.len(), episode.end, &episode.outcome));
            }
        }
    }
}

#[test]
fn what_episodes_come_to_has_the_errors_of_their_rows() {
    for habit in [Habit::LosesReward, Habit::LosesRewardLate, Habit::Faults] {
        let (sampler, params) = sampler(habit);
        let bad = (0..1000).find(|&e| start(7, 3, e) > 0.5).unwrap();
        let asked = episodes(bad..bad + if habit == Habit::Faults { 1 } else { 700 }, EpisodeKind::Training);
        let wanted = sampler.collect(&Serial, &params, &asked).unwrap_err();
        for executor in [&Serial as &dyn Executor, &Threads::new(2).unwrap()] {
            assert_eq!(sampler.outcomes(executor, &params, &asked, 0.9).unwrap_err(), wanted);
        }
    }
    let (sampler, params) = sampler(Habit::EndsEarly);
    let none = sampler.outcomes(&Serial, &params, &episodes(5..5, EpisodeKind::Training), 0.9);
    assert_eq!(none, Ok(vec![]));
}
