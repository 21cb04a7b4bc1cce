//! Arguments of the page that follows trainings.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::PathBuf;

use hwasp_live::DEFAULT_PORT;

use super::parse::{path, whole};

/// Ports that are tried behind the usual one where nobody names one.
const OTHERS: u16 = 9;

#[derive(Debug, clap::Args)]
pub(crate) struct WatchArgs {
    /// Run folders, and folders that hold some; they need not be there yet
    #[arg(required = true, value_name = "RUN", value_parser = path())]
    pub(crate) runs: Vec<PathBuf>,
    /// The port [default: 8437, or the next one that is free]
    #[arg(long, allow_negative_numbers = true, value_parser = whole(0..=65_535))]
    port: Option<u64>,
    /// The address at which it can be reached, with or without a port. Elsewhere than on loopback the page needs a token, which is
    /// in the address that is printed
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1", value_parser = place)]
    bind: Place,
    /// A name of this machine by which others open the page; may be repeated
    #[arg(long = "host", value_name = "NAME", value_parser = host)]
    pub(crate) hosts: Vec<String>,
}

/// An address, and a port where one is named.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    ip: IpAddr,
    port: Option<u16>,
}

/// This machine alone, where nothing is said.
pub(crate) const LOOPBACK: &str = "127.0.0.1";

/// Reads `127.0.0.1`, `0.0.0.0:9000`, `::1`, `[::1]:9000` or a port alone.
pub(super) fn place(text: &str) -> Result<Place, String> {
    if let Ok(address) = text.parse::<SocketAddr>() {
        return Ok(Place { ip: address.ip(), port: Some(address.port()) });
    }
    if let Ok(port) = text.parse() {
        return Ok(Place { ip: Ipv4Addr::LOCALHOST.into(), port: Some(port) });
    }
    let bare = text.strip_prefix('[').and_then(|text| text.strip_suffix(']')).unwrap_or(text);
    let ip = if text == "localhost" { Ok(Ipv4Addr::LOCALHOST.into()) } else { bare.parse() };
    ip.map(|ip| Place { ip, port: None })
        .map_err(|_| "it has to be an address such as 127.0.0.1, 0.0.0.0:9000 or [::1]:9000, or a port".to_owned())
}

/// The name of a machine, as browsers ask for it.
fn host(text: &str) -> Result<String, String> {
    let fits = |c: char| c.is_alphanumeric() || "-._".contains(c);
    if !text.is_empty() && text.chars().all(fits) {
        return Ok(text.to_owned());
    }
    Err("it has to be a name alone, such as box.lan: no address of a page, no port".to_owned())
}

impl Place {
    /// The first address to try, and how many ports behind it.
    pub(crate) fn asked(self) -> (SocketAddr, u16) {
        let others = if self.port.is_some() { 0 } else { OTHERS };
        (SocketAddr::new(self.ip, self.port.unwrap_or(DEFAULT_PORT)), others)
    }
}

impl WatchArgs {
    /// Where it listens.
    pub(crate) fn place(&self) -> Place {
        let port = self.port.and_then(|port| u16::try_from(port).ok());
        Place { port: port.or(self.bind.port), ..self.bind }
    }
}
