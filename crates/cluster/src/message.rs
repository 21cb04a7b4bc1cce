//! What travels: jobs, answers and news, in the compressed binary form of `postcard`.

use std::time::Duration;

use hwasp_algos::Archive;
use hwasp_core::{Batch, Episodes, LaneSteps, bits};
use hwasp_training::collect::{Answer, CollectError, ExperimentText, Stage};
use hwasp_training::{Checkpoint, Evaluation, MetricsRow, Trained};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// The largest value that is unpacked, bytes: what comes from elsewhere may claim any size.
const LARGEST: usize = 1 << 30;

/// Packs a value. Both sides are the same program, so that no field needs a name.
pub(crate) fn pack<T: Serialize>(value: &T) -> Result<Vec<u8>, String> {
    let bytes = postcard::to_stdvec(value).map_err(|error| error.to_string())?;
    Ok(lz4_flex::compress_prepend_size(&bytes))
}

/// Unpacks one.
pub(crate) fn unpack<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    let (size, rest) = lz4_flex::block::uncompressed_size(bytes).map_err(|error| error.to_string())?;
    // No form of compression that is used here makes more than 255 bytes of one.
    let most = LARGEST.min(rest.len().saturating_mul(255));
    if size > most {
        return Err(format!("{size} bytes are more than the {most} that may be"));
    }
    let bytes = lz4_flex::decompress(rest, size).map_err(|error| error.to_string())?;
    postcard::from_bytes(&bytes).map_err(|error| error.to_string())
}

/// The name of some bytes.
pub(crate) fn hash(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().take(16).map(|byte| format!("{byte:02x}")).collect()
}

/// Values that leave out fields, or whose form is told by their content, travel as JSON inside.
mod as_json {
    use serde::de::{DeserializeOwned, Error as _};
    use serde::ser::Error as _;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(super) fn serialize<T: Serialize, S: Serializer>(value: &T, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&serde_json::to_string(value).map_err(S::Error::custom)?)
    }

    pub(super) fn deserialize<'de, T: DeserializeOwned, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
        serde_json::from_slice(String::deserialize(deserializer)?.as_bytes()).map_err(D::Error::custom)
    }
}

/// The text and the files of an experiment, as they are kept.
#[derive(Clone, Serialize, Deserialize)]
pub(crate) struct Named(#[serde(with = "as_json")] pub(crate) ExperimentText);

/// Bytes, here or kept under their hash.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Payload {
    /// These.
    Here(#[serde(with = "serde_bytes")] Vec<u8>),
    /// Those that are kept.
    Kept(Kept),
}

/// A kept value.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub(crate) struct Kept {
    /// How long it is kept: a word of its subject.
    pub(crate) class: Class,
    /// The hash of its bytes.
    pub(crate) hash: String,
    /// How many.
    pub(crate) bytes: u64,
}

/// How long a value is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub(crate) enum Class {
    /// Until the run is over, or it is removed by name.
    Run,
    /// Until a checkpoint has what follows from it.
    Iteration,
}

impl Class {
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Run => "kept",
            Self::Iteration => "part",
        }
    }
}

/// Something to do. Its name is the hash of what it asks for.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Job {
    /// Whose answers count: [`Identity::digest`](crate::Identity::digest).
    pub(crate) identity: String,
    /// The run that it is of.
    pub(crate) run: String,
    /// Its name.
    pub(crate) name: String,
    /// A packed [`Named`].
    pub(crate) experiment: Kept,
    pub(crate) task: Task,
}

/// What to do.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) enum Task {
    /// [`Collector::rows`](hwasp_training::Collector::rows).
    Rows(Block),
    /// [`Collector::results`](hwasp_training::Collector::results).
    Results(Block),
    /// [`Collector::candidate`](hwasp_training::Collector::candidate).
    Candidate {
        #[serde(with = "bits")]
        design: Vec<f64>,
        seed: u64,
        env_steps: u64,
        /// A packed [`Archive`]. No part of its name.
        from: Option<Payload>,
    },
    /// [`Trainer::train`](hwasp_training::collect::Trainer::train).
    Training {
        /// A packed [`Checkpoint`]. No part of its name.
        from: Option<Payload>,
    },
    /// Nothing: how many of these are done in a second is the server's limit.
    Nothing(u64),
}

/// Episodes of one policy.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Block {
    pub(crate) stage: Stage,
    /// The parameters, packed.
    pub(crate) params: Payload,
    pub(crate) episodes: Episodes,
    pub(crate) steps: Option<usize>,
    pub(crate) lanes: Option<LaneSteps>,
}

/// The parameters of a policy.
#[derive(Serialize, Deserialize)]
pub(crate) struct Params(#[serde(with = "bits")] pub(crate) Vec<f32>);

impl Task {
    /// A word for logs and statistics.
    pub(crate) fn kind(&self) -> &'static str {
        match self {
            Self::Rows(_) | Self::Results(_) => "episodes",
            Self::Candidate { .. } => "candidate",
            Self::Training { .. } => "training",
            Self::Nothing(_) => "nothing",
        }
    }

    /// Its name, for an experiment.
    pub(crate) fn name(&self, identity: &str, experiment: &Kept) -> Result<String, String> {
        let bare = match self {
            Self::Candidate { design, seed, env_steps, .. } => {
                Self::Candidate { design: design.clone(), seed: *seed, env_steps: *env_steps, from: None }
            }
            Self::Training { .. } => Self::Training { from: None },
            other => other.clone(),
        };
        let bytes = postcard::to_stdvec(&(identity, &experiment.hash, &bare)).map_err(|error| error.to_string())?;
        Ok(hash(&bytes))
    }
}

/// What became of a job.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Envelope {
    /// The job's name.
    pub(crate) job: String,
    /// Who did it.
    pub(crate) worker: String,
    /// Seconds of a processor, or nearly.
    pub(crate) seconds: f64,
    /// A packed `Result<Answer, CollectError>`, or a packed [`TrainingAnswer`].
    pub(crate) content: Payload,
}

/// The content of an [`Envelope`].
pub(crate) type Content = Result<Answer, CollectError>;

/// What a training came to.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) enum TrainingAnswer {
    /// Its end.
    Trained(#[serde(with = "as_json")] Box<Trained>),
    /// A failure that would come again, in words.
    Failed(String),
    /// It could not be begun here.
    Setup(String),
}

/// Where a training stood, for whoever goes on with it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct StateNote {
    /// How often the job had been handed out by then.
    pub(crate) delivered: u64,
    /// Iterations done, where it is known.
    pub(crate) iteration: u64,
    /// A packed [`Archive`] of a candidate, a packed [`Checkpoint`] of a training.
    pub(crate) state: Payload,
}

/// News of a training, in order.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct News(pub(crate) Vec<Told>);

/// [`hwasp_training::Event`] as a value.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) enum Told {
    Started {
        env_steps: u64,
        learner: Vec<String>,
        terms: Vec<String>,
        totals: Vec<String>,
    },
    Iteration(Box<MetricsRow>),
    /// A packed [`Checkpoint`].
    Checkpoint {
        iteration: u64,
        state: Payload,
    },
    Failed {
        checkpoint: Box<Checkpoint>,
        batch: Option<Box<Batch>>,
        what: String,
    },
    Evaluating,
    Evaluated(#[serde(with = "as_json")] Box<Evaluation>),
}

/// Packed states of candidates.
pub(crate) type State = Archive;

/// How often a worker says that it is still at a job.
pub(crate) const PROGRESS: Duration = Duration::from_secs(4);
/// How long the queue waits for that before it hands the job to another one.
pub(crate) const ACK_WAIT: Duration = Duration::from_secs(15);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_comes_from_elsewhere_cannot_claim_more_than_it_may_be() {
        let zeros = vec![0_u8; 1 << 20];
        let packed = pack(&zeros).unwrap();
        assert_eq!(unpack::<Vec<u8>>(&packed).unwrap(), zeros, "the most that compression does");
        let huge = [&(1_u32 << 29).to_le_bytes()[..], &packed[4..40]].concat();
        assert!(unpack::<Vec<u8>>(&huge).unwrap_err().contains("that may be"));
        for cut in 0..packed.len().min(64) {
            assert!(unpack::<Vec<u8>>(&packed[..cut]).is_err());
        }
    }
}
