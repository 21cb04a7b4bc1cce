//! Time, so that tests can have one of their own.

use std::time::Instant;

/// What the loop knows of time.
pub trait Clock: Send {
    /// Now.
    fn now(&self) -> Instant;
    /// Waits until then; returns at once if that is past.
    fn sleep_until(&self, then: Instant);
}

/// The computer's own.
#[derive(Clone, Copy, Debug, Default)]
pub struct SystemClock;

impl Clock for SystemClock {
    fn now(&self) -> Instant {
        Instant::now()
    }

    fn sleep_until(&self, then: Instant) {
        let wait = then.saturating_duration_since(Instant::now());
        if !wait.is_zero() {
            std::thread::sleep(wait);
        }
    }
}
