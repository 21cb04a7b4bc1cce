//! A motor in real time, with a driver at the other end of its line.

#![allow(clippy::unwrap_used, dead_code, reason = "a panic is how a test fails, and each test binary uses its part")]

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use hwasp_drivers::{Dynamixel, DynamixelSettings, Pose};
use hwasp_emulators::{DynamixelEmulator, FreeSpool, STEP, World};

/// How long drivers wait for an answer.
pub(crate) const REPLY: Duration = Duration::from_millis(250);
const PATIENCE: Duration = Duration::from_secs(2);

/// A motor and its spool, moved on once a millisecond.
pub(crate) struct Bench {
    emulator: Arc<Mutex<DynamixelEmulator>>,
    ends: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Bench {
    pub(crate) fn start() -> Self {
        let emulator = Arc::new(Mutex::new(DynamixelEmulator::start(1, 1_000_000).unwrap()));
        let ends = Arc::new(AtomicBool::new(false));
        let (motor, end) = (Arc::clone(&emulator), Arc::clone(&ends));
        let thread = thread::spawn(move || {
            let mut world = FreeSpool::default();
            // No slower than it would be, and no faster: time that a busy machine loses is not caught up with.
            while !end.load(Ordering::Relaxed) {
                {
                    let motor = motor.lock().unwrap();
                    motor.tell(world.step(&Pose::default(), motor.drive()));
                    motor.advance(STEP);
                }
                thread::sleep(Duration::from_micros(950));
            }
        });
        Self { emulator, ends, thread: Some(thread) }
    }

    pub(crate) fn inject(&self, fault: &str) {
        self.emulator.lock().unwrap().inject(fault).unwrap();
    }

    pub(crate) fn path(&self) -> PathBuf {
        self.emulator.lock().unwrap().path().to_owned()
    }

    /// With more patience than on a bench: machines that test have other things to do.
    pub(crate) fn settings(&self) -> DynamixelSettings {
        DynamixelSettings { port: self.path(), reply: REPLY, watchdog: PATIENCE, ..DynamixelSettings::default() }
    }

    /// A driver whose motor is prepared.
    pub(crate) fn driver(&self) -> Dynamixel {
        let mut motor = Dynamixel::open(self.settings()).unwrap();
        motor.prepare().unwrap();
        motor
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        self.ends.store(true, Ordering::Relaxed);
        self.thread.take().unwrap().join().unwrap();
    }
}

/// Asks again and again until the answer is as wanted, for ten seconds.
pub(crate) fn until<T: std::fmt::Debug>(mut ask: impl FnMut() -> T, wanted: impl Fn(&T) -> bool) -> T {
    let began = Instant::now();
    loop {
        let answer = ask();
        if wanted(&answer) {
            return answer;
        }
        assert!(began.elapsed() < Duration::from_secs(10), "{answer:?} after ten seconds");
        thread::sleep(Duration::from_millis(2));
    }
}
