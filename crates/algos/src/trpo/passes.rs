//! Passes over the rows of a batch, on any number of threads with the same bits.

use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard};

use hwasp_core::{Executor, Policy};

use crate::minibatch::{BLOCK, Minibatch};
use crate::surrogate::Surrogate;

/// Blocks of rows that one job works on, at least.
const FEWEST_BLOCKS: usize = 4;
/// Jobs of a pass at most: each keeps a gradient.
const MOST_JOBS: usize = 256;

/// Blocks of rows that one job works on, and jobs. They follow from the rows alone, and sums go over jobs in their order:
/// who works does not matter.
fn jobs(rows: &Minibatch) -> (usize, usize) {
    let blocks = rows.count.div_ceil(BLOCK);
    let each = blocks.div_ceil(MOST_JOBS).max(FEWEST_BLOCKS);
    (each, blocks.div_ceil(each))
}

/// A policy, with what passes over a batch write. Working memory belongs to whoever works, results to the job.
pub(super) struct Passes<P: Policy> {
    policy: Arc<P>,
    idle: Mutex<Vec<Worker<P>>>,
    sums: Vec<Mutex<JobSums>>,
}

struct Worker<P: Policy> {
    tape: P::Tape,
    /// Whether the tape holds the parameters of the pass at hand.
    bound: bool,
    cotangent: Vec<f32>,
}

/// What one job gave.
#[derive(Default)]
struct JobSums {
    gradient: Vec<f32>,
    log_std_gradient: Vec<f32>,
    /// Means of the policy that acted, `[A × BLOCK]` for each block.
    old_mean: Vec<f32>,
    surrogate: f64,
    kl: f64,
    draw_kl: f64,
}

/// What parameters are worth beside those that acted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Judged {
    /// -mean(ρ·A), draws included.
    pub(super) loss: f64,
    /// KL(old || new), the mean over the rows with draws counted once an episode, nats.
    pub(super) kl: f64,
    /// KL(old || new) of what is drawn, the mean over the draws, nats; 0 where nothing is.
    pub(super) draw_kl: f64,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().expect("a pass ends where one of its jobs panics")
}

impl<P: Policy> Passes<P> {
    pub(super) fn new(policy: Arc<P>) -> Self {
        Self { policy, idle: Mutex::new(Vec::new()), sums: Vec::new() }
    }

    pub(super) fn policy(&self) -> &P {
        &self.policy
    }

    fn log_std(&self, params: &[f32], progress: f64) -> Vec<f32> {
        let mut log_std = vec![0.0; self.policy.action_dim()];
        self.policy.log_std(params, progress, &mut log_std);
        log_std
    }

    /// Calls `job` for each stretch of the rows with a worker, the place for results, and its blocks. Whoever works on the
    /// first of its jobs is bound by `bind`: parameters are packed once a pass, not once a job.
    fn each(
        &self,
        executor: &dyn Executor,
        rows: &Minibatch,
        bind: impl Fn(&mut P::Tape) + Sync,
        job: impl Fn(&mut Worker<P>, &mut JobSums, &mut dyn Iterator<Item = Range<usize>>) + Sync,
    ) {
        let (each, count) = jobs(rows);
        lock(&self.idle).iter_mut().for_each(|worker| worker.bound = false);
        // Not `for_each`: what a job that did not run had left in its place would count as its result.
        executor.map(count, |i| {
            let idle = lock(&self.idle).pop();
            let mut worker = idle.unwrap_or_else(|| Worker {
                tape: self.policy.tape(BLOCK),
                bound: false,
                cotangent: vec![0.0; self.policy.action_dim() * BLOCK],
            });
            if std::mem::replace(&mut worker.bound, true) {
                self.policy.clear(&mut worker.tape);
            } else {
                bind(&mut worker.tape);
            }
            job(&mut worker, &mut lock(&self.sums[i]), &mut rows.blocks().skip(i * each).take(each));
            lock(&self.idle).push(worker);
        });
    }

    /// Adds up the gradients of all jobs, in their order.
    fn sum_gradients(&self, rows: &Minibatch, gradient: &mut [f64]) {
        gradient.fill(0.0);
        for job_sums in &self.sums[..jobs(rows).1] {
            for (to, &from) in gradient.iter_mut().zip(&lock(job_sums).gradient) {
                *to += f64::from(from);
            }
        }
    }

    /// The loss -mean(ρ·A) (14) at `params`, the parameters that acted, and its gradient. Their means are kept for
    /// [`evaluate`](Self::evaluate).
    pub(super) fn gradient(
        &mut self,
        executor: &dyn Executor,
        rows: &Minibatch,
        params: &[f32],
        progress: f64,
        gradient: &mut [f64],
    ) -> f64 {
        let ((each, count), actions) = (jobs(rows), self.policy.action_dim());
        self.sums.resize_with(self.sums.len().max(count), || {
            Mutex::new(JobSums {
                gradient: vec![0.0; params.len()],
                log_std_gradient: vec![0.0; actions],
                ..JobSums::default()
            })
        });
        let log_std = self.log_std(params, progress);
        self.each(
            executor,
            rows,
            |tape| self.policy.bind(params, tape),
            |worker, job_sums, blocks| {
                job_sums.log_std_gradient.fill(0.0);
                job_sums.surrogate = 0.0;
                job_sums.old_mean.resize(actions * BLOCK * each, 0.0);
                let kept = job_sums.old_mean.chunks_exact_mut(actions * BLOCK);
                for (block, kept) in blocks.zip(kept) {
                    let taken = rows.rows(&block);
                    let mean = self.policy.forward(&taken, &mut worker.tape);
                    kept.copy_from_slice(&mean[..actions * BLOCK]);
                    let surrogate = self.surrogate(rows, block, mean, &log_std);
                    job_sums.surrogate += surrogate.sum();
                    surrogate.differentiate(&mut worker.cotangent, &mut job_sums.log_std_gradient);
                    self.policy.vjp(&taken, &worker.cotangent, &mut worker.tape);
                }
                self.policy.gradient(&mut worker.tape, &mut job_sums.gradient);
                if let Some(range) = self.policy.log_std_params() {
                    job_sums.gradient[range].copy_from_slice(&job_sums.log_std_gradient);
                }
            },
        );
        self.sum_gradients(rows, gradient);
        let sums = self.sums[..count].iter();
        -sums.map(|job_sums| lock(job_sums).surrogate).sum::<f64>() / rows.count.max(1) as f64
    }

    /// The surrogate of a block, without a clip.
    fn surrogate<'a>(
        &self,
        minibatch: &'a Minibatch,
        block: Range<usize>,
        mean: &'a [f32],
        log_std: &'a [f32],
    ) -> Surrogate<'a> {
        let drawn = self.policy.drawn_actions();
        Surrogate { minibatch, block, mean, log_std, drawn, clip_ratio: f32::INFINITY }
    }

    /// Writes Jᵀ·M·J·v with J the derivative of the means at `params`, M = diag(`weight`) for every row, of which draws have
    /// the row's share, and v = `tangent`; zero for the log standard deviations.
    pub(super) fn gauss_newton(
        &self,
        executor: &dyn Executor,
        rows: &Minibatch,
        params: &[f32],
        tangent: &[f32],
        weight: &[f32],
        product: &mut [f64],
    ) {
        let bind = |tape: &mut P::Tape| {
            self.policy.bind(params, tape);
            self.policy.bind_tangent(tangent, tape);
        };
        self.each(executor, rows, bind, |worker, job_sums, blocks| {
            for block in blocks {
                let taken = rows.rows(&block);
                self.policy.forward(&taken, &mut worker.tape);
                let moved = self.policy.jvp(&taken, &mut worker.tape).chunks_exact(BLOCK);
                for ((to, from), weight) in worker.cotangent.chunks_exact_mut(BLOCK).zip(moved).zip(weight) {
                    for (to, from) in to.iter_mut().zip(from) {
                        *to = weight * from;
                    }
                }
                for to in worker.cotangent.chunks_exact_mut(BLOCK).take(self.policy.drawn_actions()) {
                    for (to, share) in to.iter_mut().zip(&rows.draws.share[block.clone()]) {
                        *to *= share;
                    }
                }
                self.policy.vjp(&taken, &worker.cotangent, &mut worker.tape);
            }
            self.policy.gradient(&mut worker.tape, &mut job_sums.gradient);
        });
        self.sum_gradients(rows, product);
    }

    /// Loss and divergence at `params`, exact; old is what [`gradient`](Self::gradient) last saw, over the same rows.
    pub(super) fn evaluate(
        &self,
        executor: &dyn Executor,
        rows: &Minibatch,
        (old, params): (&[f32], &[f32]),
        progress: f64,
    ) -> Judged {
        let (actions, drawn) = (self.policy.action_dim(), self.policy.drawn_actions());
        let (old, log_std) = (self.log_std(old, progress), self.log_std(params, progress));
        self.each(
            executor,
            rows,
            |tape| self.policy.bind(params, tape),
            |worker, job_sums, blocks| {
                (job_sums.surrogate, job_sums.kl, job_sums.draw_kl) = (0.0, 0.0, 0.0);
                let kept = job_sums.old_mean.chunks_exact(actions * BLOCK);
                for (block, kept) in blocks.zip(kept) {
                    let mean = self.policy.forward(&rows.rows(&block), &mut worker.tape);
                    job_sums.kl += divergence((kept, &old), (mean, &log_std), drawn..actions, |_| 1.0, block.len());
                    if drawn > 0 {
                        let share = &rows.draws.share[block.clone()];
                        let share = |r: usize| f64::from(share[r]);
                        job_sums.draw_kl += divergence((kept, &old), (mean, &log_std), 0..drawn, share, block.len());
                    }
                    job_sums.surrogate += self.surrogate(rows, block, mean, &log_std).sum();
                }
            },
        );
        let (mut surrogate, mut kl, mut draw_kl) = (0.0, 0.0, 0.0);
        for job_sums in &self.sums[..jobs(rows).1] {
            let job_sums = lock(job_sums);
            (surrogate, kl) = (surrogate + job_sums.surrogate, kl + job_sums.kl);
            draw_kl += job_sums.draw_kl;
        }
        let (n, draws) = (rows.count.max(1) as f64, rows.draws.count());
        if draws == 0.0 {
            return Judged { loss: -surrogate / n, kl: kl / n, draw_kl };
        }
        Judged { loss: -surrogate / n, kl: (kl + draw_kl) / n, draw_kl: draw_kl / draws }
    }
}

/// Σ KL(old || new) over the first rows of a block of means `[A × BLOCK]`, each times its weight, nats:
/// log σ' - log σ + (σ² + (μ - μ')²)/(2σ'²) - ½ for each of the components.
fn divergence(
    (old, old_log_std): (&[f32], &[f32]),
    (new, log_std): (&[f32], &[f32]),
    components: Range<usize>,
    weight: impl Fn(usize) -> f64,
    rows: usize,
) -> f64 {
    let mut sum = 0.0;
    let all: f64 = (0..rows).map(&weight).sum();
    for j in components {
        let (was, is) = (f64::from(old_log_std[j]), f64::from(log_std[j]));
        let precision = (-2.0 * is).exp();
        let moved = old[j * BLOCK..][..rows].iter().zip(&new[j * BLOCK..][..rows]).enumerate();
        let squares: f64 = moved.map(|(r, (a, b))| weight(r) * (f64::from(*a) - f64::from(*b)).powi(2)).sum();
        let spread = is - was + 0.5 * (2.0 * (was - is)).exp_m1();
        sum += all * spread + 0.5 * squares * precision;
    }
    sum
}
