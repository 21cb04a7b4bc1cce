//! Logs read back.

use std::collections::BTreeMap;
use std::path::Path;

use hwasp_tasks::grasp::ShapeKind;
use mcap::MessageStream;
use mcap::read::Options;
use mcap::records::Record;
use serde::Deserialize;
use serde_json::Value;

use super::{About, channels, mcap::ABOUT};
use crate::error::{DeployError, file};

/// The largest log that is read, bytes: some hours.
const LARGEST: u64 = 1 << 30;

/// A log.
#[derive(Clone, Debug)]
pub struct Logged {
    /// What it is of.
    pub about: About,
    /// Its steps, in order.
    pub rows: Vec<Row>,
    /// The object of each episode.
    pub episodes: BTreeMap<u32, LoggedObject>,
    /// What happened: when, s, in which episode, what, and more of it.
    pub events: Vec<(f64, u32, String, String)>,
}

/// The object of an episode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoggedObject {
    /// Its bounding box, m.
    pub size: [f64; 3],
    /// Its centre, m.
    pub place: [f64; 3],
    /// Its shape, where somebody said it.
    pub shape: Option<ShapeKind>,
}

/// A step of it. What was not there is not a number.
#[derive(Clone, Debug, Default)]
pub struct Row {
    /// s since the first.
    pub time: f64,
    /// Which episode.
    pub episode: u32,
    /// What was done.
    pub phase: String,
    /// What the controller saw; empty where it did not act.
    pub seen: Vec<f64>,
    /// What it commanded.
    pub commanded: Vec<f64>,
    /// m.
    pub palm: [f64; 3],
    /// m.
    pub palm_target: [f64; 3],
    /// m.
    pub wound: f64,
    /// m.
    pub goal: f64,
    /// m.
    pub travel: f64,
    /// A.
    pub current: f64,
    /// N·m.
    pub torque: f64,
    /// How old what the motor said is, s.
    pub motor_age: f64,
    /// What was decided.
    pub response: String,
}

#[derive(Deserialize)]
struct Arm {
    palm: [Option<f64>; 3],
    palm_target: [Option<f64>; 3],
}

#[derive(Deserialize)]
struct Motor {
    wound: Option<f64>,
    goal: Option<f64>,
    travel: Option<f64>,
    current: Option<f64>,
    torque: Option<f64>,
    age: Option<f64>,
}

#[derive(Deserialize)]
struct Loop {
    episode: u32,
    phase: String,
    response: String,
}

#[derive(Deserialize)]
struct Happened {
    episode: u32,
    event: String,
    #[serde(default)]
    detail: String,
    size: Option<[f64; 3]>,
    place: Option<[f64; 3]>,
}

/// Reads an MCAP log; one that was cut off up to there.
///
/// # Errors
/// Where it is no log of this program.
pub fn read(path: &Path) -> Result<Logged, DeployError> {
    let wrong = |what: String| DeployError::Log { path: path.to_owned(), what };
    let length = std::fs::metadata(path).map_err(file("read", path))?.len();
    if length > LARGEST {
        return Err(wrong(format!("it has {length} bytes, more than a log of some hours ({LARGEST})")));
    }
    let bytes = std::fs::read(path).map_err(file("read", path))?;
    let about = about(&bytes)
        .ok_or_else(|| wrong("it is no log of `hwasp deploy`: name a file NAME.mcap that it wrote".to_owned()))?;
    let mut logged = Logged { about, rows: Vec::new(), episodes: BTreeMap::new(), events: Vec::new() };
    let stream = MessageStream::new_with_options(&bytes, Options::IgnoreEndMagic.into())
        .map_err(|error| wrong(error.to_string()))?;
    let (mut row, mut first) = (Row::default(), None);
    for message in stream {
        // What comes after a piece that was cut off is nothing.
        let Ok(message) = message else { break };
        let begin = *first.get_or_insert(message.log_time);
        let time = 1e-9 * message.log_time.saturating_sub(begin) as f64;
        let odd = |error: serde_json::Error| wrong(format!("{} at {time:.3} s: {error}", message.channel.topic));
        match message.channel.topic.as_str() {
            channels::OBSERVATION => row.seen = numbers(&message.data, &logged.about.observation).map_err(odd)?,
            channels::COMMAND => row.commanded = numbers(&message.data, &logged.about.command).map_err(odd)?,
            channels::ARM => {
                let arm: Arm = serde_json::from_slice(&message.data).map_err(odd)?;
                (row.palm, row.palm_target) = (arm.palm.map(or_nan), arm.palm_target.map(or_nan));
            }
            channels::MOTOR => {
                let motor: Motor = serde_json::from_slice(&message.data).map_err(odd)?;
                (row.wound, row.goal, row.travel) = (or_nan(motor.wound), or_nan(motor.goal), or_nan(motor.travel));
                (row.current, row.torque) = (or_nan(motor.current), or_nan(motor.torque));
                row.motor_age = or_nan(motor.age);
            }
            channels::LOOP => {
                // The last of a step.
                let Loop { episode, phase, response } = serde_json::from_slice(&message.data).map_err(odd)?;
                logged.rows.push(Row { time, episode, phase, response, ..std::mem::take(&mut row) });
            }
            channels::EVENTS => {
                let happened: Happened = serde_json::from_slice(&message.data).map_err(odd)?;
                if let (Some(size), Some(place)) = (happened.size, happened.place) {
                    let shape = ShapeKind::from_name(&happened.detail);
                    logged.episodes.insert(happened.episode, LoggedObject { size, place, shape });
                }
                logged.events.push((time, happened.episode, happened.event, happened.detail));
            }
            _ => {}
        }
    }
    Ok(logged)
}

fn or_nan(x: Option<f64>) -> f64 {
    x.unwrap_or(f64::NAN)
}

fn numbers(data: &[u8], names: &[String]) -> Result<Vec<f64>, serde_json::Error> {
    let read: BTreeMap<String, Value> = serde_json::from_slice(data)?;
    Ok(names.iter().map(|name| read.get(name).and_then(Value::as_f64).unwrap_or(f64::NAN)).collect())
}

/// What a log is of.
fn about(bytes: &[u8]) -> Option<About> {
    let records = mcap::read::LinearReader::new_with_options(bytes, Options::IgnoreEndMagic.into()).ok()?;
    records.map_while(Result::ok).find_map(|record| match record {
        Record::Metadata(metadata) if metadata.name == ABOUT => {
            serde_json::from_str(metadata.metadata.get("about")?).ok()
        }
        _ => None,
    })
}
