//! The emulator without a world behind it: a thread lets its time go on.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::{PortError, UrEmulator, UrEmulatorSettings};

/// An emulator whose clock is this machine's, for tests and for clients of others.
#[derive(Debug)]
pub struct Alone {
    emulator: Arc<Mutex<UrEmulator>>,
    ends: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Alone {
    /// Starts the emulator, and its time.
    pub fn start(settings: &UrEmulatorSettings) -> Result<Self, PortError> {
        let emulator = Arc::new(Mutex::new(UrEmulator::start(settings)?));
        let ends = Arc::new(AtomicBool::new(false));
        let (inner, over) = (Arc::clone(&emulator), Arc::clone(&ends));
        let thread = std::thread::spawn(move || {
            let mut last = Instant::now();
            while !over.load(Ordering::Relaxed) {
                std::thread::sleep(Duration::from_micros(500));
                let now = Instant::now();
                lock(&inner).advance((now - last).as_secs_f64());
                last = now;
            }
        });
        Ok(Self { emulator, ends, thread: Some(thread) })
    }

    /// The emulator, between two of its steps. Time stands still while it is held.
    pub fn emulator(&self) -> MutexGuard<'_, UrEmulator> {
        lock(&self.emulator)
    }
}

impl Drop for Alone {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn lock(emulator: &Mutex<UrEmulator>) -> MutexGuard<'_, UrEmulator> {
    emulator.lock().unwrap_or_else(PoisonError::into_inner)
}
