//! What the driver asks the controller to tell, and what it makes of it.

use super::field::FieldType;
use super::registers as r;
use super::wire::{Body, WireError};
use crate::arm::{ArmMode, Pose, Safety};

/// One packet of the controller.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// The controller's clock, s.
    pub clock: f64,
    /// Joints, rad.
    pub joints: [f64; 6],
    /// The tool in the base.
    pub tool: Pose,
    /// m/s.
    pub tool_speed: [f64; 3],
    /// As the controller counts them: 7 runs, 5 is idle.
    pub robot_mode: i32,
    /// 1 is normal, 3 a protective stop.
    pub safety_mode: i32,
    /// 2 plays.
    pub runtime_state: u32,
    /// What the program does.
    pub doing: i32,
    /// The number of the command that it has taken.
    pub taken: i32,
    /// The last value of the heart that it has seen.
    pub heard: i32,
    /// The version of the program.
    pub program: i32,
    /// The tool's point from the flange, where the controller tells it.
    pub tcp: Option<Pose>,
    /// kg, where the controller tells it.
    pub payload: Option<f64>,
}

/// Names and types of the packet, in its order; `full` asks for what older controllers do not know (payload: 3.11 and 5.5).
pub(super) fn recipe(full: bool) -> Vec<(String, FieldType)> {
    let mut recipe: Vec<(String, FieldType)> = [
        ("timestamp", FieldType::Double),
        ("actual_q", FieldType::Vector6),
        ("actual_TCP_pose", FieldType::Vector6),
        ("actual_TCP_speed", FieldType::Vector6),
        ("robot_mode", FieldType::Int32),
        ("safety_mode", FieldType::Int32),
        ("runtime_state", FieldType::Uint32),
    ]
    .map(|(name, kind)| (name.to_owned(), kind))
    .to_vec();
    for register in [r::DOING, r::TAKEN, r::HEARD, r::PROGRAM] {
        recipe.push((format!("output_int_register_{register}"), FieldType::Int32));
    }
    if full {
        recipe.push(("tcp_offset".to_owned(), FieldType::Vector6));
        recipe.push(("payload".to_owned(), FieldType::Double));
    }
    recipe
}

impl Reading {
    /// Of a packet of [`recipe`].
    pub(super) fn decode(mut body: Body<'_>, full: bool) -> Result<Self, WireError> {
        let reading = Self {
            clock: body.f64()?,
            joints: body.reals()?,
            tool: pose(body.reals()?),
            tool_speed: {
                let [x, y, z, ..] = body.reals::<6>()?;
                [x, y, z]
            },
            robot_mode: body.i32()?,
            safety_mode: body.i32()?,
            runtime_state: body.u32()?,
            doing: body.i32()?,
            taken: body.i32()?,
            heard: body.i32()?,
            program: body.i32()?,
            tcp: if full { Some(pose(body.reals()?)) } else { None },
            payload: if full { Some(body.f64()?) } else { None },
        };
        body.end()?;
        Ok(reading)
    }

    /// A value that is no number, by its name.
    pub fn nonsense(&self) -> Option<(&'static str, f64)> {
        let named = [
            ("timestamp", &[self.clock][..]),
            ("actual_q", &self.joints),
            ("actual_TCP_pose", &self.tool.position),
            ("actual_TCP_pose", &self.tool.rotation),
            ("actual_TCP_speed", &self.tool_speed),
        ];
        named.into_iter().find_map(|(name, values)| Some((name, *values.iter().find(|value| !value.is_finite())?)))
    }

    /// Whether it could move.
    pub fn mode(&self) -> ArmMode {
        match self.robot_mode {
            7 => ArmMode::Running,
            5 => ArmMode::Idle,
            _ => ArmMode::Off,
        }
    }

    /// What its safety says. 4 is recovery, 5 a safeguard, 8 a violation, 9 a fault, and newer controllers know more.
    pub fn safety(&self) -> Safety {
        match self.safety_mode {
            1 => Safety::Normal,
            2 => Safety::Reduced,
            3 => Safety::ProtectiveStop,
            6 | 7 => Safety::EmergencyStop,
            _ => Safety::Stopped,
        }
    }

    /// Whether a program plays, ours or another.
    pub fn plays(&self) -> bool {
        self.runtime_state == 2
    }
}

fn pose([x, y, z, a, b, c]: [f64; 6]) -> Pose {
    Pose { position: [x, y, z], rotation: [a, b, c] }
}
