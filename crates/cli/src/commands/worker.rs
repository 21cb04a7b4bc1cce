//! `hwasp worker`.

use std::io::Read;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use hwasp_cluster::{WorkerOptions, serve};
use hwasp_experiment::Catalogue;

use super::stop_on_signal;
use crate::args::WorkerArgs;
use crate::{log, output};
use hwasp_session::Failure;
use hwasp_session::identity;

pub(crate) fn run(args: &WorkerArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let stop = stop_on_signal()?;
    if args.until_input_ends {
        end_with_input(Arc::clone(&stop));
    }
    let threads = args.threads.or_else(|| std::thread::available_parallelism().ok()).unwrap_or(NonZeroUsize::MIN);
    let name = args.name.clone().unwrap_or_else(own_name);
    let options = WorkerOptions { server: args.connect.server(&args.server), name, threads };
    let ready = || {
        log::with_times();
        output::remark(&format!("{} takes jobs from {}, {threads} at once; Ctrl-C ends it", options.name, args.server));
    };
    let served = serve(&options, catalogue, identity(catalogue)?, &stop, &ready).map_err(Failure::input)?;
    output::remark(&format!("{} did {} jobs", options.name, served.jobs));
    Ok(())
}

/// Sets `stop` when standard input ends.
fn end_with_input(stop: Arc<AtomicBool>) {
    std::thread::spawn(move || {
        let _ = std::io::stdin().read_to_end(&mut Vec::new());
        stop.store(true, Ordering::Relaxed);
    });
}

/// This machine's name and the number of the process.
fn own_name() -> String {
    let host = std::fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    let host = host.trim();
    let host = if host.is_empty() { "worker" } else { host };
    format!("{host}-{}", std::process::id())
}
