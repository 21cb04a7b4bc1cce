//! What can happen, and what is done about it.

use std::time::Duration;

use hwasp_settings::choice;

use super::glance::Limits;

choice! {
    /// What to do, from weak to strong.
    pub enum Response {
        /// Nothing: go on.
        GoOn = "go on",
        /// Palm and spool stay where they are until the cause is gone.
        Hold = "hold",
        /// The palm goes down to where it grasped, the spool unwinds, and the motor is freed.
        SetDown = "set down",
        /// The arm stops where it is, and the motor holds what it has.
        StopArm = "stop the arm, hold",
        /// The arm stops where it is, and the motor is freed.
        Release = "stop the arm, free the motor",
    }
}

impl PartialOrd for Response {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Response {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        (*self as u8).cmp(&(*other as u8))
    }
}

choice! {
    /// Why something is done.
    pub enum Cause {
        /// A person pressed Ctrl-C.
        Interrupt = "Ctrl-C",
        /// And once more.
        InterruptTwice = "Ctrl-C, twice",
        /// What is logged cannot be written.
        LogLost = "the log cannot be written",
        /// A step began too late.
        Overrun = "a step began too late",
        /// The line to the arm is broken.
        ArmLost = "the line to the arm is broken",
        /// The arm's data are too old.
        ArmStale = "the arm's data are too old",
        /// The arm's clock stands still.
        ArmFrozen = "the arm's clock stands still",
        /// The arm was stopped by a contact or a limit of its own.
        ProtectiveStop = "protective stop of the arm",
        /// A button was pressed.
        EmergencyStop = "emergency stop of the arm",
        /// The arm's safety stopped it for another reason.
        ArmStopped = "the arm's safety stopped it",
        /// The arm is off, or its brakes are closed.
        ArmNotRunning = "the arm is not running",
        /// The palm is outside of its workspace.
        Workspace = "the palm is outside of its workspace",
        /// The palm is too fast.
        Speed = "the palm is too fast",
        /// The palm is not where it was sent.
        Following = "the palm is not where it was sent",
        /// The line to the motor is broken.
        MotorLost = "the line to the motor is broken",
        /// The motor's answer is too old.
        MotorStale = "the motor's answer is too old",
        /// The spool stands still although it should wind.
        MotorStuck = "the spool stands still although it should wind",
        /// The motor is free although it should hold.
        MotorFree = "the motor is free although it should hold",
        /// The motor tells a hardware error.
        HardwareError = "the motor tells a hardware error",
        /// The motor takes too much current for too long.
        OverCurrent = "the motor takes too much current",
        /// The motor is too hot.
        Heat = "the motor is too hot",
        /// The motor's supply is too low or too high.
        Voltage = "the motor's voltage is out of its limits",
        /// The spool is beyond its travel.
        Travel = "the spool is beyond its travel",
        /// A sensor says what is no number.
        SensorNotFinite = "a sensor says what is no number",
        /// The controller says what is no number.
        CommandNotFinite = "the controller says what is no number",
        /// The object is not seen for a moment.
        ObjectUnseen = "the object is not seen",
        /// The object is not seen for too long.
        ObjectLost = "the object is not seen any more",
    }
}

impl Cause {
    /// What is done about it.
    pub fn response(self) -> Response {
        match self {
            Self::ObjectUnseen => Response::Hold,
            // Nothing is wrong with arm and motor: they bring the object down.
            Self::Interrupt | Self::LogLost | Self::Heat | Self::ObjectLost => Response::SetDown,
            // What holds an object may go on holding it; what moves it is stopped.
            Self::Overrun
            | Self::ArmLost
            | Self::ArmStale
            | Self::ArmFrozen
            | Self::ProtectiveStop
            | Self::EmergencyStop
            | Self::ArmStopped
            | Self::ArmNotRunning
            | Self::Workspace
            | Self::Speed
            | Self::Following
            | Self::MotorLost
            | Self::MotorStale
            | Self::MotorStuck
            | Self::Voltage
            | Self::SensorNotFinite
            | Self::CommandNotFinite => Response::StopArm,
            // A motor that pulls what it should not, or is not what it was, is freed.
            Self::InterruptTwice | Self::MotorFree | Self::HardwareError | Self::OverCurrent | Self::Travel => {
                Response::Release
            }
        }
    }

    /// How long the rule itself waits before it is sure.
    pub(super) fn own_time(self, limits: &Limits) -> Duration {
        match self {
            Self::ArmStale | Self::ArmFrozen => limits.arm_stale,
            Self::MotorStale => limits.motor_stale,
            // A goal that leaves the spool at 20 mm/s leads it by a millimetre first.
            Self::MotorStuck => limits.stuck + Duration::from_millis(50),
            Self::OverCurrent => limits.current_time,
            Self::Overrun => limits.overrun,
            Self::ObjectUnseen => limits.object_stale,
            Self::ObjectLost => limits.object_stale + limits.patience,
            // One step to be sure.
            Self::Speed => Duration::from_millis(10),
            _ => Duration::ZERO,
        }
    }
}
