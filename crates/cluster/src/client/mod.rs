//! Who asks: the side of trainings, comparisons and evaluations.

mod ask;
mod collector;
mod crew;
mod long;
mod measure;
mod run;
mod trainer;
mod waiting;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::RecvTimeoutError;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use hwasp_core::Executor;
use hwasp_training::Assembly;
use hwasp_training::collect::CollectError;
use tokio::runtime::Handle;
use tokio::sync::oneshot;

use self::ask::Asker;
pub use self::collector::RemoteCollector;
pub(crate) use self::crew::call;
pub use self::measure::{Measured, measure};
pub use self::run::RunName;
use crate::error::ClusterError;
use crate::identity::Identity;
use crate::server::Server;
use crate::store::Store;

/// How long a server that is away, or full, is waited for before an error.
const STORE_PATIENCE: Duration = Duration::from_mins(10);

/// How often it is looked whether somebody wants a wait to end.
const LOOK: Duration = Duration::from_millis(100);
/// How long an answer is waited for after that: most come, and then an iteration is done.
const GRACE: Duration = Duration::from_secs(10);

/// A connection to workers, for one run. It may be shared by threads.
pub struct Cluster {
    asker: Arc<Asker>,
    handle: Handle,
    /// Ends the thread that serves the connection when it is dropped.
    over: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Cluster {
    /// Connects. `patience`: how long nothing may be heard of any worker before what waits for an answer ends in an error.
    ///
    /// # Errors
    /// Where there is no server, or it has no queue.
    pub fn connect(
        server: &Server,
        identity: Identity,
        run: RunName,
        patience: Duration,
    ) -> Result<Self, ClusterError> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let handle = runtime.handle().clone();
        let asker = runtime.block_on(async {
            let client = server.connect(&format!("hwasp {}", run.as_str())).await?;
            let store = Store::open(client, &server.address, STORE_PATIENCE).await?;
            Asker::new(store, identity, run, patience, (&server.address, &server.options())).await
        })?;
        let (over, ends) = oneshot::channel();
        let serve = move || {
            runtime.block_on(async {
                let _ = ends.await;
            });
            // What still waits for the network does not hold the program up.
            runtime.shutdown_timeout(Duration::from_millis(200));
        };
        let thread = std::thread::Builder::new().name("cluster".into()).spawn(serve)?;
        Ok(Self { asker, handle, over: Some(over), thread: Some(thread) })
    }

    /// What answers requests about experiments; `assembly` is the one that most of them are about, and `executor` answers what takes
    /// less time than the way to a worker. Where `stop` is set and no answer comes, it gives up after a while
    /// ([`CollectError::Interrupted`]).
    ///
    /// # Errors
    /// [`CollectError::Setup`] where the experiment cannot be written as a text.
    pub fn collector<'a>(
        &'a self,
        assembly: &Assembly,
        executor: &'a dyn Executor,
        stop: Option<&'a AtomicBool>,
    ) -> Result<RemoteCollector<'a>, CollectError> {
        RemoteCollector::new(self, assembly, executor, stop)
    }

    /// Workers that answered the last call: how many, and how many jobs they do at once.
    pub fn workers(&self) -> (usize, usize) {
        let crew = self.asker.crew();
        (crew.workers, crew.slots)
    }

    /// All that is needed to go on is in a checkpoint by now: answers from before the last one are not kept any longer.
    pub fn settled(&self) {
        let asker = Arc::clone(&self.asker);
        self.handle.spawn(async move { asker.settle().await });
    }

    /// Ends the work on this run: jobs that wait are removed, and those at work keep their state. To go on later asks for them again.
    pub fn stop(&self) {
        self.wait(self.asker.clone().stop_run());
    }

    /// The run is over: nothing of it is kept.
    pub fn finish(&self) {
        self.wait(self.asker.clone().forget_run());
    }

    /// Runs a future on the thread of the connection, and waits for it.
    fn wait<T: Send + 'static>(&self, work: impl Future<Output = T> + Send + 'static) -> Option<T> {
        self.wait_unless(None, work)
    }

    /// The same, and none where `stop` is set and nothing comes for a while.
    fn wait_unless<T: Send + 'static>(
        &self,
        stop: Option<&AtomicBool>,
        work: impl Future<Output = T> + Send + 'static,
    ) -> Option<T> {
        let (sender, receiver) = std::sync::mpsc::channel();
        let task = self.handle.spawn(async move {
            // Whoever waited may be gone.
            let _ = sender.send(work.await);
        });
        let mut stopped: Option<Instant> = None;
        loop {
            match receiver.recv_timeout(LOOK) {
                Ok(output) => return Some(output),
                Err(RecvTimeoutError::Disconnected) => return None,
                Err(RecvTimeoutError::Timeout) if stop.is_some_and(|stop| stop.load(Ordering::Relaxed)) => {
                    if stopped.is_none() {
                        tracing::info!(
                            "answers that are on the way are waited for, 10 s at most; Ctrl-C again ends at once"
                        );
                    }
                    if stopped.get_or_insert_with(Instant::now).elapsed() > GRACE {
                        task.abort();
                        return None;
                    }
                }
                Err(RecvTimeoutError::Timeout) => {}
            }
        }
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        if let Some(over) = self.over.take() {
            let _ = over.send(());
        }
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
