//! Designs that are drawn once an episode, worlds that are made from them, and controllers that see them.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use std::sync::Arc;

use hwasp_core::{
    Batch, CommandPort, Dimension, End, EnvSpec, Environment, EpisodeKind, Episodes, Executor, HardwarePolicy,
    Placement, Policy, PolicySpec, Port, Sampler, Serial, Step, Stream, Threads,
};
use rand::RngExt;

use Placement::{Action, Episode, Fixed, Graph};

/// Its context is the design that it was told before its start, or no number where it was told none. An episode lasts from one
/// step to six; the reward is what the plant was given.
struct Listener {
    spec: EnvSpec,
    told: Option<Vec<f64>>,
    design: Vec<f64>,
    left: usize,
}

fn spec(shaped_by: &[&str]) -> EnvSpec {
    let mut spec = common::env_spec();
    let port = |i: usize| Port { name: format!("design {i}"), dimension: Dimension::None };
    (spec.context, spec.horizon) = ((0..4).map(port).collect(), 6);
    spec.shaped_by = shaped_by.iter().map(|&name| name.to_owned()).collect();
    spec
}

impl Environment for Listener {
    fn spec(&self) -> &EnvSpec {
        &self.spec
    }
    fn set_design(&mut self, design: &[f64]) {
        self.told = Some(design.to_vec());
    }
    fn reset(&mut self, rng: &mut Stream) {
        self.design = self.told.take().unwrap_or(vec![f64::NAN; 4]);
        self.left = rng.random_range(1..=6);
    }
    fn observe(&self, out: &mut [f64]) {
        out.fill(self.left as f64);
    }
    fn state(&self, out: &mut [f64]) {
        out.fill(0.1 * self.left as f64);
    }
    fn context(&self, out: &mut [f64]) {
        out.copy_from_slice(&self.design);
    }
    fn step(&mut self, effort: &[f64], command: &[f64]) -> Step {
        self.left -= 1;
        Step { reward: effort.iter().chain(command).sum(), end: (self.left == 0).then_some(End::Terminated) }
    }
}

fn sampler(policy: PolicySpec, env: &EnvSpec) -> Sampler {
    let spec = env.clone();
    let make = move |_: Option<usize>| -> Box<dyn Environment> {
        Box::new(Listener { spec: spec.clone(), told: None, design: Vec::new(), left: 0 })
    };
    Sampler::new(Arc::new(HardwarePolicy::new(policy, env).unwrap()), Arc::new(make), None)
}

fn collect(sampler: &Sampler, executor: &dyn Executor, episodes: u64, kind: EpisodeKind) -> Batch {
    let params = sampler.policy().init(3, 1.0);
    let asked = Episodes { seed: 4, iteration: 1, indices: 0..episodes, progress: 0.0, kind };
    sampler.collect(executor, &params, &asked).unwrap()
}

/// What is drawn stays the same in all rows of an episode and differs between episodes; the world was told it, within its
/// limits, before every start. Of what is not drawn it was told what the policy has. The bits depend on no number of threads.
#[test]
fn a_design_is_drawn_once_an_episode() {
    for placements in
        [vec![Episode; 4], vec![Action, Episode, Episode, Graph], vec![Fixed(1.0), Episode, Graph, Action]]
    {
        let drawn: Vec<usize> = (0..4).filter(|&i| placements[i] == Episode).collect();
        let sampler = sampler(common::policy_spec(placements), &spec(&[]));
        let policy = sampler.policy();
        assert_eq!(policy.drawn_actions(), drawn.len());
        let params = policy.init(3, 1.0);
        for (&i, u) in drawn.iter().zip(policy.drawn_params()) {
            let mut moved = params.clone();
            moved[u] += 1.0;
            let (before, after) = (policy.design(&params), policy.design(&moved));
            assert!((0..4).all(|k| (before[k] == after[k]) != (k == i)), "{i}: {before:?} {after:?}");
        }
        let batch = collect(&sampler, &Serial, 100, EpisodeKind::Training);
        assert_eq!(
            common::bits(&batch),
            common::bits(&collect(&sampler, &Threads::new(3).unwrap(), 100, EpisodeKind::Training))
        );
        let (mean, width) = (policy.design(&policy.init(3, 1.0)), policy.action_dim());
        let mut beyond = 0;
        for episode in &batch.episodes {
            let first = &batch.action[episode.rows.start * width..][..width];
            for row in episode.rows.clone() {
                assert_eq!(batch.action[row * width..][..drawn.len()], first[..drawn.len()]);
            }
            for i in 0..4 {
                let told = episode.context[i];
                match drawn.iter().position(|&d| d == i) {
                    Some(j) => {
                        let (lo, hi) = policy.space().bounds(i);
                        assert_eq!(told, first[j].clamp(lo as f32, hi as f32));
                        beyond += usize::from(told != first[j]);
                    }
                    None => assert_eq!(told, mean[i] as f32),
                }
            }
        }
        assert!(beyond > 0, "no draw was beyond its limits");
        let mut draws: Vec<u32> = batch.episodes.iter().map(|e| batch.action[e.rows.start * width].to_bits()).collect();
        draws.sort_unstable();
        draws.dedup();
        assert_eq!(draws.len(), 100);
        // Without noise it is the mean.
        for episode in collect(&sampler, &Serial, 3, EpisodeKind::Evaluation).episodes {
            assert_eq!(episode.context, mean.iter().map(|&d| d as f32).collect::<Vec<_>>());
        }
    }
}

/// Draws have the mean and the standard deviation that the policy says: 2,000 of them, within four standard errors.
#[test]
fn draws_are_those_of_the_policy() {
    let sampler = sampler(common::policy_spec(vec![Episode; 4]), &spec(&[]));
    let policy = sampler.policy();
    let batch = collect(&sampler, &Serial, 2000, EpisodeKind::Training);
    let mean = policy.design(&policy.init(3, 1.0));
    for i in 0..4 {
        let (lo, hi) = policy.space().bounds(i);
        let z = |row: usize| (f64::from(batch.action[row * policy.action_dim() + i]) - mean[i]) / (0.4 * (hi - lo));
        let z: Vec<f64> = batch.episodes.iter().map(|episode| z(episode.rows.start)).collect();
        let (first, second) = (z.iter().sum::<f64>() / 2000.0, z.iter().map(|z| z * z).sum::<f64>() / 2000.0);
        assert!(first.abs() < 4.0 / 2000_f64.sqrt(), "{first}");
        assert!((second - 1.0).abs() < 4.0 * (2.0_f64 / 2000.0).sqrt(), "{second}");
    }
}

/// A parameter that the world is made from would change under the feet of the robot in the graph or at every step.
#[test]
fn what_shapes_the_world_is_drawn_once_or_fixed() {
    let compose = |placements| HardwarePolicy::new(common::policy_spec(placements), &spec(&["spring"]));
    for (place, name) in [(Graph, "Graph"), (Action, "Action")] {
        assert_eq!(
            compose(vec![Graph, Action, Fixed(2.0), place]).unwrap_err().to_string(),
            format!(
                "the world's model is made from spring[1], which stays as it is during an episode: place it as Episode or \
                 Fixed, not as {name}"
            )
        );
    }
    assert!(compose(vec![Graph, Action, Episode, Fixed(2.0)]).is_ok());
    assert!(compose(vec![Graph, Action, Placement::Built(0.5), Fixed(2.0)]).is_ok());
}

/// The controller sees each parameter between -1 and 1, after the observation and in every row: what was drawn, and of the
/// others what the policy has. A baseline must not see the draw at the start, and is told so.
#[test]
fn a_controller_may_see_the_design() {
    let mut placements = vec![Graph, Episode, Action, Fixed(3.0)];
    for env in [spec(&[]), spec(&["gear"])] {
        placements[0] = if env.shaped_by.is_empty() { Graph } else { Episode };
        for sees_design in [false, true] {
            let sampler = sampler(PolicySpec { sees_design, ..common::policy_spec(placements.clone()) }, &env);
            let policy = sampler.policy();
            assert_eq!(policy.start_shows_draw(), sees_design || !env.shaped_by.is_empty());
            assert_eq!((policy.observations(), policy.obs_dim()), (3, if sees_design { 7 } else { 3 }));
            let batch = collect(&sampler, &Serial, 20, EpisodeKind::Training);
            for episode in &batch.episodes {
                let told: Vec<f64> = episode.context.iter().map(|&d| f64::from(d)).collect();
                let rows = episode.rows.clone().map(|row| &batch.obs[row * policy.obs_dim()..][..policy.obs_dim()]);
                for seen in rows.chain([&episode.last_obs[..]]) {
                    for (i, (&seen, told)) in seen[3..].iter().zip(&told).enumerate() {
                        let (lo, hi) = policy.space().bounds(i);
                        let wanted = (told - 0.5 * (lo + hi)) / (0.5 * (hi - lo));
                        assert!((f64::from(seen) - wanted).abs() < 1e-6 && seen.abs() <= 1.0, "{seen} is not {wanted}");
                    }
                }
            }
        }
    }
    // What is seen of a design that stays is no draw.
    let fixed = PolicySpec { sees_design: true, ..common::policy_spec(vec![Graph; 4]) };
    assert!(!HardwarePolicy::new(fixed, &spec(&[])).unwrap().start_shows_draw());
}

/// With a brake that the law does not know between its two motors, of which the left one is the law's alone.
fn braked() -> EnvSpec {
    let mut spec = spec(&[]);
    let motor =
        |name: &str, lo, hi, direct| CommandPort { name: name.into(), dimension: Dimension::None, lo, hi, direct };
    spec.command =
        vec![motor("left", -1.0, 1.0, false), motor("brake", 0.0, 3.0, true), motor("right", -2.0, 4.0, true)];
    spec
}

fn braked_policy(placements: Vec<Placement>) -> PolicySpec {
    let mut spec = common::policy_spec(placements);
    spec.noise.command.insert(1, 0.1.into());
    spec
}

/// A command that only the law reads was sampled beside the effort that the law makes of it: noise that moves nothing.
#[test]
fn what_only_the_law_reads_is_sampled_once() {
    let names = |placements| {
        let policy = HardwarePolicy::new(braked_policy(placements), &braked()).unwrap();
        let commands: Vec<_> = (0..3).map(|c| policy.action_of_command(c)).collect();
        (policy.action_names().join(" "), commands)
    };
    assert_eq!(names(vec![Graph; 4]), ("pull push brake right".into(), vec![None, Some(2), Some(3)]));
    // The plant evaluates the law: what it reads is what there is to sample.
    let sampled = "gear[0] gear[1] spring[0] spring[1] left brake right";
    assert_eq!(names(vec![Episode; 4]), (sampled.into(), vec![Some(4), Some(5), Some(6)]));
    assert_eq!(names(vec![Fixed(1.0); 4]).0, "left brake right");
}

/// Without noise, the same command and the same effort come to the world from every placement, to the last bit.
#[test]
fn all_placements_act_alike_without_noise() {
    let run = |placements| {
        let sampler = sampler(braked_policy(placements), &braked());
        collect(&sampler, &Serial, 8, EpisodeKind::Evaluation).reward.iter().map(|r| r.to_bits()).collect::<Vec<_>>()
    };
    let graph = run(vec![Graph; 4]);
    for placements in [vec![Action; 4], vec![Episode; 4], vec![Episode, Graph, Action, Graph]] {
        assert_eq!(run(placements.clone()), graph, "{placements:?}");
    }
}

/// Such a command still has its limits, and the others their noise.
#[test]
fn commands_that_are_not_sampled_come_from_the_controller() {
    let sampler = sampler(braked_policy(vec![Graph; 4]), &braked());
    let policy = sampler.policy();
    let params = policy.init(3, 1.0);
    let mut actor = hwasp_core::Actor::new(policy, &params, 0.0, 1);
    let mut noise = [hwasp_core::stream(1, hwasp_core::Purpose::Check, 0, 0)];
    let seen: Vec<(f64, f64)> = (0..20)
        .map(|_| {
            actor.act(&[0.3, -0.2, 0.9], &[0.1, 0.2], 1, Some(&mut noise));
            (actor.unsampled(0)[0], actor.action(0)[3])
        })
        .collect();
    assert!(seen.iter().all(|(left, _)| *left == seen[0].0 && left.abs() < 1.0), "{seen:?}");
    assert!(seen.windows(2).all(|pair| pair[0].1 != pair[1].1), "{seen:?}");
}

#[test]
fn somebody_reads_each_command() {
    let mut env = braked();
    env.command[1].direct = false;
    assert_eq!(
        HardwarePolicy::new(braked_policy(vec![Graph; 4]), &env).unwrap_err().to_string(),
        "nobody reads the command brake: it is no port of the law, and plant and task leave it to the law"
    );
}

/// Efforts of different dimensions had one standard deviation.
#[test]
fn each_effort_has_its_own_noise() {
    let mut spec = common::policy_spec(vec![Graph; 4]);
    spec.noise.effort = vec![2.0.into(), 0.25.into()];
    let policy = HardwarePolicy::new(spec.clone(), &common::env_spec()).unwrap();
    let mut log_std = vec![0.0; 4];
    policy.log_std(&policy.init(0, 1.0), 0.0, &mut log_std);
    assert_eq!(log_std[..2], [2.0_f32.ln(), 0.25_f32.ln()]);
    spec.noise.effort.pop();
    assert_eq!(
        HardwarePolicy::new(spec.clone(), &common::env_spec()).unwrap_err().to_string(),
        "noise for 1 efforts, but there are 2"
    );
    // Where efforts are not sampled their noise says nothing.
    spec.placements = vec![Action; 4];
    assert!(HardwarePolicy::new(spec, &common::env_spec()).is_ok());
}
