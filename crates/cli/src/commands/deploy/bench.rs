//! The emulated bench: the process `hwasp deploy bench`, and how it is started.

use std::io::{self, BufReader};
use std::path::Path;

use hwasp_deploy::dry::BenchProcess;
use hwasp_deploy::rig::Rig;
use hwasp_emulators::bench::{BenchSettings, run_bench};
use hwasp_emulators::hand::Planted;
use hwasp_export::Deployed;

use crate::caller::Caller;
use hwasp_session::{Failure, OTHER_FILE};

pub(crate) fn run(settings: &Path) -> Result<(), Failure> {
    // Ctrl-C is for whoever drives: this process ends with its input.
    ctrlc::set_handler(|| {})?;
    let text = std::fs::read_to_string(settings).map_err(|error| Failure::from(error).hint(OTHER_FILE))?;
    let bench = BenchSettings::from_json(&text).and_then(|settings| settings.start()).map_err(Failure::input)?;
    Ok(run_bench(bench, BufReader::new(io::stdin()), &mut io::stdout())?)
}

/// Starts it with the hand of a run, which differs by what is planted: the process, and the rig that reaches it.
pub(super) fn start(deployed: &Deployed, rig: &Rig, plant: &[String]) -> Result<(BenchProcess, Rig), Failure> {
    let mut command = Caller::get().again();
    command.args(["deploy", "bench"]);
    let settings = std::env::temp_dir().join(format!("hwasp-bench-{}.json", std::process::id()));
    let started = BenchProcess::start(command, &settings, deployed, rig, &planted(plant)?);
    // It was read when the bench said that it is ready, or will never be.
    let _ = std::fs::remove_file(&settings);
    Ok(started?)
}

/// What the emulated hand differs by.
fn planted(plant: &[String]) -> Result<Planted, Failure> {
    let mut planted = Planted::default();
    for text in plant {
        let (name, value) = text.split_once('=').map_or((&**text, ""), |(name, value)| (name.trim(), value.trim()));
        // What is no number is outside of all limits.
        let value = value.parse().unwrap_or(f64::NAN);
        planted.plant(name, value).map_err(|error| Failure::input(format!("--plant {text}: {error}")))?;
    }
    Ok(planted)
}
