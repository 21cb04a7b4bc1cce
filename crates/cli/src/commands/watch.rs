//! `hwasp watch`, and the page of `hwasp train --watch`.

use std::net::TcpListener;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use hwasp_experiment::Catalogue;
use hwasp_live::{Options, Server, listen};

use super::stop_on_signal;
use crate::args::{Place, WatchArgs};
use crate::output;
use hwasp_session::Failure;

/// How often it is looked whether somebody wants it to end.
const PAUSE: Duration = Duration::from_millis(100);

pub(crate) fn run(args: &WatchArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    for path in &args.runs {
        if path.is_file() {
            return Err(Failure::input(format!("{} is not a folder", path.display()))
                .hint("name run folders, or folders that hold some; `hwasp train` writes them under runs/"));
        }
    }
    let stop = stop_on_signal()?;
    let listener = listener(args.place())?;
    let server = serve(listener, args.runs.clone(), args.hosts.clone(), catalogue)?;
    output::print(&format!("{}\n", server.url()))?;
    for path in args.runs.iter().filter(|path| !path.exists()) {
        output::remark(&format!(
            "note: {} is not there yet; it appears on the page when training begins",
            path.display()
        ));
    }
    output::remark("Ctrl-C ends it");
    wait(&stop);
    Ok(())
}

/// Listens where it was asked for.
pub(crate) fn listener(place: Place) -> Result<TcpListener, Failure> {
    let (address, others) = place.asked();
    let hint = "name another port; 0 takes one that is free";
    listen(address, others).map_err(|error| Failure::input(error).hint(hint))
}

/// Serves the page of some runs.
pub(crate) fn serve(
    listener: TcpListener,
    runs: Vec<PathBuf>,
    names: Vec<String>,
    catalogue: &Catalogue,
) -> Result<Server, Failure> {
    let server = Server::start(listener, Options { runs, names }, catalogue)?;
    if server.token().is_some() {
        output::remark(&format!(
            "note: {} can be reached from other machines; whoever has the address with its token sees the runs. They open it by \
             this machine's address, or by a name that --host names",
            server.address()
        ));
    }
    Ok(server)
}

/// Waits until somebody wants it to end.
pub(crate) fn wait(stop: &AtomicBool) {
    while !stop.load(Ordering::Relaxed) {
        std::thread::sleep(PAUSE);
    }
}
