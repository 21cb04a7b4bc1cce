//! A small robot for the tests: two motors with different limits, a law without a trivial derivative, and episodes that
//! end at different times.

// Every test file is a program of its own and uses some of this.
#![allow(dead_code)]

use std::sync::Arc;

use hwasp_core::{
    Anneal, Batch, CommandPort, DesignGroup, DesignSpace, Dimension, EnvSpec, Environment, Hardware, HardwarePolicy,
    Initial, Law, MakeEnvironment, Noise, Placement, PlacementError, Plant, PolicySpec, Port, Ports, Robot, Spread,
    Stream, Task,
};
use hwasp_diff::{Activation, Scalar};
use rand::RngExt;

/// Two gears and two springs.
pub(crate) struct Winch(DesignSpace);

impl Winch {
    pub(crate) fn new() -> Self {
        let group = |name: &str, lo, hi| DesignGroup {
            name: name.into(),
            dimension: Dimension::None,
            lo,
            hi,
            count: 2,
            initial: Initial::Logit { half_width: 1.5 },
        };
        Self(DesignSpace::new(vec![group("gear", 0.5, 3.0), group("spring", 1.0, 9.0)]).unwrap())
    }
}

impl Hardware for Winch {
    fn design(&self) -> &DesignSpace {
        &self.0
    }

    fn ports(&self) -> Ports {
        Ports {
            command: vec!["left".into(), "right".into()],
            state: vec!["x".into(), "v".into()],
            effort: vec!["pull".into(), "push".into()],
        }
    }

    fn effort<T: Scalar>(&self, design: &[T], command: &[T], state: &[T], effort: &mut [T]) {
        let (g0, g1, k0, k1) = (design[0], design[1], design[2], design[3]);
        effort[0] = (command[0] * g0).tanh() * k0 - k1 * state[0] + g1 * state[1] * 0.1;
        effort[1] = command[1] * g1 * (g0 * state[0]).sigmoid() + (k0 * k1).sqrt() * command[0] * state[1];
    }
}

/// A point under both efforts.
pub(crate) struct Point {
    x: f64,
    v: f64,
}

impl Plant for Point {
    fn advance(&mut self, effort: &[f64], _command: &[f64]) {
        self.v = 0.9 * self.v + 0.1 * (effort[0].tanh() + 0.5 * effort[1].tanh());
        self.x += 0.5 * self.v;
    }

    fn state(&self, out: &mut [f64]) {
        out.copy_from_slice(&[self.x, self.v]);
    }
}

/// Stay near the middle; the episode ends where the point has left.
pub(crate) struct Stay;

pub(crate) const HORIZON: usize = 40;

impl Task for Stay {
    type Plant = Point;

    fn spec(&self) -> EnvSpec {
        let port = |name: &str| Port { name: name.into(), dimension: Dimension::None };
        let motor =
            |name: &str, lo, hi| CommandPort { name: name.into(), dimension: Dimension::None, lo, hi, direct: true };
        EnvSpec {
            observation: vec![port("x"), port("v"), port("xv")],
            state: vec![port("x"), port("v")],
            context: vec![],
            effort: vec![port("pull"), port("push")],
            command: vec![motor("left", -1.0, 1.0), motor("right", -2.0, 4.0)],
            horizon: HORIZON,
            time_step: 0.1,
            shaped_by: vec![],
            terms: vec![],
        }
    }

    fn reset(&mut self, plant: &mut Point, rng: &mut Stream) {
        plant.x = rng.random::<f64>() * 1.8 - 0.9;
        plant.v = rng.random::<f64>() * 2.0 - 1.0;
    }

    fn observe(&self, plant: &Point, out: &mut [f64]) {
        out.copy_from_slice(&[plant.x, plant.v, plant.x * plant.v]);
    }

    fn reward(&mut self, plant: &Point, command: &[f64]) -> f64 {
        -plant.x * plant.x - 0.01 * command.iter().map(|c| c * c).sum::<f64>()
    }

    fn terminated(&self, plant: &Point) -> bool {
        plant.x.abs() > 1.0
    }
}

pub(crate) fn robot(horizon: Option<usize>) -> Box<dyn Environment> {
    Box::new(Robot::new(Point { x: 0.0, v: 0.0 }, Stay, horizon))
}

pub(crate) fn make() -> Arc<dyn MakeEnvironment> {
    Arc::new(robot)
}

pub(crate) fn env_spec() -> EnvSpec {
    Stay.spec()
}

/// Noise of another size for each part of the action; the design's leaves its limits now and then.
pub(crate) fn noise() -> Noise {
    let spread = |std, ratio, from, to| Spread { std, anneal: Some(Anneal { ratio, from, to }) };
    Noise {
        command: vec![spread(0.3, 0.01, 0.25, 0.75), spread(0.2, 0.01, 0.25, 0.75)],
        effort: vec![2.0.into(); 2],
        design: spread(0.4, 0.1, 0.0, 0.5),
        train: true,
    }
}

pub(crate) fn policy_spec(placements: Vec<Placement>) -> PolicySpec {
    PolicySpec {
        hidden: vec![7, 5],
        activation: Activation::Tanh,
        squash: true,
        state_dependent_std: false,
        observation_center: vec![0.1, 0.0, -0.2],
        observation_scale: vec![0.5, 1.0, 2.0],
        sees_design: false,
        normalize: None,
        law: Law::new(Winch::new()),
        placements,
        noise: noise(),
    }
}

pub(crate) fn policy(placements: Vec<Placement>) -> Result<HardwarePolicy, PlacementError> {
    HardwarePolicy::new(policy_spec(placements), &env_spec())
}

/// All in one place, and every kind of mixture.
pub(crate) fn all_placements() -> Vec<Vec<Placement>> {
    use Placement::{Action, Episode, Fixed, Graph};
    vec![
        vec![Graph; 4],
        vec![Action; 4],
        vec![Fixed(1.0), Fixed(2.0), Fixed(3.0), Fixed(4.0)],
        vec![Graph, Action, Action, Graph],
        vec![Action, Graph, Graph, Fixed(4.0)],
        vec![Fixed(1.0), Action, Fixed(3.0), Action],
        vec![Episode; 4],
        vec![Action, Graph, Episode, Fixed(4.0)],
        vec![Fixed(1.0), Episode, Action, Episode],
    ]
}

/// Numbers without pattern in (-1, 1): the golden-ratio sequence.
pub(crate) fn irregular(len: usize, salt: usize) -> Vec<f32> {
    let at = |i: usize| (i as f64 + 0.37 * salt as f64) * 0.618_033_988_749_894_9;
    (1..=len).map(|i| (2.0 * at(i).fract() - 1.0) as f32).collect()
}

/// Everything in a batch, as bits: also the sign of a zero counts.
pub(crate) fn bits(batch: &Batch) -> Vec<u64> {
    let narrow = [&batch.obs, &batch.state, &batch.action, &batch.log_prob];
    let mut bits: Vec<u64> = narrow.iter().flat_map(|column| column.iter().map(|x| u64::from(x.to_bits()))).collect();
    bits.extend(batch.reward.iter().map(|x| x.to_bits()));
    for episode in &batch.episodes {
        bits.extend([episode.rows.start as u64, episode.rows.end as u64, episode.end as u64]);
        bits.extend(episode.last_obs.iter().chain([&episode.log_prob]).map(|x| u64::from(x.to_bits())));
    }
    bits
}
