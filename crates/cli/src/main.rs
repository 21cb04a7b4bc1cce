//! `hwasp`: design a robot's body and its controller together.

#![allow(clippy::print_stdout, clippy::print_stderr)] // this crate is the one that prints

mod args;
mod commands;
mod progress;
mod report;

use std::process::ExitCode;

use clap::Parser;

use args::{Args, Command};

/// Any error, shown with its causes.
type Failure = Box<dyn std::error::Error>;

fn main() -> ExitCode {
    let args = Args::parse();
    let result = match &args.command {
        Command::Train(train) => commands::train::run(train),
        Command::Eval(eval) => commands::eval::run(eval),
        Command::Plot(plot) => commands::plot::run(plot),
        Command::Check(check) => commands::check::run(check),
        Command::List => commands::list::run(),
        Command::Graph(graph) => commands::graph::run(graph),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{}", report::failure(&*error));
            // 2 is for input that was wrong from the start, as for wrong arguments.
            ExitCode::from(if error.is::<hwasp_lab::spec::SpecErrors>() { 2 } else { 1 })
        }
    }
}
