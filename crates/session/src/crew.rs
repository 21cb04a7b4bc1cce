//! Who runs episodes and trainings: threads of this process, or workers elsewhere.

use std::io;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
#[cfg(feature = "cluster")]
use std::time::Duration;

#[cfg(feature = "cluster")]
use hwasp_cluster::{Cluster, Identity, RunName, Server};
use hwasp_core::{Executor, Serial};
use hwasp_experiment::Catalogue;
use hwasp_training::collect::CollectError;
use hwasp_training::{Assembly, Collector, Event, LocalCollector, Observer, ObserverError, Trainer};

use crate::failure::Failure;
use crate::given::executor;

/// Workers that are to do the work.
#[derive(Clone, Debug)]
pub struct Elsewhere {
    #[cfg(feature = "cluster")]
    server: Server,
    #[cfg(feature = "cluster")]
    patience: Duration,
}

impl Elsewhere {
    /// Those of a server. `patience`: how long none of them may be heard of.
    #[cfg(feature = "cluster")]
    pub fn new(server: Server, patience: Duration) -> Self {
        Self { server, patience }
    }
}

/// Who runs episodes and trainings. What is asked for elsewhere has the same bits.
pub struct Crew {
    executor: Box<dyn Executor>,
    #[cfg(feature = "cluster")]
    cluster: Option<Cluster>,
}

impl Crew {
    /// Threads, and the workers that were asked for. `run`: what stays the same where a run is resumed, so that what was done before
    /// is found; nothing where nobody will go on with it.
    pub fn new(
        threads: NonZeroUsize,
        elsewhere: Option<&Elsewhere>,
        run: &[String],
        catalogue: &Catalogue,
    ) -> Result<Self, Failure> {
        let executor = executor(threads)?;
        #[cfg(feature = "cluster")]
        {
            let run = if run.is_empty() { RunName::once() } else { RunName::of(run) };
            let connect = |elsewhere: &Elsewhere| {
                let identity = identity(catalogue)?;
                Cluster::connect(&elsewhere.server, identity, run, elsewhere.patience).map_err(Failure::input)
            };
            let cluster = elsewhere.map(connect).transpose()?;
            if let Some(cluster) = &cluster {
                let (workers, slots) = cluster.workers();
                match workers {
                    0 => tracing::info!("no worker is there yet; they may come at any time"),
                    1 => tracing::info!("one worker, {slots} jobs at once"),
                    _ => tracing::info!("{workers} workers, {slots} jobs at once"),
                }
            }
            Ok(Self { executor, cluster })
        }
        #[cfg(not(feature = "cluster"))]
        {
            let _ = (elsewhere, run, catalogue);
            Ok(Self { executor })
        }
    }

    /// Threads of this process.
    pub fn executor(&self) -> &dyn Executor {
        &*self.executor
    }

    /// What answers requests. Where `stop` is set and no worker answers, it gives up after a while.
    pub fn collector<'a>(
        &'a self,
        assembly: &Assembly,
        stop: Option<&'a AtomicBool>,
    ) -> Result<Box<dyn Collector + 'a>, CollectError> {
        #[cfg(feature = "cluster")]
        if let Some(cluster) = &self.cluster {
            return Ok(Box::new(cluster.collector(assembly, self.executor(), stop)?));
        }
        let _ = stop;
        Ok(Box::new(LocalCollector::new(assembly, self.executor())?))
    }

    /// Who trains whole experiments, a thread each.
    pub fn trainer(&self) -> &dyn Trainer {
        #[cfg(feature = "cluster")]
        if let Some(cluster) = &self.cluster {
            return cluster;
        }
        &Serial
    }

    /// Whether workers elsewhere do the work.
    pub fn is_elsewhere(&self) -> bool {
        #[cfg(feature = "cluster")]
        return self.cluster.is_some();
        #[cfg(not(feature = "cluster"))]
        false
    }

    /// The work came to its end, and nobody needs what workers kept of it. Otherwise whoever goes on finds it.
    pub fn finish(&self) {
        #[cfg(feature = "cluster")]
        if let Some(cluster) = &self.cluster {
            cluster.finish();
        }
    }

    /// The work ended before its end: nobody is to go on with it until it is asked for again.
    pub fn stop(&self) {
        #[cfg(feature = "cluster")]
        if let Some(cluster) = &self.cluster {
            cluster.stop();
        }
    }
}

/// After each checkpoint: answers from before the last one are not needed any more.
impl Observer for &Crew {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        #[cfg(feature = "cluster")]
        if let (Event::Checkpoint(_), Some(cluster)) = (event, &self.cluster) {
            cluster.settled();
        }
        let _ = event;
        Ok(())
    }
}

/// A folder's name from the root on, however it was typed: a part of what workers know a run by.
pub fn place(folder: &Path) -> io::Result<String> {
    Ok(std::path::absolute(folder)?.components().collect::<PathBuf>().display().to_string())
}

/// What the bits of this program depend on.
#[cfg(feature = "cluster")]
pub fn identity(catalogue: &Catalogue) -> Result<Identity, Failure> {
    #[cfg(feature = "mujoco")]
    let engine = Some(hwasp_mujoco::engine::version());
    #[cfg(not(feature = "mujoco"))]
    let engine: Option<String> = None;
    Ok(Identity::new(catalogue, engine.as_deref())?)
}
