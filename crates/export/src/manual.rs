//! What a problem tells of its sensors and motors, starts and success, as the contract has it.

use hwasp_problem::{Fact, Manual, Motor, Sensor, Told, Topic};
use serde::Serialize;

/// Something with a name, in words.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(super) struct Described {
    pub(super) name: String,
    pub(super) meaning: String,
}

/// How an observation is read.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(super) struct SensorEntry {
    /// The frame that it is told in.
    #[serde(skip_serializing_if = "Option::is_none")]
    frame: Option<String>,
    /// At which instant it is read.
    sampled: String,
    /// Standard deviation of its noise in training, in the unit.
    noise_std: f64,
}

/// What becomes of a command.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(super) struct MotorEntry {
    /// The frame that it is told in.
    #[serde(skip_serializing_if = "Option::is_none")]
    frame: Option<String>,
    /// The command under which nothing moves, in the unit.
    #[serde(skip_serializing_if = "Option::is_none")]
    hold: Option<f64>,
    /// What it does.
    becomes: String,
    /// The sum of commands that are motions.
    #[serde(skip_serializing_if = "Option::is_none")]
    target: Option<TargetEntry>,
}

/// The sum of commands that are motions within one period, in the command's unit.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct TargetEntry {
    name: String,
    /// Where it begins and what follows it.
    meaning: String,
    /// Where it begins; where there is none, where the robot stands.
    #[serde(skip_serializing_if = "Option::is_none")]
    start: Option<f64>,
    /// It is kept within these after each command.
    limits: [f64; 2],
    /// How fast it moves at most, per second: the command's limits over the period.
    speed_limits: [f64; 2],
    /// Standard deviation of what is reached from it in training, drawn anew each period and never added up.
    noise_std: f64,
}

/// What belongs together of what is told.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(super) struct TopicEntry {
    name: String,
    meaning: String,
    facts: Vec<FactEntry>,
}

/// Something to know: one of `value`, `range` (from, to), `text` and `names`.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct FactEntry {
    name: String,
    unit: &'static str,
    #[serde(skip_serializing_if = "String::is_empty")]
    meaning: String,
    #[serde(flatten)]
    told: ToldEntry,
}

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
enum ToldEntry {
    Value(f64),
    Range([f64; 2]),
    Text(String),
    Names(Vec<String>),
}

/// The frames.
pub(super) fn frames(manual: &Manual) -> Vec<Described> {
    manual.frames.iter().map(|frame| Described { name: frame.name.clone(), meaning: frame.meaning.clone() }).collect()
}

/// How an observation is read, where it is told.
pub(super) fn sensor(manual: &Manual, port: &str) -> Option<SensorEntry> {
    let Sensor { frame, sampled, noise, .. } = manual.sensors.iter().find(|sensor| sensor.port == port)?;
    Some(SensorEntry { frame: frame.clone(), sampled: sampled.clone(), noise_std: *noise })
}

/// What becomes of a command within `limits`, given every `period`, s, where it is told.
pub(super) fn motor(manual: &Manual, port: &str, limits: [f64; 2], period: f64) -> Option<MotorEntry> {
    let Motor { frame, hold, becomes, target, .. } = manual.motors.iter().find(|motor| motor.port == port)?;
    let target = target.as_ref().map(|target| TargetEntry {
        name: target.name.clone(),
        meaning: target.meaning.clone(),
        start: target.start,
        limits: target.limits,
        speed_limits: limits.map(|limit| limit / period),
        noise_std: target.noise,
    });
    Some(MotorEntry { frame: frame.clone(), hold: *hold, becomes: becomes.clone(), target })
}

/// Everything else.
pub(super) fn topics(manual: &Manual) -> Vec<TopicEntry> {
    let fact = |fact: &Fact| FactEntry {
        name: fact.name.clone(),
        unit: fact.unit,
        meaning: fact.meaning.clone(),
        told: match &fact.told {
            Told::Value(value) => ToldEntry::Value(*value),
            Told::Range(range) => ToldEntry::Range(*range),
            Told::Text(text) => ToldEntry::Text(text.clone()),
            Told::Names(names) => ToldEntry::Names(names.clone()),
        },
    };
    let topic = |topic: &Topic| TopicEntry {
        name: topic.name.clone(),
        meaning: topic.meaning.clone(),
        facts: topic.facts.iter().map(fact).collect(),
    };
    manual.topics.iter().map(topic).collect()
}
