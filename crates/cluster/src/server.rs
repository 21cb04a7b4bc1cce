//! Where the queue is, and how to be let in.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use async_nats::{Client, ConnectError, ConnectErrorKind, ConnectOptions, Event};

use crate::error::ClusterError;
use crate::slurm::quoted;

/// The longest file with a token, bytes.
const LONGEST_TOKEN: u64 = 4096;
/// How long a first connection may take.
const PATIENCE: Duration = Duration::from_secs(10);
/// The longest pause between two attempts to be connected again.
const LONGEST_PAUSE: Duration = Duration::from_secs(2);
/// Messages that may wait for us; those beyond are asked for again.
const WAITING: usize = 1 << 16;

/// Words of errors between two machines, and the way out.
const HINTS: [(&str, &str); 7] = [
    (
        "CaUsedAsEndEntity",
        "the server's certificate says that it signs others (CA:TRUE); `openssl req -x509` makes one that does not with \
         -addext basicConstraints=critical,CA:FALSE",
    ),
    ("not valid for name", "use a name in --server that the certificate has"),
    ("Expired", "the server's certificate is too old: it needs another one; see that this machine's clock is right"),
    (
        "invalid peer certificate",
        "--tls-ca names the certificate of those who signed the server's, or the server's own where it signed itself",
    ),
    ("fatal alert", "the server wants to know us, by another certificate than this: --tls-cert and --tls-key name it"),
    ("InvalidContentType", "the server has no TLS: its address begins with nats://, and --tls-ca and --tls-cert go"),
    ("timed out", "nobody answers there, or somebody who is no NATS server; see that address and port are right"),
];

/// A server, and what opens it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Server {
    /// `nats://HOST:PORT`, or `tls://HOST:PORT`.
    pub address: String,
    /// The file with the token.
    pub token: Option<PathBuf>,
    /// The certificates by which the server is known, where they are not the system's (PEM).
    pub authority: Option<PathBuf>,
    /// Our own certificate and its key, where the server wants to know us (PEM).
    pub certificate: Option<(PathBuf, PathBuf)>,
}

impl Server {
    /// What is typed behind a command that is to use it.
    pub fn options(&self) -> String {
        let files = [("--token-file", &self.token), ("--tls-ca", &self.authority)]
            .map(|(option, file)| Some((option, file.as_ref()?)));
        let pair =
            self.certificate.iter().flat_map(|(certificate, key)| [("--tls-cert", certificate), ("--tls-key", key)]);
        let further = files
            .into_iter()
            .flatten()
            .chain(pair)
            .map(|(option, file)| format!(" {option} {}", quoted(&file.display().to_string())));
        format!("--server {}{}", self.address, further.collect::<String>())
    }

    /// Connects; `name` is what the server calls us. Later the connection comes back by itself.
    pub(crate) async fn connect(&self, name: &str) -> Result<Client, ClusterError> {
        let host = self.check()?;
        let mut options = ConnectOptions::new()
            .name(name)
            .connection_timeout(PATIENCE)
            .subscription_capacity(WAITING)
            // A cut network is noticed in seconds.
            .ping_interval(Duration::from_secs(5))
            .reconnect_delay_callback(|attempt| LONGEST_PAUSE.min(Duration::from_millis(100 * attempt.max(1) as u64)))
            .event_callback({
                let (address, cut) = (self.address.clone(), Arc::new(AtomicBool::new(false)));
                move |event| {
                    let (address, cut) = (address.clone(), Arc::clone(&cut));
                    async move { tell(&event, &address, &cut) }
                }
            });
        if let Some(path) = &self.token {
            options = options.token(token(path)?);
            tell_if_open(path);
        }
        if let Some(path) = &self.authority {
            certificates(path)?;
            options = options.add_root_certificates(path.clone()).require_tls(true);
        }
        if let Some((certificate, key)) = &self.certificate {
            readable(certificate)?;
            readable(key)?;
            options = options.add_client_certificate(certificate.clone(), key.clone()).require_tls(true);
        }
        if !is_loopback(&host) && !self.is_private() {
            tracing::warn!(
                "{} is no loopback address and has no TLS: whoever listens on the way reads the token and all that travels",
                self.address
            );
        }
        options.connect(&self.address).await.map_err(|error| ClusterError::Connect {
            address: self.address.clone(),
            why: error.to_string(),
            hint: self.hint(&error),
        })
    }

    /// The way out where there is no connection.
    fn hint(&self, error: &ConnectError) -> &'static str {
        match error.kind() {
            ConnectErrorKind::Authentication | ConnectErrorKind::AuthorizationViolation if self.token.is_some() => {
                "the server has another token than the one in the file that --token-file names"
            }
            ConnectErrorKind::Authentication | ConnectErrorKind::AuthorizationViolation => {
                "the server wants a token: --token-file names the file that holds it"
            }
            ConnectErrorKind::Tls => "--tls-ca, --tls-cert and --tls-key name files with certificates and a key, PEM",
            _ => {
                // What goes wrong in TLS comes as an error of the network: its words say what it was.
                let why = error.to_string();
                let known = HINTS.iter().find(|(words, _)| why.contains(words));
                known.map_or(
                    "`hwasp cluster up` starts a server on this machine; see that address and port are right",
                    |(_, hint)| hint,
                )
            }
        }
    }

    fn is_private(&self) -> bool {
        self.address.starts_with("tls://") || self.authority.is_some() || self.certificate.is_some()
    }

    /// The host of the address.
    fn check(&self) -> Result<String, ClusterError> {
        let fault = |why: &str| ClusterError::Address { address: self.address.clone(), why: why.to_owned() };
        let (scheme, rest) = self.address.split_once("://").ok_or_else(|| fault("it begins with nats:// or tls://"))?;
        if !["nats", "tls"].contains(&scheme) {
            return Err(fault("it begins with nats:// or tls://"));
        }
        if let Some((_, host)) = rest.rsplit_once('@') {
            // The token is told nobody.
            let fault =
                |why: &str| ClusterError::Address { address: format!("{scheme}://…@{host}"), why: why.to_owned() };
            return Err(fault(
                "a token in it would be seen in lists of processes; put it into a file, for --token-file",
            ));
        }
        let host = rest.rsplit_once(':').map_or(rest, |(host, _)| host);
        if host.is_empty() || rest.contains(['/', ' ']) {
            return Err(fault("a host has to follow, and perhaps a port"));
        }
        Ok(host.trim_matches(['[', ']']).to_owned())
    }
}

fn is_loopback(host: &str) -> bool {
    host == "localhost" || host.parse::<std::net::IpAddr>().is_ok_and(|ip| ip.is_loopback())
}

fn readable(path: &Path) -> Result<(), ClusterError> {
    fs::File::open(path).map(drop).map_err(|error| file(path, &error))
}

/// Whether a file has certificates: one without any would be taken for nobody's.
fn certificates(path: &Path) -> Result<(), ClusterError> {
    let bytes = fs::read(path).map_err(|error| file(path, &error))?;
    let there = String::from_utf8_lossy(&bytes).contains("-----BEGIN CERTIFICATE-----");
    if there { Ok(()) } else { Err(file(path, &"it has no certificate (PEM)")) }
}

/// Tells of a file with a token that everybody on this machine can read.
fn tell_if_open(path: &Path) {
    #[cfg(unix)]
    if let Ok(about) = fs::metadata(path)
        && std::os::unix::fs::PermissionsExt::mode(&about.permissions()) & 0o007 != 0
    {
        tracing::warn!("everybody on this machine can read the token in {}: `chmod 600` keeps it", path.display());
    }
}

fn file(path: &Path, why: &dyn std::fmt::Display) -> ClusterError {
    ClusterError::File { path: path.to_owned(), why: why.to_string() }
}

/// The token in a file; spaces and line breaks around it are no part of it.
pub(crate) fn token(path: &Path) -> Result<String, ClusterError> {
    let fault = |why: &dyn std::fmt::Display| {
        file(
            path,
            &format!(
                "{why}\n  = hint: `hwasp cluster up` writes a token into the folder of its queue, runs/queue/token by default"
            ),
        )
    };
    let length = fs::metadata(path).map_err(|error| fault(&error))?.len();
    if length > LONGEST_TOKEN {
        return Err(fault(&format!("a token has at most {LONGEST_TOKEN} bytes, and it has {length}")));
    }
    let text = fs::read_to_string(path).map_err(|error| fault(&error))?;
    let token = text.trim();
    if token.is_empty() || token.contains(char::is_whitespace) {
        return Err(fault(&"it has to hold a token, one word"));
    }
    Ok(token.to_owned())
}

/// The connection's own news. `cut`: whether it was told that it is gone.
fn tell(event: &Event, address: &str, cut: &AtomicBool) {
    match event {
        Event::Disconnected => {
            cut.store(true, Ordering::Relaxed);
            tracing::warn!("the connection to {address} is gone; it is tried again");
        }
        Event::Connected if cut.swap(false, Ordering::Relaxed) => {
            tracing::info!("the connection to {address} is there again");
        }
        Event::Connected => tracing::debug!("connected"),
        Event::SlowConsumer(_) => tracing::debug!("messages came faster than they were read; they are asked for again"),
        Event::ServerError(error) => tracing::warn!("the server says: {error}"),
        Event::ClientError(error) => tracing::debug!("the connection: {error}"),
        Event::LameDuckMode | Event::Draining | Event::Closed => tracing::debug!("{event}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_server_is_typed_as_it_was_given() {
        let server = Server { address: "tls://box:1".into(), token: Some("a b".into()), ..Server::default() };
        assert_eq!(server.options(), "--server tls://box:1 --token-file 'a b'");
        let certificate = Some(("c".into(), "k".into()));
        let server = Server { token: None, authority: Some("ca".into()), certificate, ..server };
        assert_eq!(server.options(), "--server tls://box:1 --tls-ca ca --tls-cert c --tls-key k");
    }

    #[test]
    fn addresses_are_checked_before_anything_is_sent() {
        let host = |address: &str| Server { address: address.to_owned(), ..Server::default() }.check();
        assert_eq!(host("nats://127.0.0.1:4222").unwrap(), "127.0.0.1");
        assert_eq!(host("tls://queue.lab.example").unwrap(), "queue.lab.example");
        assert_eq!(host("nats://[::1]:4222").unwrap(), "::1");
        for wrong in
            ["127.0.0.1:4222", "http://host", "nats://", "nats://:4222", "nats://secret@host:4222", "nats://a b"]
        {
            assert!(host(wrong).is_err(), "{wrong}");
        }
    }
}
