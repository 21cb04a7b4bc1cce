//! Where things are in an XM430's control table, and in which units (emanual.robotis.com/docs/en/dxl/x/xm430-w210).

use std::f64::consts::TAU;

/// A register: its address and its bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Register {
    pub(super) at: u16,
    pub(super) size: u16,
}

const fn register(at: u16, size: u16) -> Register {
    Register { at, size }
}

pub(super) const BAUD_RATE: Register = register(8, 1);
pub(super) const RETURN_DELAY: Register = register(9, 1);
pub(super) const DRIVE_MODE: Register = register(10, 1);
pub(super) const OPERATING_MODE: Register = register(11, 1);
pub(super) const CURRENT_LIMIT: Register = register(38, 2);
pub(super) const SHUTDOWN: Register = register(63, 1);
pub(super) const TORQUE_ENABLE: Register = register(64, 1);
pub(super) const STATUS_LEVEL: Register = register(68, 1);
pub(super) const HARDWARE_ERROR: Register = register(70, 1);
pub(super) const BUS_WATCHDOG: Register = register(98, 1);
pub(super) const GOAL_CURRENT: Register = register(102, 2);
pub(super) const PROFILE_ACCELERATION: Register = register(108, 4);
pub(super) const PROFILE_VELOCITY: Register = register(112, 4);
pub(super) const GOAL_POSITION: Register = register(116, 4);
pub(super) const PRESENT_CURRENT: Register = register(126, 2);
pub(super) const PRESENT_VELOCITY: Register = register(128, 4);
pub(super) const PRESENT_POSITION: Register = register(132, 4);
pub(super) const PRESENT_VOLTAGE: Register = register(144, 2);
pub(super) const PRESENT_TEMPERATURE: Register = register(146, 1);

/// The first pointer of the indirect part, and the first byte that it points to.
pub(super) const POINTERS: u16 = 168;
pub(super) const POINTED: u16 = 224;

/// What is read at once, in this order, through the indirect part.
pub(super) const STATE: [Register; 7] = [
    TORQUE_ENABLE,
    HARDWARE_ERROR,
    PRESENT_CURRENT,
    PRESENT_VELOCITY,
    PRESENT_POSITION,
    PRESENT_VOLTAGE,
    PRESENT_TEMPERATURE,
];
/// The bytes of it.
pub(super) const STATE_LENGTH: u16 = 15;
/// What is written at once, behind it.
pub(super) const GOAL: [Register; 2] = [GOAL_CURRENT, GOAL_POSITION];

/// What the pointers have to be.
pub(super) fn pointers() -> Vec<u8> {
    let bytes = STATE.iter().chain(&GOAL).flat_map(|register| register.at..register.at + register.size);
    bytes.flat_map(u16::to_le_bytes).collect()
}

/// The mode that goes to positions with a limited current.
pub(super) const CURRENT_BASED_POSITION: i32 = 5;
/// Electrical shock, overload and overheating shut down: what the motor is delivered with.
pub(super) const SHUTS_DOWN: i32 = 0b11_0100;
/// What the bus watchdog reads after it has stopped the motor.
pub(super) const TRIPPED: i32 = 255;
/// The farthest position, ticks: 256 turns.
pub(super) const FARTHEST: i32 = 1_048_575;
/// The highest current limit, ticks.
pub(super) const MOST_CURRENT: i32 = 1193;

/// rad.
pub(super) const POSITION_TICK: f64 = TAU / 4096.0;
/// rad/s: 0.229 turns a minute.
pub(super) const VELOCITY_TICK: f64 = 0.229 * TAU / 60.0;
/// A.
pub(super) const CURRENT_TICK: f64 = 2.69e-3;
/// V.
pub(super) const VOLTAGE_TICK: f64 = 0.1;
/// s.
pub(super) const WATCHDOG_TICK: f64 = 0.020;

/// Bits per second by the number in the register.
pub(super) const BAUD_RATES: [u32; 8] = [9_600, 57_600, 115_200, 1_000_000, 2_000_000, 3_000_000, 4_000_000, 4_500_000];

/// A value of one, two or four bytes; the longer ones have a sign.
pub(super) fn value(bytes: &[u8]) -> Option<i32> {
    match *bytes {
        [a] => Some(i32::from(a)),
        [a, b] => Some(i32::from(i16::from_le_bytes([a, b]))),
        [a, b, c, d] => Some(i32::from_le_bytes([a, b, c, d])),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_and_places() {
        assert_eq!(STATE.iter().map(|register| register.size).sum::<u16>(), STATE_LENGTH);
        let pointers = pointers();
        assert_eq!((pointers.len(), &pointers[..4], &pointers[40..]), (42, &[64, 0, 70, 0][..], &[119, 0][..]));
        // A spool of 8 mm winds 1 mm in 81.5 ticks.
        assert!((1e-3 / 8e-3 / POSITION_TICK - 81.487).abs() < 1e-3);
        assert_eq!(value(&[0xFF, 0xFF]), Some(-1));
        assert_eq!((value(&[0xFF]), value(&[0xFD, 0xFF, 0xFF, 0xFF]), value(&[1, 2, 3])), (Some(255), Some(-3), None));
    }
}
