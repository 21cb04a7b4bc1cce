//! The transmission law: motor travel and joint angles to joint torques, written once.

use hwasp_core::{DesignSpace, Hardware, Initial, Ports};
use hwasp_diff::Scalar;

use super::description::TransmissionDescription;
use super::error::{HandError, within};
use super::names::{JOINTS, KIND_OF_JOINT};
use super::space::{DESIGN_LEN, HandRange, KINDS_LEN};

/// How the palm may move.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PalmMotion {
    /// Up and down only: `palm_z` (Z-Grasp).
    #[default]
    Vertical,
    /// `palm_x`, `palm_y` and `palm_z` (3D-Grasp).
    Spatial,
}

impl PalmMotion {
    /// The palm's commands, m per environment step.
    pub fn commands(self) -> &'static [&'static str] {
        match self {
            Self::Vertical => &["palm_z"],
            Self::Spatial => &["palm_x", "palm_y", "palm_z"],
        }
    }
}

/// What of the law can be chosen beside the mechanism.
///
/// | field | default | purpose | must be |
/// |---|---|---|---|
/// | `palm` | vertical | which palm commands stand before the motor's | |
/// | `range` | large | limits of the twelve parameters | lo < hi |
/// | `initial` | logit ±5 | where each parameter begins | inside of its limits |
/// | `opening` | none | what the springs of each kind of joint open with at least, N·m: [`opening_torques`](super::opening_torques) | within what the limits allow |
#[derive(Clone, Debug, PartialEq)]
pub struct TendonHandSettings {
    /// Which palm commands there are. The law passes them by.
    pub palm: PalmMotion,
    /// Limits of the parameters.
    pub range: HandRange,
    /// Where they begin.
    pub initial: [Initial; DESIGN_LEN],
    /// The least torque, N·m, with which the springs of each kind of joint hold it open.
    pub opening: Option<[f64; KINDS_LEN]>,
}

impl Default for TendonHandSettings {
    fn default() -> Self {
        Self {
            palm: PalmMotion::default(),
            range: HandRange::default(),
            initial: [Initial::Logit { half_width: 5.0 }; DESIGN_LEN],
            opening: None,
        }
    }
}

/// Three elastic tendons on one spool, each over two pulleys against two springs (paper, appendix B).
///
/// | | name | unit | |
/// |---|---|---|---|
/// | design | `thumb_proximal_radius`, …, 4 | m | pulley radii r |
/// | | `thumb_proximal_stiffness`, …, 4 | N·m/rad | spring stiffnesses k |
/// | | `thumb_proximal_preload`, …, 4 | rad | spring preloads p |
/// | command | `palm_z`, or `palm_x`, `palm_y`, `palm_z` | m | motion of the palm in the step; not used by the law |
/// | | `motor`, Δx | m | motion of the tendons' ends in the step |
/// | state | `motor_travel`, x | m | wound so far |
/// | | `thumb_proximal_angle`, …, 6, θ | rad | joint angles, 0 open |
/// | effort | `thumb_proximal_torque`, …, 6 | N·m | f·r - k·(θ + p), closing |
/// | | `motor_torque` | N·m | spool radius · Σf |
///
/// The tension of a digit is f = `k_tend`·max(0, x + Δx - Σ r·(θ - `theta_ref`)), with x + Δx limited to the spool's travel:
/// the paper's law, except that a tendon does not push. If the three exceed the motor's tension limit together, all are
/// scaled down to it.
///
/// Where springs have to open with a least torque, a preload that is too small for it counts as the one that suffices, and where
/// that would be beyond its limit the spring counts as stiffer, too: such hands are built, and the gradient knows it.
#[derive(Clone, Debug)]
pub struct TendonHand {
    transmission: TransmissionDescription,
    palm: PalmMotion,
    design: DesignSpace,
    opening: Option<Opening>,
}

/// What the springs of the four kinds of joints open with at least.
#[derive(Clone, Copy, Debug)]
struct Opening {
    /// N·m.
    torque: [f64; KINDS_LEN],
    /// The stiffness with which the largest preload suffices, N·m/rad.
    stiffness: [f64; KINDS_LEN],
}

impl Opening {
    fn new(torque: [f64; KINDS_LEN], range: &HandRange) -> Result<Self, HandError> {
        let bounds = range.bounds();
        let mut stiffness = [0.0; KINDS_LEN];
        for kind in 0..KINDS_LEN {
            let (stiffest, most) = (bounds[4 + kind].1, bounds[8 + kind].1);
            within("opening torque", torque[kind], 0.0, stiffest * most, "N·m")?;
            stiffness[kind] = torque[kind] / most;
        }
        Ok(Self { torque, stiffness })
    }

    /// Stiffness and preload of a joint as it is built.
    #[inline]
    fn springs<T: Scalar>(&self, kind: usize, stiffness: T, preload: T) -> (T, T) {
        let stiffness = stiffness.max(T::constant(self.stiffness[kind]));
        (stiffness, preload.max(T::constant(self.torque[kind]) / stiffness))
    }
}

impl TendonHand {
    /// The law of a transmission.
    pub fn new(transmission: &TransmissionDescription, settings: &TendonHandSettings) -> Result<Self, HandError> {
        transmission.check()?;
        Ok(Self {
            transmission: transmission.clone(),
            palm: settings.palm,
            design: settings.range.space(&settings.initial)?,
            opening: settings.opening.map(|torque| Opening::new(torque, &settings.range)).transpose()?,
        })
    }

    /// Stiffness and preload of the springs of a kind of joint as they are built.
    #[inline]
    fn springs<T: Scalar>(&self, design: &[T], kind: usize) -> (T, T) {
        let (stiffness, preload) = (design[4 + kind], design[8 + kind]);
        self.opening.map_or((stiffness, preload), |opening| opening.springs(kind, stiffness, preload))
    }

    /// The tensions, N, of thumb, first and second finger: `step` and `travel` in m, the six `angles` in rad.
    #[inline]
    pub fn tensions<T: Scalar>(&self, design: &[T], step: T, travel: T, angles: &[T]) -> [T; 3] {
        let TransmissionDescription { tendon_stiffness, tension_limit, ref reference, .. } = self.transmission;
        let end = (travel + step).clamp(0.0, self.transmission.travel);
        let free = [0, 1, 2].map(|digit| {
            let taken_up = [2 * digit, 2 * digit + 1].map(|joint| {
                let kind = KIND_OF_JOINT[joint];
                design[kind] * (angles[joint] - reference[kind])
            });
            // Equations of elongation and force (appendix B); a slack tendon has none.
            let elongation = end - (taken_up[0] + taken_up[1]);
            (elongation * tendon_stiffness).max(T::constant(0.0))
        });
        // min(1, limit/Σf), in the form that has a derivative where all tendons are slack.
        let limit = T::constant(tension_limit);
        let scale = limit / (free[0] + free[1] + free[2]).max(limit);
        free.map(|tension| tension * scale)
    }
}

impl Hardware for TendonHand {
    fn design(&self) -> &DesignSpace {
        &self.design
    }

    fn ports(&self) -> Ports {
        let of_joints = |quantity: &str| JOINTS.map(|joint| format!("{joint}_{quantity}"));
        let mut ports = Ports {
            command: self.palm.commands().iter().copied().map(str::to_owned).collect(),
            state: vec!["motor_travel".to_owned()],
            effort: of_joints("torque").to_vec(),
        };
        ports.command.push("motor".to_owned());
        ports.state.extend(of_joints("angle"));
        ports.effort.push("motor_torque".to_owned());
        ports
    }

    #[inline]
    fn effort<T: Scalar>(&self, design: &[T], command: &[T], state: &[T], effort: &mut [T]) {
        let (travel, angles) = (state[0], &state[1..7]);
        let tensions = self.tensions(design, command[self.palm.commands().len()], travel, angles);
        let springs = [0, 1, 2, 3].map(|kind| self.springs(design, kind));
        for (joint, &kind) in KIND_OF_JOINT.iter().enumerate() {
            let (stiffness, preload) = springs[kind];
            // Equation of joint torques (appendix B).
            effort[joint] = tensions[joint / 2] * design[kind] - stiffness * (angles[joint] + preload);
        }
        effort[6] = (tensions[0] + tensions[1] + tensions[2]) * self.transmission.spool_radius;
    }

    fn as_built(&self, design: &[f64]) -> Vec<f64> {
        let mut built = design.to_vec();
        for kind in 0..KINDS_LEN {
            (built[4 + kind], built[8 + kind]) = self.springs(design, kind);
        }
        built
    }
}
