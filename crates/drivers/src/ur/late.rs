//! How late a packet is: the controller's clock against ours.

use std::time::{Duration, Instant};

/// By how much the two clocks may drift apart, s a second; crystals of computers stay below 1e-4.
const DRIFT: f64 = 2e-4;

/// Remembers the quickest packet. A packet that took longer than it is late by the difference; packets that come regularly, but
/// through a line that holds them back, are so found as well.
#[derive(Debug, Default)]
pub(super) struct Lateness {
    /// When it began, and the least of arrival minus clock since, s.
    quickest: Option<(Instant, f64, f64)>,
}

impl Lateness {
    /// By how much a packet is late that arrived at `at`, and was sent at `clock`, s.
    pub(super) fn of(&mut self, at: Instant, clock: f64) -> Duration {
        if !clock.is_finite() {
            return Duration::ZERO; // nothing to go by; whoever reads the packet is told
        }
        let (start, least, seen) = *self.quickest.get_or_insert((at, -clock, 0.0));
        let now = at.saturating_duration_since(start).as_secs_f64();
        let offset = now - clock;
        // The clocks may have drifted since.
        let least = (least + (now - seen).max(0.0) * DRIFT).min(offset);
        self.quickest = Some((start, least, now));
        Duration::from_secs_f64((offset - least).clamp(0.0, 1e6))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_held_back_is_late_and_drift_is_not() {
        let start = Instant::now();
        let mut lateness = Lateness::default();
        for step in 0..100_000_u32 {
            // The controller's clock runs slow by 1e-4.
            let at = start + Duration::from_millis(8) * step;
            let late = lateness.of(at, 1000.0 + 0.008 * f64::from(step) * (1.0 - 1e-4));
            assert!(late < Duration::from_millis(1), "{late:?} at {step}");
        }
        let at = start + Duration::from_millis(8) * 100_000 + Duration::from_millis(50);
        let late = lateness.of(at, 1000.0 + 800.0 * (1.0 - 1e-4));
        assert!(late > Duration::from_millis(49), "{late:?}");
    }
}
