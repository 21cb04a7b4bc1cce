//! What runs a robot asks of the motor: state, goal, torque.

use std::time::Instant;

use super::Dynamixel;
use super::registers::{
    BUS_WATCHDOG, CURRENT_TICK, FARTHEST, GOAL_POSITION, HARDWARE_ERROR, POINTED, POSITION_TICK, PRESENT_POSITION,
    SHUTS_DOWN, STATE, STATE_LENGTH, TORQUE_ENABLE, TRIPPED, VELOCITY_TICK, VOLTAGE_TICK, value,
};
use crate::error::DriverError;
use crate::motor::{Motor, MotorState};

/// Questions for the state ask for up to so many bytes more than it has, in turn, so that a late answer is known by its
/// length.
const TURNS: u16 = 4;

impl Dynamixel {
    /// Refuses a number that is none, or outside of its limits.
    fn within(&self, name: &'static str, value: f64, [least, most]: [f64; 2], unit: &str) -> Result<(), DriverError> {
        if (least..=most).contains(&value) {
            return Ok(());
        }
        let limits = format!("{least} to {most} {unit}");
        Err(DriverError::Value { device: self.line.name().to_owned(), name, value, limits })
    }

    /// Why a goal was refused: the bus watchdog is what a person can do something about.
    fn explain(&mut self, error: DriverError) -> DriverError {
        let refused = matches!(error, DriverError::Refused { .. });
        if refused && self.line.get("reading its watchdog", BUS_WATCHDOG).is_ok_and(|watchdog| watchdog == TRIPPED) {
            let silence = self.settings.watchdog.as_millis();
            return self.line.refused(
                "setting its goal",
                format!(
                    "its bus watchdog stopped it, after {silence} ms without a word; switching torque on starts anew"
                ),
            );
        }
        error
    }

    /// Ends with an error where the motor has a hardware error that shuts it down.
    fn sound(&mut self, what: &'static str) -> Result<(), DriverError> {
        let bits = self.line.get(what, HARDWARE_ERROR)?;
        if bits & SHUTS_DOWN == 0 { Ok(()) } else { Err(self.line.failed(what, bits as u8)) }
    }
}

impl Motor for Dynamixel {
    fn state(&mut self) -> Result<MotorState, DriverError> {
        const WHAT: &str = "reading its state";
        self.turn = (self.turn + 1) % TURNS;
        let bytes = self.line.read(WHAT, POINTED, STATE_LENGTH + self.turn)?;
        let at = Instant::now();
        let (mut rest, mut values) = (bytes.as_slice(), [0; STATE.len()]);
        for (register, out) in STATE.iter().zip(&mut values) {
            let split = rest.split_at_checked(usize::from(register.size));
            let (head, tail) = split.ok_or_else(|| self.line.protocol(WHAT, "the answer is too short"))?;
            *out = value(head).unwrap_or_default();
            rest = tail;
        }
        let [torque, errors, current, velocity, position, voltage, temperature] = values;
        if voltage == 0 {
            self.prepared = false;
            let cause = "it was not prepared, or its power failed since: torque is off and turns are forgotten. \
                         Prepare it, and find its zero again";
            return Err(self.line.refused(WHAT, cause));
        }
        Ok(MotorState {
            at,
            position: POSITION_TICK * f64::from(position),
            velocity: VELOCITY_TICK * f64::from(velocity),
            current: CURRENT_TICK * f64::from(current),
            voltage: VOLTAGE_TICK * f64::from(voltage),
            temperature: f64::from(temperature),
            hardware_error: errors as u8,
            torque: torque != 0,
        })
    }

    fn goal(&mut self, position: f64, current: f64) -> Result<(), DriverError> {
        self.within("position", position, self.settings.range, "rad")?;
        self.within("current", current, [0.0, self.settings.current_limit], "A")?;
        let ticks = ((position / POSITION_TICK).round() as i32).clamp(-FARTHEST, FARTHEST);
        let current = (current / CURRENT_TICK) as i16;
        let goal = [&current.to_le_bytes()[..], &ticks.to_le_bytes()].concat();
        match self.line.write("setting its goal", POINTED + STATE_LENGTH, &goal) {
            Ok(false) => Ok(()),
            Ok(true) => self.sound("setting its goal"),
            Err(error) => Err(self.explain(error)),
        }
    }

    /// Torque goes on where the motor is: its goal becomes its position first, and its watchdog starts anew.
    fn torque(&mut self, on: bool) -> Result<(), DriverError> {
        const WHAT: &str = "switching torque on";
        if !on {
            return self.line.set("switching torque off", TORQUE_ENABLE, 0).map(drop);
        }

        self.sound(WHAT)?;
        if !self.prepared {
            return Err(self.line.refused(WHAT, "it is not prepared, and may be in another mode; prepare it first"));
        }
        self.line.set(WHAT, BUS_WATCHDOG, 0)?;
        let position = self.line.get(WHAT, PRESENT_POSITION)?;
        self.line.set(WHAT, GOAL_POSITION, position)?;
        self.line.set(WHAT, BUS_WATCHDOG, self.settings.watchdog_ticks())?;
        self.line.set(WHAT, TORQUE_ENABLE, 1)?;
        // The motor says nothing where an error keeps torque off.
        if self.line.get(WHAT, TORQUE_ENABLE)? == 0 {
            self.sound(WHAT)?;
            return Err(self.line.refused(WHAT, "torque stays off, and no hardware error says why"));
        }
        Ok(())
    }
}
