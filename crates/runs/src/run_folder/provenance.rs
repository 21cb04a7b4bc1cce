//! Where a run came from.

use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

/// Where a run came from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// The program's version.
    pub hwasp_version: String,
    /// What was typed.
    pub command_line: Vec<String>,
    /// Seconds since 1970, UTC.
    pub started_unix_s: u64,
    /// Operating system and processor family.
    pub platform: String,
    /// The vector instructions that were used.
    pub vector_instructions: String,
    /// Threads that episodes ran on; they do not change the result.
    pub threads: usize,
    /// The root seed.
    pub seed: u64,
    /// Where it was resumed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub resumed: Vec<Self>,
}

impl Provenance {
    /// Of a training that begins now.
    pub fn new(command_line: Vec<String>, threads: usize, seed: u64) -> Self {
        Self {
            hwasp_version: env!("CARGO_PKG_VERSION").to_owned(),
            command_line,
            started_unix_s: SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs()),
            platform: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            vector_instructions: hwasp_diff::fast::instructions(),
            threads,
            seed,
            resumed: Vec::new(),
        }
    }
}
