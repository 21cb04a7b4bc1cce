//! Without noise it does not matter where the design sits: every placement gives the same trajectory, bit for bit.
//!
//! The authors' own in-policy and in-action environments differ by up to 0.18 m with the same design and command, because
//! they limit different forces. Here there is one plant and one law.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use std::sync::{Arc, Mutex};

use hwasp_core::{
    EnvSpec, Environment, EpisodeKind, Episodes, HardwarePolicy, Law, MakeEnvironment, Noise, Placement, PolicySpec,
    Sampler, Serial, Step, Watch, Watched,
};
use hwasp_diff::Activation;
use hwasp_tasks::mass_spring::{Interface, MassSpring, MassSpringSettings};

/// Writes down, as bits, every state, effort and command that an environment sees.
struct Recorder {
    seen: Arc<Mutex<Vec<u64>>>,
}

impl Watch for Recorder {
    fn step(&mut self, inner: &mut dyn Environment, effort: &[f64], command: &[f64]) -> Step {
        let step = inner.step(effort, command);
        let mut state = [0.0; 4];
        inner.state(&mut state);
        let numbers = effort.iter().chain(command).chain(&state).chain([&step.reward]);
        self.seen.lock().unwrap().extend(numbers.map(|x| x.to_bits()));
        step
    }
}

fn policy(law: &Law, env: &EnvSpec, squash: bool, placements: Vec<Placement>) -> HardwarePolicy {
    let spec = PolicySpec {
        hidden: vec![32, 32],
        activation: Activation::Tanh,
        squash,
        state_dependent_std: false,
        observation_center: vec![0.1, 0.0],
        observation_scale: vec![0.1, 0.5],
        sees_design: false,
        normalize: None,
        law: law.clone(),
        placements,
        noise: Noise {
            command: vec![0.3.into()],
            effort: vec![3.0.into(); env.effort.len()],
            design: 0.3.into(),
            train: true,
        },
    };
    HardwarePolicy::new(spec, env).unwrap()
}

/// The numbers of three episodes of 1000 steps from held-out starts.
fn trajectories(problem: &MassSpring, policy: HardwarePolicy, seed: u64) -> Vec<u64> {
    // The gain is large enough for the motor to reach its limits where nothing squashes the output.
    let params = policy.init(seed, 3.0);
    let seen = Arc::new(Mutex::new(Vec::new()));
    let (problem, log) = (problem.clone(), Arc::clone(&seen));
    let make = move |horizon| -> Box<dyn Environment> {
        Box::new(Watched::new(problem.make(horizon), Recorder { seen: Arc::clone(&log) }))
    };
    let sampler = Sampler::new(Arc::new(policy), Arc::new(make), None);
    let starts = Episodes { seed, iteration: 0, indices: 0..3, progress: 0.0, kind: EpisodeKind::Evaluation };
    let batch = sampler.collect(&Serial, &params, &starts).unwrap();
    assert_eq!(batch.rows(), 3000);
    drop(sampler);
    let mut bits = Arc::into_inner(seen).unwrap().into_inner().unwrap();
    bits.extend(batch.obs.iter().chain(&batch.state).map(|x| u64::from(x.to_bits())));
    bits
}

fn check(problem: &MassSpring) {
    use Placement::{Action, Episode, Fixed, Graph};
    let (law, env) = (problem.law(), problem.robot(None));
    let n = law.design().len();
    for (seed, squash) in [(0, true), (1, true), (2, false)] {
        let make = |placements| policy(&law, env.spec(), squash, placements);
        let all_graph = make(vec![Graph; n]);
        let design = all_graph.design(&all_graph.init(seed, 3.0));
        let graph = trajectories(problem, all_graph, seed);
        for (name, place) in [
            ("in the action", &(|_| Action) as &dyn Fn(usize) -> Placement),
            ("drawn once an episode", &|_| Episode),
            ("fixed", &|i| Fixed(design[i])),
            ("graph and action", &|i| if i % 2 == 0 { Graph } else { Action }),
            ("graph and fixed", &|i| if i < n / 2 { Graph } else { Fixed(design[i]) }),
            ("action and fixed", &|i| if i < n / 2 { Action } else { Fixed(design[i]) }),
            ("all four", &|i| [Fixed(design[i]), Action, Graph, Episode][i % 4]),
        ] {
            let other = trajectories(problem, make((0..n).map(place).collect()), seed);
            if let Some(at) = graph.iter().zip(&other).position(|(a, b)| a != b) {
                let (a, b) = (f64::from_bits(graph[at]), f64::from_bits(other[at]));
                panic!("{n} {name}, seed {seed}, squash {squash}: number {at} is {b:e}, in the graph {a:e}");
            }
            assert_eq!(graph.len(), other.len());
        }
    }
}

fn paper(count: usize) -> MassSpringSettings {
    MassSpringSettings { count, ..MassSpringSettings::default() }
}

#[test]
fn springs_may_sit_anywhere() {
    for count in [10, 50] {
        check(&MassSpring::stiffness(paper(count)).unwrap());
    }
}

#[test]
fn a_soft_bar_may_sit_anywhere() {
    for count in [10, 50] {
        check(&MassSpring::bar(paper(count), Interface::Soft).unwrap());
    }
}

#[test]
fn a_rigid_bar_may_sit_anywhere() {
    for count in [10, 50] {
        check(&MassSpring::bar(paper(count), Interface::Rigid).unwrap());
    }
}

/// Also where efforts are limited, as in the authors' published setting: the plant does that, whoever computed them.
#[test]
fn the_effort_limit_is_the_plants() {
    let limited = MassSpringSettings { effort_limit: Some(5.0), ..paper(10) };
    check(&MassSpring::stiffness(limited).unwrap());
}
