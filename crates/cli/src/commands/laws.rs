//! `hwasp laws`.

use hwasp_expr::LIBRARY;

use crate::failure::Failure;
use crate::output;

pub(crate) fn run() -> Result<(), Failure> {
    Ok(output::print(LIBRARY)?)
}
