//! What has to hold before anyone trusts a trained design. These tests are about any problem: keep them when you change law, plant
//! and task. What is known of the lamp alone is tested beside its law, in `spring.rs`.

use std::error::Error;
use std::sync::atomic::AtomicBool;

use hwasp_core::{Purpose, Serial, check_env, stream};
use hwasp_diff::{GradCheckSettings, gradcheck};
use hwasp_experiment::{Layers, resolve};
use hwasp_problem::{Problem, World};
use hwasp_training::{Assembly, evaluate, train};
use rand::RngExt;

// The one line that names the problem.
use crate::Lamp as Own;

/// Whatever goes wrong fails the test.
type Failed = Box<dyn Error + Send + Sync>;

/// Where one trains, with the problem's own settings.
fn world() -> Result<World, Failed> {
    let world = Own.build(&Own.defaults())?.training;
    world.ready()?;
    Ok(world)
}

/// The derivatives that training follows, against finite differences, at moments of episodes under random commands. At a kink of
/// `min`, `max` or `abs` the two may differ: most of the moments have to agree.
#[test]
fn the_law_has_the_right_derivatives() -> Result<(), Failed> {
    const MOMENTS: usize = 20;
    let world = world()?;
    let (law, mut rng) = (&world.law, stream(1, Purpose::EvaluationReset, 0, 0));
    let mut wrong = Vec::new();
    for _ in 0..MOMENTS {
        let groups = law.design().groups().iter().flat_map(|group| vec![(group.lo, group.hi); group.count]);
        // Away from the limits, where a law may be at the edge of what it can say.
        let design: Vec<f64> = groups.map(|(lo, hi)| lo + (hi - lo) * (0.1 + 0.8 * rng.random::<f64>())).collect();
        let mut env = world.make.make(None);
        env.reset(&mut rng);
        let (mut command, mut state) = (Vec::new(), vec![0.0; world.env.state.len()]);
        let mut effort = vec![0.0; world.env.effort.len()];
        for _ in 0..rng.random_range(1..=world.env.horizon.min(100)) {
            command =
                world.env.command.iter().map(|port| port.lo + (port.hi - port.lo) * rng.random::<f64>()).collect();
            env.state(&mut state);
            law.effort(&design, &command, &state, &mut effort);
            if env.step(&effort, &command).end.is_some() {
                break;
            }
        }
        let moment = [command, state].concat();
        wrong.extend(gradcheck(law.program(), &design, &moment, &GradCheckSettings::default()).err());
    }
    assert!(4 * wrong.len() <= MOMENTS, "{} of {MOMENTS} moments, the first: {}", wrong.len(), wrong[0]);
    Ok(())
}

/// Ports, limits, starts, ends: everything that training relies on.
#[test]
fn the_environment_keeps_its_promises() -> Result<(), Failed> {
    let world = world()?;
    check_env(&*world.make, &world.law, false)?;
    Ok(())
}

/// A fifth of the training, its seed fixed: the return rises, and where the best design is known the trained one comes nearer to
/// it.
#[test]
fn a_short_training_improves_design_and_controller() -> Result<(), Failed> {
    let layers = Layers::from_text("experiment.toml", include_str!("../experiment.toml"))?;
    let mut experiment = resolve(layers, None, &crate::catalogue()?)?;
    experiment.train.env_steps = (experiment.train.env_steps / 5).max(experiment.train.rows() as u64);
    experiment.train.evaluation_episodes = 100;
    let assembly = Assembly::new(&experiment)?;
    let trained = train(&assembly, &Serial, &mut (), &AtomicBool::new(false))?;

    let first = assembly.init();
    let judged = |params: &[f32]| evaluate(&assembly, params, (100, 1), &Serial).map(|e| e.discounted_return.mean);
    let (before, after) = (judged(&first)?, judged(&trained.params)?);
    assert!(after > before, "discounted return {before:.3} before, {after:.3} after");

    let mut at = 0;
    for (group, best) in assembly.policy.space().groups().iter().zip(&assembly.worlds.optimum) {
        let members = at..at + group.count;
        at = members.end;
        let Some(best) = best else { continue };
        let off = |params: &[f32]| (assembly.built(params)[members.clone()].iter().sum::<f64>() - best).abs();
        let (before, after) = (off(&first), off(&trained.params));
        assert!(after < before, "{} was {before:.3} off, and is {after:.3} off", group.name);
    }
    Ok(())
}
