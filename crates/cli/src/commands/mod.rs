//! One file per command.

mod begin;
mod changes;
pub(crate) mod check;
#[cfg(feature = "cluster")]
pub(crate) mod cluster;
pub(crate) mod compare;
pub(crate) mod deploy;
pub(crate) mod design;
pub(crate) mod eval;
pub(crate) mod export;
pub(crate) mod graph;
pub(crate) mod init;
pub(crate) mod laws;
pub(crate) mod list;
pub(crate) mod parts;
pub(crate) mod play;
pub(crate) mod plot;
pub(crate) mod replay;
pub(crate) mod report;
pub(crate) mod reproduce;
pub(crate) mod schema;
pub(crate) mod tolerances;
pub(crate) mod train;
pub(crate) mod watch;
#[cfg(feature = "cluster")]
pub(crate) mod worker;

use std::io;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use hwasp_experiment::{Catalogue, Experiment, Layers, load, resolve};
use hwasp_training::{Assembly, StandInKind};

use crate::args::{LawRateArg, NearerArgs, SettingsArgs};
use crate::caller::Caller;
use hwasp_session::{Failure, OTHER_FILE};
use hwasp_session::{executor, run_folder, saved_run};

/// An experiment with settings on top: those of `--set`, then further options by their flags.
fn layers(
    experiment: &str,
    set: &[String],
    further: &[(&str, String)],
    catalogue: &Catalogue,
) -> Result<Layers, Failure> {
    let mut layers = load(experiment, catalogue).map_err(Failure::input)?;
    for assignment in set {
        layers = layers.with_assignment(assignment);
    }
    for (flag, value) in further {
        let key = if *flag == "env-steps" { "train.env_steps" } else { flag };
        layers = layers.with_option(format!("--{flag} {value}"), key, value);
    }
    Ok(layers)
}

/// What was typed. Folders may be called what is no UTF-8.
fn typed() -> Vec<String> {
    Caller::get().words.iter().map(|arg| arg.to_string_lossy().into_owned()).collect()
}

/// The experiment that arguments name, with further settings on top, put together.
fn experiment(
    name: &str,
    set: &SettingsArgs,
    further: &[(&str, String)],
    catalogue: &Catalogue,
) -> Result<(Experiment, Assembly), Failure> {
    let layers = layers(name, set.set(), further, catalogue)?;
    let spec = resolve(layers, set.method(), catalogue).map_err(Failure::input)?;
    let assembly = Assembly::new(&spec).map_err(Failure::input)?;
    Ok((spec, assembly))
}

/// The world nearer to the built robot that was asked for, if one was.
fn stand_in(asked: &NearerArgs, assembly: &Assembly) -> Result<Option<StandInKind>, Failure> {
    let asked = match (asked.native_tendons, asked.law_rate) {
        (true, _) => StandInKind::NativeTendons,
        (false, LawRateArg::Physics) => StandInKind::FastLaw,
        (false, LawRateArg::Step) => return Ok(None),
    };
    let task = &assembly.experiment().task;
    let there = task.built().stand_in.as_ref().map(|stand_in| stand_in.kind);
    if there == Some(asked) {
        return Ok(there);
    }
    let wanted = match asked {
        StandInKind::NativeTendons => "world with tendons in the place of its law; z-grasp and 3d-grasp have one",
        StandInKind::FastLaw => "world with its law at the rate of the physics; model has one, where it has a law",
    };
    let error = Failure::input(format!("{} has no {wanted}", task.name()));
    Err(match there {
        Some(StandInKind::NativeTendons) => error.hint("--native-tendons is nearer to the built robot here"),
        Some(StandInKind::FastLaw) => error.hint("--law-rate physics is nearer to the built robot here"),
        None => error,
    })
}

/// Writes a file that --out names.
fn write_out(path: &Path, text: &str) -> Result<(), Failure> {
    std::fs::write(path, text).map_err(|error| unwritten(path, &error))
}

/// Whether a file can be written there: asked before the work whose result it takes.
fn writable(path: &Path) -> Result<(), Failure> {
    let there = path.exists();
    let opened = std::fs::OpenOptions::new().append(true).create(true).open(path);
    opened.map_err(|error| unwritten(path, &error))?;
    if !there {
        std::fs::remove_file(path)?;
    }
    Ok(())
}

fn unwritten(path: &Path, error: &io::Error) -> Failure {
    let error = io::Error::new(error.kind(), format!("`{}` cannot be written: {error}", path.display()));
    Failure::from(error).hint(OTHER_FILE)
}

/// What the first Ctrl-C or SIGTERM sets; the second ends the program. To be called once.
fn stop_on_signal() -> Result<Arc<AtomicBool>, ctrlc::Error> {
    let stop = Arc::new(AtomicBool::new(false));
    let signal = Arc::clone(&stop);
    ctrlc::set_handler(move || {
        // The second time there is nobody to wait for.
        if signal.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    })?;
    Ok(stop)
}
