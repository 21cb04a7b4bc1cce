//! How a motor is reached and what it may do.

use std::path::PathBuf;
use std::time::Duration;

use super::registers::{BAUD_RATES, CURRENT_TICK, FARTHEST, MOST_CURRENT, POSITION_TICK, WATCHDOG_TICK};
use crate::error::DriverError;

/// How a motor is reached and what it may do.
///
/// | field | default | purpose |
/// |---|---|---|
/// | `port` | `/dev/ttyUSB0` | the adapter's serial port |
/// | `id` | 1 | which motor |
/// | `baud` | 1 000 000 | bits per second; a new motor has 57 600 (see [`Dynamixel::set_baud`](super::Dynamixel::set_baud)) |
/// | `current_limit` | 1.2 A | kept in the motor; no goal goes beyond |
/// | `watchdog` | 100 ms | silence after which the motor stands still by itself |
/// | `reply` | 20 ms | how long to wait for an answer |
/// | `range` | 256 turns each way | where goals may be, rad |
#[derive(Clone, Debug, PartialEq)]
pub struct DynamixelSettings {
    /// The serial port.
    pub port: PathBuf,
    /// 0 to 252.
    pub id: u8,
    /// Bits per second, one that the motor knows.
    pub baud: u32,
    /// A, up to 3.2.
    pub current_limit: f64,
    /// From 20 ms to 2.54 s, in steps of 20 ms.
    pub watchdog: Duration,
    /// From 1 ms to 1 s.
    pub reply: Duration,
    /// From and to, rad.
    pub range: [f64; 2],
}

impl Default for DynamixelSettings {
    fn default() -> Self {
        let farthest = POSITION_TICK * f64::from(FARTHEST);
        Self {
            port: PathBuf::from("/dev/ttyUSB0"),
            id: 1,
            baud: 1_000_000,
            current_limit: 1.2,
            watchdog: Duration::from_millis(100),
            reply: Duration::from_millis(20),
            range: [-farthest, farthest],
        }
    }
}

impl DynamixelSettings {
    /// What messages call the motor before there is a line to it.
    fn name(&self) -> String {
        format!("Dynamixel {} at {}", self.id, self.port.display())
    }

    /// Whether a motor can be driven so.
    ///
    /// # Errors
    /// The first value that cannot be, and what can.
    pub fn check(&self) -> Result<(), DriverError> {
        let refuse =
            |name, value: f64, limits: String| Err(DriverError::Value { device: self.name(), name, value, limits });
        if self.id > 252 {
            return refuse("id", f64::from(self.id), "0 to 252".into());
        }
        if !BAUD_RATES.contains(&self.baud) {
            let rates = BAUD_RATES.map(|rate| rate.to_string()).join(", ");
            return refuse("baud", f64::from(self.baud), format!("one of {rates}"));
        }
        let most = CURRENT_TICK * f64::from(MOST_CURRENT);
        if !(CURRENT_TICK..=most).contains(&self.current_limit) {
            return refuse("current_limit", self.current_limit, format!("{CURRENT_TICK} to {most:.2} A"));
        }
        for (name, value, least, most) in [
            ("watchdog", self.watchdog.as_secs_f64(), WATCHDOG_TICK, 127.0 * WATCHDOG_TICK),
            ("reply", self.reply.as_secs_f64(), 0.001, 1.0),
        ] {
            if !(least..=most).contains(&value) {
                return refuse(name, value, format!("{least} to {most} s"));
            }
        }
        let farthest = POSITION_TICK * f64::from(FARTHEST);
        for (name, value) in [("range[0]", self.range[0]), ("range[1]", self.range[1])] {
            if !(-farthest..=farthest).contains(&value) {
                return refuse(
                    name,
                    value,
                    format!("-{farthest:.1} to {farthest:.1} rad, which are 256 turns each way"),
                );
            }
        }
        if self.range[0] >= self.range[1] {
            return refuse("range[1]", self.range[1], format!("more than range[0] = {} rad", self.range[0]));
        }
        Ok(())
    }

    /// The current limit in ticks, not rounded up.
    pub(super) fn current_ticks(&self) -> i32 {
        (self.current_limit / CURRENT_TICK) as i32
    }

    /// The watchdog in ticks, not rounded up, and never none.
    pub(super) fn watchdog_ticks(&self) -> i32 {
        ((self.watchdog.as_secs_f64() / WATCHDOG_TICK + 1e-9) as i32).max(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_is_named() {
        let refused = |change: fn(&mut DynamixelSettings)| {
            let mut settings = DynamixelSettings::default();
            change(&mut settings);
            settings.check().unwrap_err().to_string()
        };
        assert_eq!(DynamixelSettings::default().check(), Ok(()));
        assert_eq!(DynamixelSettings::default().current_ticks(), 446);
        assert_eq!(DynamixelSettings::default().watchdog_ticks(), 5);
        assert_eq!(refused(|s| s.id = 254), "Dynamixel 254 at /dev/ttyUSB0: id = 254 is not 0 to 252");
        assert!(refused(|s| s.baud = 56_000).contains("baud = 56000 is not one of 9600, 57600,"));
        assert!(refused(|s| s.current_limit = f64::NAN).contains("current_limit = NaN is not 0.00269 to 3.21 A"));
        assert!(refused(|s| s.current_limit = 4.0).contains("current_limit = 4"));
        assert!(refused(|s| s.watchdog = Duration::ZERO).contains("watchdog = 0 is not 0.02 to 2.54 s"));
        assert!(refused(|s| s.reply = Duration::from_secs(2)).contains("reply = 2 is not 0.001 to 1 s"));
        assert!(refused(|s| s.range = [0.0, f64::INFINITY]).contains("range[1] = inf is not -1608.5 to 1608.5 rad"));
        assert!(refused(|s| s.range = [1.0, 1.0]).contains("range[1] = 1 is not more than range[0] = 1 rad"));
    }
}
