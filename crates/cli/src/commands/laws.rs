//! `hwasp laws`.

use hwasp_expr::LIBRARY;

use crate::output;
use hwasp_session::Failure;

pub(crate) fn run() -> Result<(), Failure> {
    Ok(output::print(LIBRARY)?)
}
