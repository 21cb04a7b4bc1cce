//! Past one machine: episodes, candidates and trainings on workers that take jobs from a queue.
//!
//! The queue is NATS with `JetStream`. Jobs are functions of what they hold (experiment, parameters, episodes, names of streams), so that
//! it does not matter who does one, or how often: delivery at least once gives the bits of one machine.
//!
//! ```text
//!   train, compare, eval …                 server                       worker
//!   RemoteCollector, RemoteTrainer ──▶ HWASP_JOBS  (work queue) ──▶  serve: pulls one job for each thread
//!          ▲         kept values  ──▶ HWASP_DATA                          │ tells every few seconds that it is at it
//!          └── answers, news ◀─────── HWASP_DATA  ◀── answer, then acknowledgement
//! ```
//!
//! What is lost is asked for again, whoever lost it: a job is done when its answer is kept, and not before.

#![forbid(unsafe_code)]

mod client;
mod error;
mod identity;
mod local;
mod message;
mod server;
mod slurm;
mod status;
mod store;
mod subjects;
mod worker;

pub use client::{Cluster, Measured, RemoteCollector, RunName, measure};
pub use error::ClusterError;
pub use identity::Identity;
pub use local::{LocalServer, ServerOptions, Stored};
pub use server::Server;
pub use slurm::{Scripts, SlurmOptions};
pub use status::{Status, status};
pub use worker::{Card, Served, WorkerOptions, serve};
