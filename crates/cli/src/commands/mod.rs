//! One file per command.

pub(crate) mod check;
pub(crate) mod eval;
pub(crate) mod graph;
pub(crate) mod list;
pub(crate) mod plot;
pub(crate) mod train;

use hwasp_core::{Executor, Serial, Threads};
use hwasp_lab::spec::{self, Spec};
use std::num::NonZeroUsize;

use crate::Failure;
use crate::args::ExperimentArgs;

/// The experiment that arguments name, with further settings on top.
fn experiment(args: &ExperimentArgs, further: &[(&str, String)]) -> Result<Spec, Failure> {
    let mut layers = spec::load(&args.experiment)?;
    for assignment in args.set() {
        layers = layers.with_assignment(assignment);
    }
    for (flag, value) in further {
        let key = if *flag == "env-steps" { "train.env_steps" } else { flag };
        layers = layers.with_option(format!("--{flag} {value}"), key, value);
    }
    Ok(spec::resolve(layers, args.method())?)
}

fn executor(threads: NonZeroUsize) -> Result<Box<dyn Executor>, Failure> {
    if threads.get() == 1 { Ok(Box::new(Serial)) } else { Ok(Box::new(Threads::new(threads.get())?)) }
}
