//! The MCAP file: channels of JSON, not compressed, in pieces of a second, so that a log that was cut off is read up to there.

use std::collections::BTreeMap;
use std::io;

use mcap::records::{MessageHeader, Metadata};
use mcap::{McapError, WriteOptions, Writer};
use serde::Serialize;

use super::{About, Output, channels, text};
use crate::record::{Event, Step};

/// Bytes of a piece of the file.
const CHUNK: u64 = 128 * 1024;
/// The name of the record with what a log is of.
pub(super) const ABOUT: &str = "hwasp";

/// A file that is being written.
pub(super) struct McapLog {
    writer: Writer<Box<dyn Output>>,
    channels: [u16; 6],
    sequence: u32,
    epoch: u64,
    observation: Vec<String>,
    command: Vec<String>,
    message: Vec<u8>,
}

#[derive(Serialize)]
struct Arm {
    palm: [f64; 3],
    palm_target: [f64; 3],
    tool_speed: [f64; 3],
    clock: f64,
    age: f64,
    mode: &'static str,
    safety: &'static str,
}

#[derive(Serialize)]
struct Motor {
    wound: f64,
    goal: f64,
    travel: f64,
    velocity: f64,
    current: f64,
    torque: f64,
    voltage: f64,
    temperature: f64,
    age: f64,
}

#[derive(Serialize)]
struct Loop {
    episode: u32,
    phase: &'static str,
    step: u32,
    late: f64,
    response: &'static str,
}

#[derive(Serialize)]
struct Happened {
    episode: u32,
    event: &'static str,
    detail: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    size: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    place: Option<[f64; 3]>,
}

/// Numbers by the names of ports.
struct Named<'a>(&'a [String], &'a [f64]);

impl Serialize for Named<'_> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().zip(self.1))
    }
}

fn other(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        error => io::Error::other(error),
    }
}

impl McapLog {
    pub(super) fn begin(output: Box<dyn Output>, about: &About, epoch: u64) -> io::Result<Self> {
        let options = WriteOptions::new().compression(None).chunk_size(Some(CHUNK)).profile("").library("hwasp");
        let mut writer = options.create(output).map_err(other)?;
        let mut ids = [0; 6];
        for (id, (topic, schema)) in ids.iter_mut().zip(channels::schemas(about)) {
            let schema = writer.add_schema(&topic[1..], "jsonschema", schema.as_bytes()).map_err(other)?;
            *id = writer.add_channel(schema, topic, "json", &BTreeMap::new()).map_err(other)?;
        }
        let text = serde_json::to_string(about).map_err(io::Error::other)?;
        let metadata = Metadata { name: ABOUT.to_owned(), metadata: BTreeMap::from([("about".to_owned(), text)]) };
        writer.write_metadata(&metadata).map_err(other)?;
        let (observation, command) = (about.observation.clone(), about.command.clone());
        Ok(Self { writer, channels: ids, sequence: 0, epoch, observation, command, message: Vec::with_capacity(1024) })
    }

    pub(super) fn step(&mut self, step: &Step) -> io::Result<()> {
        let (observation, command) = (std::mem::take(&mut self.observation), std::mem::take(&mut self.command));
        let written = self.acted(step, &observation, &command);
        (self.observation, self.command) = (observation, command);
        written?;
        let &Step { palm, palm_target, tool_speed, arm_clock, arm_age, .. } = step;
        let (mode, safety) = (text::mode(step.arm_mode), text::safety(step.arm_safety));
        self.put(2, step.time, &Arm { palm, palm_target, tool_speed, clock: arm_clock, age: arm_age, mode, safety })?;
        let &Step { wound, goal, travel, velocity, current, torque, voltage, temperature, motor_age, .. } = step;
        let motor = Motor { wound, goal, travel, velocity, current, torque, voltage, temperature, age: motor_age };
        self.put(3, step.time, &motor)?;
        let &Step { episode, phase, step: count, late, response, .. } = step;
        self.put(4, step.time, &Loop { episode, phase: phase.name(), step: count, late, response: response.name() })
    }

    /// What the controller saw and said, where it acted.
    fn acted(&mut self, step: &Step, observation: &[String], command: &[String]) -> io::Result<()> {
        let (seen, commanded) = (&step.seen[..observation.len()], &step.commanded[..command.len()]);
        if !seen.iter().any(|x| x.is_finite()) {
            return Ok(());
        }
        self.put(0, step.time, &Named(observation, seen))?;
        self.put(1, step.time, &Named(command, commanded))
    }

    pub(super) fn event(&mut self, time: f64, episode: u32, event: Event) -> io::Result<()> {
        let (name, detail) = text::event(event);
        let (size, place) = match event {
            Event::Episode { size, place, .. } => (Some(size), Some(place)),
            _ => (None, None),
        };
        self.put(5, time, &Happened { episode, event: name, detail, size, place })
    }

    fn put(&mut self, channel: usize, time: f64, message: &impl Serialize) -> io::Result<()> {
        self.message.clear();
        serde_json::to_writer(&mut self.message, message).map_err(io::Error::other)?;
        let at = self.epoch + (1e9 * time) as u64;
        let header = MessageHeader {
            channel_id: self.channels[channel],
            sequence: self.sequence,
            log_time: at,
            publish_time: at,
        };
        self.sequence = self.sequence.wrapping_add(1);
        self.writer.write_to_known_channel(&header, &self.message).map_err(other)
    }

    pub(super) fn flush(&mut self) -> io::Result<()> {
        self.writer.flush().map_err(other)
    }

    pub(super) fn finish(&mut self) -> io::Result<()> {
        self.writer.finish().map(|_| ()).map_err(other)
    }
}
