//! How close the passes of TRPO come to what the machine can do: `cargo bench -p hwasp-algos --bench roofline` prints the
//! tables of docs/performance.md. 20,000 rows of an 11-128-128-2 controller with the tendon law, one thread.

#![allow(clippy::print_stdout, reason = "a program")]

#[path = "../common/mod.rs"]
mod common;
mod machine;
mod products;

use std::sync::Arc;

use hwasp_algos::{BaselineConfig, Learner, Trpo, TrpoConfig, TrpoSettings};
use hwasp_core::{Batch, HardwarePolicy, Policy, Rows, Serial};

use machine::seconds;

const ROWS: usize = 20_000;
const BLOCK: usize = 64;
const WIDTH: usize = 128;

/// The rows of a batch as blocks that a policy takes: columns of the law's state and of the actions.
struct Blocks {
    obs: Vec<f32>,
    state: Vec<f32>,
    action: Vec<f32>,
    obs_dim: usize,
}

impl Blocks {
    fn new(policy: &HardwarePolicy, batch: &Batch) -> Self {
        let columns =
            |rows: &[f32], width: usize| (0..width).flat_map(|c| rows.iter().skip(c).step_by(width).copied()).collect();
        let (state, action) = (columns(&batch.state, policy.state_dim()), columns(&batch.action, policy.action_dim()));
        Self { obs: batch.obs.clone(), state, action, obs_dim: policy.obs_dim() }
    }

    fn each(&self, mut work: impl FnMut(&Rows<'_>)) {
        for at in (0..ROWS).step_by(BLOCK) {
            let count = BLOCK.min(ROWS - at);
            work(&Rows {
                count,
                obs: &self.obs[at * self.obs_dim..][..count * self.obs_dim],
                state: &self.state[at..],
                action: &self.action[at..],
                stride: ROWS,
            });
        }
    }
}

/// The time of an update with so many products and so many steps of the line search, which all fail.
fn update(policy: &Arc<HardwarePolicy>, params: &[f32], batch: &Batch, products: usize, steps: usize) -> f64 {
    let max_kl = if steps > 0 { 0.0 } else { 0.01 };
    let trpo =
        TrpoConfig { cg_iterations: products, cg_tolerance: 0.0, backtracks: steps, max_kl, ..TrpoConfig::default() };
    let settings =
        TrpoSettings { trpo, baseline: BaselineConfig::Linear { ridge: 1e-5, privileged: false, context: false } };
    let mut trpo = Trpo::new(&settings, Arc::clone(policy), params.to_vec(), 1);
    seconds(|| _ = trpo.update(&Serial, batch, 0.0, 0).expect("finite"))
}

fn main() {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    println!("| machine, {} | one core | {cores} cores |\n|---|---|---|", hwasp_diff::fast::instructions());
    let peak = machine::peak(1);
    println!("| multiply-adds in f32, GFLOP/s | {:.1} | {:.1} |", 1e-9 * peak, 1e-9 * machine::peak(cores));
    println!(
        "| reading memory, GB/s | {:.1} | {:.1} |",
        1e-9 * machine::bandwidth(1),
        1e-9 * machine::bandwidth(cores)
    );

    println!("\n| product by nalgebra, m × k × n | GFLOP/s | of the peak |\n|---|---|---|");
    let mut best: f64 = 0.0;
    for (m, k, n) in
        [(ROWS, WIDTH, WIDTH), (BLOCK, WIDTH, WIDTH), (WIDTH, ROWS, WIDTH), (WIDTH, BLOCK, WIDTH), (ROWS, 11, WIDTH)]
    {
        let rate = products::product(m, k, n);
        best = best.max(rate);
        println!("| {m} × {k} × {n} | {:.1} | {:.0} % |", 1e-9 * rate, 100.0 * rate / peak);
    }

    let policy = common::hand(&[WIDTH, WIDTH]);
    let params = policy.init(1, 1.0);
    let batch = common::hand_batch(&policy, &params, ROWS);
    let blocks = Blocks::new(&policy, &batch);
    let mut tape = policy.tape(BLOCK);
    let (cotangent, mut gradient) = (vec![0.1; policy.action_dim() * BLOCK], vec![0.0; params.len()]);
    policy.bind(&params, &mut tape);
    policy.bind_tangent(&params, &mut tape);
    let forward = seconds(|| blocks.each(|rows| _ = std::hint::black_box(policy.forward(rows, &mut tape))));
    let with_vjp = seconds(|| {
        policy.bind(&params, &mut tape);
        blocks.each(|rows| {
            policy.forward(rows, &mut tape);
            policy.vjp(rows, &cotangent, &mut tape);
        });
        policy.gradient(&mut tape, &mut gradient);
    });
    let with_both = seconds(|| {
        policy.bind(&params, &mut tape);
        policy.bind_tangent(&params, &mut tape);
        blocks.each(|rows| {
            policy.forward(rows, &mut tape);
            policy.jvp(rows, &mut tape);
            policy.vjp(rows, &cotangent, &mut tape);
        });
        policy.gradient(&mut tape, &mut gradient);
    });
    let (bare, products, steps) = (
        update(&policy, &params, &batch, 0, 0),
        update(&policy, &params, &batch, 10, 0),
        update(&policy, &params, &batch, 0, 10),
    );

    // Multiply-adds of the layers, two operations each: of the first, of those behind it.
    let (first, rest) = ((11 * WIDTH) as f64, (WIDTH * WIDTH + WIDTH * 2) as f64);
    let one_forward = first + rest;
    let one_vjp = first + 2.0 * rest;
    let one_jvp = first + 2.0 * rest;
    println!("\n| pass over {ROWS} rows | ms | GFLOP/s | of the peak | of nalgebra's best |\n|---|---|---|---|---|");
    for (name, time, work) in [
        ("forward", forward, one_forward),
        ("forward and vjp: a gradient", with_vjp, one_forward + one_vjp),
        ("forward, jvp and vjp: a product with the Fisher matrix", with_both, one_forward + one_jvp + one_vjp),
        ("TRPO: gradient, gathering, linear baseline", bare, one_forward + one_vjp),
        ("TRPO: one product with the Fisher matrix", (products - bare) / 10.0, one_forward + one_jvp + one_vjp),
        ("TRPO: one step of the line search", (steps - bare) / 10.0, one_forward),
    ] {
        let rate = 2.0 * work * ROWS as f64 / time;
        println!(
            "| {name} | {:.2} | {:.1} | {:.0} % | {:.0} % |",
            1e3 * time,
            1e-9 * rate,
            100.0 * rate / peak,
            100.0 * rate / best
        );
    }
}
