//! The program `hwasp` as a function, [`run`]. Your own program calls it with more problems in the catalogue.
//!
//! ```no_run
//! use std::process::ExitCode;
//!
//! // Your own problem joins by `.with(Lamp)`; `hwasp init` writes a project with one.
//! fn main() -> ExitCode {
//!     hwasp_cli::run(&hwasp_builtin::catalogue())
//! }
//! ```

#![forbid(unsafe_code)]

mod args;
mod caller;
mod commands;
mod crew;
mod failure;
mod given;
mod grid_progress;
mod log;
mod output;
mod progress;
mod project;
mod report;
mod session;

use std::process::ExitCode;

use clap::Parser;
use hwasp_experiment::Catalogue;

use args::{Args, Command, GREETING, LogFormat, LogLevel};

pub use caller::Caller;
pub use commands::check::checked;
pub use crew::Elsewhere;
pub use failure::Failure;
pub use session::{Session, Training, What};

/// Runs the program: reads its command line, does what it asks for, and says how that went. Experiment files may name what is
/// in the `catalogue`.
pub fn run(catalogue: &Catalogue) -> ExitCode {
    ExitCode::from(obeyed(catalogue))
}

/// The same for a process whose command line is not the program's alone, Python for one. Returns the exit status.
pub fn run_for(caller: Caller, catalogue: &Catalogue) -> u8 {
    caller.remember();
    obeyed(catalogue)
}

fn obeyed(catalogue: &Catalogue) -> u8 {
    let args = match Args::try_parse_from(&Caller::get().words) {
        Ok(args) => args,
        Err(answer) => return answered(&answer),
    };
    let quiet = args.command.as_ref().is_some_and(Command::quiet);
    log::begin(args.log_format, args.log_level, quiet);
    let obeyed = match &args.command {
        Some(command) => obey(command, catalogue),
        None => output::print(GREETING).map_err(Failure::from),
    };
    match obeyed {
        Ok(()) => 0,
        Err(failure) => {
            tracing::error!("{}", failure.text());
            failure.exit_code()
        }
    }
}

/// Help, the version, or what is wrong with the command line. Errors go where all others do, in the form that is asked for.
fn answered(answer: &clap::Error) -> u8 {
    let text = answer.render().to_string();
    if answer.use_stderr() {
        log::begin(LogFormat::typed(), LogLevel::Info, false);
        tracing::error!("{}", text.trim_end());
    } else if let Err(error) = output::print(&text) {
        log::begin(LogFormat::typed(), LogLevel::Info, false);
        tracing::error!("error: {error}");
        return 1;
    }
    answer.exit_code() as u8
}

fn obey(command: &Command, catalogue: &Catalogue) -> Result<(), Failure> {
    match command {
        Command::Train(train) => commands::train::run(train, catalogue),
        Command::Eval(eval) => commands::eval::run(eval, catalogue),
        Command::Design(design) => commands::design::run(design, catalogue),
        Command::Export(export) => commands::export::run(export, catalogue),
        Command::Deploy(deploy) => commands::deploy::run(deploy, catalogue),
        Command::Parts(parts) => commands::parts::run(parts, catalogue),
        Command::Tolerances(tolerances) => commands::tolerances::run(tolerances, catalogue),
        Command::Replay(replay) => commands::replay::run(replay, catalogue),
        Command::Play(play) => commands::play::run(play, catalogue),
        Command::Watch(watch) => commands::watch::run(watch, catalogue),
        Command::Plot(plot) => commands::plot::run(plot, catalogue),
        Command::Report(report) => commands::report::run(report, catalogue),
        Command::Compare(compare) => commands::compare::run(compare, catalogue),
        Command::Reproduce(reproduce) => commands::reproduce::run(reproduce, catalogue),
        #[cfg(feature = "cluster")]
        Command::Worker(worker) => commands::worker::run(worker, catalogue),
        #[cfg(feature = "cluster")]
        Command::Cluster(cluster) => commands::cluster::run(cluster),
        Command::Check(check) => commands::check::run(check, catalogue),
        Command::Schema(schema) => commands::schema::run(schema, catalogue),
        Command::List => commands::list::run(catalogue),
        Command::Laws => commands::laws::run(),
        Command::Graph(graph) => commands::graph::run(graph, catalogue),
        Command::Init(init) => commands::init::run(init, catalogue),
    }
}
