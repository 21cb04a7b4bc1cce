//! Absolute deadlines, and how late they were met.

use std::time::{Duration, Instant};

/// Deadlines of one period. A deadline that was missed by more than a period is left out, not made up for.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    period: Duration,
    next: Instant,
}

impl Pace {
    /// The first deadline is `first`.
    pub fn new(first: Instant, period: Duration) -> Self {
        Self { period, next: first }
    }

    /// The deadline to wait for.
    pub fn next(&self) -> Instant {
        self.next
    }

    /// The deadline is met at `now`: how late that is.
    pub fn met(&mut self, now: Instant) -> Duration {
        let late = now.saturating_duration_since(self.next);
        self.next += self.period;
        while self.next + self.period <= now {
            self.next += self.period;
        }
        late
    }

    /// From now on, as if nothing had been missed.
    pub fn restart(&mut self, now: Instant) {
        self.next = now;
    }
}

/// The width of a class, µs.
const CLASS: u64 = 10;
/// Classes: the last has all that is later.
const CLASSES: usize = 5000;

/// How late deadlines were met: counts in classes of 10 µs, so that keeping them takes no memory and no time.
#[derive(Clone, Debug)]
pub struct Jitter {
    classes: Vec<u64>,
    count: u64,
    worst: Duration,
}

impl Default for Jitter {
    fn default() -> Self {
        Self { classes: vec![0; CLASSES], count: 0, worst: Duration::ZERO }
    }
}

impl Jitter {
    /// Counts a deadline.
    pub fn note(&mut self, late: Duration) {
        let class = (late.as_micros() as u64 / CLASS).min(CLASSES as u64 - 1);
        self.classes[class as usize] += 1;
        self.count += 1;
        self.worst = self.worst.max(late);
    }

    /// Deadlines counted.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The latest.
    pub fn worst(&self) -> Duration {
        self.worst
    }

    /// The lateness that a share of them kept, to 10 µs and rounded up.
    pub fn quantile(&self, share: f64) -> Duration {
        let wanted = (share * self.count as f64).ceil() as u64;
        let mut so_far = 0;
        for (class, count) in self.classes.iter().enumerate() {
            so_far += count;
            if so_far >= wanted.max(1) {
                return Duration::from_micros((class as u64 + 1) * CLASS).min(self.worst);
            }
        }
        self.worst
    }
}

impl std::fmt::Display for Jitter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let ms = |time: Duration| 1e3 * time.as_secs_f64();
        let (median, most, worst) = (self.quantile(0.5), self.quantile(0.99), self.worst);
        write!(
            f,
            "{:.2} ms median, {:.2} ms at the 99th percentile, {:.2} ms at worst, of {} steps",
            ms(median),
            ms(most),
            ms(worst),
            self.count
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deadlines_are_absolute() {
        let (begin, ms) = (Instant::now(), Duration::from_millis);
        let mut pace = Pace::new(begin, ms(10));
        assert_eq!(pace.met(begin + ms(3)), ms(3));
        // The next one is where it would have been.
        assert_eq!(pace.next(), begin + ms(10));
        assert_eq!(pace.met(begin + ms(47)), ms(37));
        // Three were missed, and are left out; the one that is due is met late.
        assert_eq!(pace.next(), begin + ms(40));
        assert_eq!(pace.met(begin + ms(47)), ms(7));
        assert_eq!(pace.next(), begin + ms(50));
    }

    #[test]
    fn quantiles_of_lateness() {
        let mut jitter = Jitter::default();
        assert_eq!(jitter.quantile(0.5), Duration::ZERO);
        for late in 0..1000_u64 {
            jitter.note(Duration::from_micros(late));
        }
        jitter.note(Duration::from_secs(1));
        assert_eq!(jitter.quantile(0.5), Duration::from_micros(510));
        assert_eq!(jitter.quantile(0.99), Duration::from_millis(1));
        assert_eq!((jitter.worst(), jitter.count()), (Duration::from_secs(1), 1001));
    }
}
