//! The program `hwasp`, to be called: a program of one's own is this one with further problems.
//!
//! ```no_run
//! use std::process::ExitCode;
//!
//! use hwasp_training::spec::OwnProblem;
//!
//! fn problem() -> OwnProblem {
//!     # unimplemented!()
//!     // a law, a plant and a task: `hwasp init` writes one to begin with
//! }
//!
//! fn main() -> ExitCode {
//!     hwasp_cli::run([problem()])
//! }
//! ```

#![forbid(unsafe_code)]

mod args;
mod commands;
mod failure;
mod grid_progress;
mod log;
mod output;
mod progress;
mod project;
mod report;

use std::process::ExitCode;

use clap::Parser;
use hwasp_training::spec::{self, OwnProblem};

use args::{Args, Command};
use failure::Failure;

/// Runs the program: reads its command line, does what it asks for, and says how that went. Experiment files may name the
/// `problems` beside those that come with the program.
pub fn run(problems: impl IntoIterator<Item = OwnProblem>) -> ExitCode {
    let args = Args::parse();
    log::begin(args.log_format, args.log_level, args.command.quiet());
    match spec::register(problems).map_err(Failure::from).and_then(|()| obey(&args.command)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            tracing::error!("{}", failure.text());
            failure.exit_code()
        }
    }
}

fn obey(command: &Command) -> Result<(), Failure> {
    match command {
        Command::Train(train) => commands::train::run(train),
        Command::Eval(eval) => commands::eval::run(eval),
        Command::Design(design) => commands::design::run(design),
        Command::Export(export) => commands::export::run(export),
        Command::Parts(parts) => commands::parts::run(parts),
        Command::Tolerances(tolerances) => commands::tolerances::run(tolerances),
        Command::Replay(replay) => commands::replay::run(replay),
        Command::Play(play) => commands::play::run(play),
        Command::Plot(plot) => commands::plot::run(plot),
        Command::Report(report) => commands::report::run(report),
        Command::Compare(compare) => commands::compare::run(compare),
        Command::Reproduce(reproduce) => commands::reproduce::run(reproduce),
        Command::Check(check) => commands::check::run(check),
        Command::List => commands::list::run(),
        Command::Graph(graph) => commands::graph::run(graph),
        Command::Init(init) => commands::init::run(init),
    }
}
