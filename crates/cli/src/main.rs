//! `hwasp`: design a robot's body and its controller together.

#![forbid(unsafe_code)]

mod args;
mod commands;
mod failure;
mod grid_progress;
mod log;
mod output;
mod progress;
mod report;

use std::process::ExitCode;

use clap::Parser;

use args::{Args, Command};

fn main() -> ExitCode {
    let args = Args::parse();
    log::begin(args.log_format, args.log_level, args.command.quiet());
    let result = match &args.command {
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
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            tracing::error!("{}", failure.text());
            failure.exit_code()
        }
    }
}
