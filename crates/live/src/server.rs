//! The server: a thread that waits for connections, with limits on what one may send and how long it may take.

use std::io;
use std::net::{IpAddr, SocketAddr, TcpListener};
use std::path::PathBuf;
use std::pin::pin;
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use hwasp_experiment::Catalogue;
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use thiserror::Error;
use tokio::net::TcpStream;
use tokio::sync::{Semaphore, oneshot};
use tokio::time::timeout;

use crate::api::Desk;
use crate::door::Door;
use crate::list::List;
use crate::nice::step_back;
use crate::worker::Worker;

/// The port where none is named.
pub const DEFAULT_PORT: u16 = 8437;
/// Connections at a time; further ones wait.
const MOST_CONNECTIONS: usize = 64;
/// The longest head of a request, bytes.
const LONGEST_HEAD: usize = 32 << 10;
/// How long a client may take for the head of a request.
const HEAD_TIME: Duration = Duration::from_secs(5);
/// How long a connection is used, and how long its last answer may take then.
const CONNECTION_TIME: Duration = Duration::from_mins(1);
/// Threads that read run folders.
const READERS: usize = 2;

/// Why there is no page.
#[derive(Debug, Error)]
pub enum StartError {
    /// The address cannot be had.
    #[error("{address} cannot be listened at: {}", if .source.kind() == io::ErrorKind::AddrInUse {
        "another program has this port".to_owned()
    } else {
        source.to_string()
    })]
    Listen {
        /// The address.
        address: SocketAddr,
        /// What the system says.
        source: io::Error,
    },
    /// No thread or no random number is to be had.
    #[error("the page cannot be served: {0}")]
    System(String),
}

/// What is served, and to whom.
#[derive(Debug, Default)]
pub struct Options {
    /// Run folders, and folders that hold some. They need not be there yet.
    pub runs: Vec<PathBuf>,
    /// Names that lead to this machine, besides localhost and addresses.
    pub names: Vec<String>,
}

/// A page that is served, until this is dropped.
#[derive(Debug)]
pub struct Server {
    address: SocketAddr,
    token: Option<String>,
    stop: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

/// Listens at an address; where its port is taken, at one of the `others` that follow it.
pub fn listen(address: SocketAddr, others: u16) -> Result<TcpListener, StartError> {
    let mut last = None;
    for port in address.port()..=address.port().saturating_add(others) {
        match TcpListener::bind(SocketAddr::new(address.ip(), port)) {
            Ok(listener) => return Ok(listener),
            Err(source) => last = last.or(Some(source)),
        }
    }
    Err(StartError::Listen { address, source: last.unwrap_or_else(|| io::ErrorKind::AddrInUse.into()) })
}

impl Server {
    /// Serves the page on a thread of its own.
    pub fn start(listener: TcpListener, options: Options, catalogue: &Catalogue) -> Result<Self, StartError> {
        let system = |error: io::Error| StartError::System(error.to_string());
        let address = listener.local_addr().map_err(system)?;
        listener.set_nonblocking(true).map_err(system)?;
        let door = Door::new(address, &options.names).map_err(|error| StartError::System(error.to_string()))?;
        let token = door.token.clone();
        let began = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_nanos());
        let list = Mutex::new(List::new(options.runs, catalogue.clone(), format!("{began:x}")));
        let worker = Worker::start(catalogue.clone()).map_err(system)?;
        let desk = Arc::new(Desk { door, list, worker });
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_io()
            .enable_time()
            .max_blocking_threads(READERS)
            .build()
            .map_err(system)?;
        let (stop, stopped) = oneshot::channel();
        let serve = move || {
            step_back(10);
            runtime.block_on(async {
                tokio::spawn(accept(listener, desk));
                // It is told so, or the server is dropped.
                let _ = stopped.await;
            });
            runtime.shutdown_background();
        };
        let thread = std::thread::Builder::new().name("hwasp-watch".to_owned()).spawn(serve).map_err(system)?;
        Ok(Self { address, token, stop: Some(stop), thread: Some(thread) })
    }

    /// Where it is listening.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// The token that data need, where it can be reached from elsewhere.
    pub fn token(&self) -> Option<&str> {
        self.token.as_deref()
    }

    /// What a browser on this machine opens. The token is behind the `#`, which browsers keep to themselves.
    pub fn url(&self) -> String {
        let (ip, port) = (self.address.ip(), self.address.port());
        let host = match ip {
            ip if ip.is_unspecified() => "localhost".to_owned(),
            IpAddr::V6(ip) => format!("[{ip}]"),
            IpAddr::V4(ip) => ip.to_string(),
        };
        let token = self.token.as_ref().map(|token| format!("#token={token}"));
        format!("http://{host}:{port}/{}", token.unwrap_or_default())
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(thread) = self.thread.take() {
            // It has nothing to tell.
            let _ = thread.join();
        }
    }
}

async fn accept(listener: TcpListener, desk: Arc<Desk>) {
    let Ok(listener) = tokio::net::TcpListener::from_std(listener) else { return };
    let places = Arc::new(Semaphore::new(MOST_CONNECTIONS));
    loop {
        let Ok(place) = Arc::clone(&places).acquire_owned().await else { return };
        let Ok((stream, _)) = listener.accept().await else {
            // Too many open files, perhaps: that passes.
            tokio::time::sleep(Duration::from_millis(50)).await;
            continue;
        };
        let desk = Arc::clone(&desk);
        tokio::spawn(async move {
            connection(stream, desk).await;
            drop(place);
        });
    }
}

async fn connection(stream: TcpStream, desk: Arc<Desk>) {
    // Answers are small, and each is written in one piece.
    let _ = stream.set_nodelay(true);
    let service = service_fn(move |request: hyper::Request<hyper::body::Incoming>| {
        let desk = Arc::clone(&desk);
        async move {
            let (head, _) = request.into_parts();
            Ok::<_, std::convert::Infallible>(desk.answer(&head).await.response())
        }
    });
    let mut settings = http1::Builder::new();
    settings.timer(TokioTimer::new()).header_read_timeout(HEAD_TIME).max_buf_size(LONGEST_HEAD);
    let mut connection = pin!(settings.serve_connection(TokioIo::new(stream), service));
    // What a client does wrong is its own affair.
    if timeout(CONNECTION_TIME, connection.as_mut()).await.is_err() {
        connection.as_mut().graceful_shutdown();
        let _ = timeout(CONNECTION_TIME, connection).await;
    }
}
