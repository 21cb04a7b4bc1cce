//! The connection of RTDE once packets flow: a thread keeps the newest, orders go out.

use std::io::{Read, Write};
use std::net::{Shutdown, TcpStream};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::late::Lateness;
use super::reading::Reading;
use super::registers as r;
use super::settings::UrSettings;
use super::talk::{OUTPUTS, Talk, odd, unasked};
use super::tcp;
use super::wire::{Body, Frame, Frames, kind};
use crate::arm::Pose;
use crate::error::DriverError;

/// The newest packet, when it came, and by how much it was late.
#[derive(Clone, Debug)]
pub(super) struct Newest {
    pub(super) at: Instant,
    pub(super) late: Duration,
    pub(super) reading: Reading,
}

#[derive(Debug, Default)]
struct Inbox {
    newest: Option<Newest>,
    count: u64,
    broken: Option<DriverError>,
}

#[derive(Debug, Default)]
struct Shared {
    inbox: Mutex<Inbox>,
    news: Condvar,
}

/// An open connection.
#[derive(Debug)]
pub(super) struct Link {
    stream: TcpStream,
    settings: UrSettings,
    shared: Arc<Shared>,
    reader: Option<JoinHandle<()>>,
    /// Of the recipe that we send.
    inputs: u8,
    /// Of the controller: major, minor, bugfix, build.
    pub(super) version: [u32; 4],
}

impl Link {
    /// Connects, agrees, and has the first packet when it returns.
    pub(super) fn connect(settings: &UrSettings) -> Result<Self, DriverError> {
        match Self::open(settings, true) {
            // As the vendor's own client does, from the beginning: a refused recipe leaves a connection of little use.
            Err(DriverError::Refused { what: OUTPUTS, .. }) => Self::open(settings, false),
            opened => opened,
        }
    }

    fn open(settings: &UrSettings, full: bool) -> Result<Self, DriverError> {
        let stream = tcp::connect(settings, settings.rtde_port, "connecting to RTDE")?;
        let mut talk = Talk::new(stream, settings);
        talk.agree()?;
        let version = talk.version()?;
        let most = if version[0] >= 5 { 500.0 } else { 125.0 };
        if settings.frequency > most {
            let (device, limits) =
                (settings.device(), format!("1 to {most}: the controller's version is {}", version[0]));
            return Err(DriverError::Value { device, name: "frequency", value: settings.frequency, limits });
        }
        let outputs = talk.outputs(full)?;
        let inputs = talk.inputs()?;
        talk.start()?;
        let (stream, frames) = talk.end();
        let broken = |cause: std::io::Error| tcp::broken(settings, "starting to read", &cause);
        stream.set_read_timeout(None).map_err(broken)?;
        let shared = Arc::new(Shared::default());
        let mut inlet = Inlet {
            stream: stream.try_clone().map_err(broken)?,
            settings: settings.clone(),
            frames,
            outputs,
            full,
            lateness: Lateness::default(),
            shared: Arc::clone(&shared),
        };
        let reader = std::thread::Builder::new().name("arm".to_owned()).spawn(move || inlet.run()).map_err(broken)?;
        let link = Self { stream, settings: settings.clone(), shared, reader: Some(reader), inputs, version };
        link.after(0, settings.answer)?;
        Ok(link)
    }

    /// The newest packet and how many came; an error where the connection is broken.
    pub(super) fn newest(&self) -> Result<(u64, Newest), DriverError> {
        self.after(0, Duration::ZERO)
    }

    /// The newest packet once more than `count` have come; waits at most `patience`.
    pub(super) fn after(&self, count: u64, patience: Duration) -> Result<(u64, Newest), DriverError> {
        let waits = |inbox: &mut Inbox| inbox.broken.is_none() && inbox.count <= count;
        let (inbox, _) = self
            .shared
            .news
            .wait_timeout_while(lock(&self.shared.inbox), patience, waits)
            .unwrap_or_else(PoisonError::into_inner);
        if let Some(broken) = &inbox.broken {
            return Err(broken.clone());
        }
        match &inbox.newest {
            Some(newest) if inbox.count > count => Ok((inbox.count, newest.clone())),
            _ => Err(DriverError::Timeout { device: self.settings.device(), what: "state", waited: patience }),
        }
    }

    /// Writes the registers of the program, all in one packet.
    pub(super) fn order(
        &mut self,
        command: r::Command,
        number: i32,
        beat: i32,
        target: &Pose,
        speed: f64,
    ) -> Result<(), DriverError> {
        let mut body = vec![self.inputs];
        for value in [command as i32, number, beat] {
            body.extend_from_slice(&value.to_be_bytes());
        }
        for value in target.position.iter().chain(&target.rotation).chain([&speed]) {
            body.extend_from_slice(&value.to_be_bytes());
        }
        // 69 bytes: a frame can tell them.
        let bytes = Frame::bytes(kind::DATA, &body).unwrap_or_default();
        self.stream.write_all(&bytes).map_err(|cause| tcp::broken(&self.settings, "sending an order", &cause))
    }
}

impl Drop for Link {
    fn drop(&mut self) {
        // The reader wakes up by this.
        let _ = self.stream.shutdown(Shutdown::Both);
        if let Some(reader) = self.reader.take() {
            let _ = reader.join();
        }
    }
}

fn lock(inbox: &Mutex<Inbox>) -> MutexGuard<'_, Inbox> {
    inbox.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What the thread has that reads.
struct Inlet {
    stream: TcpStream,
    settings: UrSettings,
    frames: Frames,
    outputs: u8,
    full: bool,
    lateness: Lateness,
    shared: Arc<Shared>,
}

impl Inlet {
    /// Reads until the connection ends, by whichever side.
    fn run(&mut self) {
        let mut bytes = [0; 4096];
        let mut at = Instant::now();
        let end = loop {
            if let Err(cause) = self.sort(at) {
                break cause;
            }
            match self.stream.read(&mut bytes) {
                Ok(0) => break tcp::closed(&self.settings, "state"),
                Ok(count) => {
                    at = Instant::now();
                    self.frames.push(&bytes[..count]);
                }
                Err(cause) => break tcp::broken(&self.settings, "state", &cause),
            }
        };
        let _ = self.stream.shutdown(Shutdown::Both);
        lock(&self.shared.inbox).broken = Some(end);
        self.shared.news.notify_all();
    }

    /// Takes whole frames out of what has come.
    fn sort(&mut self, at: Instant) -> Result<(), DriverError> {
        let what = "state";
        while let Some(frame) = self.frames.take().map_err(|cause| odd(&self.settings, what, &cause))? {
            match frame.kind {
                kind::DATA => {
                    let mut body = Body::new(&frame.body);
                    let number = body.u8().map_err(|cause| odd(&self.settings, what, &cause))?;
                    if number != self.outputs {
                        let cause = format!("a packet of recipe {number}; ours is {}", self.outputs);
                        return Err(DriverError::Protocol { device: self.settings.device(), what, cause });
                    }
                    let reading =
                        Reading::decode(body, self.full).map_err(|cause| odd(&self.settings, what, &cause))?;
                    let late = self.lateness.of(at, reading.clock);
                    let mut inbox = lock(&self.shared.inbox);
                    inbox.newest = Some(Newest { at, late, reading });
                    inbox.count += 1;
                    drop(inbox);
                    self.shared.news.notify_all();
                }
                kind::TEXT => {}
                other => return Err(unasked(&self.settings, what, other)),
            }
        }
        Ok(())
    }
}
