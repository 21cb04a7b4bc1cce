//! What jobs of one run are kept under, so that whoever goes on with it finds them.

use std::time::{SystemTime, UNIX_EPOCH};

use crate::message::hash;

/// The name of a run on the server.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunName(String);

impl RunName {
    /// Of what stays the same when a run is resumed.
    pub fn of(parts: &[String]) -> Self {
        let bytes: Vec<u8> = parts.iter().flat_map(|part| [part.as_bytes(), &[0]].concat()).collect();
        Self(hash(&bytes)[..16].to_owned())
    }

    /// Of something that nobody will go on with.
    pub fn once() -> Self {
        let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_nanos());
        Self::of(&[now.to_string(), std::process::id().to_string()])
    }

    /// As a word.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}
