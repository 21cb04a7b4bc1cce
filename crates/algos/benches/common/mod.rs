//! What the benchmarks work on: two policies and batches of theirs.

#![allow(dead_code, reason = "each benchmark uses a part")]

use std::sync::Arc;

use hwasp_core::{
    Actor, Batch, CommandPort, Dimension, End, EnvSpec, Episode, EpisodeKind, Episodes, HardwarePolicy, Law,
    MakeEnvironment, Noise, Placement, Policy, PolicySpec, Port, Purpose, Sampler, Serial, stream,
};
use hwasp_diff::Activation;
use hwasp_tasks::hand::{HandDescription, TendonHand, TendonHandSettings};
use hwasp_tasks::mass_spring::{MassSpring, MassSpringSettings};
use rand::RngExt;

fn spec(law: Law, hidden: &[usize], center: Vec<f64>, scale: Vec<f64>, effort: f64) -> PolicySpec {
    PolicySpec {
        hidden: hidden.to_vec(),
        activation: Activation::Tanh,
        squash: true,
        state_dependent_std: false,
        observation_center: center,
        observation_scale: scale,
        sees_design: false,
        normalize: None,
        placements: vec![Placement::Graph; law.design().len()],
        noise: Noise {
            command: vec![0.3.into(); law.ports().command.len()],
            effort: vec![effort.into(); law.ports().effort.len()],
            design: 0.1.into(),
            train: true,
        },
        law,
    }
}

/// A controller with two inputs and the law of ten springs, on the mass-spring problem.
pub(crate) fn springs(hidden: &[usize]) -> (MassSpring, Arc<HardwarePolicy>) {
    let problem = MassSpring::stiffness(MassSpringSettings::default()).expect("the paper's settings are sound");
    let spec = spec(problem.law(), hidden, vec![0.1, 0.0], vec![0.1, 0.5], 3.0);
    let policy = HardwarePolicy::new(spec, problem.make(None).spec()).expect("law and plant fit");
    (problem, Arc::new(policy))
}

/// Episodes of that problem.
pub(crate) fn batch(problem: &MassSpring, policy: &Arc<HardwarePolicy>, episodes: u64, horizon: usize) -> Batch {
    let sampler = Sampler::new(Arc::clone(policy), Arc::new(problem.clone()), Some(horizon));
    let kind = EpisodeKind::Training;
    let asked = Episodes { seed: 1, iteration: 0, indices: 0..episodes, progress: 0.0, kind };
    sampler.collect(&Serial, &policy.init(1, 1.0), &asked).expect("the plant is sound")
}

/// A controller with eleven inputs and the law of the tendon-driven hand: the sizes of the paper's grasping.
pub(crate) fn hand(hidden: &[usize]) -> Arc<HardwarePolicy> {
    let law = TendonHand::new(&HandDescription::default().transmission, &TendonHandSettings::default());
    let law = Law::new(law.expect("the paper's hand is sound"));
    let port = |name: &String| Port { name: name.clone(), dimension: Dimension::None };
    let limits = [0.002, 0.0002];
    let motor = |(name, &limit): (&String, &f64)| {
        let (name, dimension) = (name.clone(), Dimension::Length);
        CommandPort { name, dimension, lo: -limit, hi: limit, direct: true }
    };
    let env = EnvSpec {
        observation: (0..11).map(|i| port(&format!("seen {i}"))).collect(),
        state: law.ports().state.iter().map(port).collect(),
        context: vec![],
        effort: law.ports().effort.iter().map(port).collect(),
        command: law.ports().command.iter().zip(&limits).map(motor).collect(),
        horizon: 500,
        time_step: 0.05,
        shaped_by: vec![],
        terms: vec![],
    };
    let spec = spec(law, hidden, vec![0.0; 11], vec![1.0; 11], 0.02);
    Arc::new(HardwarePolicy::new(spec, &env).expect("law and ports fit"))
}

/// Rows for it without an engine: sensible states, what the policy does there, and rewards without a pattern. Episodes
/// have 500 rows.
pub(crate) fn hand_batch(policy: &HardwarePolicy, params: &[f32], rows: usize) -> Batch {
    let (seen, states) = (policy.obs_dim(), policy.state_dim());
    let mut batch = Batch::default();
    for (episode, at) in (0..rows).step_by(500).enumerate() {
        let count = (rows - at).min(500);
        let mut numbers = stream(1, Purpose::TrainingReset, 0, episode as u64);
        let obs: Vec<f32> = (0..seen * count).map(|_| numbers.random::<f32>() * 2.0 - 1.0).collect();
        // Travel in m, then angles in rad, column by column.
        let range = |s: usize| if s == 0 { 0.03 } else { 1.2 };
        let state: Vec<f64> = (0..states * count).map(|i| numbers.random::<f64>() * range(i / count)).collect();
        let mut noise: Vec<_> = (at..at + count).map(|row| stream(1, Purpose::TrainingNoise, 0, row as u64)).collect();
        let mut actor = Actor::new(policy, params, 0.0, count);
        actor.act(&obs, &state, count, Some(&mut noise));
        for r in 0..count {
            batch.state.extend((0..states).map(|s| state[s * count + r] as f32));
            batch.action.extend(actor.action(r).iter().map(|&a| a as f32));
            batch.log_prob.push(actor.log_prob(r));
            batch.reward.push(numbers.random::<f64>());
        }
        batch.episodes.push(Episode {
            rows: at..at + count,
            end: End::Truncated,
            cut: false,
            last_obs: obs[..seen].to_vec(),
            last_state: batch.state[batch.state.len() - states..].to_vec(),
            context: vec![],
            log_prob: 0.0,
            outcome: None,
            terms: vec![],
        });
        batch.obs.extend(obs);
    }
    batch
}
