//! Experiments of a text and a model, and what their robots see.

#![allow(dead_code, reason = "each test binary uses its part")]

use std::sync::Arc;

use hwasp_core::{Environment, Purpose, stream};
use hwasp_experiment::{Experiment, Faults, Files, Folder, Layers, resolve};
use hwasp_testing::catalogue;

/// The experiment of a model and of keys and tables of `[task]`, from line 5 of its text, or what is wrong with it. Where the text
/// says no reward there is one of nothing.
pub(crate) fn resolved(model: &str, text: &str) -> Result<Experiment, Faults> {
    let reward = if text.contains("[task.reward]") { "" } else { "\n[task.reward]\nnone = 0\n" };
    let text = format!("name = \"robot\"\n[task]\nproblem = \"model\"\nmodel = \"robot.xml\"\n{text}{reward}");
    from(&text, &files(model), Some("fixed"))
}

/// The experiment of a text, whose files are sent with it.
pub(crate) fn from(text: &str, files: &Arc<Files>, method: Option<&str>) -> Result<Experiment, Faults> {
    let layers = Layers::from_text("robot.toml", text).unwrap().with_folder(Folder::Sent(Arc::clone(files)));
    resolve(layers, method, catalogue())
}

/// The one file of a model.
pub(crate) fn files(model: &str) -> Arc<Files> {
    Arc::new(Files::from([("robot.xml".to_owned(), Arc::from(model.as_bytes()))]))
}

/// The same as [`resolved`] where nothing is wrong.
pub(crate) fn experiment(model: &str, text: &str) -> Experiment {
    resolved(model, text).unwrap_or_else(|faults| panic!("{faults}"))
}

/// The robot of [`experiment`] as it is deployed.
pub(crate) fn robot(model: &str, text: &str) -> Box<dyn Environment> {
    experiment(model, text).task.built().deployment.make.make(None)
}

/// Begins an episode, which is in order.
pub(crate) fn begin(robot: &mut dyn Environment, episode: u64) {
    robot.reset(&mut stream(0, Purpose::EvaluationReset, 0, episode));
    assert_eq!(robot.fault(), None);
}

/// What the controller sees.
pub(crate) fn seen(robot: &dyn Environment) -> Vec<f64> {
    let mut seen = vec![0.0; robot.spec().observation.len()];
    robot.observe(&mut seen);
    seen
}
