//! `hwasp deploy rehearse`.

use std::net::TcpStream;
use std::path::Path;

use hwasp_deploy::calibrate::stands;
use hwasp_deploy::controller::hand;
use hwasp_deploy::dry::{BenchProcess, HeldOut};
use hwasp_deploy::rig::{Rig, text_of};
use hwasp_emulators::bench::object_text;
use hwasp_experiment::Catalogue;

use super::answers::Answers;
use super::{bench, deployed, interrupts};
use crate::args::DeployRehearseArgs;
use crate::output::{self, shell};
use hwasp_session::{Failure, OTHER_FILE};

/// The last held-out object that can be asked for.
const LAST: u64 = 1_000_000;

/// How a rig of an emulated bench begins: such a file may be written anew.
const ABOUT: &str = "# An emulated bench: `hwasp deploy rehearse` writes this file, and removes it when it ends.\n";

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
    let alive = |rig: Rig| TcpStream::connect((&*rig.arm.host, rig.arm.rtde_port as u16)).is_ok();
    if Rig::open(&args.out).is_ok_and(alive) {
        return Err(Failure::input(format!("{out} is that of a rehearsal that goes on")).hint(OTHER_FILE));
    }
    let hand = hand(deployed.spec()).map_err(Failure::input)?;
    if let Err(droops) = stands(hand, deployed.design()) {
        output::remark(&format!("note: `calibrate` and `run` will refuse this hand, for {droops}"));
    }
    let interrupts = interrupts()?;
    let (mut process, mut reached) = bench::start(&deployed, &rig, &args.plant)?;
    // What is rehearsed is no trial of the built hand.
    reached.log.folder = args.out.with_extension("logs");
    std::fs::write(&args.out, text_of(&reached, ABOUT)).map_err(|error| Failure::from(error).hint(OTHER_FILE))?;
    let (run, out, calibration) = (shell(&args.run), shell(&args.out), calibration(&args.out));
    output::print(&format!(
        "the emulated bench is there: {out}\nIn another terminal, in this order:\n\n  hwasp deploy check --rig {out}\n  \
         hwasp deploy calibrate {run} --rig {out} --out {calibration}\n\nThen type `object 0` here, and there the command that it tells. `quit` ends it.\n"
    ))?;
    let mut answers = Answers::listen(interrupts);
    let mut ended = Ok(());
    while ended.is_ok() {
        match answers.next().as_deref() {
            None | Some("quit") => break,
            Some("") => {}
            Some(line) => ended = obey(line, &mut process, &held_out, args),
        }
    }
    // Nobody is to believe that the bench is still there.
    let _ = std::fs::remove_file(&args.out);
    ended
}

/// Where the calibration of a rehearsal is kept: not where that of the built hand is.
fn calibration(rig: &Path) -> String {
    shell(&rig.with_extension("calibration.toml"))
}

fn obey(line: &str, process: &mut BenchProcess, held_out: &HeldOut, args: &DeployRehearseArgs) -> Result<(), Failure> {
    let Some(index) = line.strip_prefix("object") else {
        // What the bench says against an order is an answer, too.
        match process.order(line) {
            Ok(answer) => output::print(&format!("{answer}\n"))?,
            Err(error) => output::remark(&error.to_string()),
        }
        return Ok(());
    };
    let Some(index) = index.trim().parse().ok().filter(|index| *index <= LAST) else {
        output::remark(&format!("object{index}: write `object INDEX`, a whole number from 0 to {LAST}"));
        return Ok(());
    };
    let (object, _) = held_out.draw(index);
    process.order(&format!("object {}", object_text(&object)))?;
    let [x, y, z] = object.bounding_box().map(|edge| 1e3 * edge);
    let ([at_x, at_y], shape) = (object.place.map(|at| 1e3 * at), object.kind.name());
    Ok(output::print(&format!(
        "a {shape} of {:.0} g; to grasp it:\n  hwasp deploy run {} --rig {} --calibration {} --size {x:.1},{y:.1},{z:.1} --at {at_x:.1},{at_y:.1} --shape {shape}\n",
        1e3 * object.mass,
        shell(&args.run),
        shell(&args.out),
        calibration(&args.out)
    ))?)
}
