//! The hand of a design behind the emulators: MuJoCo with the hand's own tendons, its palm at the arm's tool and its tendons on
//! the motor's spool.

mod spool;

use std::collections::VecDeque;

use hwasp_core::{Environment, Purpose, stream};
use hwasp_drivers::Pose;
use hwasp_grasp::{CarriedHand, Grasp, GraspError, GraspSettings, Hold, Object};
use hwasp_mujoco::engine::{EditError, PhysicsFault};
use hwasp_tasks::hand::{DESIGN_LEN, TransmissionDescription};
use thiserror::Error;

pub use spool::Planted;

use crate::world::{STEP, SpoolDrive, SpoolState, World};
use spool::{Spool, Tendons};

/// The steps of a world between two looks at the hold, which counts in 10 ms.
const LOOK: usize = 10;

/// How the palm hangs on the tool.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Carry {
    /// It is bolted to an arm: 160 N/mm, critically damped, so that it is 5 ms late. As stiff as steps of 1 ms allow; the order
    /// of magnitude is that of an arm under position control.
    #[default]
    Stiff,
    /// By the compliant control with which controllers are trained, 2.5 N/mm.
    Compliant,
}

/// Stiffness, N/m, damping, N·s/m, and most force, N, of a palm that is bolted to an arm and weighs 1 kg.
const STIFF: [f64; 3] = [1.6e5, 800.0, 2000.0];

/// A hand on a bench.
#[derive(Clone, Debug, PartialEq)]
pub struct HandWorldSettings {
    /// The hand but for its design, and how objects are drawn.
    pub grasp: GraspSettings,
    /// The design as built, SI.
    pub design: [f64; DESIGN_LEN],
    /// Where the arm's base stands in the world, whose floor is at z = 0 and whose axes are the palm's.
    pub base: Pose,
    /// Where the palm's origin is in the tool's frame, m.
    pub palm: [f64; 3],
    /// How the palm hangs on the tool.
    pub carry: Carry,
    /// What differs from the description.
    pub planted: Planted,
}

/// Why there is no such world.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum HandWorldError {
    /// No such hand.
    #[error(transparent)]
    Grasp(#[from] GraspError),
    /// No such object.
    #[error(transparent)]
    Object(#[from] EditError),
    /// A value that cannot be.
    #[error("{name} = {value} is not {lo} to {hi}{unit}")]
    Planted {
        /// What is planted.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What can be, from and to.
        lo: f64,
        /// The same.
        hi: f64,
        /// Of all of them, behind a space; nothing for a factor.
        unit: &'static str,
    },
    /// What nothing is called that can be planted.
    #[error("`{name}` cannot be planted; there are {}", Planted::names())]
    NotPlanted {
        /// What was given.
        name: String,
    },
}

/// What is to be seen of a hand.
#[derive(Clone, Debug, PartialEq)]
pub struct HandView {
    /// The palm in the world, m.
    pub palm: [f64; 3],
    /// Angles of the joints, rad.
    pub joints: [f64; 6],
    /// The object.
    pub object: Object,
    /// Its centre in the world, m, and its orientation (w, x, y, z).
    pub object_pose: [f64; 7],
    /// Height of its lowest point above the floor, m.
    pub clearance: f64,
    /// Which links touch it.
    pub touching: [bool; 6],
    /// Whether the last second was a hold, as a success asks for.
    pub success: bool,
    /// Wound on the spool, m.
    pub wound: f64,
    /// What all tendons pull together, N.
    pub tension: f64,
    /// s since the object was put there.
    pub time: f64,
    /// Why the world stands still, if the physics broke down.
    pub fault: Option<String>,
}

/// The hand of a design, an object and a floor.
#[derive(Debug)]
pub struct HandWorld {
    hand: CarriedHand,
    grasp: Grasp,
    transmission: TransmissionDescription,
    settings: HandWorldSettings,
    object: Object,
    spool: Spool,
    /// Drives that have not reached the spool yet.
    late: VecDeque<SpoolDrive>,
    hold: Hold,
    steps: usize,
    /// Whether the hand has to be taken to where the tool is first.
    fresh: bool,
    fault: Option<PhysicsFault>,
}

impl HandWorld {
    /// A hand above the first object of the evaluation with seed 0.
    ///
    /// # Errors
    /// Where there is no such hand.
    pub fn new(settings: HandWorldSettings) -> Result<Self, HandWorldError> {
        settings.planted.check()?;
        let grasp = Grasp::native(settings.grasp.clone(), &settings.design)?;
        let mut built = settings.grasp.hand.clone();
        if let Some(stiffness) = settings.planted.tendon_stiffness {
            built.transmission.tendon_stiffness = stiffness;
        }
        if settings.carry == Carry::Stiff {
            let palm = &mut built.palm;
            [palm.position_gain, palm.velocity_gain, palm.force_limit] = STIFF;
        }
        let (object, palm) = held_out(&grasp, 0, 0);
        let mut hand = CarriedHand::new(&built, &settings.design)?;
        hand.start(object.clone(), palm)?;
        let waiting = (settings.planted.delay / STEP).round() as usize;
        Ok(Self {
            hand,
            grasp,
            transmission: built.transmission,
            settings,
            object,
            spool: Spool::default(),
            late: vec![SpoolDrive::Free; waiting].into(),
            hold: Hold::default(),
            steps: 0,
            fresh: true,
            fault: None,
        })
    }

    /// The object of an episode of evaluation, and where the palm starts above it in the world, m.
    pub fn drawn(&self, seed: u64, index: u64) -> (Object, [f64; 3]) {
        held_out(&self.grasp, seed, index)
    }

    /// Puts an object on the floor instead of the one that is there, and opens the hand, whose palm is at the tool.
    ///
    /// # Errors
    /// Where the engine does not take it.
    pub fn put(&mut self, object: Object, tool: &Pose) -> Result<(), EditError> {
        self.hand.start(object.clone(), self.palm_at(tool))?;
        self.object = object;
        self.hold.start();
        (self.steps, self.fresh, self.fault) = (0, false, None);
        Ok(())
    }

    /// What is to be seen.
    pub fn look(&self) -> HandView {
        HandView {
            palm: self.hand.palm(),
            joints: self.hand.joints(),
            object: self.object.clone(),
            object_pose: self.hand.object_pose(),
            clearance: self.hand.clearance(),
            touching: if self.steps == 0 { [false; 6] } else { self.hand.touching() },
            success: self.hold.success(),
            wound: self.spool.wound,
            tension: self.spool.tension,
            time: STEP * self.steps as f64,
            fault: self.fault.as_ref().map(ToString::to_string),
        }
    }

    /// Where the palm is in the world with the tool so, m.
    pub fn palm_at(&self, tool: &Pose) -> [f64; 3] {
        let in_base = add(turned(tool.rotation, self.settings.palm), tool.position);
        add(turned(self.settings.base.rotation, in_base), self.settings.base.position)
    }

    fn go(&mut self, palm: [f64; 3]) -> Result<(), PhysicsFault> {
        if std::mem::take(&mut self.fresh) {
            // An object that the engine took it takes again.
            let _started = self.hand.start(self.object.clone(), palm);
        }
        self.hand.carry(palm);
        self.hand.wind(self.spool.wound - self.settings.planted.slack);
        self.hand.step()?;
        self.steps += 1;
        if self.steps.is_multiple_of(LOOK) {
            let [x, y, z, ..] = self.hand.object_pose();
            self.hold.note(self.hand.clearance(), self.hand.touching(), self.hand.palm(), [x, y, z]);
        }
        Ok(())
    }
}

impl World for HandWorld {
    fn step(&mut self, tool: &Pose, drive: SpoolDrive) -> SpoolState {
        let TransmissionDescription { tendon_stiffness, spool_radius, torque_constant, .. } = self.transmission;
        let Planted { torque_gain, friction, slack, zero, .. } = self.settings.planted;
        self.late.push_back(drive);
        let drive = self.late.pop_front().unwrap_or(SpoolDrive::Free);
        let per_ampere = torque_constant * torque_gain;
        let driven =
            Option::from(drive).map(|(goal, current): (f64, f64)| (spool_radius * (goal - zero), per_ampere * current));
        let taken_up = self.hand.taken_up().map(|length| length + slack);
        let tendons = Tendons { taken_up, stiffness: tendon_stiffness, radius: spool_radius, friction };
        let before = self.spool.wound;
        self.spool.turn(driven, &tendons);
        if self.fault.is_none() {
            let palm = self.palm_at(tool);
            self.fault = self.go(palm).err();
        }
        SpoolState {
            position: self.spool.wound / spool_radius + zero,
            velocity: (self.spool.wound - before) / spool_radius / STEP,
            current: self.spool.torque / per_ampere,
        }
    }
}

/// The object of an episode of evaluation, as `hwasp eval` has it, and where the palm starts above it in the world, m. Neither depends on
/// the design.
pub fn held_out(grasp: &Grasp, seed: u64, index: u64) -> (Object, [f64; 3]) {
    let mut robot = grasp.robot(None);
    robot.reset(&mut stream(seed, Purpose::EvaluationReset, 0, index));
    (robot.plant().object().clone(), robot.plant().palm())
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] + b[i])
}

/// A vector turned by an axis times an angle (Rodrigues).
fn turned(rotation: [f64; 3], v: [f64; 3]) -> [f64; 3] {
    let angle = rotation.iter().map(|r| r * r).sum::<f64>().sqrt();
    if angle == 0.0 {
        return v;
    }
    let k = rotation.map(|r| r / angle);
    let (sin, cos) = angle.sin_cos();
    let along = (1.0 - cos) * (k[0] * v[0] + k[1] * v[1] + k[2] * v[2]);
    let cross = [k[1] * v[2] - k[2] * v[1], k[2] * v[0] - k[0] * v[2], k[0] * v[1] - k[1] * v[0]];
    [0, 1, 2].map(|i| cos * v[i] + sin * cross[i] + along * k[i])
}
