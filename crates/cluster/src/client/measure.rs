//! What a queue and its workers are able to do, measured: the numbers by which one says how far it scales.

use std::time::{Duration, Instant};

use futures_util::{StreamExt, stream};
use hwasp_training::collect::CollectError;
use serde::Serialize;

use super::ask::{Asker, Need};
use super::{Cluster, RunName};
use crate::error::ClusterError;
use crate::identity::Identity;
use crate::message::{Class, Task};
use crate::server::Server;

/// Empty jobs that are asked for at once.
const AT_ONCE: usize = 256;
/// Bytes that go there and back.
const BYTES: usize = 16 << 20;

/// What a queue and its workers are able to do.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Measured {
    /// Workers that were there.
    pub workers: usize,
    /// Jobs that they do at once.
    pub slots: usize,
    /// One empty job there and back, median, ms.
    pub job_ms: f64,
    /// Empty jobs in a second, many at once.
    pub jobs_per_s: f64,
    /// Megabytes in a second that the server takes and keeps.
    pub up_mb_per_s: f64,
    /// Megabytes in a second that it gives.
    pub down_mb_per_s: f64,
}

/// Floods workers with so many jobs that do nothing.
///
/// # Errors
/// Where there is no server, or no worker answers within `patience`.
pub fn measure(server: &Server, identity: Identity, jobs: u64, patience: Duration) -> Result<Measured, ClusterError> {
    let cluster = Cluster::connect(server, identity, RunName::once(), patience)?;
    let (workers, slots) = cluster.workers();
    let asker = cluster.asker.clone();
    let measured = cluster.wait(async move { flood(&asker, jobs).await }).unwrap_or(Err(CollectError::Interrupted));
    cluster.finish();
    let [job_ms, jobs_per_s, up_mb_per_s, down_mb_per_s] = measured?;
    Ok(Measured { workers, slots, job_ms, jobs_per_s, up_mb_per_s, down_mb_per_s })
}

async fn flood(asker: &Asker, jobs: u64) -> Result<[f64; 4], CollectError> {
    let (names, need) = asker.put_always(Class::Run, b"nothing".to_vec()).await?;
    let needs: [Need; 1] = [need];
    let ask = |i: u64| {
        let (needs, job) = (&needs, asker.job(names.clone(), Task::Nothing(i)));
        async move { asker.ask(&job?, needs).await.map(drop) }
    };
    let mut times = Vec::new();
    for i in 0..jobs.min(51) {
        let began = Instant::now();
        ask(u64::MAX - i).await?;
        times.push(began.elapsed().as_secs_f64() * 1e3);
    }
    times.sort_by(f64::total_cmp);
    let began = Instant::now();
    let mut asked = stream::iter(0..jobs).map(ask).buffer_unordered(AT_ONCE);
    while let Some(answered) = asked.next().await {
        answered?;
    }
    let jobs_per_s = jobs as f64 / began.elapsed().as_secs_f64();
    // Noise: nothing on the way can make it smaller.
    let mut word = 1_u64;
    let noise = std::iter::repeat_with(|| {
        word = word.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (word >> 56) as u8
    });
    let bytes: Vec<u8> = noise.take(BYTES).collect();
    let began = Instant::now();
    let (kept, _) = asker.put_always(Class::Run, bytes).await?;
    let up = began.elapsed().as_secs_f64();
    let began = Instant::now();
    let back = asker.store.kept(&asker.run, &kept).await;
    back.map_err(|error| CollectError::Unanswered(error.to_string()))?;
    let megabytes = BYTES as f64 / 1e6;
    Ok([times[times.len() / 2], jobs_per_s, megabytes / up, megabytes / began.elapsed().as_secs_f64()])
}
