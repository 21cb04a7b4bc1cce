//! `hwasp list`.

use hwasp_lab::spec::{self, EXPERIMENTS};

use crate::Failure;

pub(crate) fn run() -> Result<(), Failure> {
    let width = EXPERIMENTS.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    for (name, _) in EXPERIMENTS {
        let spec = spec::resolve(spec::load(name)?, None)?;
        println!("{name:width$}  {}", spec.description);
    }
    Ok(())
}
