//! A Dynamixel XM430-W210 by protocol 2.0, which goes to positions with a limited current (its mode 5).
//!
//! State and goal are one exchange each, through the motor's indirect registers. A motor that lost its power forgets what
//! these point to, and then reads no voltage: that is told as a restart, never as a position.

mod line;
mod motion;
mod registers;
mod settings;
mod wire;
mod words;

use std::thread;
use std::time::{Duration, Instant};

pub use settings::DynamixelSettings;
pub use words::hardware_error_words;

use crate::error::DriverError;
use crate::motor::Motor;
use line::Line;
use registers::{
    BAUD_RATE, BAUD_RATES, BUS_WATCHDOG, CURRENT_BASED_POSITION, CURRENT_LIMIT, DRIVE_MODE, OPERATING_MODE, POINTERS,
    PROFILE_ACCELERATION, PROFILE_VELOCITY, RETURN_DELAY, Register, SHUTDOWN, SHUTS_DOWN, STATUS_LEVEL, pointers,
};

/// The model number of an XM430-W210.
pub const XM430_W210: u16 = 1030;
/// How long a motor may take to start.
const STARTS_WITHIN: Duration = Duration::from_secs(2);

/// Who a motor says to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DynamixelIdentity {
    /// Its model number; [`XM430_W210`] is the one that this driver knows.
    pub model: u16,
    /// The version of its firmware.
    pub firmware: u8,
}

/// A setting in the motor that is not as it has to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Difference {
    /// The register.
    pub name: &'static str,
    /// What it has.
    pub found: i32,
    /// What it has to have.
    pub wanted: i32,
}

/// A motor at the end of a serial line.
#[derive(Debug)]
pub struct Dynamixel {
    line: Line,
    settings: DynamixelSettings,
    turn: u16,
    prepared: bool,
}

impl Dynamixel {
    /// Opens the port and asks who is there. Changes nothing in the motor.
    ///
    /// # Errors
    /// Settings that cannot be, a port that is not there, a motor that does not answer or is of another model.
    pub fn open(settings: DynamixelSettings) -> Result<Self, DriverError> {
        settings.check()?;
        let mut motor = Self { line: Line::open(&settings)?, settings, turn: 0, prepared: false };
        let model = motor.identify()?.model;
        if model == XM430_W210 {
            return Ok(motor);
        }
        let cause = format!("it is of model {model}, and this driver knows an XM430-W210, model {XM430_W210}");
        Err(motor.line.refused("opening", cause))
    }

    /// The speed at which the motor answers, if any, bits per second: for a motor whose speed was changed, or never.
    ///
    /// # Errors
    /// Where the port cannot be used.
    pub fn find_baud(settings: &DynamixelSettings) -> Result<Option<u32>, DriverError> {
        let free = Line::open(settings)?;
        for baud in BAUD_RATES {
            // Not every port has every speed.
            let Ok(mut line) = free.reopened(&DynamixelSettings { baud, ..settings.clone() }) else { continue };
            match line.ping() {
                Ok(_) => return Ok(Some(baud)),
                Err(DriverError::Line { device, what, cause }) => {
                    return Err(DriverError::Line { device, what, cause });
                }
                Err(_) => {}
            }
        }
        Ok(None)
    }

    /// What it was opened with.
    pub fn settings(&self) -> &DynamixelSettings {
        &self.settings
    }

    /// Asks who is there.
    ///
    /// # Errors
    /// Those of the line.
    pub fn identify(&mut self) -> Result<DynamixelIdentity, DriverError> {
        let [low, high, firmware] = self.line.ping()?;
        Ok(DynamixelIdentity { model: u16::from_le_bytes([low, high]), firmware })
    }

    /// Reads a register of one, two or four bytes that this driver knows nothing of; the longer ones have a sign.
    ///
    /// # Errors
    /// Those of the line, and a register that the motor does not have.
    pub fn register(&mut self, address: u16, bytes: u16) -> Result<i32, DriverError> {
        let register = self.sized("reading a register", address, bytes)?;
        self.line.get("reading a register", register)
    }

    /// Writes such a register. The motor itself has to refuse what it must not be told.
    ///
    /// # Errors
    /// Those of the line, and what the motor refuses.
    pub fn set_register(&mut self, address: u16, bytes: u16, value: i32) -> Result<(), DriverError> {
        let register = self.sized("writing a register", address, bytes)?;
        self.line.set("writing a register", register, value).map(drop)
    }

    fn sized(&self, what: &'static str, at: u16, size: u16) -> Result<Register, DriverError> {
        if matches!(size, 1 | 2 | 4) {
            return Ok(Register { at, size });
        }
        Err(self.line.refused(what, format!("{size} bytes are not 1, 2 or 4, as registers have")))
    }

    /// What the motor keeps without power and how it has to be: name, register, value.
    fn kept(&self) -> [(&'static str, Register, i32); 5] {
        [
            ("return delay", RETURN_DELAY, 0),
            ("drive mode", DRIVE_MODE, 0),
            ("operating mode", OPERATING_MODE, CURRENT_BASED_POSITION),
            ("current limit", CURRENT_LIMIT, self.settings.current_ticks()),
            ("shutdown", SHUTDOWN, SHUTS_DOWN),
        ]
    }

    /// What [`Self::prepare`] would change of what the motor keeps without power.
    ///
    /// # Errors
    /// Those of the line.
    pub fn differences(&mut self) -> Result<Vec<Difference>, DriverError> {
        let mut differences = Vec::new();
        for (name, register, wanted) in self.kept() {
            let found = self.line.get("reading its settings", register)?;
            if found != wanted {
                differences.push(Difference { name, found, wanted });
            }
        }
        Ok(differences)
    }

    /// Takes torque off and sets all that [`Motor`] needs. What the motor keeps is written only where it differs, and read
    /// again. Returns what was changed of it.
    ///
    /// # Errors
    /// Those of the line, and a motor that does not take what it is told.
    pub fn prepare(&mut self) -> Result<Vec<Difference>, DriverError> {
        self.torque(false)?;
        self.line.set("asking for answers", STATUS_LEVEL, 2)?;
        let changed = self.differences()?;
        for (name, register, wanted) in self.kept() {
            if changed.iter().any(|difference| difference.name == name) {
                self.line.set("writing its settings", register, wanted)?;
            }
        }
        if let Some(Difference { name, found, wanted }) = self.differences()?.first() {
            let cause = format!("{name} is {found} although it was set to {wanted}");
            return Err(self.line.refused("writing its settings", cause));
        }
        for register in [PROFILE_ACCELERATION, PROFILE_VELOCITY, BUS_WATCHDOG] {
            self.line.set("preparing", register, 0)?;
        }
        let wanted = pointers();
        self.line.write("preparing", POINTERS, &wanted)?;
        if self.line.read("preparing", POINTERS, wanted.len() as u16)? != wanted {
            return Err(self.line.refused("preparing", "its indirect registers do not keep what they are told"));
        }
        self.prepared = true;
        Ok(changed)
    }

    /// Sets the motor's speed, bits per second, which it keeps, and goes on at it.
    ///
    /// # Errors
    /// Those of the line and of the settings.
    pub fn set_baud(&mut self, baud: u32) -> Result<(), DriverError> {
        let settings = DynamixelSettings { baud, ..self.settings.clone() };
        settings.check()?;
        let number = BAUD_RATES.iter().position(|&rate| rate == baud).unwrap_or_default();
        self.torque(false)?;
        self.line.set("setting its speed", BAUD_RATE, number as i32)?;
        self.line = self.line.reopened(&settings)?;
        self.settings = settings;
        self.await_answer()
    }

    /// Lets the motor start anew, which ends hardware errors; torque is off and turns are forgotten then, and
    /// [`Self::prepare`] has to follow. Never done by itself: whoever calls it has looked at the motor.
    ///
    /// # Errors
    /// Those of the line, and a motor that does not come back within two seconds.
    pub fn reboot(&mut self) -> Result<(), DriverError> {
        self.line.reboot()?;
        self.prepared = false;
        self.await_answer()
    }

    fn await_answer(&mut self) -> Result<(), DriverError> {
        let since = Instant::now();
        loop {
            match self.line.ping() {
                Err(DriverError::Timeout { .. } | DriverError::Protocol { .. }) if since.elapsed() < STARTS_WITHIN => {
                    thread::sleep(Duration::from_millis(10));
                }
                answer => return answer.map(drop),
            }
        }
    }
}
