//! The dashboard of the controller: a line of text asks, a line answers.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::Instant;

use super::settings::UrSettings;
use super::tcp;
use crate::error::DriverError;

/// The longest answer that is read, bytes.
const LONGEST: usize = 4096;

/// A connection to the dashboard. It tells, and it stops; only a person unlocks.
#[derive(Debug)]
pub struct Dashboard {
    stream: TcpStream,
    settings: UrSettings,
    unread: Vec<u8>,
}

impl Dashboard {
    /// Connects and reads the greeting.
    pub fn connect(settings: &UrSettings) -> Result<Self, DriverError> {
        let stream = tcp::connect(settings, settings.dashboard_port, "connecting to the dashboard")?;
        let mut dashboard = Self { stream, settings: settings.clone(), unread: Vec::new() };
        let greeting = dashboard.line("greeting of the dashboard")?;
        if greeting.contains("Dashboard") {
            return Ok(dashboard);
        }
        Err(dashboard.odd("greeting of the dashboard", &greeting))
    }

    /// Version of the controller's software, for instance `URSoftware 3.15.8.106339`.
    pub fn polyscope(&mut self) -> Result<String, DriverError> {
        self.ask("PolyscopeVersion")
    }

    /// Mode of the robot: `RUNNING`, `IDLE`, `POWER_OFF` …
    pub fn robot_mode(&mut self) -> Result<String, DriverError> {
        self.named("robotmode", "Robotmode: ")
    }

    /// Mode of its safety: `NORMAL`, `PROTECTIVE_STOP` …
    pub fn safety_mode(&mut self) -> Result<String, DriverError> {
        self.named("safetymode", "Safetymode: ")
    }

    /// State of the program: `STOPPED`, `PLAYING`, `PAUSED`, and its name.
    pub fn program_state(&mut self) -> Result<String, DriverError> {
        self.ask("programState")
    }

    /// Serial number of the arm; `None` from a controller that does not know the question (before 3.12 and 5.6).
    pub fn serial_number(&mut self) -> Result<Option<String>, DriverError> {
        let answer = self.ask("get serial number")?;
        Ok((!answer.is_empty() && answer.bytes().all(|byte| byte.is_ascii_digit())).then_some(answer))
    }

    /// Whether programs from outside are accepted; `None` from a controller that knows no difference (CB3).
    pub fn remote(&mut self) -> Result<Option<bool>, DriverError> {
        Ok(match self.ask("is in remote control")?.as_str() {
            "true" => Some(true),
            "false" => Some(false),
            _ => None,
        })
    }

    /// Stops the program, whichever it is.
    pub fn stop(&mut self) -> Result<String, DriverError> {
        self.ask("stop")
    }

    /// Unlocks a protective stop. **Only a person who has looked at the arm may ask for this**; nothing here calls it. No program
    /// goes on by it: the arm follows again after [`super::UrArm::start`] alone.
    pub fn unlock_protective_stop(&mut self) -> Result<(), DriverError> {
        let answer = self.ask("unlock protective stop")?;
        if answer.starts_with("Protective stop releasing") {
            return Ok(());
        }
        Err(DriverError::Refused { device: self.settings.device(), what: "unlock protective stop", cause: answer })
    }

    fn named(&mut self, question: &'static str, head: &str) -> Result<String, DriverError> {
        let answer = self.ask(question)?;
        answer.strip_prefix(head).map(str::to_owned).ok_or_else(|| self.odd(question, &answer))
    }

    fn ask(&mut self, question: &'static str) -> Result<String, DriverError> {
        self.stream
            .write_all(format!("{question}\n").as_bytes())
            .map_err(|cause| tcp::broken(&self.settings, question, &cause))?;
        self.line(question)
    }

    /// One line, in time and not endless.
    fn line(&mut self, what: &'static str) -> Result<String, DriverError> {
        let until = Instant::now() + self.settings.answer;
        loop {
            if let Some(end) = self.unread.iter().position(|byte| *byte == b'\n') {
                let line: Vec<u8> = self.unread.drain(..=end).collect();
                return Ok(String::from_utf8_lossy(&line).trim().to_owned());
            }
            if self.unread.len() > LONGEST {
                return Err(self.odd(what, "a line without an end"));
            }
            let mut bytes = [0; 512];
            tcp::patience(&self.stream, until, &self.settings, what)?;
            match self.stream.read(&mut bytes) {
                Ok(0) => return Err(tcp::closed(&self.settings, what)),
                Ok(count) => self.unread.extend_from_slice(&bytes[..count]),
                Err(cause) => return Err(tcp::broken(&self.settings, what, &cause)),
            }
        }
    }

    fn odd(&self, what: &'static str, answer: &str) -> DriverError {
        let answer: String = answer.chars().take(80).collect();
        DriverError::Protocol { device: self.settings.device(), what, cause: format!("the answer is {answer:?}") }
    }
}
