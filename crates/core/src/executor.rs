//! Who runs the jobs. Results come back in job order, and nothing in a job depends on who ran it.

use rayon::prelude::*;

/// Runs independent jobs and returns their results in the order of the jobs.
pub trait Executor: Send + Sync {
    /// How many jobs run at once.
    fn workers(&self) -> usize;

    /// Calls `job(i)` for every `i < count`, on any thread and in any order.
    fn for_each(&self, count: usize, job: &(dyn Fn(usize) + Sync));
}

impl dyn Executor + '_ {
    /// The results of `job(i)` for every `i < count`, in order.
    pub fn map<T: Send>(&self, count: usize, job: impl Fn(usize) -> T + Sync) -> Vec<T> {
        let slots: Vec<std::sync::Mutex<Option<T>>> = (0..count).map(|_| std::sync::Mutex::new(None)).collect();
        self.for_each(count, &|i| {
            let result = job(i);
            // Each slot is locked once, by the one job it belongs to.
            if let Ok(mut slot) = slots[i].lock() {
                *slot = Some(result);
            }
        });
        slots.into_iter().filter_map(|slot| slot.into_inner().ok().flatten()).collect()
    }

    /// Calls both, at once where there are workers for it; `first` before `second` where there is one.
    pub fn both<'a>(&self, first: &'a mut (dyn FnMut() + Send + 'a), second: &'a mut (dyn FnMut() + Send + 'a)) {
        let jobs = [std::sync::Mutex::new(first), std::sync::Mutex::new(second)];
        self.for_each(jobs.len(), &|i| {
            if let Ok(mut job) = jobs[i].lock() {
                job();
            }
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
