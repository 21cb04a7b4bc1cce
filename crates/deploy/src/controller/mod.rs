//! The trained controller on the bench: sensors to observations by name, commands by name to targets.

mod ports;
mod spool;

use hwasp_core::{Actor, Normalizer};
use hwasp_experiment::Experiment;
use hwasp_export::Deployed;
use hwasp_tasks::grasp::{GraspTaskSettings, ObjectSensed, TravelSensed, Viewpoint};
use hwasp_tasks::hand::HandDescription;
use hwasp_workshop::design::hand_of;

use crate::error::DeployError;

pub use ports::{Sensed, Sensor};
pub use spool::Spool;

use ports::{Actuator, actuators, sensors};

/// The most numbers that a controller may see here: those of a step are logged in one piece.
pub const MOST_SEEN: usize = 16;
/// The most that it may command.
pub const MOST_COMMANDED: usize = 8;

/// What a run says of its bench; runs that say nothing have the paper's.
#[derive(Clone, Debug, PartialEq)]
pub struct Training {
    /// Whether the motor's travel is what the encoder says, and not the sum of what was commanded.
    pub encoder: bool,
    /// The motor's torque from which on a carried object counts as held, N·m.
    pub felt: f64,
    /// How fast the palm was at most, m/s, where training had a limit.
    pub palm_speed: Option<f64>,
    /// Whether the object is seen from the palm.
    pub from_palm: bool,
    /// The palm's height above the object's top at the start, from and to, m.
    pub height: [f64; 2],
    /// Edges of objects, from and to, m.
    pub size: [f64; 2],
    /// Where objects stood, ± m.
    pub offset: f64,
}

/// The torque at which an object counts as held where a run does not say: between that of closing freely and that of a grasp.
const FELT: f64 = 0.55;

impl Training {
    /// What the experiment of a run says.
    ///
    /// # Errors
    /// [`DeployError::NoHand`] where it is of another problem.
    pub fn of(spec: &Experiment) -> Result<Self, DeployError> {
        let no_hand = || DeployError::NoHand { problem: spec.task.name().to_owned() };
        let settings = spec.task.settings::<GraspTaskSettings>().ok_or_else(no_hand)?;
        let bench = &settings.bench;
        Ok(Self {
            encoder: bench.travel_sensed != TravelSensed::Commanded,
            felt: if bench.object_sensed == ObjectSensed::Tracked { FELT } else { bench.grasp_felt },
            palm_speed: bench.palm_speed,
            from_palm: settings.viewpoint == Viewpoint::Palm,
            height: settings.height,
            size: settings.size,
            offset: settings.offset,
        })
    }
}

/// The hand of a run.
///
/// # Errors
/// [`DeployError::NoHand`] where it has none.
pub fn hand(spec: &Experiment) -> Result<&HandDescription, DeployError> {
    hand_of(spec).ok_or_else(|| DeployError::NoHand { problem: spec.task.name().to_owned() })
}

/// The deterministic controller on the design as built. A step allocates nothing.
pub struct Controller<'d> {
    actor: Actor<'d>,
    normalizer: Normalizer,
    sensors: Vec<Sensor>,
    actuators: Vec<Actuator>,
    limits: Vec<(f64, f64)>,
    from_palm: bool,
    observation: Vec<f64>,
    input: Vec<f32>,
    state: Vec<f64>,
    command: Vec<f64>,
}

impl<'d> Controller<'d> {
    /// That of a run.
    ///
    /// # Errors
    /// Where it sees or commands what the bench does not have.
    pub fn new(deployed: &'d Deployed, training: &Training) -> Result<Self, DeployError> {
        let env = deployed.env();
        let (sensors, actuators) = (sensors(env)?, actuators(env)?);
        Ok(Self {
            actor: Actor::new(deployed.policy(), deployed.params(), 1.0, 1),
            normalizer: deployed.normalizer(),
            observation: vec![0.0; sensors.len()],
            input: vec![0.0; sensors.len()],
            // What only the law reads; commands do not depend on it.
            state: vec![0.0; env.state.len()],
            command: vec![0.0; actuators.len()],
            limits: env.command.iter().map(|port| (port.lo, port.hi)).collect(),
            from_palm: training.from_palm,
            sensors,
            actuators,
        })
    }

    /// Acts on what is sensed. What it says is in [`command`](Self::command), within the motors' limits; a number that is none
    /// stays none, for whoever looks at it before it is obeyed.
    pub fn act(&mut self, sensed: &Sensed) {
        for (seen, sensor) in self.observation.iter_mut().zip(&self.sensors) {
            *seen = sensor.read(sensed, self.from_palm);
        }
        self.normalizer.apply(&self.observation, &mut self.input);
        self.actor.act(&self.input, &self.state, 1, None);
        for ((command, &said), &(lo, hi)) in self.command.iter_mut().zip(self.actor.action(0)).zip(&self.limits) {
            *command = if said.is_finite() { said.clamp(lo, hi) } else { f64::NAN };
        }
    }

    /// What it saw last, SI.
    pub fn observation(&self) -> &[f64] {
        &self.observation
    }

    /// What it commanded last, SI, by port.
    pub fn command(&self) -> &[f64] {
        &self.command
    }

    /// The same as motion of palm and spool, m.
    pub fn motion(&self) -> ([f64; 3], f64) {
        let (mut palm, mut motor) = ([0.0; 3], 0.0);
        for (actuator, &command) in self.actuators.iter().zip(&self.command) {
            match actuator {
                Actuator::Palm(axis) => palm[*axis] = command,
                Actuator::Motor => motor = command,
            }
        }
        (palm, motor)
    }

    /// Whether the palm moves along all axes, and not only up and down.
    pub fn spatial(&self) -> bool {
        self.actuators.iter().any(|actuator| matches!(actuator, Actuator::Palm(0 | 1)))
    }
}
