//! `[motor]`.

use std::path::PathBuf;

use hwasp_core::Dimension;
use hwasp_settings::{Fields, Settings, choice};

choice! {
    /// Which way the motor turns to wind the tendons.
    pub enum Winding {
        /// Towards larger positions.
        Positive = "positive",
        /// Towards smaller positions.
        Negative = "negative",
    }
}

impl Winding {
    /// 1 or -1.
    pub fn sign(self) -> f64 {
        match self {
            Self::Positive => 1.0,
            Self::Negative => -1.0,
        }
    }
}

/// The motor that winds.
#[derive(Clone, Debug, PartialEq)]
pub struct MotorSettings {
    /// The serial port.
    pub port: PathBuf,
    /// Bits in a second.
    pub baud: u64,
    /// Its number on the bus.
    pub id: u64,
    /// Which way it winds.
    pub winding: Winding,
    /// The most current that its own limit lets through, A.
    pub current_limit: f64,
    /// After this time without a word from here it stops by itself, s.
    pub watchdog: f64,
}

impl Default for MotorSettings {
    fn default() -> Self {
        Self {
            port: "/dev/ttyUSB0".into(),
            baud: 1_000_000,
            id: 1,
            winding: Winding::Positive,
            current_limit: 1.2,
            watchdog: 0.1,
        }
    }
}

impl Settings for MotorSettings {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        fields.path(
            "port",
            &mut self.port,
            "the serial port, the adapter's name under /dev/serial/by-id for one that stays",
        );
        fields.integer(
            "baud",
            &mut self.baud,
            9600..=4_500_000,
            "bits in a second; the motor leaves its maker with 57600",
        );
        fields.integer("id", &mut self.id, 0..=252, "its number on the bus");
        fields.choice("winding", &mut self.winding, "which way it turns to wind the tendons");
        let about =
            "the most current that the motor's own limit lets through, written into it by `hwasp deploy calibrate`";
        fields.quantity("current_limit", &mut self.current_limit, Dimension::Current, 0.01..=3.2, about);
        let about =
            "after this time without a word from here the motor stops by itself (bus watchdog, in steps of 20 ms)";
        fields.quantity("watchdog", &mut self.watchdog, Dimension::Time, 0.02..=2.5, about);
        if fields.sound(&["watchdog"]) {
            let watchdog = self.watchdog;
            fields.check("watchdog", watchdog >= 0.06, || {
                let message =
                    format!("motor.watchdog is {:.0} ms, shorter than a motor's answer may be late", 1e3 * watchdog);
                (message, "write at least \"60 ms\"; 100 ms is the default".to_owned())
            });
        }
    }
}
