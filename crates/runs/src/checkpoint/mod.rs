//! Checkpoints as files. A training that goes on from one gets the bits of a training that was never interrupted.
//!
//! A checkpoint is a safetensors file, which cannot run code: the arrays of an [`Archive`] with their names, and in its
//! metadata, under `hwasp_checkpoint`, a JSON [`Header`] with the version of the format, the hash of the experiment and a
//! checksum over all the rest. The state before an iteration that failed is a checkpoint too, with the batch beside it.

mod batch;
mod error;

use std::collections::HashMap;
use std::fmt::Write;

use hwasp_algos::{Archive, Array};
use hwasp_training::Checkpoint;
use safetensors::tensor::{Dtype, TensorView};
use safetensors::{SafeTensors, serialize};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::tensors::check_header;

pub(crate) use batch::{batch_arrays, has_batch, has_this_batch};
pub use error::CheckpointError;

/// The version that is written. Versions: 1, since 0.2.
pub const FORMAT_VERSION: u32 = 1;
/// The largest checkpoint that is read, bytes: a full covariance over 8000 parameters, and some.
pub const LARGEST_CHECKPOINT: u64 = 2 << 30;

const KEY: &str = "hwasp_checkpoint";

/// What is known of a checkpoint before its arrays are looked at.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// Of the format.
    pub version: u32,
    /// Of the program that wrote it.
    pub hwasp_version: String,
    /// SHA-256 of the resolved experiment.
    pub experiment: String,
    /// Iterations done.
    pub iteration: u64,
    /// Real simulator steps so far.
    pub env_steps: u64,
    /// The mean undiscounted return of the last iterations; none before the first.
    pub training_return: Option<f64>,
    /// What failed in the iteration that follows, where one did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fault: Option<String>,
    /// SHA-256 of this header without it and of all arrays.
    #[serde(default)]
    pub checksum: String,
}

/// The hash of a resolved experiment.
pub fn experiment_hash(resolved: &str) -> String {
    hex(Sha256::digest(resolved.as_bytes()).as_slice())
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// The kind of an array's numbers, and its bytes.
fn bytes(array: &Array) -> (Dtype, usize, Vec<u8>) {
    match array {
        Array::F32(v) => (Dtype::F32, v.len(), v.iter().flat_map(|x| x.to_le_bytes()).collect()),
        Array::F64(v) => (Dtype::F64, v.len(), v.iter().flat_map(|x| x.to_le_bytes()).collect()),
        Array::U64(v) => (Dtype::U64, v.len(), v.iter().flat_map(|x| x.to_le_bytes()).collect()),
    }
}

/// The array of a tensor, if it is of a kind that is written.
fn array(tensor: &TensorView<'_>) -> Option<Array> {
    let eights = || tensor.data().as_chunks::<8>().0.iter();
    match (tensor.dtype(), tensor.shape().len()) {
        (Dtype::F32, 1) => {
            Some(Array::F32(tensor.data().as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect()))
        }
        (Dtype::F64, 1) => Some(Array::F64(eights().map(|b| f64::from_le_bytes(*b)).collect())),
        (Dtype::U64, 1) => Some(Array::U64(eights().map(|b| u64::from_le_bytes(*b)).collect())),
        _ => None,
    }
}

/// Over the header without its checksum, and name, kind, length and bytes of each array in the order of names.
fn checksum<'a>(header: &Header, arrays: impl Iterator<Item = (&'a str, Dtype, &'a [u8])>) -> String {
    let mut hash = Sha256::new();
    let plain = Header { checksum: String::new(), ..header.clone() };
    hash.update(serde_json::to_vec(&plain).unwrap_or_default());
    for (name, kind, bytes) in arrays {
        hash.update(name.as_bytes());
        hash.update(format!("\n{kind:?} {}\n", bytes.len()).as_bytes());
        hash.update(bytes);
    }
    hex(hash.finalize().as_slice())
}

/// A checkpoint as bytes of a file, for the experiment with this hash; `fault`: what failed in the iteration that follows.
pub fn encode(checkpoint: &Checkpoint, experiment: &str, fault: Option<&str>) -> Result<Vec<u8>, CheckpointError> {
    let pieces: Vec<_> = checkpoint.archive.iter().map(|(name, array)| (name, bytes(array))).collect();
    let mut header = Header {
        version: FORMAT_VERSION,
        hwasp_version: env!("CARGO_PKG_VERSION").to_owned(),
        experiment: experiment.to_owned(),
        iteration: checkpoint.iteration,
        env_steps: checkpoint.env_steps,
        training_return: checkpoint.training_return.filter(|r| r.is_finite()),
        fault: fault.map(str::to_owned),
        checksum: String::new(),
    };
    header.checksum = checksum(&header, pieces.iter().map(|(name, (kind, _, b))| (name.as_str(), *kind, &b[..])));
    let views = pieces
        .iter()
        .map(|(name, (kind, length, b))| Ok((name.as_str(), TensorView::new(*kind, vec![*length], b)?)))
        .collect::<Result<Vec<_>, safetensors::SafeTensorError>>()?;
    let text = serde_json::to_string(&header).map_err(|e| CheckpointError::Header(e.to_string()))?;
    Ok(serialize(views, Some(HashMap::from([(KEY.to_owned(), text)])))?)
}

/// A checkpoint from bytes that anyone may have written, if they are one of the experiment with this hash.
pub fn decode(bytes: &[u8], experiment: &str) -> Result<Checkpoint, CheckpointError> {
    let header = Header::read(bytes)?;
    if header.version > FORMAT_VERSION || header.version == 0 {
        let Header { version, hwasp_version, .. } = header;
        return Err(CheckpointError::Version { version, hwasp_version });
    }
    let file = SafeTensors::deserialize(bytes)?;
    let mut tensors = file.tensors();
    tensors.sort_by(|a, b| a.0.cmp(&b.0));
    let found = checksum(&header, tensors.iter().map(|(name, t)| (name.as_str(), t.dtype(), t.data())));
    if found != header.checksum {
        return Err(CheckpointError::Checksum);
    }
    if header.experiment != experiment {
        return Err(CheckpointError::Experiment { hwasp_version: header.hwasp_version });
    }
    let mut archive = Archive::new();
    for (name, tensor) in tensors {
        let Some(array) = array(&tensor) else {
            let (kind, shape) = (tensor.dtype(), tensor.shape());
            return Err(CheckpointError::Array { found: format!("{kind:?} {shape:?}"), name });
        };
        archive.insert(name, array);
    }
    let Header { iteration, env_steps, training_return, .. } = header;
    Ok(Checkpoint { iteration, env_steps, training_return, archive })
}

impl Header {
    /// Of a file, whatever wrote it.
    pub fn read(bytes: &[u8]) -> Result<Self, CheckpointError> {
        check_header(bytes)?;
        let (_, metadata) = SafeTensors::read_metadata(bytes)?;
        let text = metadata.metadata().as_ref().and_then(|about| about.get(KEY)).ok_or(CheckpointError::NotOne)?;
        serde_json::from_str(text).map_err(|e| CheckpointError::Header(e.to_string()))
    }
}

#[cfg(test)]
mod tests;
