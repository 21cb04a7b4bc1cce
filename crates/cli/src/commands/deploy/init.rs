//! `hwasp deploy init`.

use std::fs::File;
use std::io::{ErrorKind, Write};

use hwasp_deploy::rig::template;

use crate::args::DeployInitArgs;
use crate::output;
use hwasp_session::{Failure, OTHER_FILE};

pub(crate) fn run(args: &DeployInitArgs) -> Result<(), Failure> {
    let path = args.out.display();
    let written = File::create_new(&args.out).and_then(|mut file| file.write_all(template().as_bytes()));
    written.map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => {
            Failure::input(format!("{path} exists already, and is not overwritten")).hint(OTHER_FILE)
        }
        _ => Failure::from(error).hint(OTHER_FILE),
    })?;
    Ok(output::print(&format!(
        "{path}\n\nMeasure and enter what is marked there, then: hwasp deploy check\nWhat to wire and to measure: docs/deploy.md\n"
    ))?)
}
