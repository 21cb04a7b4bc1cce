//! Robots from text: an experiment and its model, resolved, written, made and moved. `crates/model/tests/fuzzed.rs` includes this
//! file, too.

use std::sync::Arc;

use hwasp_core::{Purpose, stream};
use hwasp_experiment::{Catalogue, Experiment, Faults, Files, Folder, Layers, resolve};

/// What is between an experiment and its model.
pub const BETWEEN: &str = "\n%%%\n";
/// Simulation steps that are waited for.
const MOST_STEPS: f64 = 200.0;

fn read(text: &str, files: &Arc<Files>, catalogue: &Catalogue) -> Result<Experiment, Faults> {
    let layers = Layers::from_text("fuzz.toml", text)?.with_folder(Folder::Sent(Arc::clone(files)));
    resolve(layers, Some("fixed"), catalogue)
}

/// An experiment with the problem `model`, and the model `robot.xml` behind a line of `%%%`: faults, or a robot whose file gives it
/// again, and which moves or says why not. Whether it moved to the end.
pub fn robot(text: &str, catalogue: &Catalogue) -> bool {
    let (experiment, model) = text.split_once(BETWEEN).unwrap_or((text, ""));
    let files = Arc::new(Files::from([("robot.xml".to_owned(), Arc::from(model.as_bytes()))]));
    let experiment = match read(experiment, &files, catalogue) {
        Ok(experiment) => experiment,
        Err(faults) => {
            assert!(!faults.to_string().is_empty());
            return false;
        }
    };
    let written = experiment.to_toml().expect("a resolved experiment can be written");
    let again = read(&written, &files, catalogue).unwrap_or_else(|faults| panic!("{faults}\n{written}"));
    assert_eq!(again, experiment, "{written}");
    let built = experiment.task.built();
    for world in [&built.training, &built.deployment] {
        let mut robot = world.make.make(Some(3));
        // The horizon is of steps that may each be thousands of the engine's.
        if robot.spec().time_step > MOST_STEPS * 1e-3 {
            return false;
        }
        let mut seen = vec![0.0; robot.spec().observation.len()];
        let mut state = vec![0.0; robot.spec().state.len()];
        let mut effort = vec![0.0; robot.spec().effort.len()];
        let command: Vec<f64> = robot.spec().command.iter().map(|port| port.hi).collect();
        let design = world.law.design().middle();
        for (episode, progress) in [(0, 0.0), (1, 1.0)] {
            robot.set_progress(progress);
            robot.set_design(&design);
            robot.reset(&mut stream(0, Purpose::TrainingReset, 0, episode));
            for _ in 0..3 {
                robot.state(&mut state);
                world.law.effort(&design, &command, &state, &mut effort);
                let step = robot.step(&effort, &command);
                if let Some(fault) = robot.fault() {
                    assert!(!fault.is_empty());
                    return false;
                }
                robot.observe(&mut seen);
                assert!(step.reward.is_finite() && seen.iter().all(|x| (*x as f32).is_finite()), "{seen:?}");
                if step.end.is_some() {
                    break;
                }
            }
        }
    }
    true
}
