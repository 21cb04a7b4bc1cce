//! Standard output, whose reader may go away (`hwasp list | head -1`), and remarks beside it.

use std::io::{self, ErrorKind, Write};

/// Prints a result. A reader that has gone is no failure; a full disk is.
pub(crate) fn print(text: &str) -> io::Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        Err(error) => Err(io::Error::new(error.kind(), format!("cannot write to standard output: {error}"))),
        Ok(()) => Ok(()),
    }
}

/// Tells a remark.
pub(crate) fn remark(text: &str) {
    tracing::info!("{text}");
}
