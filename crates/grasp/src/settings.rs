//! What of the grasping tasks can be chosen.

use hwasp_core::{Initial, share_done};

use crate::error::GraspError;
use hwasp_tasks::grasp::rules::{HORIZON, PALM_STEP};
pub use hwasp_tasks::grasp::{Bench, Inertia, ShapeKind, Viewpoint};
use hwasp_tasks::hand::{DESIGN_LEN, HandDescription, HandRange, KINDS_LEN, PalmMotion};

/// The reward of a step: `distance`·|palm - object| + `contact`·C + f(height) (paper, appendix B; numbers \[M\]). The last is
/// ours, and zero unless asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct GraspReward {
    /// Per metre between palm and object.
    pub distance: f64,
    /// Per distal link that touches the object.
    pub contact: f64,
    /// Heights of the object's lowest point, m, rising, and what is given from there on.
    pub height: Vec<(f64, f64)>,
    /// Per metre that the palm is told to move sideways.
    pub sideways: f64,
    /// Per metre by which palm and object came nearer to each other, seen from above, in the step. Over an episode it adds up
    /// to what start and end differ by (shaping by a potential: Ng, Harada and Russell, ICML 1999).
    pub approach: f64,
}

impl Default for GraspReward {
    fn default() -> Self {
        Self {
            distance: -2.0,
            contact: 0.1,
            height: vec![(0.005, 0.5), (0.020, 1.0), (0.050, 2.0), (0.100, 4.0)],
            sideways: 0.0,
            approach: 0.0,
        }
    }
}

/// A quantity that changes evenly while training goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramp {
    /// Its first value.
    pub first: f64,
    /// Its last.
    pub last: f64,
    /// The fractions of training between which it changes.
    pub progress: [f64; 2],
}

impl Ramp {
    /// Its value at this fraction of training.
    pub(super) fn at(&self, progress: f64) -> f64 {
        let [from, to] = self.progress;
        self.first + (self.last - self.first) * share_done(progress, from, to)
    }
}

/// A grasping task.
///
/// | field | default | purpose | source |
/// |---|---|---|---|
/// | `palm` | vertical | Z-Grasp or 3D-Grasp | \[P\] |
/// | `range`, `initial` | large, logit ±5 | limits and start of the design | \[M\] |
/// | `opening` | none | what the springs open with at least, N·m | \[M\] |
/// | `shapes` | all four | which objects there are | \[P\] |
/// | `size` | 40 to 100 mm | each edge of the bounding box | \[P\] |
/// | `mass` | 100 to 500 g | | \[P\] |
/// | `friction` | 0.5 to 1 | sliding, on hand and floor | \[P\] |
/// | `inertia` | 1e-4 to 5e-3 kg·m² | each principal moment | \[P\] |
/// | `height` | 150 to 250 mm | of the palm above the object's top at the start | \[M\] |
/// | `offset` | 0 (3D: 50 mm) | the object's place, ± in x and y | \[M\] |
/// | `offset_ramp` | none | another offset while training goes on | \[M\] |
/// | `load_ramp` | none | objects heavier by a factor while training goes on | \[M\] |
/// | `yaw`, `lying` | 0, 0 | turned by up to ±, share of cylinders on their side | \[M\] |
/// | `viewpoint` | world | from where the controller sees the object | \[P\] |
/// | `bench` | the paper's simulation | what is sensed, how late, what the hand really does | \[M\] |
/// | `sensor_noise` | 1 mm, 0.08 mm | palm and object position; motor travel | \[P\] |
/// | `actuation_noise` | 1 mm, 0.08 mm | palm target; motor travel | \[P\] |
/// | `disturbance` | 0.02 N, 0.002 N·m | on palm and object, redrawn each step | \[P\] |
/// | `horizon` | 500 | steps of 10 ms | \[P\] |
#[derive(Clone, Debug, PartialEq)]
pub struct GraspSettings {
    /// How the palm may move.
    pub palm: PalmMotion,
    /// Everything about the hand that is not designed.
    pub hand: HandDescription,
    /// Limits of the design.
    pub range: HandRange,
    /// Where the design begins.
    pub initial: [Initial; DESIGN_LEN],
    /// What the springs of each kind of joint open with at least, N·m; none where hands may droop.
    pub opening: Option<[f64; KINDS_LEN]>,
    /// Shapes of objects, at least one.
    pub shapes: Vec<ShapeKind>,
    /// Edges of the bounding box, from and to, m.
    pub size: [f64; 2],
    /// Mass, from and to, kg.
    pub mass: [f64; 2],
    /// Friction, from and to.
    pub friction: [f64; 2],
    /// Inertia.
    pub inertia: Inertia,
    /// Height of the palm above the object's top at the start, from and to, m.
    pub height: [f64; 2],
    /// The object's place in x and y, ± m.
    pub offset: f64,
    /// The offset while training goes on, ± m, where it changes.
    pub offset_ramp: Option<Ramp>,
    /// A factor of the mass while training goes on.
    pub load_ramp: Option<Ramp>,
    /// The object's yaw, ± rad.
    pub yaw: f64,
    /// The share of cylinders that lie.
    pub lying: f64,
    /// From where the controller sees the object.
    pub viewpoint: Viewpoint,
    /// What is sensed, how late, and what the hand really does.
    pub bench: Bench,
    /// Standard deviations of the sensors: positions, m, and motor travel, m.
    pub sensor_noise: [f64; 2],
    /// Standard deviations of what the actuators do: palm, m, and motor travel, m. Never accumulates.
    pub actuation_noise: [f64; 2],
    /// Standard deviations of force, N, and torque, N·m, on palm and object, per axis.
    pub disturbance: [f64; 2],
    /// Motion of the palm in a step, ± m.
    pub palm_step: f64,
    /// The reward.
    pub reward: GraspReward,
    /// Environment steps of an episode.
    pub horizon: usize,
}

impl Default for GraspSettings {
    fn default() -> Self {
        Self {
            palm: PalmMotion::Vertical,
            hand: HandDescription::default(),
            range: HandRange::Large,
            initial: [Initial::Logit { half_width: 5.0 }; DESIGN_LEN],
            opening: None,
            shapes: ShapeKind::EACH.to_vec(),
            size: [0.040, 0.100],
            mass: [0.100, 0.500],
            friction: [0.5, 1.0],
            inertia: Inertia::Independent([1e-4, 5e-3]),
            height: [0.150, 0.250],
            offset: 0.0,
            offset_ramp: None,
            load_ramp: None,
            yaw: 0.0,
            lying: 0.0,
            viewpoint: Viewpoint::World,
            bench: Bench::default(),
            sensor_noise: [1e-3, 8e-5],
            actuation_noise: [1e-3, 8e-5],
            disturbance: [0.02, 0.002],
            palm_step: PALM_STEP,
            reward: GraspReward::default(),
            horizon: HORIZON,
        }
    }
}

impl GraspSettings {
    /// Whether objects can be drawn from them and a hand be moved by them.
    pub(super) fn check(&self) -> Result<(), GraspError> {
        let setting = |name, value: String, limits| Err(GraspError::Setting { name, value, limits });
        if self.shapes.is_empty() {
            return setting("shapes", "[]".into(), "at least one of sphere, box, cylinder and ellipsoid");
        }
        if self.horizon == 0 {
            return setting("horizon", "0".into(), "at least 1");
        }
        let inertia = match self.inertia {
            Inertia::Independent(range) => range,
            Inertia::Physical => [1.0; 2],
        };
        for (name, [lo, hi], least) in [
            ("size", self.size, 1e-3),
            ("mass", self.mass, 1e-6),
            ("friction", self.friction, 0.0),
            ("inertia", inertia, 1e-9),
            ("height", self.height, 0.0),
            ("bench.delay", self.bench.delay, 0.0),
            ("bench.arm_lag", self.bench.arm_lag, 0.0),
            ("bench.slack", self.bench.slack, 0.0),
            ("bench.torque_gain", self.bench.torque_gain, 1e-3),
            ("bench.limit_gain", self.bench.limit_gain, 1e-3),
        ] {
            if !(lo.is_finite() && hi.is_finite() && least <= lo && lo <= hi) {
                return setting(
                    name,
                    format!("{lo} to {hi}"),
                    "a range of positive finite numbers, the smaller one first",
                );
            }
        }
        for (name, value) in [
            ("offset", self.offset),
            ("offset_ramp.first", self.offset_ramp.map_or(0.0, |ramp| ramp.first)),
            ("offset_ramp.last", self.offset_ramp.map_or(0.0, |ramp| ramp.last)),
            ("yaw", self.yaw),
            ("lying", self.lying),
            ("sensor_noise[0]", self.sensor_noise[0]),
            ("sensor_noise[1]", self.sensor_noise[1]),
            ("actuation_noise[0]", self.actuation_noise[0]),
            ("actuation_noise[1]", self.actuation_noise[1]),
            ("disturbance[0]", self.disturbance[0]),
            ("disturbance[1]", self.disturbance[1]),
        ] {
            if !(value.is_finite() && value >= 0.0) {
                return setting(name, value.to_string(), "a finite number that is not negative");
            }
        }
        if let Some(ramp) = self.load_ramp
            && ![ramp.first, ramp.last].iter().all(|factor| factor.is_finite() && *factor > 0.0)
        {
            return setting("load_ramp", format!("{} to {}", ramp.first, ramp.last), "two positive factors");
        }
        if !(self.palm_step.is_finite() && self.palm_step > 0.0) {
            return setting("palm_step", self.palm_step.to_string(), "a positive length");
        }
        if self.reward.height.windows(2).any(|pair| pair[0].0 >= pair[1].0) {
            return setting("reward.height", format!("{:?}", self.reward.height), "in rising order of heights");
        }
        Ok(())
    }
}
