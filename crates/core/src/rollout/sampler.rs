//! Runs episodes of a policy over an executor's workers.

use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard};

use super::lanes::{Keep, Lanes};
use super::{Batch, EpisodeResult, Episodes, LaneSteps, RolloutError};
use crate::environment::{Environment, MakeEnvironment};
use crate::executor::Executor;
use crate::policy::{Actor, HardwarePolicy};

/// Episodes that one job steps in lock step, at most.
const LANES: usize = 32;
/// Jobs of each worker after which results are taken in: enough that no worker waits long for the others, and few.
const JOBS_PER_WORKER: usize = 16;

/// Runs episodes of one policy in environments of one kind. Environments are made once per thread and reused.
pub struct Sampler {
    policy: Arc<HardwarePolicy>,
    make: Arc<dyn MakeEnvironment>,
    horizon: Option<usize>,
    /// Sets of environments that go in lock step, each for one job at a time.
    idle: Mutex<Vec<Vec<Box<dyn Environment>>>>,
}

impl std::fmt::Debug for Sampler {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Sampler").field("policy", &self.policy).field("horizon", &self.horizon).finish_non_exhaustive()
    }
}

impl Sampler {
    /// `horizon` replaces the task's own episode length.
    pub fn new(policy: Arc<HardwarePolicy>, make: Arc<dyn MakeEnvironment>, horizon: Option<usize>) -> Self {
        Self { policy, make, horizon, idle: Mutex::new(Vec::new()) }
    }

    /// The policy that acts.
    pub fn policy(&self) -> &Arc<HardwarePolicy> {
        &self.policy
    }

    /// Runs the episodes and returns them with all of their rows, in the order of their indices.
    ///
    /// # Errors
    /// Where a reward or a log-probability is no number, or where the physics failed in every episode. Told is the one with
    /// the lowest index, whatever the number of workers.
    pub fn collect(&self, executor: &dyn Executor, params: &[f32], episodes: &Episodes) -> Result<Batch, RolloutError> {
        self.collect_part(executor, params, episodes)?.sound()
    }

    /// The same of episodes that are a part of those that were asked for: [`Batch::join`] puts parts together, and
    /// [`Batch::sound`] sees whether all failed.
    ///
    /// # Errors
    /// Where a reward or a log-probability is no number.
    pub fn collect_part(
        &self,
        executor: &dyn Executor,
        params: &[f32],
        episodes: &Episodes,
    ) -> Result<Batch, RolloutError> {
        let lanes = lanes(executor, &episodes.indices);
        let parts = self.jobs(executor, params, episodes, lanes, Keep::Rows(None), |lanes, _| lanes.batch());
        Ok(Batch::join(parts.into_iter().collect::<Result<_, _>>()?))
    }

    /// Runs lanes instead of single episodes: `episodes.indices` are some of them, and each takes its share of `steps`. The
    /// batch has the episodes of one lane after those of the other. Parts are put together as those of
    /// [`collect_part`](Self::collect_part) are.
    ///
    /// # Errors
    /// Where a reward or a log-probability is no number. Told is the first of the lane with the lowest index.
    pub fn collect_lanes(
        &self,
        executor: &dyn Executor,
        params: &[f32],
        episodes: &Episodes,
        steps: LaneSteps,
    ) -> Result<Batch, RolloutError> {
        let lanes = lanes(executor, &episodes.indices);
        let parts = self.jobs(executor, params, episodes, lanes, Keep::Rows(Some(steps)), |lanes, _| lanes.batch());
        Ok(Batch::join(parts.into_iter().collect::<Result<_, _>>()?))
    }

    /// Runs the episodes as [`collect`](Self::collect) does, with the same bits, and keeps of each what it came to, in the
    /// order of their indices: the error where its physics failed. What is held of an episode does not grow with its steps.
    ///
    /// # Errors
    /// As those of [`collect`](Self::collect).
    pub fn outcomes(
        &self,
        executor: &dyn Executor,
        params: &[f32],
        episodes: &Episodes,
        discount: f64,
    ) -> Result<Vec<Result<EpisodeResult, RolloutError>>, RolloutError> {
        let results = self.outcomes_part(executor, params, episodes, discount)?;
        all_failed(&results).map_or(Ok(results), Err)
    }

    /// The same of episodes that are a part of those that were asked for: parts are put together one after the other, and
    /// [`all_failed`] sees whether all failed.
    ///
    /// # Errors
    /// As those of [`collect_part`](Self::collect_part).
    pub fn outcomes_part(
        &self,
        executor: &dyn Executor,
        params: &[f32],
        episodes: &Episodes,
        discount: f64,
    ) -> Result<Vec<Result<EpisodeResult, RolloutError>>, RolloutError> {
        let lanes = lanes(executor, &episodes.indices);
        let round = (lanes * executor.workers() * JOBS_PER_WORKER) as u64;
        let Range { start, end } = episodes.indices;
        let mut results = Vec::with_capacity((end - start) as usize);
        for first in (start..end).step_by(round as usize) {
            let round = Episodes { indices: first..(first + round).min(end), ..episodes.clone() };
            let job = |lanes: &mut Lanes<'_>, episodes: &Episodes| lanes.results(episodes, discount);
            for part in self.jobs(executor, params, &round, lanes, Keep::Rewards, job) {
                results.extend(part?);
            }
        }
        Ok(results)
    }

    /// Runs episodes in jobs of so many lanes at most, and returns what `result` makes of each job, in order.
    fn jobs<T: Send>(
        &self,
        executor: &dyn Executor,
        params: &[f32],
        episodes: &Episodes,
        lanes: usize,
        keep: Keep,
        result: impl Fn(&mut Lanes<'_>, &Episodes) -> T + Sync,
    ) -> Vec<Result<T, RolloutError>> {
        let Range { start, end } = episodes.indices;
        executor.map(((end - start) as usize).div_ceil(lanes), |job| {
            let first = start + (job * lanes) as u64;
            let indices = first..(first + lanes as u64).min(end);
            self.run(params, &Episodes { indices, ..episodes.clone() }, keep, &result)
        })
    }

    fn idle(&self) -> MutexGuard<'_, Vec<Vec<Box<dyn Environment>>>> {
        self.idle.lock().expect("nothing panics while the list is locked")
    }

    /// Takes idle environments, and makes those that are missing.
    fn environments(&self, count: usize) -> Vec<Box<dyn Environment>> {
        let mut set = self.idle().pop().unwrap_or_default();
        if set.len() < count {
            set.extend(self.make.make_many(count - set.len(), self.horizon));
        }
        set
    }

    /// One job: its episodes in lock step, and what `result` makes of them.
    fn run<T>(
        &self,
        params: &[f32],
        episodes: &Episodes,
        keep: Keep,
        result: impl Fn(&mut Lanes<'_>, &Episodes) -> T,
    ) -> Result<T, RolloutError> {
        let count = (episodes.indices.end - episodes.indices.start) as usize;
        let mut environments = self.environments(count);
        // The last job may have fewer lanes than others.
        let rest = environments.split_off(count);
        let mut lanes = Lanes::new(&self.policy, params, environments, episodes, keep);
        let mut actor = Actor::new(&self.policy, params, episodes.progress, count);
        let result = lanes.run(&mut actor, episodes).map(|()| result(&mut lanes, episodes));
        let mut set = std::mem::take(&mut lanes.environments);
        set.extend(rest);
        self.idle().push(set);
        result
    }
}

/// The first failure, where the physics of every episode failed.
pub fn all_failed(results: &[Result<EpisodeResult, RolloutError>]) -> Option<RolloutError> {
    let first = results.first()?.as_ref().err()?;
    results.iter().all(Result::is_err).then(|| first.clone())
}

/// Episodes of one job: as many as give every worker one, up to [`LANES`].
fn lanes(executor: &dyn Executor, indices: &Range<u64>) -> usize {
    let count = (indices.end - indices.start) as usize;
    count.div_ceil(executor.workers()).clamp(1, LANES)
}
