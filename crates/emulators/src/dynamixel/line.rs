//! The thread that listens on the line and answers.

use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use super::device::Device;
use super::frame::Framer;
use super::instructions::answer;
use super::pty::Pty;
use super::{lock, table};

/// A packet that does not go on for so long is given up.
const PATIENCE: Duration = Duration::from_millis(10);

/// A line that is listened to, until this is dropped.
#[derive(Debug)]
pub(super) struct Line {
    ends: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Line {
    pub(super) fn start(pty: Pty, device: Arc<Mutex<Device>>) -> io::Result<Self> {
        let ends = Arc::new(AtomicBool::new(false));
        let end = Arc::clone(&ends);
        let thread = thread::Builder::new().name("dynamixel".into()).spawn(move || {
            // An error is the end of the line: then there is nobody to be told.
            let _ended = listen(pty, &device, &end);
        })?;
        Ok(Self { ends, thread: Some(thread) })
    }
}

impl Drop for Line {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // It has nothing left to say, even if it panicked.
            let _panicked = thread.join();
        }
    }
}

fn listen(mut pty: Pty, device: &Mutex<Device>, ends: &AtomicBool) -> io::Result<()> {
    let (mut framer, mut bytes) = (Framer::default(), [0; 512]);
    while !ends.load(Ordering::Relaxed) {
        let count = pty.read(&mut bytes, PATIENCE)?;
        if count == 0 {
            framer.forget();
            continue;
        }
        let baud = table::BAUD_RATES[lock(device).memory.get(&table::BAUD_RATE) as usize % table::BAUD_RATES.len()];
        // At another speed all is noise.
        if pty.speed().is_some_and(|speed| speed != baud) {
            continue;
        }
        framer.take(&bytes[..count]);
        while let Some(arrival) = framer.next() {
            let (answer, wait) = {
                let mut device = lock(device);
                let delay = 2e-6 * f64::from(device.memory.get(&table::RETURN_DELAY));
                let wait = Duration::from_secs_f64(delay + 1e-3 * device.faults.delay);
                (answer(&mut device, &arrival).and_then(|bytes| spoil(&mut device, bytes)), wait)
            };
            let Some(answer) = answer else { continue };
            if !wait.is_zero() {
                thread::sleep(wait);
            }
            if ends.load(Ordering::Relaxed) {
                break;
            }
            pty.write(&answer)?;
        }
    }
    Ok(())
}

/// What arrives of an answer.
fn spoil(device: &mut Device, mut answer: Vec<u8>) -> Option<Vec<u8>> {
    let (drop, wrong, noise) = (device.faults.drop, device.faults.wrong_crc, device.faults.noise);
    if device.happens(drop) {
        return None;
    }
    if device.happens(wrong)
        && let Some(last) = answer.last_mut()
    {
        *last ^= 0x5A;
    }
    if device.happens(noise) {
        // Half a header, a header whose length cannot be, and one that promises what never comes.
        let mut spoilt = vec![0x00, 0xFF, 0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x00, 0x00, 0x55, 0xFF, 0xFF];
        spoilt.append(&mut answer);
        spoilt.extend([0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x7F]);
        return Some(spoilt);
    }
    Some(answer)
}
