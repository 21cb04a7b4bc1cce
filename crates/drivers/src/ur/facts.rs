//! What the controller says of itself when it is asked.

use super::dashboard::Dashboard;
use super::drive::UrArm;
use crate::arm::Pose;
use crate::error::DriverError;

/// What [`UrArm::facts`] asks for.
#[derive(Clone, Debug, PartialEq)]
pub struct UrFacts {
    /// Major, minor, bugfix and build of the controller.
    pub controller: [u32; 4],
    /// Of its software, as the dashboard tells it.
    pub polyscope: String,
    /// Of the arm, where the controller tells it.
    pub serial_number: Option<String>,
    /// `RUNNING`, `IDLE` …
    pub robot_mode: String,
    /// `NORMAL`, `PROTECTIVE_STOP` …
    pub safety_mode: String,
    /// `STOPPED`, `PLAYING` … and the program's name.
    pub program_state: String,
    /// Whether programs from outside are accepted; `None` where there is no such switch (CB3).
    pub remote: Option<bool>,
    /// The tool's point from the flange that is active now, where the controller tells it.
    pub tcp: Option<Pose>,
    /// kg that are active now, where the controller tells it.
    pub payload: Option<f64>,
}

impl UrArm {
    /// Asks the dashboard, and the newest packet.
    pub fn facts(&mut self) -> Result<UrFacts, DriverError> {
        let reading = self.link.newest()?.1.reading;
        let mut dashboard = Dashboard::connect(&self.settings)?;
        Ok(UrFacts {
            controller: self.link.version,
            polyscope: dashboard.polyscope()?,
            serial_number: dashboard.serial_number()?,
            robot_mode: dashboard.robot_mode()?,
            safety_mode: dashboard.safety_mode()?,
            program_state: dashboard.program_state()?,
            remote: dashboard.remote()?,
            tcp: reading.tcp,
            payload: reading.payload,
        })
    }
}
