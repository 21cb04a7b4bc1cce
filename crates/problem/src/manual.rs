//! What somebody has to know who puts a controller to work, beyond names, units and limits of its ports.

/// How a problem's sensors and motors, starts and success are told to a stranger. All of it may be empty: whatever is there goes
/// into the contract beside every exported controller.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Manual {
    /// The frames that positions are told in.
    pub frames: Vec<Frame>,
    /// What there is to know of observations.
    pub sensors: Vec<Sensor>,
    /// What becomes of commands.
    pub motors: Vec<Motor>,
    /// Everything else, by subject.
    pub topics: Vec<Topic>,
}

/// A frame: a point and axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// What sensors and motors call it.
    pub name: String,
    /// Where its origin is and where its axes point.
    pub meaning: String,
}

/// What there is to know of an observation.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    /// The observation's port.
    pub port: String,
    /// The [`Frame`] that it is told in, for positions.
    pub frame: Option<String>,
    /// At which instant it is read.
    pub sampled: String,
    /// The standard deviation of its noise in training, in the port's unit; 0 where there is none.
    pub noise: f64,
}

/// What becomes of a command.
#[derive(Clone, Debug, PartialEq)]
pub struct Motor {
    /// The command's port.
    pub port: String,
    /// The [`Frame`] that it is told in, for positions.
    pub frame: Option<String>,
    /// The command under which nothing moves, in the port's unit, where there is one.
    pub hold: Option<f64>,
    /// What it does.
    pub becomes: String,
    /// The sum that commands add up to, where they are motions.
    pub target: Option<Target>,
}

/// The sum of a motor's commands.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// What it is called.
    pub name: String,
    /// Where it begins and what follows it.
    pub meaning: String,
    /// Where it begins, in the port's unit; none where the robot stands where it stands.
    pub start: Option<f64>,
    /// The limits that it is kept within after each command, in the port's unit.
    pub limits: [f64; 2],
    /// The standard deviation, in the port's unit, of what is reached from the sum, drawn anew each period and never added up.
    pub noise: f64,
}

/// A subject: what belongs together of what is told.
#[derive(Clone, Debug, PartialEq)]
pub struct Topic {
    /// What it is called.
    pub name: String,
    /// What it is about.
    pub meaning: String,
    /// What there is to know.
    pub facts: Vec<Fact>,
}

/// Something to know.
#[derive(Clone, Debug, PartialEq)]
pub struct Fact {
    /// What it is called.
    pub name: String,
    /// What is told of it.
    pub told: Told,
    /// The symbol of its SI unit; empty for pure numbers and words.
    pub unit: &'static str,
    /// What it means.
    pub meaning: String,
}

/// What is told.
#[derive(Clone, Debug, PartialEq)]
pub enum Told {
    /// One number.
    Value(f64),
    /// From and to.
    Range([f64; 2]),
    /// A word, a formula or sentences.
    Text(String),
    /// Words in order.
    Names(Vec<String>),
}

impl Topic {
    /// A subject of which nothing is told yet.
    pub fn new(name: &str, meaning: impl Into<String>) -> Self {
        Self { name: name.to_owned(), meaning: meaning.into(), facts: Vec::new() }
    }

    /// The same with a fact more.
    #[must_use]
    pub fn with(mut self, name: &str, told: impl Into<Told>, unit: &'static str, meaning: impl Into<String>) -> Self {
        self.facts.push(Fact { name: name.to_owned(), told: told.into(), unit, meaning: meaning.into() });
        self
    }
}

impl From<f64> for Told {
    fn from(value: f64) -> Self {
        Self::Value(value)
    }
}

impl From<[f64; 2]> for Told {
    fn from(range: [f64; 2]) -> Self {
        Self::Range(range)
    }
}

impl From<&str> for Told {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<&[&str]> for Told {
    fn from(names: &[&str]) -> Self {
        Self::Names(names.iter().map(|&name| name.to_owned()).collect())
    }
}
