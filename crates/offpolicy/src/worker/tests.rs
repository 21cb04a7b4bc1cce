//! Losses and gradients against arithmetic by hand and against finite differences.

use hwasp_core::{
    Batch, CommandPort, DesignGroup, DesignSpace, Dimension, End, EnvSpec, Episode, HardwarePolicy, Initial, Law,
    Noise, Placement, PolicySpec, Port, Ports,
};
use hwasp_diff::{Activation, Program};

use super::*;
use crate::replay::{Dims, Replay};

/// A motor pushes against a spring: effort = push - k·y with k in [0, 4] N/m, and the controller sees y.
fn policy(hidden: &[usize]) -> HardwarePolicy {
    let port = |name: &str| Port { name: name.into(), dimension: Dimension::None };
    let stiffness = DesignGroup {
        name: "k".into(),
        dimension: Dimension::Stiffness,
        lo: 0.0,
        hi: 4.0,
        count: 1,
        initial: Initial::Value(2.0),
    };
    let ports = Ports { command: vec!["push".into()], state: vec!["y".into()], effort: vec!["force".into()] };
    let spring = Program::trace(&["k"], &["push", "y"], |u, c| vec![("force".into(), c[0] - u[0] * c[1])]);
    let push = CommandPort { name: "push".into(), dimension: Dimension::None, lo: -1.0, hi: 1.0, direct: true };
    let env = EnvSpec {
        observation: vec![port("y")],
        state: vec![port("y")],
        context: vec![],
        effort: vec![port("force")],
        command: vec![push],
        horizon: 1,
        time_step: 0.1,
        shaped_by: vec![],
        terms: vec![],
    };
    let spec = PolicySpec {
        hidden: hidden.to_vec(),
        activation: Activation::Tanh,
        squash: false,
        observation_center: vec![0.0],
        observation_scale: vec![1.0],
        sees_design: false,
        normalize: None,
        law: Law::from_program(spring, DesignSpace::new(vec![stiffness]).unwrap(), ports).unwrap(),
        placements: vec![Placement::Graph],
        noise: Noise { command: vec![0.1.into()], effort: vec![0.5.into()], design: 0.1.into(), train: false },
    };
    HardwarePolicy::new(spec, &env).unwrap()
}

const Y: [f32; 3] = [0.1, 0.2, -0.1];
const NEXT: [f32; 3] = [0.3, -0.2, 0.4];
/// Effort and command that were taken.
const TAKEN: [[f32; 2]; 3] = [[0.3, 0.5], [-0.4, 0.2], [0.1, -0.6]];
const REWARD: [f64; 3] = [1.0, -2.0, 0.5];
const DISCOUNT: f64 = 0.9;
/// What is added to both components of the target's actions: z = 1, 0.3 of it, 0.2 at most; commands stay within 1.
const NOISE: f64 = 0.2;

/// Three episodes of a step; the last one is over for good.
fn replay(policy: &HardwarePolicy) -> Replay {
    let mut batch = Batch { obs: Y.to_vec(), state: Y.to_vec(), reward: REWARD.to_vec(), ..Batch::default() };
    batch.action = TAKEN.concat();
    for (row, &next) in NEXT.iter().enumerate() {
        batch.episodes.push(Episode {
            rows: row..row + 1,
            end: if row == 2 { End::Terminated } else { End::Truncated },
            cut: false,
            last_obs: vec![next],
            last_state: vec![next],
            context: vec![],
            log_prob: 0.0,
            outcome: None,
            terms: vec![],
        });
    }
    let mut replay = Replay::new(Dims::of(policy), 100);
    replay.push(&batch, &policy.action_limits());
    replay
}

/// Those three steps, with values in units of two about one.
fn sample(policy: &HardwarePolicy) -> Sample {
    let (mut sample, replay) = (Sample::new(Dims::of(policy), 3), replay(policy));
    for (r, at) in replay.step_frames().enumerate() {
        sample.take(r, &replay, at, (1, DISCOUNT), (1.0, 2.0));
    }
    sample.noise.fill(1.0);
    sample
}

/// w, b, and u, for which k is 2.
const PARAMS: [f32; 3] = [0.5, 0.1, 0.0];
/// Of y, effort, command, and the constant.
const CRITICS: [[f32; 4]; 2] = [[1.0, 0.5, -0.25, 0.1], [0.5, 0.75, 0.5, -0.1]];

struct Scene {
    policy: HardwarePolicy,
    params: Vec<f32>,
    critics: Critics,
    sample: Sample,
    scaling: Scaling,
    view: View,
    limits: Vec<Option<(f32, f32)>>,
}

impl Scene {
    /// With these layers of controller and critics.
    fn new(hidden: &[usize], critic_hidden: &[usize]) -> Self {
        let policy = policy(hidden);
        let dims = Dims::of(&policy);
        let view = View::new(dims, false, false);
        let (params, sample) = (policy.init(5, 1.0), sample(&policy));
        let critics = Critics::new(view.width(), critic_hidden, 5);
        Self { limits: policy.action_limits(), params, critics, sample, scaling: Scaling::new(dims), view, policy }
    }

    fn step(&self) -> Step<'_, HardwarePolicy> {
        Step {
            policy: &self.policy,
            params: &self.params,
            target: &self.params,
            critics: &self.critics,
            sample: &self.sample,
            scaling: &self.scaling,
            view: self.view,
            limits: &self.limits,
            rows: 3,
            smoothing: &[(0.3, 0.2), (0.3, 0.2)],
        }
    }

    fn worker(&self) -> Worker<HardwarePolicy> {
        Worker::new(0..3, &self.policy, &self.critics, self.view)
    }
}

fn close(given: &[f32], wanted: &[f64]) {
    assert_eq!(given.len(), wanted.len());
    for (given, wanted) in given.iter().zip(wanted) {
        assert!((f64::from(*given) - wanted).abs() < 1e-6, "{given} instead of {wanted}");
    }
}

/// Everything is linear: a controller w·y + b, and critics of four numbers.
#[test]
fn three_rows_by_hand() {
    let mut scene = Scene::new(&[], &[]);
    scene.params = PARAMS.to_vec();
    for (critic, params) in scene.critics.each.iter_mut().zip(CRITICS) {
        (critic.params, critic.target) = (params.to_vec(), params.to_vec());
    }
    let mut worker = scene.worker();
    worker.judge(&scene.step());
    let wide = |x: f32| f64::from(x);
    let [w, b, _] = PARAMS.map(wide);
    let value = |critic: [f32; 4], y: f64, effort: f64, command: f64| {
        let [of_y, of_effort, of_command, constant] = critic.map(wide);
        of_y * y + of_effort * effort + of_command * command + constant
    };
    let mut squares = 0.0;
    for (i, critic) in CRITICS.into_iter().enumerate() {
        let mut gradient = [0.0; 4];
        for r in 0..3 {
            let (y, next) = (wide(Y[r]), wide(NEXT[r]));
            let command = w * next + b;
            let (effort, command) = (command - 2.0 * next + NOISE, (command + NOISE).min(1.0));
            let discount = if r == 2 { 0.0 } else { DISCOUNT };
            let least = CRITICS.map(|critic| value(critic, next, effort, command)).into_iter().fold(f64::MAX, f64::min);
            // In units of two about one.
            let wanted = (REWARD[r] + discount * (1.0 + 2.0 * least) - 1.0) / 2.0;
            let [effort, command] = TAKEN[r].map(wide);
            let error = value(critic, y, effort, command) - wanted;
            squares += if i == 0 { error * error } else { 0.0 };
            for (g, x) in gradient.iter_mut().zip([y, effort, command, 1.0]) {
                *g += 2.0 / 3.0 * error * x;
            }
        }
        let mut given = [0.0; 4];
        scene.critics.network.gradient(&worker.critics[i], &mut given);
        close(&given, &gradient);
    }
    assert!((worker.squares - squares).abs() < 1e-6);

    // The first critic gives 0.5 for effort and -0.25 for command. A command does both; the stiffness takes y of the effort, and
    // grows by 1 N/m per u: L = -mean(0.25·(w·y + b) - 0.5·k·y + …).
    worker.improve(&scene.step());
    let mut given = [0.0; 3];
    worker.policy_gradient(&scene.policy, &mut given);
    let mean_y = Y.map(wide).iter().sum::<f64>() / 3.0;
    close(&given, &[-0.25 * mean_y, -0.25, 0.5 * mean_y]);
    let values = Y.map(wide).map(|y| value(CRITICS[0], y, w * y + b - 2.0 * y, w * y + b)).iter().sum::<f64>();
    assert!((worker.values - values).abs() < 1e-6);
}

/// A command beyond its limit is worth no more there: no gradient leads further out, and all lead back.
#[test]
fn beyond_a_limit_only_the_way_back_is_open() {
    let mut scene = Scene::new(&[], &[]);
    // 3 and more, where the limit is 1, and a critic that looks at the command alone.
    scene.params = vec![0.0, 3.0, 0.0];
    for (of_command, wanted) in [(0.5, 0.0), (-0.5, 0.5)] {
        scene.critics.each[0].params = vec![0.0, 0.0, of_command, 0.0];
        let mut worker = scene.worker();
        worker.improve(&scene.step());
        let mut given = [0.0; 3];
        worker.policy_gradient(&scene.policy, &mut given);
        assert!((given[1] - wanted).abs() < 1e-6, "{given:?}");
        assert!((worker.values - 3.0 * f64::from(of_command)).abs() < 1e-6, "the critic sees the limit");
    }
}

/// Through critic, law and controller, by central differences, so small that hardly a kink lies on the way.
#[test]
fn the_gradient_reaches_controller_and_design() {
    let mut scene = Scene::new(&[5], &[9, 7]);
    // A critic that is as steep as a trained one.
    for param in &mut scene.critics.each[0].params {
        *param *= 3.0;
    }
    let mut worker = scene.worker();
    worker.improve(&scene.step());
    let mut given = vec![0.0; scene.params.len()];
    worker.policy_gradient(&scene.policy, &mut given);
    let largest = given.iter().fold(0.0_f32, |most, g| most.max(g.abs()));
    assert!(given.last().is_some_and(|design| design.abs() > 1e-3 * largest), "{given:?}");
    for i in 0..given.len() {
        let at = scene.params[i];
        let mut loss = |by: f32| {
            scene.params[i] = at + by;
            worker.improve(&scene.step());
            -worker.values / 3.0
        };
        let numeric = (loss(0.002) - loss(-0.002)) / 0.004;
        scene.params[i] = at;
        let error = (f64::from(given[i]) - numeric).abs();
        assert!(error < 0.02 * f64::from(largest), "parameter {i}: {} and {numeric}", given[i]);
    }
}
