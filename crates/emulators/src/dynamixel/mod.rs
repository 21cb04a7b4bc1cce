//! A Dynamixel XM430-W210 that is not there: it speaks protocol 2.0 at the end of a serial line, and turns a spool.
//!
//! It follows ROBOTIS' descriptions of the protocol and of the motor (emanual.robotis.com), and knows nothing of the driver.
//! Mode 5, current-based position, is exact in what it asks of the spool; modes 0, 1, 3, 4 and 16 are there, with rough
//! dynamics. Profiles are those by velocity. A factory reset is refused. Where the description leaves something open, the
//! emulator does what is worse for a driver: goals stay when torque goes on, and torque that an error keeps off is told by
//! the alert bit alone.
//!
//! # Faults
//! | text | what happens |
//! |---|---|
//! | `drop SHARE` | this share of the answers is lost |
//! | `wrong-crc SHARE` | this share of the answers has a wrong checksum |
//! | `noise SHARE` | this share of the answers comes among bytes that mean nothing |
//! | `delay MS` | answers come later by so much |
//! | `stuck REGISTER` | the register, say `present-position`, reads from now on what it reads now |
//! | `over-current A` | the current reads so much, whatever it is |
//! | `heat C` | so warm; beyond the limit of 80 °C it shuts down |
//! | `voltage V` | so much; beyond 9.5 to 16 V a hardware error shows |
//! | `overload`, `shock`, `encoder` | the hardware error of this name; the first two shut down |
//! | `silent` | it hears and answers nothing |
//! | `restart` | power fails for a moment: registers and count of turns are lost, torque is off |
//! | `cut` | the serial port is gone, for good |
//! | `clear` | all but `cut` and hardware errors end; the latter end by a reboot |

mod device;
mod faults;
mod frame;
mod instructions;
mod line;
mod memory;
mod profile;
mod pty;
mod table;

use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use thiserror::Error;

use crate::world::{SpoolDrive, SpoolState};
use device::Device;
use faults::Order;
pub(crate) use faults::check_fault;
use line::Line;
use pty::Pty;

/// Why there is no emulator.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DynamixelError {
    /// No such motor.
    #[error("id = {0} is not 0 to 252")]
    Id(u8),
    /// No such speed.
    #[error("baud = {0} is not one of 9600, 57600, 115200, 1000000, 2000000, 3000000, 4000000 and 4500000")]
    Baud(u32),
    /// The system gives no pseudo-terminal.
    #[error("no pseudo-terminal: {0}")]
    Pty(#[from] io::Error),
}

/// A motor at the end of a serial line. Whoever has it moves it on, in real time or not; a thread of its own answers.
#[derive(Debug)]
pub struct DynamixelEmulator {
    device: Arc<Mutex<Device>>,
    path: PathBuf,
    line: Option<Line>,
}

impl DynamixelEmulator {
    /// A motor with this identity that listens at this speed, and is otherwise as it leaves the factory.
    ///
    /// # Errors
    /// Where there is no such motor, or no pseudo-terminal.
    pub fn start(id: u8, baud: u32) -> Result<Self, DynamixelError> {
        if id > 252 {
            return Err(DynamixelError::Id(id));
        }
        let number = table::BAUD_RATES.iter().position(|&rate| rate == baud).ok_or(DynamixelError::Baud(baud))?;
        let pty = Pty::open()?;
        let path = pty.path().to_owned();
        let device = Arc::new(Mutex::new(Device::new(id, number as u8)));
        let line = Line::start(pty, Arc::clone(&device))?;
        Ok(Self { device, path, line: Some(line) })
    }

    /// The serial port.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its identity and its speed, bits per second, as they are now.
    pub fn identity(&self) -> (u8, u32) {
        let device = self.device();
        let baud = table::BAUD_RATES[device.memory.get(&table::BAUD_RATE) as usize % table::BAUD_RATES.len()];
        (device.memory.get(&table::ID) as u8, baud)
    }

    /// What the motor does to the spool now.
    pub fn drive(&self) -> SpoolDrive {
        self.device().drive()
    }

    /// What the spool does to the motor.
    pub fn tell(&self, spool: SpoolState) {
        self.device().tell(spool);
    }

    /// Goes on by `dt`, s; 1 ms as a rule.
    pub fn advance(&self, dt: f64) {
        self.device().advance(dt);
    }

    /// Lets something go wrong, by a line of [the table](self).
    ///
    /// # Errors
    /// What is wrong with the text.
    pub fn inject(&mut self, text: &str) -> Result<(), String> {
        let order = self.device().inject(text)?;
        if order == Order::Cut {
            self.line = None;
        }
        Ok(())
    }

    fn device(&self) -> MutexGuard<'_, Device> {
        lock(&self.device)
    }
}

/// A motor whose thread died is as it was: nothing of it is half done.
fn lock(device: &Mutex<Device>) -> MutexGuard<'_, Device> {
    device.lock().unwrap_or_else(PoisonError::into_inner)
}
