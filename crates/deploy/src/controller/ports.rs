//! The names of what is seen and commanded.

use hwasp_core::EnvSpec;

use super::{MOST_COMMANDED, MOST_SEEN};
use crate::error::DeployError;

/// What the bench senses in a step; the task's world, SI.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensed {
    /// Where the palm is.
    pub palm: [f64; 3],
    /// Where the object's centre is taken to be.
    pub object: [f64; 3],
    /// Its bounding box.
    pub size: [f64; 3],
    /// What the motor has wound.
    pub travel: f64,
    /// The motor's torque.
    pub torque: f64,
    /// What the motor is to have wound.
    pub travel_target: f64,
}

/// A number of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sensor {
    /// Of the palm's place.
    Palm(usize),
    /// Of the object's.
    Object(usize),
    /// Of its bounding box.
    Size(usize),
    /// What is wound.
    Travel,
    /// The motor's torque.
    Torque,
    /// What is to be wound.
    TravelTarget,
}

impl Sensor {
    /// Its value; the object from the palm where the controller was trained so.
    pub fn read(self, sensed: &Sensed, from_palm: bool) -> f64 {
        match self {
            Self::Palm(axis) => sensed.palm[axis],
            Self::Object(axis) if from_palm => sensed.object[axis] - sensed.palm[axis],
            Self::Object(axis) => sensed.object[axis],
            Self::Size(axis) => sensed.size[axis],
            Self::Travel => sensed.travel,
            Self::Torque => sensed.torque,
            Self::TravelTarget => sensed.travel_target,
        }
    }

    fn named(name: &str) -> Option<Self> {
        let axis = |begin: &str| ["x", "y", "z"].iter().position(|axis| name.strip_prefix(begin) == Some(axis));
        match name {
            "motor_travel" => Some(Self::Travel),
            "motor_torque" => Some(Self::Torque),
            "motor_travel_target" => Some(Self::TravelTarget),
            _ => axis("palm_")
                .map(Self::Palm)
                .or_else(|| axis("object_").map(Self::Object))
                .or_else(|| axis("size_").map(Self::Size)),
        }
    }
}

/// What a command moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Actuator {
    /// The palm along an axis.
    Palm(usize),
    /// The spool.
    Motor,
}

pub(super) fn sensors(env: &EnvSpec) -> Result<Vec<Sensor>, DeployError> {
    let unknown = |name: &str| DeployError::Sensor { name: name.to_owned() };
    if let Some(port) = env.observation.get(MOST_SEEN) {
        return Err(unknown(&port.name));
    }
    env.observation.iter().map(|port| Sensor::named(&port.name).ok_or_else(|| unknown(&port.name))).collect()
}

pub(super) fn actuators(env: &EnvSpec) -> Result<Vec<Actuator>, DeployError> {
    let unknown = |name: &str| DeployError::Actuator { name: name.to_owned() };
    if let Some(port) = env.command.get(MOST_COMMANDED) {
        return Err(unknown(&port.name));
    }
    let named = |name: &str| match name {
        "motor" => Some(Actuator::Motor),
        "palm_x" => Some(Actuator::Palm(0)),
        "palm_y" => Some(Actuator::Palm(1)),
        "palm_z" => Some(Actuator::Palm(2)),
        _ => None,
    };
    env.command.iter().map(|port| named(&port.name).ok_or_else(|| unknown(&port.name))).collect()
}
