//! The beginning of a connection of RTDE: question and answer, until version and recipes are agreed.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::Instant;

use super::reading::recipe;
use super::registers as r;
use super::settings::UrSettings;
use super::tcp;
use super::wire::{Body, Frame, Frames, WireError, kind};
use crate::error::DriverError;

/// What is refused where the controller does not know a name.
pub(super) const OUTPUTS: &str = "recipe of outputs";

/// Question and answer, before packets flow.
pub(super) struct Talk<'a> {
    stream: TcpStream,
    settings: &'a UrSettings,
    frames: Frames,
    until: Instant,
}

impl<'a> Talk<'a> {
    /// All of it has to be over within `answer`.
    pub(super) fn new(stream: TcpStream, settings: &'a UrSettings) -> Self {
        Self { stream, settings, frames: Frames::default(), until: Instant::now() + settings.answer }
    }

    /// What has come beyond the last answer is kept.
    pub(super) fn end(self) -> (TcpStream, Frames) {
        (self.stream, self.frames)
    }

    pub(super) fn agree(&mut self) -> Result<(), DriverError> {
        let what = "protocol of RTDE";
        let body = self.ask(what, kind::PROTOCOL, &2_u16.to_be_bytes())?;
        self.accepted(what, &body, "version 2 of the protocol is not known to it: update the controller (3.10 or 5.4)")
    }

    pub(super) fn version(&mut self) -> Result<[u32; 4], DriverError> {
        let what = "version of the controller";
        let body = self.ask(what, kind::CONTROLLER, &[])?;
        let mut body = Body::new(&body);
        let mut version = [0; 4];
        for part in &mut version {
            *part = body.u32().map_err(|cause| odd(self.settings, what, &cause))?;
        }
        Ok(version)
    }

    /// The number of the recipe.
    pub(super) fn outputs(&mut self, full: bool) -> Result<u8, DriverError> {
        let recipe = recipe(full);
        let names: Vec<&str> = recipe.iter().map(|(name, _)| name.as_str()).collect();
        let mut body = self.settings.frequency.to_be_bytes().to_vec();
        body.extend_from_slice(names.join(",").as_bytes());
        let answer = self.ask(OUTPUTS, kind::OUTPUTS, &body)?;
        let expected: Vec<_> = recipe.iter().map(|(_, kind)| kind.name()).collect();
        self.recipe(OUTPUTS, &answer, &names, &expected)
    }

    pub(super) fn inputs(&mut self) -> Result<u8, DriverError> {
        let what = "recipe of inputs";
        let mut names: Vec<String> =
            [r::COMMAND, r::NUMBER, r::BEAT].iter().map(|at| format!("input_int_register_{at}")).collect();
        names.extend((r::TARGET..=r::SPEED).map(|at| format!("input_double_register_{at}")));
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let answer = self.ask(what, kind::INPUTS, names.join(",").as_bytes())?;
        let expected: Vec<_> = (0..names.len()).map(|at| if at < 3 { "INT32" } else { "DOUBLE" }).collect();
        self.recipe(what, &answer, &names, &expected)
    }

    /// The number of a recipe, if every name has the type that it should have.
    fn recipe(&self, what: &'static str, answer: &[u8], names: &[&str], expected: &[&str]) -> Result<u8, DriverError> {
        let mut body = Body::new(answer);
        let number = body.u8().map_err(|cause| odd(self.settings, what, &cause))?;
        let text = body.text().map_err(|cause| odd(self.settings, what, &cause))?;
        let kinds: Vec<&str> = text.trim_end_matches(',').split(',').map(str::trim).collect();
        if kinds.len() != names.len() {
            let cause = format!("{} names were sent, {} types came back", names.len(), kinds.len());
            return Err(DriverError::Protocol { device: self.settings.device(), what, cause });
        }
        for ((name, kind), expected) in names.iter().zip(&kinds).zip(expected) {
            if kind != expected {
                let cause = match *kind {
                    "IN_USE" => format!("{name} is in use by another client or a field bus: close it"),
                    "NOT_FOUND" => format!("{name} is not known to the controller: update it (3.10 or 5.4)"),
                    other => format!("{name} has the type {other:.20}, not {expected}"),
                };
                return Err(DriverError::Refused { device: self.settings.device(), what, cause });
            }
        }
        Ok(number)
    }

    pub(super) fn start(&mut self) -> Result<(), DriverError> {
        let what = "start of RTDE";
        let body = self.ask(what, kind::START, &[])?;
        self.accepted(what, &body, "the controller does not start to send")
    }

    fn accepted(&self, what: &'static str, body: &[u8], refusal: &str) -> Result<(), DriverError> {
        match Body::new(body).u8().map_err(|cause| odd(self.settings, what, &cause))? {
            0 => Err(DriverError::Refused { device: self.settings.device(), what, cause: refusal.to_owned() }),
            _ => Ok(()),
        }
    }

    /// Sends, and waits for the answer of the same kind; words to a person in between are passed over.
    fn ask(&mut self, what: &'static str, kind: u8, body: &[u8]) -> Result<Vec<u8>, DriverError> {
        let bytes = Frame::bytes(kind, body).unwrap_or_default();
        self.stream.write_all(&bytes).map_err(|cause| tcp::broken(self.settings, what, &cause))?;
        loop {
            match self.frames.take().map_err(|cause| odd(self.settings, what, &cause))? {
                Some(frame) if frame.kind == kind => return Ok(frame.body),
                Some(frame) if frame.kind == kind::TEXT => continue,
                // The first packet may overtake the word that they begin.
                Some(frame) if frame.kind == kind::DATA && kind == kind::START => continue,
                Some(frame) => return Err(unasked(self.settings, what, frame.kind)),
                None => {}
            }
            tcp::patience(&self.stream, self.until, self.settings, what)?;
            let mut bytes = [0; 2048];
            match self.stream.read(&mut bytes) {
                Ok(0) => return Err(tcp::closed(self.settings, what)),
                Ok(count) => self.frames.push(&bytes[..count]),
                Err(cause) => return Err(tcp::broken(self.settings, what, &cause)),
            }
        }
    }
}

pub(super) fn odd(settings: &UrSettings, what: &'static str, cause: &WireError) -> DriverError {
    DriverError::Protocol { device: settings.device(), what, cause: cause.to_string() }
}

pub(super) fn unasked(settings: &UrSettings, what: &'static str, kind: u8) -> DriverError {
    DriverError::Protocol { device: settings.device(), what, cause: format!("a frame of kind {kind} came unasked") }
}
