//! `hwasp` with one problem more: a lamp on an arm that a spring should carry.
//!
//! Every command of hwasp works on it (`train`, `eval`, `compare`, `report`, `export` …); `help` lists them.

#![forbid(unsafe_code)]

mod arm;
mod hold;
mod spring;
#[cfg(test)]
mod tests;

use std::process::ExitCode;

use hwasp_core::{Dimension, Environment, Law, Robot};
use hwasp_experiment::{Catalogue, CatalogueError};
use hwasp_problem::{AnyError, Built, Problem, Role, Words};
use hwasp_settings::{Fields, Settings};

use arm::Arm;
use hold::Hold;
use spring::Spring;

fn main() -> Result<ExitCode, CatalogueError> {
    Ok(hwasp_cli::run(&catalogue()?))
}

/// What experiments may name: the problems of hwasp, and this one.
fn catalogue() -> Result<Catalogue, CatalogueError> {
    hwasp_builtin::catalogue().with(Lamp)
}

/// The problem `lamp` of experiment files.
pub(crate) struct Lamp;

/// What experiments may set in `[task]`, beside the horizon.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LampSettings {
    /// The angle at which the lamp is held, rad from upright.
    goal: f64,
}

impl Settings for LampSettings {
    /// Each setting once, with its limits: from this hwasp reads it, names what is wrong, and completes it in editors.
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        fields.quantity("goal", &mut self.goal, Dimension::Angle, -1.2..=1.2, "the angle at which the lamp is held");
    }
}

impl Problem for Lamp {
    type Settings = LampSettings;

    fn name(&self) -> &'static str {
        "lamp"
    }

    /// The settings of an experiment that says nothing.
    fn defaults(&self) -> LampSettings {
        LampSettings { goal: 0.6 }
    }

    fn build(&self, settings: &LampSettings) -> Result<Built, AnyError> {
        let (law, arm, goal) = (Law::new(Spring::new()?), Arm::default(), settings.goal);
        // One for each thread; `horizon` is that of the experiment.
        let make = move |horizon| -> Box<dyn Environment> { Box::new(Robot::new(arm.clone(), Hold { goal }, horizon)) };
        // For reports and exports.
        let words =
            Words::about("A motor holds a lamp on an arm, beside a spring. The spring's stiffness is the design.")
                .with(Role::Command, &[("motor", "torque of the motor")])
                .with(Role::Effort, &[("torque", "torque of motor and spring on the arm")]);
        // What is best is known here, and reports say how near a design is; leave it out where it is not.
        Ok(Built { optimum: vec![Some(Spring::BALANCE)], words, ..Built::new(law, make) })
    }
}
