use thiserror::Error;

use super::FORMAT_VERSION;

/// Why a checkpoint is of no use.
#[derive(Debug, Error)]
pub enum CheckpointError {
    /// It is not safetensors.
    #[error("it is damaged, or not in the safetensors format: {0}")]
    Format(#[from] safetensors::SafeTensorError),
    /// It is safetensors, but no checkpoint.
    #[error("it is not a checkpoint of hwasp: its metadata has no `hwasp_checkpoint`")]
    NotOne,
    /// The header is no JSON, or lacks something.
    #[error("its header cannot be read: {0}")]
    Header(String),
    /// Bytes have changed since it was written.
    #[error("it is damaged: the checksum does not fit its contents")]
    Checksum,
    /// It is of a format that is not known.
    #[error(
        "its format has version {version} (written by hwasp {hwasp_version}), and this program knows versions 1 to \
         {FORMAT_VERSION}; resume with a program as new as the one that wrote it"
    )]
    Version {
        /// Of its format.
        version: u32,
        /// What wrote it.
        hwasp_version: String,
    },
    /// It is of another experiment.
    #[error(
        "it belongs to another experiment, or to one with other settings (written by hwasp {hwasp_version}); resume with \
         the experiment.toml that it was written with"
    )]
    Experiment {
        /// What wrote it.
        hwasp_version: String,
    },
    /// An array of a kind that checkpoints do not have.
    #[error("its array `{name}` is {found}, which is no array of a checkpoint")]
    Array {
        /// Its name.
        name: String,
        /// Kind and shape.
        found: String,
    },
}
