//! What ends a motion: a state machine without devices and without a clock of its own. It is given times and states, and says
//! what to do.
//!
//! Software is no safety function: the arm's own safety, its stop button and the motor's own limits are. What is here ends a
//! motion earlier and more gently, and says why.

mod cause;
mod glance;
mod timers;

use std::time::{Duration, Instant};

use hwasp_drivers::{ArmMode, Safety};

pub use cause::{Cause, Response};
pub use glance::{Glance, Limits};

use glance::Found;
use timers::Since;

/// What to do now, and why.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// What to do.
    pub response: Response,
    /// Why, where it is not to go on.
    pub cause: Option<Cause>,
}

impl Verdict {
    /// All is well.
    pub const GO_ON: Self = Self { response: Response::GoOn, cause: None };
}

/// The rules, and what they remember. To be asked once a step.
///
/// What was decided stays: a response is followed by a stronger one, never by a weaker one, whatever the devices say later. Only
/// [`Response::Hold`] ends by itself.
#[derive(Clone, Debug)]
pub struct Watch {
    limits: Limits,
    decided: Verdict,
    /// When the arm's clock went on last, and what it said then.
    arm_clock: Option<(f64, Instant)>,
    current: Since,
    still: Since,
    /// What was wound when the spool was seen moving last, m.
    moved_at: f64,
    unseen: Since,
    fast: u32,
    /// Since when the motor has not said a word.
    silent: Since,
    /// How often a person had asked to stop by the last step.
    interrupts: u32,
}

/// So many steps in a row the palm is too fast before it is stopped: one reading may be noise.
const FAST_STEPS: u32 = 2;
/// How much faster than allowed the palm is found before it is stopped.
const FAST_SHARE: f64 = 1.5;
/// A spool that moves less than this stands still, m: six steps of its encoder.
const STILL: f64 = 7.5e-5;
/// A spool that lags its goal by less than this need not move, m.
const LAG: f64 = 1e-3;
/// A motor with more than this share of its current works against something.
const WORKING: f64 = 0.8;

impl Watch {
    /// Nothing has happened yet.
    pub fn new(limits: Limits) -> Self {
        Self {
            limits,
            decided: Verdict::GO_ON,
            arm_clock: None,
            current: Since::default(),
            still: Since::default(),
            moved_at: f64::NAN,
            unseen: Since::default(),
            fast: 0,
            silent: Since::default(),
            interrupts: 0,
        }
    }

    /// The limits that it keeps.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// What was decided so far.
    pub fn decided(&self) -> Verdict {
        self.decided
    }

    /// Looks at a step, and says what to do.
    pub fn judge(&mut self, glance: &Glance) -> Verdict {
        let mut found = Found::default();
        self.people(glance, &mut found);
        self.time(glance, &mut found);
        self.arm(glance, &mut found);
        self.motor(glance, &mut found);
        self.object(glance, &mut found);
        self.decide(found)
    }

    /// A command that is no number: nothing of it is obeyed.
    pub fn not_finite(&mut self, controller: bool) -> Verdict {
        let mut found = Found::default();
        found.is(true, if controller { Cause::CommandNotFinite } else { Cause::SensorNotFinite });
        self.decide(found)
    }

    fn decide(&mut self, found: Found) -> Verdict {
        let Some(cause) = found.worst() else {
            // A hold ends when its cause does.
            return self.decided;
        };
        let response = cause.response();
        if response > self.decided.response {
            let verdict = Verdict { response, cause: Some(cause) };
            if response > Response::Hold {
                self.decided = verdict;
            }
            return verdict;
        }
        self.decided
    }

    fn people(&mut self, glance: &Glance, found: &mut Found) {
        // Whoever asks again does not want to wait: neither for the object to be down nor for the end of a hold.
        let again = glance.interrupts > self.interrupts && self.decided.response >= Response::SetDown;
        self.interrupts = glance.interrupts;
        found.is(glance.interrupts > 0, Cause::Interrupt);
        found.is(again || glance.interrupts > 1, Cause::InterruptTwice);
        found.is(glance.log_lost, Cause::LogLost);
    }

    fn time(&self, glance: &Glance, found: &mut Found) {
        found.is(glance.late > self.limits.overrun, Cause::Overrun);
    }

    fn arm(&mut self, glance: &Glance, found: &mut Found) {
        found.is(glance.arm_lost, Cause::ArmLost);
        let Some(arm) = &glance.arm else {
            // Before the first packet there is nothing that grows old but the wait itself.
            let since = self.arm_clock.get_or_insert((f64::NAN, glance.now)).1;
            return found.is(glance.now.saturating_duration_since(since) > self.limits.arm_stale, Cause::ArmStale);
        };
        let numbers = arm.tool.position.iter().chain(&arm.tool.rotation).chain(&arm.tool_speed).chain([&arm.clock]);
        if !numbers.chain(&arm.joints).all(|x| x.is_finite()) {
            return found.is(true, Cause::SensorNotFinite);
        }
        found.is(glance.now.saturating_duration_since(arm.at) > self.limits.arm_stale, Cause::ArmStale);
        // Packets that arrive in time may still say the same for ever.
        match self.arm_clock {
            Some((clock, since)) if clock == arm.clock => {
                found.is(glance.now.saturating_duration_since(since) > self.limits.arm_stale, Cause::ArmFrozen);
            }
            _ => self.arm_clock = Some((arm.clock, glance.now)),
        }
        found.is(arm.safety == Safety::ProtectiveStop, Cause::ProtectiveStop);
        found.is(arm.safety == Safety::EmergencyStop, Cause::EmergencyStop);
        found.is(arm.safety == Safety::Stopped, Cause::ArmStopped);
        found.is(arm.mode != ArmMode::Running, Cause::ArmNotRunning);
        let outside = |axis: usize| {
            let [lo, hi] = self.limits.workspace[axis];
            glance.palm[axis] < lo - self.limits.margin || glance.palm[axis] > hi + self.limits.margin
        };
        found.is((0..3).any(outside), Cause::Workspace);
        let speed = arm.tool_speed.iter().map(|x| x * x).sum::<f64>().sqrt();
        self.fast = if speed > FAST_SHARE * self.limits.palm_speed { self.fast + 1 } else { 0 };
        found.is(self.fast >= FAST_STEPS, Cause::Speed);
        let off = (0..3).map(|i| (glance.palm[i] - glance.palm_target[i]).powi(2)).sum::<f64>().sqrt();
        found.is(off > self.limits.following, Cause::Following);
    }

    fn motor(&mut self, glance: &Glance, found: &mut Found) {
        found.is(glance.motor_lost, Cause::MotorLost);
        let Some(motor) = &glance.motor else {
            return found.is(self.silent.lasts(true, glance.now) > self.limits.motor_stale, Cause::MotorStale);
        };
        if ![motor.position, motor.velocity, motor.current, motor.voltage, motor.temperature]
            .iter()
            .all(|x| x.is_finite())
        {
            return found.is(true, Cause::SensorNotFinite);
        }
        found.is(glance.now.saturating_duration_since(motor.at) > self.limits.motor_stale, Cause::MotorStale);
        found.is(motor.hardware_error != 0, Cause::HardwareError);
        found.is(glance.holding && !motor.torque, Cause::MotorFree);
        let over = self.current.lasts(motor.current.abs() > self.limits.current, glance.now);
        found.is(over >= self.limits.current_time && !over.is_zero(), Cause::OverCurrent);
        found.is(motor.temperature > self.limits.temperature, Cause::Heat);
        let [lo, hi] = self.limits.voltage;
        found.is(!(lo..=hi).contains(&motor.voltage), Cause::Voltage);
        let beyond = self.limits.lead + self.limits.margin;
        found.is(glance.wound < -beyond || glance.wound > self.limits.travel + beyond, Cause::Travel);
        // A spool that should wind, has current to spare and does not: its register is stuck, or its line is caught.
        let still = (glance.wound - self.moved_at).abs() < STILL;
        if !still {
            self.moved_at = glance.wound;
        }
        let idle = motor.current.abs() < WORKING * self.limits.working_current;
        let should = glance.holding && (glance.wound_target - glance.wound).abs() > LAG && idle;
        found.is(self.still.lasts(should && still, glance.now) >= self.limits.stuck, Cause::MotorStuck);
    }

    fn object(&mut self, glance: &Glance, found: &mut Found) {
        let unseen = glance.object_age.is_some_and(|age| age > self.limits.object_stale);
        let lasted = self.unseen.lasts(unseen, glance.now);
        found.is(unseen, Cause::ObjectUnseen);
        found.is(unseen && lasted > self.limits.patience, Cause::ObjectLost);
    }
}

/// How long a rule may take to see its cause, from the moment on when it is there; a step of the loop and the time of its own.
pub fn reaction(cause: Cause, limits: &Limits, step: Duration) -> Duration {
    cause.own_time(limits) + step
}
