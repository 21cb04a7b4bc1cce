//! `hwasp deploy rehearse`.

use std::io::BufRead;
use std::path::Path;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use hwasp_deploy::dry::{BenchProcess, HeldOut};
use hwasp_deploy::rig::{Rig, text_of};
use hwasp_emulators::bench::object_text;
use hwasp_experiment::Catalogue;

use super::{bench, deployed, interrupts};
use crate::args::DeployRehearseArgs;
use crate::failure::{Failure, OTHER_FILE};
use crate::output;

/// How a rig of an emulated bench begins: such a file may be written anew.
const ABOUT: &str = "# An emulated bench: `hwasp deploy rehearse` writes this file, and removes it when it ends.\n";

/// How often it is looked whether somebody wants it to end.
const LOOK: Duration = Duration::from_millis(100);

pub(crate) fn run(args: &DeployRehearseArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let deployed = deployed(&args.run, catalogue)?;
    let rig = args.rig.as_deref().map_or_else(|| Ok(Rig::default()), |path| Rig::open(path).map_err(Failure::input))?;
    let held_out = HeldOut::new(&deployed, None).map_err(Failure::input)?;
    let out = args.out.display().to_string();
    let there = std::fs::read_to_string(&args.out).unwrap_or_default();
    if args.out.exists() && !there.starts_with(ABOUT) {
        return Err(
            Failure::input(format!("{out} is no rig of an emulated bench, and is not overwritten")).hint(OTHER_FILE)
        );
    }
    let interrupts = interrupts()?;
    let (mut process, reached) = bench::start(&deployed, &rig, &args.plant)?;
    std::fs::write(&args.out, text_of(&reached, ABOUT)).map_err(|error| Failure::from(error).hint(OTHER_FILE))?;
    let (run, calibration) = (args.run.display(), calibration(&args.out));
    output::print(&format!(
        "the emulated bench is there: {out}\nIn another terminal, in this order:\n\n  hwasp deploy check --rig {out}\n  \
         hwasp deploy calibrate {run} --rig {out} --out {calibration}\n\nThen type `object 0` here, and there the command that it tells. `quit` ends it.\n"
    ))?;
    let lines = lines();
    let ended = loop {
        if interrupts.load(Ordering::Relaxed) > 0 {
            break Ok(());
        }
        match lines.recv_timeout(LOOK) {
            Ok(line) if line.trim() == "quit" => break Ok(()),
            Ok(line) if line.trim().is_empty() => {}
            Ok(line) => {
                if let Err(failure) = obey(line.trim(), &mut process, &held_out, args) {
                    break Err(failure);
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break Ok(()),
        }
    };
    remove(&args.out);
    ended
}

/// Where the calibration of a rehearsal is kept: not where that of the built hand is.
fn calibration(rig: &Path) -> String {
    rig.with_extension("calibration.toml").display().to_string()
}

/// What is typed, by a thread: reading waits, and Ctrl-C does not.
fn lines() -> mpsc::Receiver<String> {
    let (sender, receiver) = mpsc::channel();
    std::thread::spawn(move || {
        for line in std::io::stdin().lock().lines() {
            let Ok(line) = line else { return };
            if sender.send(line).is_err() {
                return;
            }
        }
    });
    receiver
}

fn obey(line: &str, process: &mut BenchProcess, held_out: &HeldOut, args: &DeployRehearseArgs) -> Result<(), Failure> {
    let Some(index) = line.strip_prefix("object ").and_then(|index| index.trim().parse().ok()) else {
        // What the bench says against an order is an answer, too.
        match process.order(line) {
            Ok(answer) => output::print(&format!("{answer}\n"))?,
            Err(error) => output::remark(&error.to_string()),
        }
        return Ok(());
    };
    let (object, _) = held_out.draw(index);
    process.order(&format!("object {}", object_text(&object)))?;
    let [x, y, z] = object.bounding_box().map(|edge| 1e3 * edge);
    let ([at_x, at_y], shape) = (object.place.map(|at| 1e3 * at), object.kind.name());
    Ok(output::print(&format!(
        "a {shape} of {:.0} g; to grasp it:\n  hwasp deploy run {} --rig {} --calibration {} --size {x:.1},{y:.1},{z:.1} --at {at_x:.1},{at_y:.1} --shape {shape}\n",
        1e3 * object.mass,
        args.run.display(),
        args.out.display(),
        calibration(&args.out)
    ))?)
}

/// Nobody is to believe that the bench is still there.
fn remove(path: &Path) {
    let _ = std::fs::remove_file(path);
}
