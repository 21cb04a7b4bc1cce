//! `hwasp list`.

use std::fmt::Write;

use hwasp_training::spec::{self, EXPERIMENTS};

use crate::failure::Failure;
use crate::output;

pub(crate) fn run() -> Result<(), Failure> {
    let width = EXPERIMENTS.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    let mut text = String::new();
    for (name, _) in EXPERIMENTS {
        let spec = spec::resolve(spec::load(name)?, None)?;
        let _ = writeln!(text, "{name:width$}  {}", spec.description);
    }
    for own in spec::registered() {
        let _ = writeln!(
            text,
            "{:width$}  a problem of this program: task.problem = \"{0}\" in an experiment file",
            own.name()
        );
    }
    Ok(output::print(&text)?)
}
