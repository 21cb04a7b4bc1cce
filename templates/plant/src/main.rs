//! `hwasp` with one problem more: a lamp on an arm that a spring should carry.
//!
//! Every command of hwasp works on it (`train`, `eval`, `compare`, `graph` …); `help` lists them.

#![forbid(unsafe_code)]

mod arm;
mod hold;
mod spring;
#[cfg(test)]
mod tests;

use std::process::ExitCode;

use hwasp_core::{Dimension, Environment, Law, Robot};
use hwasp_training::Problems;
use hwasp_training::spec::{OwnProblem, Setting};

use arm::Arm;
use hold::Hold;
use spring::Spring;

fn main() -> ExitCode {
    hwasp_cli::run([problem()])
}

/// The problem `lamp` of experiment files. What they may set in `[task]` beside the horizon has its limits here.
fn problem() -> OwnProblem {
    let goal = Setting { name: "goal", dimension: Dimension::Angle, default: 0.6, limits: -1.2..=1.2 };
    OwnProblem::new("lamp", [goal], |[goal]| {
        let law = Law::new(Spring::new()?);
        let arm = Arm::default();
        // One for each thread; `horizon` is that of the experiment.
        let make = move |horizon| -> Box<dyn Environment> { Box::new(Robot::new(arm.clone(), Hold { goal }, horizon)) };
        // What is best is known here, and reports say how near a design is; leave it out where it is not.
        Ok(Problems { optimum: vec![Some(Spring::BALANCE)], ..Problems::new(law, make) })
    })
}
