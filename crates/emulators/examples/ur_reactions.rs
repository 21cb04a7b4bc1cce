//! `ur_reactions [TIMES]`: how long the driver takes to notice each fault of the arm, and the arm to stand, with the settings
//! as they come. The arm follows at 0.1 m/s, 125 orders a second; whoever drives stops at the first refusal. Prints a table for
//! `docs/deploy_arm.md`.

use std::io::Write;
use std::time::{Duration, Instant};

use hwasp_drivers::ur::{UrArm, UrSettings};
use hwasp_drivers::{Arm, ArmMode, Safety};
use hwasp_emulators::ur::{Alone, Generation, UrEmulatorSettings};

/// Faults, and what has to hold by the settings, ms: noticed, and standing.
const FAULTS: [&str; 9] =
    ["no orders", "protective-stop", "emergency-stop", "idle", "silent", "delay 100", "freeze", "nan", "cut"];

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

fn main() -> Result<()> {
    let times: usize = std::env::args().nth(1).map_or(Ok(5), |text| text.parse())?;
    let mut out = std::io::stdout();
    writeln!(
        out,
        "| fault | controller | noticed after, ms | the arm stands after, ms | what the driver says |\n|---|---|---|---|---|"
    )?;
    for fault in FAULTS {
        for generation in [Generation::Cb3, Generation::ESeries] {
            let (mut noticed, mut stood, mut said) = (Vec::new(), Vec::new(), String::new());
            for _ in 0..times {
                let (first, second, what) = once(generation, fault)?;
                noticed.push(first);
                stood.push(second);
                said = what;
            }
            let name = if generation == Generation::Cb3 { "CB3" } else { "e-Series" };
            writeln!(out, "| {fault} | {name} | {} | {} | {said} |", range(&noticed), range(&stood))?;
        }
    }
    Ok(())
}

fn range(times: &[f64]) -> String {
    let (least, most) =
        times.iter().fold((f64::MAX, 0.0_f64), |(least, most), time| (least.min(*time), most.max(*time)));
    format!("{least:.0} to {most:.0}")
}

fn once(generation: Generation, fault: &str) -> Result<(f64, f64, String)> {
    let alone = Alone::start(&UrEmulatorSettings::new(generation))?;
    let ports = alone.emulator().ports();
    let mut settings = UrSettings::new("127.0.0.1");
    (settings.rtde_port, settings.dashboard_port, settings.script_port) = (ports.rtde, ports.dashboard, ports.script);
    settings.frequency = if generation == Generation::Cb3 { 125.0 } else { 500.0 };
    let mut arm = UrArm::connect(&settings)?;
    arm.start()?;
    let (begin, start) = (arm.state()?.tool, Instant::now());
    let target = |at: Instant| {
        let mut target = begin;
        target.position[0] += 0.1 * (at - start).as_secs_f64();
        target
    };
    while start.elapsed() < Duration::from_millis(600) {
        arm.servo(&target(Instant::now()))?;
        std::thread::sleep(Duration::from_millis(8));
    }
    let injected = Instant::now();
    let milliseconds = |since: Instant| since.elapsed().as_secs_f64() * 1e3;
    let (mut noticed, mut said) = (0.0, "its program has ended".to_owned());
    if fault == "no orders" {
        while arm.reading()?.doing == 2 {
            std::thread::sleep(Duration::from_micros(500));
        }
        noticed = milliseconds(injected);
    } else {
        alone.emulator().inject(fault)?;
        let mut next = injected;
        while noticed == 0.0 {
            let state = arm.state();
            let stopped =
                state.as_ref().is_ok_and(|state| state.safety != Safety::Normal || state.mode != ArmMode::Running);
            let ordered = if Instant::now() >= next {
                next += Duration::from_millis(8);
                arm.servo(&target(Instant::now()))
            } else {
                Ok(())
            };
            match state.err().or(ordered.err()) {
                Some(cause) => (noticed, said) = (milliseconds(injected), cause.to_string()),
                None if stopped => (noticed, said) = (milliseconds(injected), format!("{:?}", arm.state()?.safety)),
                None => std::thread::sleep(Duration::from_micros(500)),
            }
        }
        let _ = arm.stop();
    }
    while alone.emulator().tool_speed() > 0.0 {
        std::thread::sleep(Duration::from_micros(500));
    }
    Ok((noticed, milliseconds(injected), said.replace("arm 127.0.0.1: ", "")))
}
