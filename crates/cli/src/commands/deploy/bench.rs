//! `hwasp deploy bench`, the process behind a dry run.

use std::io::{self, BufReader};
use std::path::Path;

use hwasp_emulators::bench::{BenchSettings, run_bench};

use crate::failure::{Failure, OTHER_FILE};

pub(crate) fn run(settings: &Path) -> Result<(), Failure> {
    // Ctrl-C is for whoever drives: this process ends with its input.
    ctrlc::set_handler(|| {})?;
    let text = std::fs::read_to_string(settings).map_err(|error| Failure::from(error).hint(OTHER_FILE))?;
    let bench = BenchSettings::from_json(&text).and_then(|settings| settings.start()).map_err(Failure::input)?;
    Ok(run_bench(bench, BufReader::new(io::stdin()), &mut io::stdout())?)
}
