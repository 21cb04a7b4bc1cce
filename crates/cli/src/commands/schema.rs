//! `hwasp schema`.

use hwasp_experiment::{Catalogue, reference, schema};

use super::write_out;
use crate::args::SchemaArgs;
use crate::output;
use hwasp_session::Failure;

pub(crate) fn run(args: &SchemaArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let text = if args.reference {
        reference(catalogue)
    } else {
        format!("{}\n", serde_json::to_string_pretty(&schema(catalogue))?)
    };
    let Some(path) = &args.out else { return Ok(output::print(&text)?) };
    write_out(path, &text)?;
    Ok(output::print(&format!("{}\n", path.display()))?)
}
