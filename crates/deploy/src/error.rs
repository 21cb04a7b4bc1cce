//! Why a robot is not driven.

use std::io;
use std::path::PathBuf;

use hwasp_drivers::DriverError;
use hwasp_export::ExportError;
use hwasp_runs::RunError;
use hwasp_settings::Faults;
use thiserror::Error;

/// Why a robot is not driven. Each says the way out.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DeployError {
    /// There is no `rig.toml` to read.
    #[error("{source}; `hwasp deploy init` writes one")]
    NoRig {
        /// What the system says.
        source: RunError,
    },
    /// `rig.toml` says what cannot be.
    #[error(transparent)]
    Rig(#[from] Faults),
    /// The run has no controller to drive with.
    #[error(transparent)]
    Run(#[from] ExportError),
    /// A device.
    #[error(transparent)]
    Driver(#[from] DriverError),
    /// A controller that sees what a bench has no sensor for.
    #[error(
        "the controller sees `{name}`, which the bench does not sense: it senses palm_x, palm_y, palm_z, object_x, object_y, \
         object_z, size_x, size_y, size_z, motor_travel and motor_torque, as z-grasp and 3d-grasp have them"
    )]
    Sensor {
        /// The observation.
        name: String,
    },
    /// A controller that commands what a bench does not move.
    #[error(
        "the controller commands `{name}`, which the bench does not move: it moves palm_x, palm_y, palm_z and motor"
    )]
    Actuator {
        /// The command.
        name: String,
    },
    /// A run whose mechanism is no hand.
    #[error("{problem} has no hand with a motor: z-grasp and 3d-grasp have one")]
    NoHand {
        /// The problem.
        problem: String,
    },
    /// A value that was asked for and cannot be.
    #[error("{name} = {value} is not {limits}")]
    Value {
        /// What it is.
        name: &'static str,
        /// What was given.
        value: String,
        /// What can be.
        limits: String,
    },
    /// A hand that hangs shut.
    #[error(
        "the hand droops shut with the palm down: the springs of {joint} open with {springs:.2} N·mm, its weight closes with \
         {weight:.2} N·mm; train with task.opening_margin, or choose stiffer springs with `hwasp parts`"
    )]
    Droops {
        /// The joint.
        joint: &'static str,
        /// N·mm.
        springs: f64,
        /// N·mm.
        weight: f64,
    },
    /// A calibration that is not there, or of another rig or hand.
    #[error("{path}: {what}; `hwasp deploy calibrate` makes it anew")]
    Calibration {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// What was measured while calibrating cannot be.
    #[error("calibration: {what}; {hint}")]
    Measured {
        /// What was found.
        what: String,
        /// The way out.
        hint: &'static str,
    },
    /// A file.
    #[error("`{}` cannot be {action}: {source}", path.display())]
    File {
        /// What was to be done: "read", "written".
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// A log that says nothing.
    #[error("{}: {what}", path.display())]
    Log {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// The process with the emulators.
    #[error("the emulated bench: {what}")]
    Bench {
        /// What happened.
        what: String,
    },
    /// A fit that found nothing.
    #[error("identify: {what}; {hint}")]
    Fit {
        /// What is wrong.
        what: String,
        /// The way out.
        hint: &'static str,
    },
    /// A motion that was stopped.
    #[error("stopped: {cause}; {state}")]
    Stopped {
        /// Why.
        cause: String,
        /// In which state arm and hand are now.
        state: String,
    },
}

/// A file that cannot be used.
pub(crate) fn file(action: &'static str, path: &std::path::Path) -> impl FnOnce(io::Error) -> DeployError {
    let path = path.to_owned();
    move |source| DeployError::File { action, path, source }
}
