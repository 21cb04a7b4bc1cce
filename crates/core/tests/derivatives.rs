//! The derivatives of whole policies, through controller and law, for every kind of placement.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use hwasp_core::{HardwarePolicy, ParamKind, Policy, Rows};
use hwasp_diff::{GradCheckSettings, gradcheck};

/// Rows that are passed, and the distance between their columns; the tape is larger still.
const ROWS: usize = 5;
const STRIDE: usize = 6;
const TAPE: usize = 8;

/// A block of rows with actions inside the limits of the design, away from the kinks of the clamp.
struct Block {
    obs: Vec<f32>,
    state: Vec<f32>,
    action: Vec<f32>,
}

impl Block {
    fn new(policy: &HardwarePolicy, salt: usize) -> Self {
        let mut action = vec![f32::NAN; policy.action_dim() * STRIDE];
        for (j, name) in policy.action_names().iter().enumerate() {
            let design = policy.space().names().iter().position(|n| n == name);
            let (lo, hi) = design.map_or((-1.0, 1.0), |i| policy.space().bounds(i));
            for (r, x) in common::irregular(ROWS, salt + j).into_iter().enumerate() {
                action[j * STRIDE + r] = (0.5 * (lo + hi)) as f32 + 0.45 * (hi - lo) as f32 * x;
            }
        }
        Self {
            obs: common::irregular(ROWS * policy.obs_dim(), salt + 10),
            state: common::irregular(STRIDE * policy.state_dim(), salt + 11),
            action,
        }
    }

    fn rows(&self) -> Rows<'_> {
        Rows { count: ROWS, obs: &self.obs, state: &self.state, action: &self.action, stride: STRIDE }
    }
}

/// Σ cotangent·mean over the block.
fn value(policy: &HardwarePolicy, params: &[f32], block: &Block, cotangent: &[f32]) -> f64 {
    let mut tape = policy.tape(TAPE);
    policy.bind(params, &mut tape);
    dot(policy, policy.forward(&block.rows(), &mut tape), cotangent)
}

fn dot(policy: &HardwarePolicy, mean: &[f32], cotangent: &[f32]) -> f64 {
    let of_column =
        |j: usize| (0..ROWS).map(move |r| f64::from(mean[j * TAPE + r]) * f64::from(cotangent[j * TAPE + r]));
    (0..policy.action_dim()).flat_map(of_column).sum()
}

fn policies() -> impl Iterator<Item = (HardwarePolicy, Vec<f32>)> {
    common::all_placements().into_iter().map(|placements| {
        let policy = common::policy(placements).unwrap();
        let params = policy.init(3, 1.0);
        (policy, params)
    })
}

/// With steps of 0.01 central differences in f32 are good to about 1e-3 of the largest entry.
#[test]
fn the_gradient_is_that_of_finite_differences() {
    for (policy, mut params) in policies() {
        let block = Block::new(&policy, 0);
        let cotangent = common::irregular(policy.action_dim() * TAPE, 20);
        let mut tape = policy.tape(TAPE);
        let mut gradient = vec![f32::NAN; params.len()];
        policy.bind(&params, &mut tape);
        policy.forward(&block.rows(), &mut tape);
        policy.vjp(&block.rows(), &cotangent, &mut tape);
        policy.gradient(&mut tape, &mut gradient);
        for group in policy.groups() {
            let largest = gradient[group.range.clone()].iter().fold(0.0_f32, |m, g| m.max(g.abs()));
            assert_eq!(
                largest == 0.0,
                group.kind == ParamKind::LogStd || group.range.is_empty(),
                "{group:?}: {largest}"
            );
            for i in group.range.clone() {
                let at = params[i];
                let mut moved = |step: f32| {
                    params[i] = at + step;
                    value(&policy, &params, &block, &cotangent)
                };
                let numeric = (moved(0.01) - moved(-0.01)) / 0.02;
                params[i] = at;
                let error = (f64::from(gradient[i]) - numeric).abs();
                let allowed = 2e-3 * f64::from(largest);
                assert!(
                    error <= allowed,
                    "{:?} {i}: {} against {numeric}, {:?}",
                    group.kind,
                    gradient[i],
                    policy.spec()
                );
            }
        }
    }
}

/// J'w·v = w·Jv.
#[test]
fn tangent_and_gradient_are_transposes() {
    for (policy, params) in policies() {
        let block = Block::new(&policy, 5);
        let cotangent = common::irregular(policy.action_dim() * TAPE, 21);
        let direction = common::irregular(params.len(), 22);
        let mut tape = policy.tape(TAPE);
        let mut gradient = vec![f32::NAN; params.len()];
        policy.bind(&params, &mut tape);
        policy.bind_tangent(&direction, &mut tape);
        policy.forward(&block.rows(), &mut tape);
        let tangent = dot(&policy, policy.jvp(&block.rows(), &mut tape), &cotangent);
        policy.vjp(&block.rows(), &cotangent, &mut tape);
        policy.gradient(&mut tape, &mut gradient);
        let terms = gradient.iter().zip(&direction).map(|(g, v)| f64::from(*g) * f64::from(*v));
        let (reverse, size) = terms.fold((0.0, 0.0), |(sum, size), t| (sum + t, size + t.abs()));
        assert!(size > 0.1, "{size} is too little to compare");
        assert!((tangent - reverse).abs() < 1e-5 * size, "{tangent} against {reverse}, {:?}", policy.spec());
    }
}

/// Gradients add up over blocks, in one tape or in two that are put together.
#[test]
fn blocks_add_up() {
    for (policy, params) in policies() {
        let blocks = [Block::new(&policy, 1), Block::new(&policy, 2)];
        let cotangent = common::irregular(policy.action_dim() * TAPE, 23);
        let gradient_of = |parts: &[&[usize]]| {
            let mut tapes: Vec<_> = parts
                .iter()
                .map(|part| {
                    let mut tape = policy.tape(TAPE);
                    policy.bind(&params, &mut tape);
                    for &b in *part {
                        policy.forward(&blocks[b].rows(), &mut tape);
                        policy.vjp(&blocks[b].rows(), &cotangent, &mut tape);
                    }
                    tape
                })
                .collect();
            let others = tapes.split_off(1);
            for other in &others {
                policy.add_cotangents(&mut tapes[0], other);
            }
            let mut gradient = vec![f32::NAN; params.len()];
            policy.gradient(&mut tapes[0], &mut gradient);
            gradient
        };
        let (first, second) = (gradient_of(&[&[0]]), gradient_of(&[&[1]]));
        for together in [gradient_of(&[&[0, 1]]), gradient_of(&[&[0], &[1]])] {
            let largest = together.iter().fold(0.0_f32, |m, g| m.max(g.abs()));
            for i in 0..params.len() {
                let error = (first[i] + second[i] - together[i]).abs();
                assert!(error <= 1e-5 * largest, "{i}: {} + {} is not {}", first[i], second[i], together[i]);
            }
        }
    }
}

/// The traced composition in f64, with no column held: squash, limits and law.
#[test]
fn the_program_passes_gradcheck() {
    for (policy, params) in policies() {
        let program = policy.program();
        let design = policy.groups().iter().find(|g| g.kind == ParamKind::Design).unwrap().range.clone();
        let u: Vec<f64> = params[design].iter().map(|&u| f64::from(u)).collect();
        let rows = 3;
        // In the interior of the limits: those of the motors are ±1 here, and samples are in SI.
        let names = policy.space().names();
        let mut columns = Vec::new();
        for (c, column) in program.column_names().iter().enumerate() {
            let design = names.iter().position(|name| *column == format!("{name} (sample)"));
            let (lo, hi) = design.map_or((-1.0, 1.0), |i| policy.space().bounds(i));
            let part = common::irregular(rows, 7 + c);
            columns.extend(part.iter().map(|&x| 0.5 * (lo + hi) + 0.45 * (hi - lo) * f64::from(x)));
        }
        let program = program.clone().holding(&vec![false; program.column_names().len()]);
        if let Err(error) = gradcheck(&program, &u, &columns, &GradCheckSettings::default()) {
            panic!("{:?}: {error}", policy.spec().placements);
        }
    }
}
