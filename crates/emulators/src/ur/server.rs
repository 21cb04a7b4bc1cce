//! Sockets: a thread for each port and for each connection.

use std::io::{Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::sync_channel;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use hwasp_drivers::ur::wire::Frames;

use super::controller::Controller;
use super::rtde::Client;
use super::upload::Upload;
use super::{dashboard, settings::Generation};

/// Frames that wait to be written to one client.
const WAITING: usize = 256;

/// What ports and host share.
#[derive(Debug)]
pub(super) struct Shared {
    pub(crate) controller: Controller,
    pub(crate) clients: Vec<(u64, Client)>,
    /// Every connection, to be cut.
    pub(crate) streams: Vec<(u64, TcpStream)>,
    next: u64,
}

impl Shared {
    pub(crate) fn new(controller: Controller) -> Self {
        Self { controller, clients: Vec::new(), streams: Vec::new(), next: 0 }
    }

    /// Closes all that is connected.
    pub(crate) fn cut(&mut self) {
        for (_, stream) in self.streams.drain(..) {
            let _ = stream.shutdown(Shutdown::Both);
        }
        self.clients.clear();
    }

    fn gone(&mut self, number: u64) {
        self.streams.retain(|(own, _)| *own != number);
        self.clients.retain(|(own, _)| *own != number);
    }
}

pub(super) fn lock(shared: &Mutex<Shared>) -> MutexGuard<'_, Shared> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What a port serves.
#[derive(Clone, Copy, Debug)]
pub(super) enum Service {
    Rtde,
    Dashboard,
    Script,
}

/// A port that is open.
#[derive(Debug)]
pub(super) struct Door {
    pub(crate) address: SocketAddr,
    ends: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Door {
    pub(crate) fn open(address: SocketAddr, service: Service, shared: &Arc<Mutex<Shared>>) -> std::io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        let address = listener.local_addr()?;
        let ends = Arc::new(AtomicBool::new(false));
        let (shared, over) = (Arc::clone(shared), Arc::clone(&ends));
        let thread = std::thread::Builder::new().name(format!("{service:?}")).spawn(move || {
            for stream in listener.incoming() {
                if over.load(Ordering::Relaxed) {
                    return;
                }
                if let Ok(stream) = stream {
                    admit(stream, service, &shared);
                }
            }
        })?;
        Ok(Self { address, ends, thread: Some(thread) })
    }
}

impl Drop for Door {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Relaxed);
        // Wakes the thread that waits for somebody to come.
        let woken = TcpStream::connect(self.address).is_ok();
        if let Some(thread) = self.thread.take().filter(|_| woken) {
            let _ = thread.join();
        }
    }
}

fn admit(stream: TcpStream, service: Service, shared: &Arc<Mutex<Shared>>) {
    let _ = stream.set_nodelay(true);
    let Ok(copy) = stream.try_clone() else {
        return;
    };
    let number = {
        let mut all = lock(shared);
        all.next += 1;
        let number = all.next;
        all.streams.push((number, copy));
        number
    };
    let shared = Arc::clone(shared);
    // Without a thread there is no service: the connection closes.
    let _ = std::thread::Builder::new().name(format!("{service:?} {number}")).spawn(move || {
        match service {
            Service::Rtde => rtde(stream, number, &shared),
            Service::Dashboard => ask(stream, &shared),
            Service::Script => upload(stream, &shared),
        }
        lock(&shared).gone(number);
    });
}

fn rtde(mut stream: TcpStream, number: u64, shared: &Mutex<Shared>) {
    let Ok(mut out) = stream.try_clone() else {
        return;
    };
    let (line, waiting) = sync_channel::<Vec<u8>>(WAITING);
    lock(shared).clients.push((number, Client::new(line)));
    let writer = std::thread::Builder::new().name("RTDE out".to_owned()).spawn(move || {
        while waiting.recv().is_ok_and(|bytes| out.write_all(&bytes).is_ok()) {}
        let _ = out.shutdown(Shutdown::Both);
    });
    let mut frames = Frames::default();
    let mut bytes = [0; 4096];
    'open: while writer.is_ok() {
        match stream.read(&mut bytes) {
            Ok(count) if count > 0 => frames.push(&bytes[..count]),
            _ => break,
        }
        loop {
            let frame = match frames.take() {
                Ok(Some(frame)) => frame,
                Ok(None) => break,
                Err(cause) => {
                    lock(shared).controller.say(format!("RTDE: {cause}"));
                    break 'open;
                }
            };
            let Shared { controller, clients, .. } = &mut *lock(shared);
            let Some(at) = clients.iter().position(|(own, _)| *own == number) else {
                break 'open;
            };
            // Taken out, so that it can be asked about the others.
            let (_, mut client) = clients.swap_remove(at);
            let stays = client.answer(&frame, controller, &|sink| clients.iter().any(|(_, other)| other.writes(sink)));
            clients.push((number, client));
            if !stays {
                break 'open;
            }
        }
    }
    let _ = stream.shutdown(Shutdown::Both);
}

fn ask(mut stream: TcpStream, shared: &Mutex<Shared>) {
    if stream.write_all(format!("{}\n", dashboard::GREETING).as_bytes()).is_err() {
        return;
    }
    let mut unread = Vec::new();
    let mut bytes = [0; 512];
    while unread.len() < 4096 {
        match stream.read(&mut bytes) {
            Ok(count) if count > 0 => unread.extend_from_slice(&bytes[..count]),
            _ => break,
        }
        while let Some(end) = unread.iter().position(|byte| *byte == b'\n') {
            let line: Vec<u8> = unread.drain(..=end).collect();
            let (text, stays) = dashboard::answer(&mut lock(shared).controller, String::from_utf8_lossy(&line).trim());
            if stream.write_all(format!("{text}\n").as_bytes()).is_err() || !stays {
                let _ = stream.shutdown(Shutdown::Both);
                return;
            }
        }
    }
    let _ = stream.shutdown(Shutdown::Both);
}

fn upload(mut stream: TcpStream, shared: &Mutex<Shared>) {
    let mut upload = Upload::default();
    let mut bytes = [0; 4096];
    while let Ok(count) = stream.read(&mut bytes) {
        if count == 0 {
            break;
        }
        let mut all = lock(shared);
        // In local control an e-Series closes the port to programs.
        if all.controller.faults.local && all.controller.settings.generation == Generation::ESeries {
            all.controller.say("a program was refused: local control".to_owned());
            break;
        }
        match upload.push(&bytes[..count]) {
            Ok(programs) => programs.iter().for_each(|program| all.controller.start(program)),
            Err(cause) => {
                all.controller.say(cause);
                break;
            }
        }
    }
    let _ = stream.shutdown(Shutdown::Both);
}
