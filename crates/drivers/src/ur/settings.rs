//! What has to be known of an arm before anything speaks to it.

use std::time::Duration;

use crate::arm::Pose;
use crate::error::DriverError;

/// Where targets may be, and how they may be reached.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseLimits {
    /// The lowest corner of the box in which the tool's position has to stay, m, in the arm's base.
    pub lowest: [f64; 3],
    /// Its highest corner, m.
    pub highest: [f64; 3],
    /// How far from the tool a target to follow may be, m.
    pub leap: f64,
    /// How far it may be turned from the tool, rad.
    pub turn: f64,
    /// The fastest straight move, m/s.
    pub speed: f64,
}

impl Default for PoseLimits {
    /// A box around a UR5's reach of 0.85 m, above its base's plane; 50 mm, 0.35 rad; 0.1 m/s.
    fn default() -> Self {
        Self { lowest: [-0.85, -0.85, 0.0], highest: [0.85, 0.85, 0.95], leap: 0.05, turn: 0.35, speed: 0.1 }
    }
}

/// What hangs at the flange.
#[derive(Clone, Debug, PartialEq)]
pub struct Payload {
    /// kg.
    pub mass: f64,
    /// Its centre, m, from the flange.
    pub center: [f64; 3],
}

/// An arm of Universal Robots, CB3 or e-Series, and how it is driven.
#[derive(Clone, Debug, PartialEq)]
pub struct UrSettings {
    /// Name or address of the controller.
    pub host: String,
    /// Of RTDE: 30004.
    pub rtde_port: u16,
    /// Of the dashboard: 29999.
    pub dashboard_port: u16,
    /// To which programs are sent: 30002.
    pub script_port: u16,
    /// States a second: at most 125 from a CB3, 500 from an e-Series.
    pub frequency: f64,
    /// How long the controller may take to connect and to answer.
    pub answer: Duration,
    /// A state older than this is none.
    pub oldest: Duration,
    /// The program stops the arm when nothing was told to it for this long.
    pub watchdog: Duration,
    /// A pose that stays the same to the last bit for this long, while its target is elsewhere, is stuck.
    pub stuck: Duration,
    /// Of `servoj`: s by which it looks ahead to smooth, 0.03 to 0.2.
    pub lookahead: f64,
    /// Of `servoj`: 100 to 2000.
    pub gain: f64,
    /// Of a straight move, m/s², and of its stop.
    pub acceleration: f64,
    /// Of the joints when they stop following, rad/s².
    pub deceleration: f64,
    /// The tool's point, from the flange; without it the controller keeps its own.
    pub tcp: Option<Pose>,
    /// Without it the controller keeps its own.
    pub payload: Option<Payload>,
    /// For targets.
    pub limits: PoseLimits,
}

impl UrSettings {
    /// The vendor's ports and cautious motion.
    pub fn new(host: &str) -> Self {
        Self {
            host: host.to_owned(),
            rtde_port: 30004,
            dashboard_port: 29999,
            script_port: 30002,
            frequency: 125.0,
            answer: Duration::from_secs(2),
            oldest: Duration::from_millis(40),
            watchdog: Duration::from_millis(100),
            stuck: Duration::from_millis(200),
            lookahead: 0.05,
            gain: 300.0,
            acceleration: 0.5,
            deceleration: 10.0,
            tcp: None,
            payload: None,
            limits: PoseLimits::default(),
        }
    }

    /// The arm's name in messages.
    pub(crate) fn device(&self) -> String {
        format!("arm {}", self.host)
    }

    /// Everything is within what controller and program take.
    pub fn check(&self) -> Result<(), DriverError> {
        let number = |name: &'static str, value: f64, lowest: f64, highest: f64| {
            if value >= lowest && value <= highest {
                Ok(())
            } else {
                Err(self.bad(name, value, format!("{lowest} to {highest}")))
            }
        };
        number("frequency", self.frequency, 1.0, 500.0)?;
        number("answer", self.answer.as_secs_f64(), 0.05, 60.0)?;
        number("oldest", self.oldest.as_secs_f64(), 1.0 / self.frequency, 1.0)?;
        number("watchdog", self.watchdog.as_secs_f64(), 0.02, 1.0)?;
        number("stuck", self.stuck.as_secs_f64(), 0.02, 10.0)?;
        number("lookahead", self.lookahead, 0.03, 0.2)?;
        number("gain", self.gain, 100.0, 2000.0)?;
        number("acceleration", self.acceleration, 0.05, 3.0)?;
        number("deceleration", self.deceleration, 0.5, 40.0)?;
        number("leap", self.limits.leap, 1e-4, 0.5)?;
        number("turn", self.limits.turn, 1e-3, std::f64::consts::PI)?;
        number("speed", self.limits.speed, 1e-3, 1.0)?;
        for axis in 0..3 {
            number("lowest", self.limits.lowest[axis], -2.0, 2.0)?;
            number("highest", self.limits.highest[axis], self.limits.lowest[axis], 2.0)?;
        }
        for value in self.tcp.iter().flat_map(|tcp| tcp.position) {
            number("tcp position", value, -1.0, 1.0)?;
        }
        for value in self.tcp.iter().flat_map(|tcp| tcp.rotation) {
            number("tcp rotation", value, -7.0, 7.0)?;
        }
        if let Some(payload) = &self.payload {
            number("payload mass", payload.mass, 0.0, 40.0)?;
            for value in payload.center {
                number("payload center", value, -0.5, 0.5)?;
            }
        }
        Ok(())
    }

    /// A straight move at this speed is allowed.
    pub(crate) fn check_speed(&self, speed: f64) -> Result<(), DriverError> {
        if speed >= 1e-3 && speed <= self.limits.speed {
            return Ok(());
        }
        Err(self.bad("speed", speed, format!("0.001 to {} m/s", self.limits.speed)))
    }

    /// A target is a number, and within the box.
    pub(crate) fn check_target(&self, target: &Pose) -> Result<(), DriverError> {
        const POSITION: [&str; 3] = ["target x", "target y", "target z"];
        const ROTATION: [&str; 3] = ["target rx", "target ry", "target rz"];
        for axis in 0..3 {
            let (value, lowest, highest) = (target.position[axis], self.limits.lowest[axis], self.limits.highest[axis]);
            if !(value >= lowest && value <= highest) {
                return Err(self.bad(
                    POSITION[axis],
                    value,
                    format!("{lowest} to {highest} m: the workspace of the limits"),
                ));
            }
            let value = target.rotation[axis];
            if !value.is_finite() || value.abs() > 7.0 {
                return Err(self.bad(ROTATION[axis], value, "-7 to 7 rad".to_owned()));
            }
        }
        Ok(())
    }

    /// A target to follow is near enough to where the tool is.
    pub(crate) fn check_leap(&self, target: &Pose, tool: &Pose) -> Result<(), DriverError> {
        let (away, turned) = (target.distance(tool), target.turn(tool));
        if away > self.limits.leap {
            return Err(self.bad("distance of the target from the tool", away, format!("0 to {} m", self.limits.leap)));
        }
        if turned > self.limits.turn {
            return Err(self.bad("turn of the target from the tool", turned, format!("0 to {} rad", self.limits.turn)));
        }
        Ok(())
    }

    fn bad(&self, name: &'static str, value: f64, limits: String) -> DriverError {
        DriverError::Value { device: self.device(), name, value, limits }
    }
}
