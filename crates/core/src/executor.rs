//! Who runs the jobs. Results come back in job order, and nothing in a job depends on who ran it.

use std::sync::Mutex;

use rayon::prelude::*;

/// Why no slot of a result is ever poisoned.
const UNPOISONED: &str = "a slot is locked once, by the job it belongs to, and nothing panics meanwhile";

/// Runs independent jobs and returns their results in the order of the jobs.
pub trait Executor: Send + Sync {
    /// How many jobs run at once.
    fn workers(&self) -> usize;

    /// Calls `job(i)` for every `i < count`, on any thread and in any order.
    fn for_each(&self, count: usize, job: &(dyn Fn(usize) + Sync));
}

impl dyn Executor + '_ {
    /// The results of `job(i)` for every `i < count`, in order.
    ///
    /// # Panics
    /// If the executor does not run every job, or a job panics.
    pub fn map<T: Send>(&self, count: usize, job: impl Fn(usize) -> T + Sync) -> Vec<T> {
        let slots: Vec<Mutex<Option<T>>> = (0..count).map(|_| Mutex::new(None)).collect();
        self.for_each(count, &|i| {
            let result = job(i);
            *slots[i].lock().expect(UNPOISONED) = Some(result);
        });
        let result = |(i, slot): (usize, Mutex<Option<T>>)| {
            let result = slot.into_inner().expect(UNPOISONED);
            result.unwrap_or_else(|| panic!("the executor did not run job {i} of {count}"))
        };
        slots.into_iter().enumerate().map(result).collect()
    }

    /// Calls both, at once where there are workers for it; `first` before `second` where there is one.
    ///
    /// # Panics
    /// If one of them panics.
    pub fn both<'a>(&self, first: &'a mut (dyn FnMut() + Send + 'a), second: &'a mut (dyn FnMut() + Send + 'a)) {
        let jobs = [Mutex::new(first), Mutex::new(second)];
        self.for_each(jobs.len(), &|i| {
            let mut job = jobs[i].lock().expect("an executor runs every job once");
            job();
        });
    }
}

/// One job after the other on the calling thread.
#[derive(Clone, Copy, Debug, Default)]
pub struct Serial;

impl Executor for Serial {
    fn workers(&self) -> usize {
        1
    }

    fn for_each(&self, count: usize, job: &(dyn Fn(usize) + Sync)) {
        (0..count).for_each(job);
    }
}

/// A pool of threads.
#[derive(Debug)]
pub struct Threads {
    pool: rayon::ThreadPool,
}

impl Threads {
    /// A pool of `count` threads; the error is the operating system's.
    pub fn new(count: usize) -> Result<Self, rayon::ThreadPoolBuildError> {
        Ok(Self { pool: rayon::ThreadPoolBuilder::new().num_threads(count).build()? })
    }
}

impl Executor for Threads {
    fn workers(&self) -> usize {
        self.pool.current_num_threads()
    }

    fn for_each(&self, count: usize, job: &(dyn Fn(usize) + Sync)) {
        self.pool.install(|| (0..count).into_par_iter().for_each(job));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Forgets the last job.
    struct Forgetful;

    impl Executor for Forgetful {
        fn workers(&self) -> usize {
            1
        }

        fn for_each(&self, count: usize, job: &(dyn Fn(usize) + Sync)) {
            (1..count).for_each(|i| job(i - 1));
        }
    }

    /// The result of a job that was not run was left out: a batch had fewer episodes than were asked for, and nobody said so.
    #[test]
    #[should_panic(expected = "the executor did not run job 2 of 3")]
    fn a_job_that_is_not_run_is_no_shorter_list() {
        let executor: &dyn Executor = &Forgetful;
        executor.map(3, |i| i);
    }
}
