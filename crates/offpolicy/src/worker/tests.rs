//! Losses and gradients against arithmetic by hand and against finite differences.

use hwasp_core::{
    Batch, CommandPort, DesignGroup, DesignSpace, Dimension, End, EnvSpec, Episode, HardwarePolicy, Initial, Law,
    Noise, Placement, PolicySpec, Port, Ports,
};
use hwasp_diff::{Activation, Program};

use super::*;
use crate::replay::{Dims, Replay};
use crate::sac::{SacConfig, SacRule};
use crate::td3::Td3Config;

/// A motor pushes against a spring: effort = push - k·y with k in [0, 4] N/m, and the controller sees y.
fn policy(hidden: &[usize], state_dependent_std: bool) -> HardwarePolicy {
    policy_with(hidden, state_dependent_std, Placement::Graph, false)
}

fn policy_with(hidden: &[usize], state_dependent_std: bool, placement: Placement, sees_design: bool) -> HardwarePolicy {
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
        squash: state_dependent_std,
        state_dependent_std,
        observation_center: vec![0.0],
        observation_scale: vec![1.0],
        sees_design,
        normalize: None,
        law: Law::from_program(spring, DesignSpace::new(vec![stiffness]).unwrap(), ports).unwrap(),
        placements: vec![placement],
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
    let mut batch = Batch { state: Y.to_vec(), reward: REWARD.to_vec(), ..Batch::default() };
    let seen = |y: f32| [vec![y], vec![0.0; policy.obs_dim() - 1]].concat();
    batch.obs = Y.into_iter().flat_map(seen).collect();
    batch.action = TAKEN.concat();
    for (row, &next) in NEXT.iter().enumerate() {
        batch.episodes.push(Episode {
            rows: row..row + 1,
            end: if row == 2 { End::Terminated } else { End::Truncated },
            cut: false,
            last_obs: seen(next),
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
fn sample(policy: &HardwarePolicy, drawn: usize) -> Sample {
    let (mut sample, replay) = (Sample::new(Dims::of(policy), 3, drawn, 2), replay(policy));
    for (r, at) in replay.step_frames().enumerate() {
        sample.take(r, &replay, at, (1, DISCOUNT), (1.0, 2.0));
    }
    sample.next_noise.fill(1.0);
    sample.now_noise.fill(-0.5);
    sample
}

/// w, b, and u, for which k is 2.
const PARAMS: [f32; 3] = [0.5, 0.1, 0.0];
/// Of y, effort, command, and the constant.
const CRITICS: [[f32; 4]; 2] = [[1.0, 0.5, -0.25, 0.1], [0.5, 0.75, 0.5, -0.1]];

struct Scene<R> {
    rule: R,
    smoothing: Vec<(f32, f32)>,
    policy: HardwarePolicy,
    params: Vec<f32>,
    critics: Critics,
    sample: Sample,
    scaling: Scaling,
    view: View,
    limits: Vec<Option<(f32, f32)>>,
}

impl Scene<Td3Config> {
    /// With these layers of controller and critics.
    fn td3(hidden: &[usize], critic_hidden: &[usize]) -> Self {
        Self::of(Td3Config::default(), policy(hidden, false), critic_hidden, vec![(0.3, 0.2); 2])
    }
}

impl Scene<SacRule> {
    /// The same with a nat worth a fifth.
    fn sac(hidden: &[usize], critic_hidden: &[usize]) -> Self {
        let rule = SacRule::new(SacConfig { temperature: 0.2, ..SacConfig::default() }, 1);
        Self::of(rule, policy(hidden, true), critic_hidden, vec![])
    }
}

impl<R: Rule<HardwarePolicy>> Scene<R> {
    fn of(rule: R, policy: HardwarePolicy, critic_hidden: &[usize], smoothing: Vec<(f32, f32)>) -> Self {
        let dims = Dims::of(&policy);
        let view = View::new(dims, false, false);
        let (params, sample) = (policy.init(5, 1.0), sample(&policy, R::drawn(&policy)));
        let (critics, scaling) = (Critics::new(view.width(), critic_hidden, false, 5), Scaling::new(dims));
        Self { rule, smoothing, limits: policy.action_limits(), params, critics, sample, scaling, view, policy }
    }

    fn step(&self) -> Step<'_, HardwarePolicy, R> {
        Step {
            rule: &self.rule,
            policy: &self.policy,
            params: &self.params,
            slow: &self.params,
            critics: &self.critics,
            version: 0,
            sample: &self.sample,
            scaling: &self.scaling,
            view: self.view,
            limits: &self.limits,
            rows: 3,
            smoothing: &self.smoothing,
        }
    }

    fn worker(&self) -> Worker<HardwarePolicy> {
        Worker::new::<R>(0..3, &self.policy, &self.critics, self.view)
    }

    /// Sets both critics and their targets.
    fn set_critics(&mut self, params: [[f32; 4]; 2]) {
        for (critic, params) in self.critics.each.iter_mut().zip(params) {
            (critic.params, critic.target) = (params.to_vec(), params.to_vec());
        }
    }

    /// The policy's gradient, and that by central differences of its loss, so small that hardly a kink lies on the way.
    fn gradients(&mut self) -> (Vec<f32>, Vec<f64>) {
        let mut worker = self.worker();
        let mut loss = |scene: &Self| {
            // Binds the parameters, where no slow copy has its own.
            worker.judge(&scene.step());
            worker.improve(&scene.step());
            let temperature = f64::from(scene.rule.temperature());
            ((temperature * worker.log_probs - worker.values) / 3.0, worker.gradient_of(scene))
        };
        let given = loss(self).1;
        let numeric = (0..given.len()).map(|i| {
            let at = self.params[i];
            let mut moved = |by: f32| {
                self.params[i] = at + by;
                loss(self).0
            };
            let slope = (moved(5e-4) - moved(-5e-4)) / 1e-3;
            self.params[i] = at;
            slope
        });
        let numeric = numeric.collect();
        (given, numeric)
    }
}

impl Worker<HardwarePolicy> {
    fn gradient_of<R>(&mut self, scene: &Scene<R>) -> Vec<f32> {
        let mut gradient = vec![0.0; scene.params.len()];
        self.policy_gradient(&scene.policy, &mut gradient);
        gradient
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
    let mut scene = Scene::td3(&[], &[]);
    scene.params = PARAMS.to_vec();
    scene.set_critics(CRITICS);
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
    let mut scene = Scene::td3(&[], &[]);
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

/// Through critics, law and controller: the design's part is not small beside the others.
fn reaches_all<R: Rule<HardwarePolicy>>(mut scene: Scene<R>) {
    // Critics that are as steep as trained ones.
    for param in scene.critics.each.iter_mut().flat_map(|critic| &mut critic.params) {
        *param *= 3.0;
    }
    let (given, numeric) = scene.gradients();
    let largest = given.iter().fold(0.0_f32, |most, g| most.max(g.abs()));
    assert!(given.last().is_some_and(|design| design.abs() > 1e-3 * largest), "{given:?}");
    for (i, (given, numeric)) in given.iter().zip(numeric).enumerate() {
        let error = (f64::from(*given) - numeric).abs();
        assert!(error < 0.02 * f64::from(largest), "parameter {i}: {given} and {numeric}");
    }
}

#[test]
fn the_gradient_reaches_controller_and_design() {
    reaches_all(Scene::td3(&[5], &[9, 7]));
    reaches_all(Scene::sac(&[5], &[9, 7]));
}

/// Everything but the squash is linear: m = w·y + b, log σ = v·y + c, a = tanh(m + σ·ξ), effort = a - 2·y.
#[test]
fn three_rows_of_sac_by_hand() {
    let mut scene = Scene::sac(&[], &[]);
    // Weights of mean and log σ, their biases, and u.
    scene.params = vec![0.5, 0.3, 0.1, -1.0, 0.0];
    scene.set_critics(CRITICS);
    let wide = |x: f32| f64::from(x);
    let temperature = 0.2;
    let drawn = |y: f64, noise: f64| {
        let (mean, log_std) = (0.5 * y + 0.1, 0.3 * y - 1.0);
        let command = (mean + log_std.exp() * noise).tanh();
        let normal = -0.5 * noise * noise - log_std - 0.5 * std::f64::consts::TAU.ln();
        (command, normal - (1.0 - command * command).ln())
    };
    let value = |critic: [f32; 4], y: f64, command: f64| {
        let [of_y, of_effort, of_command, constant] = critic.map(wide);
        of_y * y + of_effort * (command - 2.0 * y) + of_command * command + constant
    };
    let least =
        |y: f64, command: f64| CRITICS.map(|critic| value(critic, y, command)).into_iter().fold(f64::MAX, f64::min);
    let mut worker = scene.worker();
    worker.judge(&scene.step());
    let squares = (0..3).map(|r| {
        let (y, next) = (wide(Y[r]), wide(NEXT[r]));
        let (command, log_prob) = drawn(next, 1.0);
        let discount = if r == 2 { 0.0 } else { DISCOUNT };
        let soft = least(next, command) - temperature * log_prob;
        // In units of two about one.
        let wanted = (REWARD[r] + discount * (1.0 + 2.0 * soft) - 1.0) / 2.0;
        let [of_y, of_effort, of_command, constant] = CRITICS[0].map(wide);
        let [effort, command] = TAKEN[r].map(wide);
        (of_y * y + of_effort * effort + of_command * command + constant - wanted).powi(2)
    });
    let squares = squares.sum::<f64>();
    assert!((worker.squares - squares).abs() < 1e-6, "{} and {squares}", worker.squares);

    worker.improve(&scene.step());
    let draws = Y.map(wide).map(|y| (y, drawn(y, -0.5)));
    let (values, log_probs) = draws.iter().fold((0.0, 0.0), |sum, &(y, (a, p))| (sum.0 + least(y, a), sum.1 + p));
    assert!((worker.values - values).abs() < 1e-6 && (worker.log_probs - log_probs).abs() < 1e-5);
    // The second critic says less in all rows: 0.75 for effort and 0.5 for the command, of which the stiffness takes y.
    assert!(draws.iter().all(|&(y, (a, _))| value(CRITICS[1], y, a) < value(CRITICS[0], y, a)));
    let mut wanted = [0.0; 5];
    for &(y, (a, _)) in &draws {
        let noise = -0.5 * (0.3 * y - 1.0).exp();
        let of_sum = -1.25 * (1.0 - a * a) + temperature * 2.0 * a;
        let of_log_std = of_sum * noise - temperature;
        let row = [of_sum * y, of_log_std * y, of_sum, of_log_std, 0.75 * y];
        for (sum, g) in wanted.iter_mut().zip(row) {
            *sum += g / 3.0;
        }
    }
    close(&worker.gradient_of(&scene), &wanted);
}

/// -log α·(log π + H̄): it grows where the policy is surer than wanted, and falls where it is less sure.
#[test]
fn the_temperature_follows_entropy() {
    for (log_prob, grows) in [(2.0, true), (0.5, false)] {
        let mut rule = SacRule::new(SacConfig::default(), 1);
        let before = Rule::<HardwarePolicy>::temperature(&rule);
        Rule::<HardwarePolicy>::settle(&mut rule, log_prob, 0.0);
        let after = Rule::<HardwarePolicy>::temperature(&rule);
        assert_eq!(after > before, grows);
        assert!(((after / before).ln().abs() - 3e-4).abs() < 1e-6, "Adam's first step is its rate: {before}, {after}");
    }
}

mod drawn;
