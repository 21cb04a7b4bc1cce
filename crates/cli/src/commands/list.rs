//! `hwasp list`.

use std::fmt::Write;

use hwasp_experiment::{Catalogue, Layers, resolve};

use crate::failure::Failure;
use crate::output;

pub(crate) fn run(catalogue: &Catalogue) -> Result<(), Failure> {
    let presets = catalogue.presets();
    let width = presets.iter().map(|preset| preset.name.len()).max().unwrap_or(0);
    let mut text = String::new();
    for preset in &presets {
        let layers = Layers::from_text(preset.name, preset.text)?;
        let experiment = resolve(layers, None, catalogue)?;
        let _ = writeln!(text, "{:width$}  {}", preset.name, experiment.description);
    }
    for problem in catalogue.problems().iter().filter(|problem| problem.presets().is_empty()) {
        let about = "a problem of this program";
        let _ = writeln!(
            text,
            "{:width$}  {about}: task.problem = \"{}\" in an experiment file",
            problem.name(),
            problem.name()
        );
    }
    Ok(output::print(&text)?)
}
