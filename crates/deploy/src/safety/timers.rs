//! How long something lasts.

use std::time::{Duration, Instant};

/// Since when something is so.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Since(Option<Instant>);

impl Since {
    /// For how long it is so by now; zero where it is not, and when it begins.
    pub(super) fn lasts(&mut self, is_so: bool, now: Instant) -> Duration {
        if !is_so {
            self.0 = None;
            return Duration::ZERO;
        }
        now.saturating_duration_since(*self.0.get_or_insert(now))
    }
}
