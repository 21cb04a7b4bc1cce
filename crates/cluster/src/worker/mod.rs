//! `hwasp worker`: takes one job for each thread from the queue, does it, and keeps the answer before it says that it is done.

mod card;
mod service;
mod uploads;
mod work;

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use hwasp_experiment::Catalogue;

use self::service::Service;
use crate::error::ClusterError;
use crate::identity::Identity;
use crate::server::Server;
use crate::store::Store;

#[cfg(test)]
pub(crate) use self::card::AtWork;
pub use self::card::Card;

/// How often it is looked whether it is to end.
const LOOK: Duration = Duration::from_millis(200);
/// How long an answer is tried to be kept. Then the job goes back to the queue.
const PATIENCE: Duration = Duration::from_mins(2);
/// How long it may take to send what is not sent yet.
const FLUSH: Duration = Duration::from_secs(5);

/// Locks a list.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().expect("nothing panics while a list is locked")
}

/// A worker that is asked for.
#[derive(Clone, Debug)]
pub struct WorkerOptions {
    /// Where jobs come from.
    pub server: Server,
    /// What others call it.
    pub name: String,
    /// Jobs at once.
    pub threads: NonZeroUsize,
}

/// What a worker came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Served {
    /// Jobs answered.
    pub jobs: u64,
    /// Seconds that they took.
    pub seconds: f64,
}

/// Serves until `stop` is set: then no further job is taken, short ones come to their end, and what takes long keeps its state, so that
/// another worker goes on with it. `ready` is called once it is connected.
///
/// # Errors
/// Where there is no server, or it has no queue. Later it waits for the server to come back.
pub fn serve(
    options: &WorkerOptions,
    catalogue: &Catalogue,
    identity: Identity,
    stop: &Arc<AtomicBool>,
    ready: &dyn Fn(),
) -> Result<Served, ClusterError> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    runtime.block_on(async {
        let client = options.server.connect(&format!("hwasp worker {}", options.name)).await?;
        let store = Store::open(client, &options.server.address, PATIENCE).await?;
        let service = Service::new(options, store, catalogue, identity, Arc::clone(stop));
        let listeners = service.listen().await?;
        // Whoever is told that it is ready is answered.
        let _ = tokio::time::timeout(FLUSH, service.store.client.flush()).await;
        ready();
        let slots: Vec<_> = (0..options.threads.get()).map(|_| tokio::spawn(Arc::clone(&service).slot())).collect();
        while !stop.load(Ordering::Relaxed) {
            tokio::time::sleep(LOOK).await;
        }
        service.drain();
        tracing::info!("{} takes no further jobs; those at work come to their end, or keep their state", options.name);
        for slot in slots {
            // Nothing in it panics but jobs, and those are caught.
            let _ = slot.await;
        }
        for listener in listeners {
            listener.abort();
        }
        // Acknowledgements may still be on the way.
        let _ = tokio::time::timeout(FLUSH, service.store.client.flush()).await;
        Ok(service.served())
    })
}
