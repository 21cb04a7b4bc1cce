//! Every environment of this crate keeps the invariants of all environments.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use hwasp_core::check_env;
use hwasp_tasks::mass_spring::{Interface, MassSpring, MassSpringSettings};
use hwasp_tasks::pendulum::{Pendulum, PendulumSettings};
use hwasp_tasks::reach::{Reach, ReachSettings};

#[test]
fn mass_spring_keeps_the_invariants() {
    let paper = MassSpringSettings::default;
    for settings in [
        paper(),
        MassSpringSettings { count: 1, ..paper() },
        MassSpringSettings { count: 50, effort_limit: Some(5.0), ..paper() },
        paper().with_hard_reward(),
    ] {
        let problems = [
            MassSpring::stiffness(settings.clone()),
            MassSpring::bar(settings.clone(), Interface::Soft),
            MassSpring::bar(settings, Interface::Rigid),
        ];
        for problem in problems {
            let problem = problem.unwrap();
            check_env(&problem, &problem.law(), false).unwrap_or_else(|fault| panic!("{problem:?}: {fault}"));
        }
    }
}

#[test]
fn reach_keeps_the_invariants() {
    let problem = Reach::new(ReachSettings::default()).unwrap();
    check_env(&problem, &problem.law(), false).unwrap();
}

#[test]
fn pendulum_keeps_the_invariants() {
    let problem = Pendulum::new(&PendulumSettings::default()).unwrap();
    check_env(&problem, &problem.law(), false).unwrap();
}
