//! Controllers that tell how widely their commands spread.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use hwasp_core::Placement::{self, Fixed, Graph};
use hwasp_core::{Actor, HardwarePolicy, Policy, PolicySpec, Purpose, Reparameterised, Rows, stream};
use rand_distr::{Distribution, StandardNormal};

const ROWS: usize = 5;
const COMMANDS: usize = 2;

fn spec(placements: Vec<Placement>, squash: bool) -> PolicySpec {
    PolicySpec { squash, state_dependent_std: true, ..common::policy_spec(placements) }
}

fn policy(placements: Vec<Placement>, squash: bool) -> HardwarePolicy {
    HardwarePolicy::new(spec(placements, squash), &common::env_spec()).unwrap()
}

/// Rows without a pattern, for a policy.
struct Data {
    obs: Vec<f32>,
    state: Vec<f32>,
    action: Vec<f32>,
    noise: Vec<f32>,
}

impl Data {
    fn of(policy: &HardwarePolicy) -> Self {
        let numbers = |width, salt| common::irregular(ROWS * width, salt);
        Self {
            obs: numbers(policy.obs_dim(), 1),
            state: numbers(policy.state_dim(), 2),
            action: numbers(policy.action_dim(), 3).iter().map(|x| 2.0 + x).collect(),
            noise: numbers(COMMANDS, 4),
        }
    }

    fn rows(&self) -> Rows<'_> {
        Rows { count: ROWS, obs: &self.obs, state: &self.state, action: &self.action, stride: ROWS }
    }
}

#[test]
fn the_means_are_those_of_the_controller_alone() {
    for placements in common::all_placements() {
        for squash in [true, false] {
            let policy = policy(placements.clone(), squash);
            let spec = PolicySpec { state_dependent_std: false, ..spec(placements.clone(), squash) };
            let alone = HardwarePolicy::new(spec, &common::env_spec()).unwrap();
            let params = policy.init(3, 1.0);
            let controller = policy.controller_params(&params);
            let narrow = [&policy.without_spread(controller)[..], &params[controller.len()..]].concat();
            let data = Data::of(&policy);
            let means = |policy: &HardwarePolicy, params: &[f32]| {
                let mut tape = policy.tape(ROWS);
                policy.bind(params, &mut tape);
                policy.forward(&data.rows(), &mut tape).to_vec()
            };
            assert_eq!(means(&policy, &params), means(&alone, &narrow), "{placements:?}");
        }
    }
}

/// The density of a command is that of its number, over how much the command changes with it: in units of half the motor's range.
#[test]
fn log_probabilities_are_densities_of_commands() {
    for squash in [true, false] {
        let policy = policy(vec![Fixed(1.0), Fixed(2.0), Fixed(3.0), Fixed(4.0)], squash);
        let env = common::env_spec();
        let (params, data) = (policy.init(3, 1.0), Data::of(&policy));
        let mut tape = policy.tape(ROWS);
        policy.bind(&params, &mut tape);
        let mut sampled = |noise: &[f32]| {
            let (actions, log_probs) = policy.sample(&data.rows(), noise, &mut tape);
            (actions.to_vec(), log_probs[..ROWS].to_vec())
        };
        let (step, noise) = (0.02, data.noise.clone());
        let moved = |by: f32| noise.iter().map(|z| z + by).collect::<Vec<_>>();
        let (low, high) = (sampled(&moved(-step)).0, sampled(&moved(step)).0);
        let (_, log_probs) = sampled(&noise);
        for r in 0..ROWS {
            let density: f64 = (0..COMMANDS)
                .map(|c| {
                    let (port, z) = (&env.command[c], f64::from(noise[c * ROWS + r]));
                    let at = (policy.action_dim() - COMMANDS + c) * ROWS + r;
                    let slope = f64::from(high[at] - low[at]) / (0.5 * (port.hi - port.lo)) / f64::from(2.0 * step);
                    -0.5 * z * z - 0.5 * std::f64::consts::TAU.ln() - slope.ln()
                })
                .sum();
            assert!((density - f64::from(log_probs[r])).abs() < 2e-3, "{density} and {}", log_probs[r]);
        }
    }
}

/// Of actions and log-probabilities together, by central differences.
#[test]
fn the_way_back_is_the_derivative() {
    for (placements, squash) in [(vec![Graph; 4], true), (vec![Graph; 4], false), (vec![Placement::Action; 4], true)] {
        let policy = policy(placements, squash);
        let (mut params, data) = (policy.init(3, 1.0), Data::of(&policy));
        let cotangent = common::irregular(policy.action_dim() * ROWS, 9);
        let of_log_prob = 0.7;
        let mut tape = policy.tape(ROWS);
        let mut value = |params: &[f32]| {
            policy.bind(params, &mut tape);
            let (actions, log_probs) = policy.sample(&data.rows(), &data.noise, &mut tape);
            let products = actions.iter().zip(&cotangent).map(|(a, c)| f64::from(*a) * f64::from(*c));
            products.sum::<f64>() + of_log_prob * log_probs.iter().map(|&p| f64::from(p)).sum::<f64>()
        };
        value(&params);
        let mut gradient = vec![0.0; params.len()];
        let mut other = policy.tape(ROWS);
        policy.bind(&params, &mut other);
        policy.sample(&data.rows(), &data.noise, &mut other);
        policy.vjp_sample(&data.rows(), &cotangent, of_log_prob as f32, &mut other);
        policy.gradient(&mut other, &mut gradient);
        let largest = gradient.iter().fold(0.0_f32, |most, g| most.max(g.abs()));
        // Log standard deviations beside the controller are nobody's here.
        for i in 0..policy.design_params().end {
            let at = params[i];
            let mut moved = |by: f32| {
                params[i] = at + by;
                value(&params)
            };
            let numeric = (moved(0.01) - moved(-0.01)) / 0.02;
            params[i] = at;
            let error = (f64::from(gradient[i]) - numeric).abs();
            assert!(error < 2e-3 * f64::from(largest), "parameter {i}: {} and {numeric}", gradient[i]);
        }
    }
}

/// Who acts draws as who learns does, with `noise.command` as the spread at first.
#[test]
fn actors_draw_the_same() {
    let policy = policy(vec![Fixed(1.0), Fixed(2.0), Fixed(3.0), Fixed(4.0)], true);
    let (params, data) = (policy.init(3, 0.0), Data::of(&policy));
    let mut actor = Actor::new(&policy, &params, 0.0, 1);
    let mut noise = [stream(1, Purpose::Check, 0, 0)];
    let first: Vec<f32> = {
        let mut copy = noise[0].clone();
        (0..COMMANDS).map(|_| -> f64 { StandardNormal.sample(&mut copy) }).map(|z| z as f32).collect()
    };
    let state: Vec<f64> = (0..policy.state_dim()).map(|s| f64::from(data.state[s * ROWS])).collect();
    actor.act(&data.obs[..policy.obs_dim()], &state, 1, Some(&mut noise));
    let mut tape = policy.tape(1);
    policy.bind(&params, &mut tape);
    let single = |columns: &[f32]| columns.iter().step_by(ROWS).copied().collect::<Vec<f32>>();
    let (state, action) = (single(&data.state), single(&data.action));
    let rows = Rows { count: 1, obs: &data.obs[..policy.obs_dim()], state: &state, action: &action, stride: 1 };
    let (actions, log_probs) = policy.sample(&rows, &first, &mut tape);
    assert!((actor.log_prob(0) - log_probs[0]).abs() < 1e-5);
    let env = common::env_spec();
    for (c, (&acted, &sampled)) in actor.action(0).iter().zip(actions).enumerate() {
        assert!((acted - f64::from(sampled)).abs() < 1e-6);
        // Nothing but the bias: tanh of the spread at first, 2·std of half the range, times the number.
        let std = [0.3, 0.2][c];
        let port = &env.command[c];
        let wanted = (2.0 * std * f64::from(first[c])).tanh() * 0.5 * (port.hi - port.lo) + 0.5 * (port.hi + port.lo);
        assert!((acted - wanted).abs() < 1e-5 * wanted.abs().max(1.0), "{acted} and {wanted}");
    }
}
