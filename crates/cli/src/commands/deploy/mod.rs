//! `hwasp deploy`.

mod answers;
#[cfg(feature = "mujoco")]
mod bench;
mod calibrate;
mod check;
#[cfg(feature = "mujoco")]
mod identify;
mod init;
#[cfg(feature = "mujoco")]
mod rehearse;
#[cfg(feature = "mujoco")]
mod replay;
mod run;
mod trials;

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use hwasp_deploy::DeployError;
use hwasp_deploy::rig::Rig;
use hwasp_experiment::Catalogue;
use hwasp_export::Deployed;

use super::run_folder;
use crate::args::{DeployArgs, DeployCommand, RigArgs};
use hwasp_session::Failure;

pub(crate) fn run(args: &DeployArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    match &args.command {
        DeployCommand::Init(init) => init::run(init),
        DeployCommand::Check(check) => check::run(check),
        DeployCommand::Calibrate(calibrate) => calibrate::run(calibrate, catalogue),
        DeployCommand::Run(run) => run::run(run, catalogue),
        DeployCommand::Trials(trials) => trials::run(trials, catalogue),
        #[cfg(feature = "mujoco")]
        DeployCommand::Bench { settings } => bench::run(settings),
        #[cfg(not(feature = "mujoco"))]
        DeployCommand::Bench { .. } => Err(no_engine()),
        #[cfg(feature = "mujoco")]
        DeployCommand::Rehearse(args) => rehearse::run(args, catalogue),
        #[cfg(feature = "mujoco")]
        DeployCommand::Replay(args) => replay::run(args, catalogue),
        #[cfg(feature = "mujoco")]
        DeployCommand::Identify(args) => identify::run(args, catalogue),
        #[cfg(not(feature = "mujoco"))]
        DeployCommand::Rehearse(_) | DeployCommand::Replay(_) | DeployCommand::Identify(_) => Err(no_engine()),
    }
}

/// What a program without the engine says.
#[cfg(not(feature = "mujoco"))]
fn no_engine() -> Failure {
    Failure::input("this program was built without the MuJoCo engine: build it with the feature \"mujoco\"")
}

/// The rig that was named.
fn rig(args: &RigArgs) -> Result<Rig, Failure> {
    Rig::open(&args.rig).map_err(Failure::input)
}

/// The trained controller of a run.
fn deployed(run: &Path, catalogue: &Catalogue) -> Result<Deployed, Failure> {
    Deployed::open(run_folder(run)?, catalogue).map_err(|error| Failure::input(DeployError::Run(error)))
}

/// Counts how often a person asked to stop. To be called once.
fn interrupts() -> Result<Arc<AtomicU32>, ctrlc::Error> {
    let count = Arc::new(AtomicU32::new(0));
    let own = Arc::clone(&count);
    ctrlc::set_handler(move || {
        // Nobody waits for ever for a program that does not listen.
        if own.fetch_add(1, Ordering::Relaxed) >= 3 {
            std::process::exit(130);
        }
    })?;
    Ok(count)
}
