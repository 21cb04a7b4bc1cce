//! Who is there, and what waits.

use std::collections::BTreeMap;
use std::time::Duration;

use serde::Serialize;

use crate::client::call;
use crate::error::ClusterError;
use crate::server::Server;
use crate::store::Store;
use crate::subjects;
use crate::worker::Card;

/// A worker is slow if it does so much less in a second at work than half of the workers do.
const SLOW: f64 = 0.5;

/// Queue and workers.
#[derive(Clone, Debug, Serialize)]
pub struct Status {
    /// The server.
    pub address: String,
    /// The server's own version.
    pub server_version: String,
    /// Jobs that wait for a worker.
    pub waiting: u64,
    /// Jobs that workers are at.
    pub at_work: u64,
    /// What is kept, bytes.
    pub kept_bytes: u64,
    /// Runs that something is kept of: messages of each.
    pub runs: BTreeMap<String, u64>,
    /// Milliseconds there and back.
    pub round_trip_ms: f64,
    /// The workers, by name.
    pub workers: Vec<Worker>,
}

/// A worker and its rates.
#[derive(Clone, Debug, Serialize)]
pub struct Worker {
    /// What it says of itself.
    #[serde(flatten)]
    pub card: Card,
    /// Jobs in a minute since it began.
    pub jobs_per_minute: f64,
    /// Mean seconds of its jobs; none before the first.
    pub job_s: Option<f64>,
    /// Whether its jobs take more than twice as long as those of half of the workers.
    pub slow: bool,
}

/// Asks server and workers.
///
/// # Errors
/// Where there is no server, or it has no queue.
pub fn status(server: &Server) -> Result<Status, ClusterError> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let status = runtime.block_on(ask(server));
    runtime.shutdown_timeout(Duration::from_millis(200));
    status
}

async fn ask(server: &Server) -> Result<Status, ClusterError> {
    let queue = |why: String| ClusterError::Queue { address: server.address.clone(), why };
    let client = server.connect("hwasp cluster status").await?;
    let store = Store::open(client, &server.address, Duration::ZERO).await?;
    let cards = call(&store, None).await.map_err(queue)?;
    let jobs = store.jobs().await.map_err(queue)?;
    let messages = jobs.get_info().await.map_err(|error| queue(error.to_string()))?.state.messages;
    let round_trip_ms = store.round_trip.as_secs_f64() * 1e3;
    // As workers say: what was given back counts as waiting at once.
    let at_work = cards.iter().map(|card| card.at_work.len() as u64).sum();
    let data = store.data().await.map_err(queue)?;
    let mut found = data.info_with_subjects(subjects::ALL_DATA).await.map_err(|error| queue(error.to_string()))?;
    let mut runs = BTreeMap::new();
    while let Some(Ok((subject, count))) = futures_util::StreamExt::next(&mut found).await {
        if let Some(run) = subject.split('.').nth(2) {
            *runs.entry(run.to_owned()).or_default() += count as u64;
        }
    }
    let kept_bytes = data.get_info().await.map_err(|error| queue(error.to_string()))?.state.bytes;
    Ok(Status {
        address: server.address.clone(),
        server_version: store.client.server_info().version,
        waiting: messages.saturating_sub(at_work),
        at_work,
        kept_bytes,
        runs,
        round_trip_ms,
        workers: rated(cards),
    })
}

/// Workers with their rates.
fn rated(cards: Vec<Card>) -> Vec<Worker> {
    let mean = |card: &Card| (card.jobs > 0).then(|| card.busy_s / card.jobs as f64);
    let mut times: Vec<f64> = cards.iter().filter_map(mean).collect();
    times.sort_by(f64::total_cmp);
    let median = times.get(times.len() / 2).copied();
    let rate = |card: Card| {
        let job_s = mean(&card);
        let slow = job_s.zip(median).is_some_and(|(own, median)| own * SLOW > median);
        Worker { jobs_per_minute: 60.0 * card.jobs as f64 / card.up_s.max(1.0), job_s, slow, card }
    };
    cards.into_iter().map(rate).collect()
}
