//! What a bench is made of, as text.

use std::net::{IpAddr, Ipv4Addr};

use hwasp_drivers::Pose;
use hwasp_grasp::GraspSettings;
use hwasp_tasks::hand::DESIGN_LEN;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::{Bench, BenchWorld};
use crate::dynamixel::{DynamixelEmulator, DynamixelError};
use crate::hand::{Carry, HandWorld, HandWorldError, HandWorldSettings, Planted};
use crate::ur::{Generation, PortError, Ports, UrEmulator, UrEmulatorSettings};
use crate::world::FreeSpool;

/// Why there is no bench.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum BenchError {
    /// The text is none of a bench.
    #[error("no settings of a bench: {0}")]
    Text(#[from] serde_json::Error),
    /// No such arm.
    #[error("arm = {0:?} is neither \"cb3\" nor \"e-series\"")]
    Arm(String),
    /// The arm's ports are taken.
    #[error(transparent)]
    Ports(#[from] PortError),
    /// No such motor.
    #[error(transparent)]
    Motor(#[from] DynamixelError),
    /// No such hand.
    #[error(transparent)]
    Hand(#[from] HandWorldError),
}

/// A bench, as JSON has it.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
pub struct BenchSettings {
    /// `cb3`, `e-series`, or nothing.
    pub arm: Option<String>,
    /// Whether the arm listens at the vendor's ports; otherwise at any that are free.
    pub vendor_ports: bool,
    /// The motor's identity.
    pub id: u8,
    /// The motor's speed, bits per second.
    pub baud: u32,
    /// The hand, or nothing on the spool.
    pub hand: Option<HandSettings>,
}

impl Default for BenchSettings {
    fn default() -> Self {
        Self { arm: None, vendor_ports: false, id: 1, baud: 1_000_000, hand: None }
    }
}

/// A hand and how it is mounted, as JSON has it. What a field means: [`HandWorldSettings`] and [`Planted`].
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs, reason = "the fields are those of the types that the line above names")]
pub struct HandSettings {
    pub design: [f64; DESIGN_LEN],
    /// The most the tendons pull together, N; as the description has it where there is none.
    pub tension_limit: Option<f64>,
    #[serde(default)]
    pub base_position: [f64; 3],
    #[serde(default)]
    pub base_rotation: [f64; 3],
    #[serde(default)]
    pub palm: [f64; 3],
    #[serde(default)]
    pub compliant: bool,
    #[serde(default = "one")]
    pub torque_gain: f64,
    pub tendon_stiffness: Option<f64>,
    #[serde(default)]
    pub friction: f64,
    #[serde(default)]
    pub slack: f64,
    #[serde(default)]
    pub delay: f64,
    #[serde(default)]
    pub zero: f64,
}

fn one() -> f64 {
    1.0
}

impl HandSettings {
    /// The world that it describes, with the objects of the paper.
    pub fn world(&self) -> HandWorldSettings {
        let mut grasp = GraspSettings::default();
        if let Some(limit) = self.tension_limit {
            grasp.hand.transmission.tension_limit = limit;
        }
        let &Self { torque_gain, tendon_stiffness, friction, slack, delay, zero, .. } = self;
        HandWorldSettings {
            grasp,
            design: self.design,
            base: Pose { position: self.base_position, rotation: self.base_rotation },
            palm: self.palm,
            carry: if self.compliant { Carry::Compliant } else { Carry::Stiff },
            planted: Planted { torque_gain, tendon_stiffness, friction, slack, delay, zero },
        }
    }
}

impl BenchSettings {
    /// Reads them.
    ///
    /// # Errors
    /// Where the text is none.
    pub fn from_json(text: &str) -> Result<Self, BenchError> {
        Ok(serde_json::from_str(text)?)
    }

    /// Starts the emulators.
    ///
    /// # Errors
    /// Where one of them cannot be.
    pub fn start(&self) -> Result<Bench, BenchError> {
        let generation = match self.arm.as_deref() {
            None => None,
            Some("cb3") => Some(Generation::Cb3),
            Some("e-series") => Some(Generation::ESeries),
            Some(other) => return Err(BenchError::Arm(other.into())),
        };
        let ports = if self.vendor_ports { Ports::VENDOR } else { Ports::ANY };
        let address = IpAddr::V4(Ipv4Addr::LOCALHOST);
        let arm = generation
            .map(|generation| {
                UrEmulator::start(&UrEmulatorSettings { address, ports, ..UrEmulatorSettings::new(generation) })
            })
            .transpose()?;
        let motor = DynamixelEmulator::start(self.id, self.baud)?;
        let world = match &self.hand {
            None => BenchWorld::Free(FreeSpool::default()),
            Some(hand) => BenchWorld::Hand(Box::new(HandWorld::new(hand.world())?)),
        };
        Ok(Bench::new(arm, motor, world))
    }
}
