//! Collecting apart from computing: what is asked of whoever runs episodes, and what comes back.
//!
//! Requests and answers are plain values. A request names the experiment by its resolved text, and streams by seed, iteration
//! and episode, so that the answer has the same bits whoever gives it: a thread
//! ([`LocalCollector`](crate::LocalCollector)), or a [`Worker`](crate::Worker) in another process.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use hwasp_algos::Archive;
use hwasp_core::{Batch, EpisodeResult, Episodes, LaneSteps, RolloutError, bits};
use hwasp_experiment::{Experiment, Faults, Files, Folder, Layers};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Episodes, and trainings inside of a search, for whoever asks.
pub trait Collector: Send + Sync {
    /// Runs episodes and returns them with all of their rows, in the order of their indices. The physics of all of them may
    /// have failed ([`Batch::sound`]).
    ///
    /// # Errors
    /// [`CollectError::Rollout`] where a reward or a log-probability is no number: the first by index.
    fn rows(&self, request: &EpisodesRequest) -> Result<Batch, CollectError>;

    /// Runs the same episodes with the same bits, and keeps of each what it came to.
    ///
    /// # Errors
    /// As those of [`rows`](Self::rows).
    fn results(&self, request: &EpisodesRequest) -> Result<Vec<EpisodeAnswer>, CollectError>;

    /// Trains a controller for the design of a candidate. `watch` may be given the state of the training on the way; what it
    /// is not given has to be done again after an interruption.
    ///
    /// # Errors
    /// [`CollectError::Interrupted`] where `watch` asked for it.
    fn candidate(&self, request: &CandidateRequest, watch: &dyn Watch) -> Result<CandidateAnswer, CollectError>;

    /// Calls `job(i, collector)` for every `i < count`, in any order and as many at once as it has workers. Each call has a
    /// collector of its own, which answers on one worker.
    fn each(&self, count: usize, job: &(dyn Fn(usize, &dyn Collector) + Sync));
}

/// Watches a training inside of a search.
pub trait Watch: Sync {
    /// Whether it should end.
    fn stopped(&self) -> bool;

    /// Whether its state is wanted now.
    fn due(&self) -> bool;

    /// Takes its state.
    fn keep(&self, state: &Archive);
}

/// Nobody watches.
impl Watch for () {
    fn stopped(&self) -> bool {
        false
    }

    fn due(&self) -> bool {
        false
    }

    fn keep(&self, _: &Archive) {}
}

/// An experiment as its resolved text and the files that it names, shared: whoever knows these knows the experiment.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "Written", into = "Written")]
pub struct ExperimentText(Arc<Parts>);

#[derive(Debug, PartialEq, Eq)]
struct Parts {
    text: String,
    files: Arc<Files>,
}

/// The same as it is written: files in hexadecimal digits, for a mesh is no text.
#[derive(Serialize, Deserialize)]
struct Written {
    text: String,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    files: BTreeMap<String, String>,
}

impl ExperimentText {
    /// Of an experiment.
    ///
    /// # Errors
    /// [`CollectError::Setup`] where it cannot be written as TOML.
    pub fn of(experiment: &Experiment) -> Result<Self, CollectError> {
        let text = experiment.to_toml();
        let text = text.map_err(|error| CollectError::Setup(format!("the experiment cannot be written: {error}")))?;
        Ok(Self(Arc::new(Parts { text, files: Arc::clone(experiment.files()) })))
    }

    /// The text.
    pub fn as_str(&self) -> &str {
        &self.0.text
    }

    /// Its layers, for whoever puts it together again; `name` is what messages call it.
    ///
    /// # Errors
    /// Where the text is no TOML.
    pub fn layers(&self, name: &str) -> Result<Layers, Faults> {
        Ok(Layers::from_text(name, &self.0.text)?.with_folder(Folder::Sent(Arc::clone(&self.0.files))))
    }

    /// Whether both are the same; texts that are shared are not read for that.
    pub(crate) fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0) || self == other
    }
}

/// Of a text that names no files.
impl From<String> for ExperimentText {
    fn from(text: String) -> Self {
        Self(Arc::new(Parts { text, files: Arc::default() }))
    }
}

impl From<Written> for ExperimentText {
    fn from(written: Written) -> Self {
        let files = written.files.into_iter().map(|(path, digits)| (path, unhex(&digits).into())).collect();
        Self(Arc::new(Parts { text: written.text, files: Arc::new(files) }))
    }
}

impl From<ExperimentText> for Written {
    fn from(text: ExperimentText) -> Self {
        let files = text.0.files.iter().map(|(path, bytes)| (path.clone(), hex(bytes))).collect();
        Self { text: text.0.text.clone(), files }
    }
}

/// Two digits for each byte.
fn hex(bytes: &[u8]) -> String {
    let digit = |half: u8| char::from_digit(u32::from(half), 16).unwrap_or('0');
    bytes.iter().flat_map(|byte| [digit(byte >> 4), digit(byte & 15)]).collect()
}

/// The bytes of pairs of digits; what is none is left out, and the experiment tells that its files are others.
fn unhex(digits: &str) -> Vec<u8> {
    let pair = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok();
    digits.as_bytes().chunks(2).filter_map(pair).collect()
}

/// Where episodes run, and what acts in them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Stage {
    /// The world where one trains; the policy as it learns.
    Training,
    /// The world where the result has to work; the controller on hardware of this design, SI.
    Deployment(#[serde(with = "bits")] Vec<f64>),
    /// The world that stands in for the robot built to this design, SI; the controller.
    StandIn(#[serde(with = "bits")] Vec<f64>),
    /// The world where the experiment polishes, with hardware of this design, SI; the policy as it learns there.
    Polish(#[serde(with = "bits")] Vec<f64>),
}

/// What an episode came to; the error where its physics failed.
pub type EpisodeAnswer = Result<EpisodeResult, RolloutError>;

/// Episodes of one policy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EpisodesRequest {
    /// The experiment.
    pub experiment: ExperimentText,
    /// Where they run.
    pub stage: Stage,
    /// Of the policy in training and in a polish, of the controller alone elsewhere.
    #[serde(with = "bits")]
    pub params: Vec<f32>,
    /// Which episodes, and how.
    pub episodes: Episodes,
    /// The steps of an episode, where not as many as the world has.
    pub steps: Option<usize>,
    /// Where steps are counted, and not episodes: what lanes share. The indices are those of lanes then, and rows are what can be
    /// asked for.
    #[serde(default)]
    pub lanes: Option<LaneSteps>,
}

impl EpisodesRequest {
    /// So many requests, at most, of consecutive episodes. Their answers put together in order ([`Batch::join`], or one list
    /// after the other) are the answer to this one.
    pub fn split(&self, parts: usize) -> Vec<Self> {
        let Range { start, end } = self.episodes.indices;
        let each = (end - start).div_ceil(parts.max(1) as u64).max(1);
        (start..end).step_by(each as usize).map(|first| self.part(first..(first + each).min(end))).collect()
    }

    /// Requests of consecutive episodes for so many workers who take one after the other: large ones first, and at the end such small
    /// ones, though of `least` episodes, that all workers end together.
    pub fn shared_by(&self, workers: usize, least: u64) -> Vec<Self> {
        let Range { start, end } = self.episodes.indices;
        let (mut parts, mut first) = (Vec::new(), start);
        while first < end {
            let count = (end - first).div_ceil(2 * workers.max(1) as u64).max(least).min(end - first);
            parts.push(self.part(first..first + count));
            first += count;
        }
        parts
    }

    /// The same for some of its episodes.
    fn part(&self, indices: Range<u64>) -> Self {
        Self { episodes: Episodes { indices, ..self.episodes.clone() }, ..self.clone() }
    }
}

/// A training for the design of a candidate, inside of a search.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CandidateRequest {
    /// The experiment of the search.
    pub experiment: ExperimentText,
    /// The design, SI.
    #[serde(with = "bits")]
    pub design: Vec<f64>,
    /// The root seed of its training.
    pub seed: u64,
    /// The budget of its training, simulator steps.
    pub env_steps: u64,
    /// The state to go on from, where it was interrupted.
    pub from: Option<Archive>,
}

/// What the training of a candidate came to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum CandidateAnswer {
    /// It came to its end.
    Trained {
        /// The controller's parameters.
        #[serde(with = "bits")]
        controller: Vec<f32>,
        /// Mean discounted and undiscounted return of its last iterations.
        #[serde(with = "bits")]
        returns: (f64, f64),
        /// Simulator steps taken.
        env_steps: u64,
        /// Episodes whose physics failed.
        discarded_episodes: u64,
    },
    /// It failed: it ranks last, and its whole budget is charged.
    Failed(CandidateFailure),
}

/// Why a candidate is worth nothing.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CandidateFailure {
    /// What went wrong; the same text for all that failed alike.
    pub cause: String,
    /// The same with episode and step, where it was in one.
    pub text: String,
}

impl CandidateFailure {
    /// A failure in an episode.
    pub(crate) fn episode(error: &RolloutError) -> Self {
        Self { cause: error.what.clone(), text: error.to_string() }
    }
}

/// Why there is no answer.
#[derive(Clone, Debug, Error, PartialEq, Eq, Serialize, Deserialize)]
pub enum CollectError {
    /// An episode gave a number that is none.
    #[error(transparent)]
    Rollout(#[from] RolloutError),
    /// The experiment cannot be set up where it was asked for, or a state that came along is not of it.
    #[error("{0}")]
    Setup(String),
    /// Whoever was asked is gone.
    #[error("whoever was asked for episodes has not answered: {0}")]
    Unanswered(String),
    /// Someone asked it to stop.
    #[error("stopped while an answer was waited for")]
    Interrupted,
}

/// A request of any kind, for those that send them elsewhere.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Request {
    /// [`Collector::rows`].
    Rows(EpisodesRequest),
    /// [`Collector::results`].
    Results(EpisodesRequest),
    /// [`Collector::candidate`].
    Candidate(CandidateRequest),
}

/// The answer to a [`Request`] of the same name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Answer {
    /// Episodes with their rows.
    Rows(Batch),
    /// What episodes came to.
    Results(Vec<EpisodeAnswer>),
    /// What a training came to.
    Candidate(CandidateAnswer),
}
