//! What goes wrong between machines.

use std::path::PathBuf;

use hwasp_training::collect::CollectError;
use thiserror::Error;

/// Why there is no cluster, or no answer from it.
#[derive(Debug, Error)]
pub enum ClusterError {
    /// An address that is none.
    #[error(
        "`{address}` is no address of a server: {why}\n  = hint: nats://127.0.0.1:4222, or tls://queue.lab.example:4222; \
         `hwasp cluster up` says the one of a server that it starts"
    )]
    Address {
        /// What was given.
        address: String,
        /// What is wrong with it.
        why: String,
    },
    /// A file that lets somebody in and cannot be used.
    #[error("`{}` cannot be used: {why}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
    /// Nobody listens there, or not for us.
    #[error("no connection to {address}: {why}\n  = hint: {hint}")]
    Connect {
        /// The server.
        address: String,
        /// What happened.
        why: String,
        /// The way out.
        hint: &'static str,
    },
    /// The server does not do what is asked of it.
    #[error(
        "{address} does not answer as a queue should: {why}\n  = hint: it needs JetStream, NATS 2.9 or later; `hwasp cluster up` starts one"
    )]
    Queue {
        /// The server.
        address: String,
        /// What happened.
        why: String,
    },
    /// This process cannot be set up.
    #[error("the connection cannot be served: {0}")]
    Runtime(#[from] std::io::Error),
    /// The identity cannot be computed.
    #[error("what this program computes cannot be told: {0}")]
    Probe(#[from] CollectError),
    /// A server of one's own does not start.
    #[error("the server does not start: {why}\n  = hint: {hint}")]
    Start {
        /// What happened.
        why: String,
        /// The way out.
        hint: String,
    },
}
