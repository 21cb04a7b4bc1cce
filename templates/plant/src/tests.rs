//! What has to hold before anyone trusts a trained design.

use std::error::Error;
use std::sync::atomic::AtomicBool;

use hwasp_core::{Law, Plant, Serial, check_env};
use hwasp_diff::{GradCheckSettings, gradcheck};
use hwasp_training::spec::{self, Layers};
use hwasp_training::{Assembly, evaluate, train};

use crate::arm::Arm;
use crate::problem;
use crate::spring::Spring;

/// Whatever goes wrong fails the test.
type Failed = Box<dyn Error + Send + Sync>;

/// The derivatives that training follows, against finite differences, at two moments.
#[test]
fn the_law_has_the_right_derivatives() -> Result<(), Failed> {
    let law = Law::new(Spring::new()?);
    // Column by column: motor (N·m), angle (rad), speed (rad/s). Keep away from the kinks of `min`, `max` and `abs`.
    let columns = [[0.3, -1.0], [0.4, -0.9], [2.0, 0.1]].concat();
    gradcheck(law.program(), &[250.0], &columns, &GradCheckSettings::default())?;
    Ok(())
}

/// Ports, limits, starts, ends: everything that training relies on.
#[test]
fn the_environment_keeps_its_promises() -> Result<(), Failed> {
    let world = problem().usual()?.training;
    check_env(&*world.make, &world.law, false)?;
    Ok(())
}

/// A fact that is known without any training: law and plant agree on it.
#[test]
fn the_balanced_arm_stays_where_it_is_put() -> Result<(), Failed> {
    let (law, mut arm) = (Law::new(Spring::new()?), Arm::default());
    for start in [-1.0, 0.2, 0.7] {
        arm.place(start);
        let (mut state, mut effort) = ([0.0; 2], [0.0]);
        for _ in 0..100 {
            arm.state(&mut state);
            law.effort(&[Spring::BALANCE], &[0.0], &state, &mut effort);
            arm.advance(&effort, &[0.0]);
        }
        assert!((arm.angle() - start).abs() < 1e-6, "put at {start} rad, it went to {} rad", arm.angle());
    }
    Ok(())
}

/// A fifth of the training, its seed fixed: the return rises, and the spring comes nearer to the one that is best.
#[test]
fn a_short_training_improves_design_and_controller() -> Result<(), Failed> {
    spec::register([problem()])?;
    let layers = Layers::from_text("experiment.toml", include_str!("../experiment.toml"))?;
    let layers = layers.with_override("train.env_steps", "60_000").with_override("train.evaluation_episodes", "100");
    let assembly = Assembly::new(&spec::resolve(layers, None)?)?;
    let trained = train(&assembly, &Serial, &mut (), &AtomicBool::new(false))?;

    let first = assembly.init();
    let judged = |params: &[f32]| evaluate(&assembly, params, (100, 1), &Serial).map(|e| e.discounted_return.mean);
    let (before, after) = (judged(&first)?, judged(&trained.params)?);
    assert!(after > before + 10.0, "discounted return {before:.1} before, {after:.1} after");

    let off = |params: &[f32]| (assembly.policy.design(params)[0] - Spring::BALANCE).abs();
    let (before, after) = (off(&first), off(&trained.params));
    assert!(after < 0.5 * before, "the stiffness was {before:.1} N/m off, and is {after:.1} N/m off");
    Ok(())
}
