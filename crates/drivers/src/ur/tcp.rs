//! Connections that end in time, and the words for those that break.

use std::io::{Error, ErrorKind};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::Instant;

use super::settings::UrSettings;
use crate::error::DriverError;

/// Connects to a port of the arm's host; whoever reads or writes waits for no longer than `answer`.
pub(super) fn connect(settings: &UrSettings, port: u16, what: &'static str) -> Result<TcpStream, DriverError> {
    let addresses =
        (settings.host.as_str(), port).to_socket_addrs().map_err(|cause| line(settings, what, cause.to_string()))?;
    let mut last = line(settings, what, "the name has no address".to_owned());
    for address in addresses {
        match TcpStream::connect_timeout(&address, settings.answer) {
            Ok(stream) => {
                let answer = Some(settings.answer);
                stream
                    .set_nodelay(true)
                    .and_then(|()| stream.set_read_timeout(answer))
                    .and_then(|()| stream.set_write_timeout(answer))
                    .map_err(|cause| line(settings, what, cause.to_string()))?;
                return Ok(stream);
            }
            Err(cause) => last = line(settings, what, format!("{address}: {cause}")),
        }
    }
    Err(last)
}

/// The next read waits until then at the longest.
pub(super) fn patience(
    stream: &TcpStream,
    until: Instant,
    settings: &UrSettings,
    what: &'static str,
) -> Result<(), DriverError> {
    let left = until.saturating_duration_since(Instant::now());
    if left.is_zero() {
        return Err(late(settings, what));
    }
    stream.set_read_timeout(Some(left)).map_err(|cause| line(settings, what, cause.to_string()))
}

/// What a failed read or write means.
pub(super) fn broken(settings: &UrSettings, what: &'static str, cause: &Error) -> DriverError {
    match cause.kind() {
        ErrorKind::WouldBlock | ErrorKind::TimedOut => late(settings, what),
        _ => line(settings, what, cause.to_string()),
    }
}

/// The other side has closed.
pub(super) fn closed(settings: &UrSettings, what: &'static str) -> DriverError {
    line(settings, what, "the controller closed the connection".to_owned())
}

fn late(settings: &UrSettings, what: &'static str) -> DriverError {
    DriverError::Timeout { device: settings.device(), what, waited: settings.answer }
}

fn line(settings: &UrSettings, what: &'static str, cause: String) -> DriverError {
    DriverError::Line { device: settings.device(), what, cause }
}
