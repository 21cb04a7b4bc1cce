//! One problem, written in Rust and as text: the lamp of `hwasp init --template mjcf`, with the sources of that project, and the same
//! model with formulas. Steps per second of both, law included; the last line says it in JSON.
//!
//!     text_and_rust [STEPS]         default: 200,000 steps
//!
//! Both run on one thread, in turn, three times; the fastest of each counts. Its test holds both to the same bits.

#![allow(clippy::print_stdout)] // a program

use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

use hwasp_core::{Environment, Law, Purpose, Robot, stream};
use hwasp_experiment::{Experiment, Files, Folder, Layers, resolve};
use rand::RngExt;
use serde_json::json;

#[path = "../../../templates/mjcf/src/arm.rs"]
mod arm;
#[path = "../../../templates/plant/src/hold.rs"]
mod hold;
#[path = "../../../templates/plant/src/spring.rs"]
mod spring;

use arm::Arm;
use hold::Hold;
use spring::Spring;

/// How often each is measured.
const ROUNDS: usize = 3;
/// The angle at which the lamp is held, rad.
const GOAL: f64 = 0.6;

/// The same as `arm.rs`, `hold.rs` and `spring.rs` together.
const TEXT: &str = r#"
name = "lamp"
[task]
problem = "model"
model = "mechanism.xml"
frame_skip = 4
horizon = 100
observe = ["joint.pivot.pos", "joint.pivot.vel"]
[task.commands]
motor = { limits = ["-1.5 N*m", "1.5 N*m"] }
[task.define]
goal = "0.6 rad"
[task.start]
"joint.pivot.pos" = "goal + uniform(-0.3, 0.3)"
[task.reward]
held = "1 - (joint.pivot.pos - goal)^2 - (command.motor / 1.5 N*m)^2"
[task.law]
"actuator.torque" = "command.motor - stiffness * (0.05 m * 0.1 m) * sin(joint.pivot.pos)"
[task.design]
stiffness = { limits = ["0 N/m", "1000 N/m"], initial = "800 N/m" }
"#;

type Failed = Box<dyn Error + Send + Sync>;

fn main() -> Result<(), Failed> {
    let steps: usize = std::env::args().nth(1).map_or(Ok(200_000), |steps| steps.parse())?;
    let experiment = text()?;
    let world = &experiment.task.built().deployment;
    let mut of_text = world.make.make(Some(100));
    let (law, mut of_rust) = (Law::new(Spring::new()?), Robot::new(Arm::new()?, Hold { goal: GOAL }, None));
    let (mut text, mut rust) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..ROUNDS {
        text = text.min(seconds(&mut *of_text, &world.law, steps));
        rust = rust.min(seconds(&mut of_rust, &law, steps));
    }
    let rate = |seconds: f64| steps as f64 / seconds;
    println!("as text {:.0} steps/s, in Rust {:.0} steps/s: {:.3} of it", rate(text), rate(rust), rust / text);
    println!("{}", json!({ "text_steps_per_s": rate(text), "rust_steps_per_s": rate(rust), "ratio": rust / text }));
    Ok(())
}

/// The text with the model of the project.
fn text() -> Result<Experiment, Failed> {
    let model = include_bytes!("../../../templates/mjcf/mechanism.xml");
    let files = Files::from([("mechanism.xml".to_owned(), Arc::from(&model[..]))]);
    let layers = Layers::from_text("lamp.toml", TEXT)?.with_folder(Folder::Sent(Arc::new(files)));
    Ok(resolve(layers, Some("fixed"), &hwasp_builtin::catalogue())?)
}

/// Seconds for so many steps under random commands, resets and the law included.
fn seconds(robot: &mut dyn Environment, law: &Law, steps: usize) -> f64 {
    let mut chance = stream(0, Purpose::Samples, 0, 0);
    let commands: Vec<[f64; 1]> = (0..4096).map(|_| [3.0 * chance.random::<f64>() - 1.5]).collect();
    let (mut seen, mut state, mut effort) = ([0.0; 2], vec![0.0; robot.spec().state.len()], [0.0]);
    robot.reset(&mut chance);
    let began = Instant::now();
    for command in commands.iter().cycle().take(steps) {
        robot.state(&mut state);
        law.effort(&[Spring::BALANCE], command, &state, &mut effort);
        let step = robot.step(&effort, command);
        robot.observe(&mut seen);
        if step.end.is_some() {
            robot.reset(&mut chance);
        }
    }
    began.elapsed().as_secs_f64()
}

#[cfg(test)]
mod tests {
    use hwasp_core::{Plant, Task};

    use super::*;

    /// For the test beside the law, which in the project is written for an arm that may be refused.
    impl Default for Arm {
        fn default() -> Self {
            Self::new().unwrap_or_else(|error| panic!("{error}"))
        }
    }

    /// The same start, then the same commands: every effort, observation and reward of an episode has the same bits.
    #[test]
    fn both_give_the_same_bits() -> Result<(), Failed> {
        let experiment = text()?;
        let world = &experiment.task.built().deployment;
        let mut of_text = world.make.make(Some(100));
        let (law, mut arm, mut hold) = (Law::new(Spring::new()?), Arm::new()?, Hold { goal: GOAL });
        let names = of_text.spec().state.iter().map(|port| port.name.as_str()).collect::<Vec<_>>();
        assert_eq!(names, ["joint.pivot.pos"]);
        for (number, design) in [(0, [Spring::BALANCE]), (1, [50.0]), (2, [977.3])] {
            let mut chance = stream(0, Purpose::EvaluationReset, 0, number);
            of_text.reset(&mut chance);
            let (mut seen, mut state, mut efforts) = ([[0.0; 2]; 2], [0.0; 2], [[0.0], [0.0]]);
            of_text.observe(&mut seen[0]);
            arm.place(seen[0][0]);
            let mut ends = None;
            for step in 0..100 {
                let command = [3.0 * chance.random::<f64>() - 1.5];
                arm.state(&mut state);
                law.effort(&design, &command, &state, &mut efforts[0]);
                of_text.state(&mut state[..1]);
                world.law.effort(&design, &command, &state[..1], &mut efforts[1]);
                assert_eq!(efforts[0][0].to_bits(), efforts[1][0].to_bits(), "effort of step {step}");
                arm.advance(&efforts[0], &command);
                let of_rust = hold.reward(&arm, &command);
                let answer = of_text.step(&efforts[1], &command);
                assert_eq!(of_rust.to_bits(), answer.reward.to_bits(), "reward of step {step}");
                hold.observe(&arm, &mut seen[0]);
                of_text.observe(&mut seen[1]);
                assert_eq!(seen[0].map(f64::to_bits), seen[1].map(f64::to_bits), "observation of step {step}");
                ends = answer.end;
            }
            assert_eq!((of_text.fault(), arm.fault()), (None, None));
            assert_eq!(ends, Some(hwasp_core::End::Truncated));
        }
        Ok(())
    }
}
