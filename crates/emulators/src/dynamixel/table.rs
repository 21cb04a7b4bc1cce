//! The control table of an XM430-W210: names, places, sizes, first values and limits, as ROBOTIS' manual has them
//! (emanual.robotis.com/docs/en/dxl/x/xm430-w210).

/// The model number of an XM430-W210.
pub(super) const MODEL: i32 = 1030;
/// The version that the emulator says to have.
pub(super) const FIRMWARE: i32 = 47;
/// The bytes of the table.
pub(super) const LENGTH: usize = 662;
/// Where what is kept without power ends.
pub(super) const EEPROM: usize = 64;

/// Who may write a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Access {
    /// Nobody.
    Read,
    /// Anybody, between these values.
    Between(i32, i32),
    /// Anybody, between minus the value of this register and the value itself.
    Within(&'static Register),
    /// Positions: their limits follow from the mode.
    Position,
}

/// A register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Register {
    pub(super) name: &'static str,
    pub(super) at: usize,
    pub(super) size: usize,
    pub(super) first: i32,
    pub(super) access: Access,
}

impl Register {
    const fn new(at: usize, size: usize, name: &'static str, first: i32, access: Access) -> Self {
        Self { name, at, size, first, access }
    }

    /// Whether it is kept without power.
    pub(super) fn is_kept(&self) -> bool {
        self.at < EEPROM
    }
}

macro_rules! registers {
    ($($constant:ident = $at:literal, $size:literal, $name:literal, $first:expr, $access:expr;)*) => {
        $(pub(super) const $constant: Register = Register::new($at, $size, $name, $first, $access);)*
        /// All of them but the indirect ones, in the order of their addresses.
        pub(super) const REGISTERS: &[Register] = &[$($constant),*];
    };
}

use Access::{Between, Position, Read, Within};

registers! {
    MODEL_NUMBER = 0, 2, "model-number", MODEL, Read;
    MODEL_INFORMATION = 2, 4, "model-information", 0, Read;
    FIRMWARE_VERSION = 6, 1, "firmware-version", FIRMWARE, Read;
    ID = 7, 1, "id", 1, Between(0, 252);
    BAUD_RATE = 8, 1, "baud-rate", 1, Between(0, 7);
    RETURN_DELAY = 9, 1, "return-delay", 250, Between(0, 254);
    // 4, time-based profiles, is left out.
    DRIVE_MODE = 10, 1, "drive-mode", 0, Between(0, 1);
    OPERATING_MODE = 11, 1, "operating-mode", 3, Between(0, 16);
    SHADOW_ID = 12, 1, "shadow-id", 255, Between(0, 255);
    PROTOCOL = 13, 1, "protocol", 2, Between(2, 2);
    HOMING_OFFSET = 20, 4, "homing-offset", 0, Between(-1_044_479, 1_044_479);
    MOVING_THRESHOLD = 24, 4, "moving-threshold", 10, Between(0, 1023);
    TEMPERATURE_LIMIT = 31, 1, "temperature-limit", 80, Between(0, 100);
    MAX_VOLTAGE = 32, 2, "max-voltage", 160, Between(95, 160);
    MIN_VOLTAGE = 34, 2, "min-voltage", 95, Between(95, 160);
    PWM_LIMIT = 36, 2, "pwm-limit", 885, Between(0, 885);
    CURRENT_LIMIT = 38, 2, "current-limit", 1193, Between(0, 1193);
    VELOCITY_LIMIT = 44, 4, "velocity-limit", 330, Between(0, 1023);
    MAX_POSITION = 48, 4, "max-position", 4095, Between(0, 4095);
    MIN_POSITION = 52, 4, "min-position", 0, Between(0, 4095);
    STARTUP = 60, 1, "startup", 0, Between(0, 3);
    SHUTDOWN = 63, 1, "shutdown", 0b11_0100, Between(0, 255);
    TORQUE_ENABLE = 64, 1, "torque-enable", 0, Between(0, 1);
    LED = 65, 1, "led", 0, Between(0, 1);
    STATUS_LEVEL = 68, 1, "status-level", 2, Between(0, 2);
    REGISTERED = 69, 1, "registered", 0, Read;
    HARDWARE_ERROR = 70, 1, "hardware-error", 0, Read;
    VELOCITY_I = 76, 2, "velocity-i", 1920, Between(0, 16_383);
    VELOCITY_P = 78, 2, "velocity-p", 100, Between(0, 16_383);
    POSITION_D = 80, 2, "position-d", 0, Between(0, 16_383);
    POSITION_I = 82, 2, "position-i", 0, Between(0, 16_383);
    POSITION_P = 84, 2, "position-p", 800, Between(0, 16_383);
    FEEDFORWARD_2 = 88, 2, "feedforward-2", 0, Between(0, 16_383);
    FEEDFORWARD_1 = 90, 2, "feedforward-1", 0, Between(0, 16_383);
    BUS_WATCHDOG = 98, 1, "bus-watchdog", 0, Between(0, 127);
    GOAL_PWM = 100, 2, "goal-pwm", 885, Within(&PWM_LIMIT);
    GOAL_CURRENT = 102, 2, "goal-current", 1193, Within(&CURRENT_LIMIT);
    GOAL_VELOCITY = 104, 4, "goal-velocity", 0, Within(&VELOCITY_LIMIT);
    PROFILE_ACCELERATION = 108, 4, "profile-acceleration", 0, Between(0, 32_767);
    PROFILE_VELOCITY = 112, 4, "profile-velocity", 0, Between(0, 32_767);
    GOAL_POSITION = 116, 4, "goal-position", 0, Position;
    REALTIME_TICK = 120, 2, "realtime-tick", 0, Read;
    MOVING = 122, 1, "moving", 0, Read;
    MOVING_STATUS = 123, 1, "moving-status", 0, Read;
    PRESENT_PWM = 124, 2, "present-pwm", 0, Read;
    PRESENT_CURRENT = 126, 2, "present-current", 0, Read;
    PRESENT_VELOCITY = 128, 4, "present-velocity", 0, Read;
    PRESENT_POSITION = 132, 4, "present-position", 0, Read;
    VELOCITY_TRAJECTORY = 136, 4, "velocity-trajectory", 0, Read;
    POSITION_TRAJECTORY = 140, 4, "position-trajectory", 0, Read;
    PRESENT_VOLTAGE = 144, 2, "present-voltage", 120, Read;
    PRESENT_TEMPERATURE = 146, 1, "present-temperature", 25, Read;
    BACKUP_READY = 147, 1, "backup-ready", 0, Read;
}

/// The register of this name.
pub(super) fn by_name(name: &str) -> Option<&'static Register> {
    REGISTERS.iter().find(|register| register.name == name)
}

/// The register that has this byte.
pub(super) fn at(address: usize) -> Option<&'static Register> {
    let below = REGISTERS.partition_point(|register| register.at <= address);
    REGISTERS[..below].last().filter(|register| address < register.at + register.size)
}

/// Indirect bytes come in two rows: addresses from here, data from there, so many.
const INDIRECT: [(usize, usize, usize); 2] = [(168, 224, 28), (578, 634, 28)];

/// What an address of the indirect part is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Indirect {
    /// The low or high byte of the pointer that starts here.
    Pointer(usize),
    /// The byte that the pointer which starts here points at.
    Data(usize),
}

/// What this address is of the indirect part, if of it.
pub(super) fn indirect(address: usize) -> Option<Indirect> {
    INDIRECT.iter().find_map(|&(pointers, data, count)| {
        let pointer = address.checked_sub(pointers).filter(|offset| *offset < 2 * count);
        let datum = address.checked_sub(data).filter(|offset| *offset < count);
        pointer
            .map(|offset| Indirect::Pointer(pointers + offset / 2 * 2))
            .or(datum.map(|offset| Indirect::Data(pointers + 2 * offset)))
    })
}

/// All pointers of the indirect part, and what they point at in the beginning: their own data.
pub(super) fn pointers() -> impl Iterator<Item = (usize, u16)> {
    INDIRECT.iter().flat_map(|&(pointers, data, count)| (0..count).map(move |i| (pointers + 2 * i, (data + i) as u16)))
}

/// Bits per second by the number in the register.
pub(super) const BAUD_RATES: [u32; 8] = [9_600, 57_600, 115_200, 1_000_000, 2_000_000, 3_000_000, 4_000_000, 4_500_000];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_belongs_to_one_register() {
        for pair in REGISTERS.windows(2) {
            assert!(pair[0].at + pair[0].size <= pair[1].at, "{} and {}", pair[0].name, pair[1].name);
        }
        assert_eq!(at(133).map(|register| register.name), Some("present-position"));
        assert_eq!((at(14), at(66), at(148)), (None, None, None));
        assert_eq!(by_name("goal-current").map(|register| register.at), Some(102));
        assert_eq!(indirect(169), Some(Indirect::Pointer(168)));
        assert_eq!(indirect(251), Some(Indirect::Data(222)));
        assert_eq!(indirect(634), Some(Indirect::Data(578)));
        assert_eq!((indirect(167), indirect(252), indirect(662)), (None, None, None));
    }
}
