//! The serial line: one question, one answer.

use std::io;
use std::path::Path;
use std::time::{Duration, Instant};

use serial2::SerialPort;
use std::fs::File;

use super::registers::{Register, value};
use super::settings::DynamixelSettings;
use super::wire::{self, Found, Status};
use super::words::{error_words, hardware_error_words};
use crate::error::DriverError;

const PING: u8 = 0x01;
const READ: u8 = 0x02;
const WRITE: u8 = 0x03;
const REBOOT: u8 = 0x08;
/// The alert bit of an answer's error.
const ALERT: u8 = 0x80;
/// More than comes before an answer, unless nothing makes sense.
const MOST_BYTES: usize = 4096;

/// For how long a port that is taken is asked again.
const LETS_GO: Duration = Duration::from_millis(300);

fn name(settings: &DynamixelSettings) -> String {
    format!("Dynamixel {} at {}", settings.id, settings.port.display())
}

fn failed(settings: &DynamixelSettings, cause: String) -> DriverError {
    DriverError::Line { device: name(settings), what: "opening the port", cause }
}

/// A line to one motor.
#[derive(Debug)]
pub(super) struct Line {
    port: SerialPort,
    /// The port is this program's as long as this is open: another one would take answers away, or free the motor.
    lock: File,
    id: u8,
    /// For how long to wait.
    patience: Duration,
    /// What messages call it.
    name: String,
    bytes: Vec<u8>,
}

impl Line {
    /// Opens the port, where no other program has it.
    pub(super) fn open(settings: &DynamixelSettings) -> Result<Self, DriverError> {
        let port = &settings.port;
        let lock = File::open(port).map_err(|error| failed(settings, with_way_out(&error, port)))?;
        let begin = Instant::now();
        while lock.try_lock().is_err() {
            // One that has just let go may have a child that has yet to close what it inherited.
            if begin.elapsed() > LETS_GO {
                return Err(failed(settings, "another program drives this motor; end that one first".to_owned()));
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        Self::with(settings, lock)
    }

    /// The same port at another speed.
    pub(super) fn reopened(&self, settings: &DynamixelSettings) -> Result<Self, DriverError> {
        let lock = self.lock.try_clone().map_err(|error| failed(settings, error.to_string()))?;
        Self::with(settings, lock)
    }

    fn with(settings: &DynamixelSettings, lock: File) -> Result<Self, DriverError> {
        let DynamixelSettings { port, id, baud, reply, .. } = settings;
        let opened = SerialPort::open(port, *baud).and_then(|mut serial| {
            serial.set_write_timeout(*reply)?;
            Ok(serial)
        });
        let serial = opened.map_err(|error| failed(settings, with_way_out(&error, port)))?;
        Ok(Self { port: serial, lock, id: *id, patience: *reply, name: name(settings), bytes: Vec::new() })
    }

    /// What messages call the motor.
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    /// Asks who is there: model and firmware.
    pub(super) fn ping(&mut self) -> Result<[u8; 3], DriverError> {
        let answer = self.ask("ping", PING, &[], 3)?;
        answer.data.try_into().map_err(|_| self.protocol("ping", "the answer is too short"))
    }

    /// Reads so many bytes from an address on.
    pub(super) fn read(&mut self, what: &'static str, at: u16, count: u16) -> Result<Vec<u8>, DriverError> {
        let parameters: Vec<u8> = [at, count].into_iter().flat_map(u16::to_le_bytes).collect();
        let answer = self.ask(what, READ, &parameters, usize::from(count))?;
        Ok(answer.data)
    }

    /// Reads a register.
    pub(super) fn get(&mut self, what: &'static str, register: Register) -> Result<i32, DriverError> {
        let bytes = self.read(what, register.at, register.size)?;
        value(&bytes).ok_or_else(|| self.protocol(what, "the answer is too short"))
    }

    /// Writes bytes from an address on. Returns whether the motor has a hardware error.
    pub(super) fn write(&mut self, what: &'static str, at: u16, bytes: &[u8]) -> Result<bool, DriverError> {
        let parameters = [&at.to_le_bytes(), bytes].concat();
        Ok(self.ask(what, WRITE, &parameters, 0)?.error & ALERT != 0)
    }

    /// Writes a register.
    pub(super) fn set(&mut self, what: &'static str, register: Register, value: i32) -> Result<bool, DriverError> {
        self.write(what, register.at, &value.to_le_bytes()[..usize::from(register.size)])
    }

    /// Lets the motor start anew.
    pub(super) fn reboot(&mut self) -> Result<(), DriverError> {
        self.ask("reboot", REBOOT, &[], 0).map(drop)
    }

    /// An error for an answer that makes no sense.
    pub(super) fn protocol(&self, what: &'static str, cause: impl Into<String>) -> DriverError {
        DriverError::Protocol { device: self.name.clone(), what, cause: cause.into() }
    }

    /// An error for something that the motor does not want.
    pub(super) fn refused(&self, what: &'static str, cause: impl Into<String>) -> DriverError {
        DriverError::Refused { device: self.name.clone(), what, cause: cause.into() }
    }

    /// The refusal of a motor with these hardware errors.
    pub(super) fn failed(&self, what: &'static str, bits: u8) -> DriverError {
        let words = hardware_error_words(bits);
        self.refused(what, format!("hardware error {bits:#04x}: {words}. Find out why, then reboot it"))
    }

    /// Sends an instruction and waits for the answer that has `expected` bytes, or an error. Answers of other lengths are
    /// late ones, to questions that were given up.
    fn ask(
        &mut self,
        what: &'static str,
        instruction: u8,
        parameters: &[u8],
        expected: usize,
    ) -> Result<Status, DriverError> {
        let device = self.name.clone();
        let line = |error: io::Error| {
            if error.kind() == io::ErrorKind::TimedOut {
                let cause = "the port takes no bytes".to_owned();
                return DriverError::Line { device: device.clone(), what, cause };
            }
            DriverError::Line { device: device.clone(), what, cause: error.to_string() }
        };
        self.port.discard_input_buffer().map_err(line)?;
        self.bytes.clear();
        self.port.write_all(&wire::instruction(self.id, instruction, parameters)).map_err(line)?;
        let asked = Instant::now();
        let mut chunk = [0; 256];
        loop {
            let Found { answers, broken } = wire::find(&self.bytes);
            let ours = answers.into_iter().find(|answer| {
                let refused = answer.error & !ALERT != 0 && answer.data.is_empty();
                answer.id == self.id && (refused || answer.data.len() == expected)
            });
            if let Some(answer) = ours {
                return match answer.error & !ALERT {
                    0 => Ok(answer),
                    number => Err(self.refused(what, error_words(number))),
                };
            }
            let left = self.patience.saturating_sub(asked.elapsed());
            if left.is_zero() {
                return Err(if broken {
                    self.protocol(what, "the answer has a wrong checksum")
                } else {
                    DriverError::Timeout { device: self.name.clone(), what, waited: self.patience }
                });
            }
            if self.bytes.len() > MOST_BYTES {
                return Err(self.protocol(what, "many bytes come, and no answer among them"));
            }
            // The port counts in ms, and takes less than one for none.
            self.port.set_read_timeout(left.max(Duration::from_millis(1))).map_err(line)?;
            match self.port.read(&mut chunk) {
                Ok(0) => return Err(line(io::Error::other("the port is gone"))),
                Ok(count) => self.bytes.extend(&chunk[..count]),
                Err(error) if matches!(error.kind(), io::ErrorKind::TimedOut | io::ErrorKind::Interrupted) => {}
                Err(error) => return Err(line(error)),
            }
        }
    }
}

fn with_way_out(error: &io::Error, port: &Path) -> String {
    let hint = match error.kind() {
        io::ErrorKind::NotFound => "plug the adapter in, and see `ls /dev/serial/by-id`",
        io::ErrorKind::PermissionDenied => "join the group that owns the port, as a rule `dialout`",
        _ => return error.to_string(),
    };
    format!("{error} ({}); {hint}", port.display())
}
