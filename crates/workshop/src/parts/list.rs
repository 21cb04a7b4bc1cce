//! The parts list as files and programs have it. Everything is in SI units.

use hwasp_fabrication::{SeatedSpring, Verdict, Workshop};
use hwasp_tasks::hand::DESIGN_LEN;
use hwasp_training::{Change, Evaluation};
use serde::{Deserialize, Serialize};

/// The parts of a hand and what they are worth: `parts.json`. SI units: m, N·m/rad, N·m, rad, Pa.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PartsList {
    /// The experiment.
    pub experiment: String,
    /// How learner, controller and hardware were composed.
    pub method: String,
    /// The problem.
    pub task: String,
    /// The root seed.
    pub seed: u64,
    /// Where the springs come from.
    pub catalogue: CatalogueNote,
    /// The workshop; what an older list does not say of it is as by default.
    #[serde(rename = "bench")]
    pub workshop: Workshop,
    /// The four kinds of joints: thumb proximal, thumb distal, finger proximal, finger distal.
    pub joints: Vec<JointParts>,
    /// Every design parameter as trained and as these parts make it, in the order of the design.
    pub design: Vec<SnappedParameter>,
    /// What became of return and success.
    pub worth: PartsWorth,
    /// Whether a hand can be built of them, and why; older lists do not say it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub verdict: Option<Verdict>,
}

/// Where springs come from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CatalogueNote {
    /// The file; `built in` for the one that comes with the program.
    pub name: String,
    /// How many springs it has.
    pub springs: usize,
}

/// What the transmission is at a kind of joint.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointDesign {
    /// Radius of the pulley, to the middle of the line, m.
    pub radius: f64,
    /// Stiffness of all springs of a joint together, N·m/rad.
    pub stiffness: f64,
    /// How far they are wound up where the joint is open, rad.
    pub preload: f64,
}

impl JointDesign {
    /// Torque of the springs, N·m, where the joint is closed by an angle, rad.
    pub fn spring_torque(&self, angle: f64) -> f64 {
        self.stiffness * (angle + self.preload)
    }
}

/// The parts of a kind of joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointParts {
    /// Thumb or finger, proximal or distal.
    pub joint: String,
    /// How many joints of the hand are built so.
    pub joints: u32,
    /// What was trained.
    pub trained: JointDesign,
    /// What these parts make.
    pub built: JointDesign,
    /// The pulley.
    pub pulley: PulleyPart,
    /// The springs.
    pub spring: SpringPart,
    /// How far the springs' torque is off at worst, over the joint's whole range, N·m.
    pub torque_error: f64,
}

impl SpringPart {
    /// As its joint has to make room for it: wide as it is free, long with the joint closed.
    pub fn seated(&self) -> SeatedSpring {
        SeatedSpring { wire: self.wire, outer: self.outer, length: self.length_wound }
    }
}

/// The design that parts of four kinds of joints make, in its order.
pub(super) fn design_of(joints: &[JointParts; 4], of: fn(&JointParts) -> JointDesign) -> [f64; DESIGN_LEN] {
    std::array::from_fn(|i| {
        let JointDesign { radius, stiffness, preload } = of(&joints[i % 4]);
        [radius, stiffness, preload][i / 4]
    })
}

/// A pulley.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PulleyPart {
    /// Radius of the ground of the groove, m.
    pub groove_radius: f64,
    /// Diameter of the line on it, m; the middle of the line lies at the pulley's radius.
    pub line: f64,
}

/// The springs of a joint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpringPart {
    /// What the catalogue calls it.
    pub part: String,
    /// How many of them lie side by side.
    pub count: u32,
    /// Diameter of the wire, m.
    pub wire: f64,
    /// Outer diameter of the free coil, m.
    pub outer: f64,
    /// Inner diameter of the free coil, m.
    pub inner: f64,
    /// Turns of the body.
    pub turns: f64,
    /// Angle between the legs of the free spring, rad.
    pub leg_angle: f64,
    /// Length of each leg, m.
    pub leg: f64,
    /// Torque per angle of one spring, N·m/rad.
    pub rate: f64,
    /// Torque of one spring with the joint closed, N·m.
    pub largest_torque: f64,
    /// Bending stress there, Pa.
    pub stress: f64,
    /// The same as a share of the wire's strength.
    pub stress_share: f64,
    /// Inner diameter with the joint closed, m: what is left for the axle.
    pub inner_wound: f64,
    /// Length of the body with the joint closed, m.
    pub length_wound: f64,
    /// The hole of the fixed leg, from 0: its angle is `hole` times the pitch, from the moving leg's seat in the open joint
    /// against the direction of closing.
    pub hole: u32,
}

/// A design parameter as trained and as built.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SnappedParameter {
    /// Its name.
    pub name: String,
    /// The SI unit of its values.
    pub unit: String,
    /// As trained.
    pub trained: f64,
    /// As the parts make it.
    pub built: f64,
}

/// What a parts list is worth, on the same held-out episodes throughout.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PartsWorth {
    /// The trained controller on the trained design.
    pub trained: Evaluation,
    /// The trained controller on the parts.
    pub snapped: Evaluation,
    /// From the first to the second: what rounding to parts costs.
    pub snapping: Change,
    /// The controller trained further on the parts, where that was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tuned: Option<TunedWorth>,
}

/// What training further on the parts is worth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TunedWorth {
    /// The run folder of the further training, seen from the folder of the list.
    pub folder: String,
    /// Real simulator steps of it.
    pub env_steps: u64,
    /// The tuned controller on the parts.
    pub evaluation: Evaluation,
    /// From the trained controller on the trained design to this.
    pub change: Change,
}
