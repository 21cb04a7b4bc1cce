//! Standard output, whose reader may go away (`hwasp list | head -1`), and remarks beside it.
//!
//! Names in files and arguments are other people's text: what would move a terminal's cursor or turn its writing is shown as a
//! mark, here and in the log ([`printable_lines`]).

use std::io::{self, ErrorKind, Write};

use hwasp_settings::text::printable_lines;

pub(crate) use hwasp_session::shell;

/// Prints a result. A reader that has gone is no failure; a full disk is.
pub(crate) fn print(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(printable_lines(text).as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        Err(error) => Err(io::Error::new(error.kind(), format!("cannot write to standard output: {error}"))),
        Ok(()) => Ok(()),
    }
}

/// Tells a remark.
pub(crate) fn remark(text: &str) {
    tracing::info!("{text}");
}
