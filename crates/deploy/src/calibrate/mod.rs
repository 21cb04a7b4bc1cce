//! What has to be measured on a hand before it is driven: where its tendons begin to pull, how much friction there is, and how much
//! torque its motor gives per current.

mod onset;
mod weight;

use std::fmt::Write;
use std::path::Path;

use hwasp_runs::files::{Disk, read_limited, replace};
use hwasp_settings::written;
use hwasp_tasks::hand::{DESIGN_LEN, HandDescription, droop};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::error::{DeployError, file};
use crate::rig::Rig;

pub use onset::{Found, Onset, Sweep, find, onset};
pub use weight::{Weighed, weigh, weighed};

/// What the file is called.
pub const CALIBRATION: &str = "calibration.toml";
/// The largest file that is read, bytes.
const LARGEST: u64 = 1 << 16;

/// What was measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Calibration {
    /// When, UTC.
    pub date: String,
    /// SHA-256 of the motor's table of `rig.toml`.
    pub motor_sha256: String,
    /// SHA-256 of the design as built.
    pub design_sha256: String,
    /// The motor's position at which the tendons begin to pull, rad. A motor forgets its turns when its power goes: measure again.
    pub zero_rad: f64,
    /// Torque per current as a multiple of the data sheet's.
    pub torque_gain: f64,
    /// How the gain is known: `weight`, or `data sheet`.
    pub gain_from: String,
    /// Current with which a slack spool begins and goes on to wind, A.
    pub friction_up_a: f64,
    /// The same to unwind, A.
    pub friction_down_a: f64,
}

impl Calibration {
    /// Of a hand that is as it is described: the emulated one.
    pub fn ideal(rig: &Rig, design: &[f64]) -> Self {
        Self {
            date: String::new(),
            motor_sha256: motor_hash(rig),
            design_sha256: design_hash(design),
            zero_rad: 0.0,
            torque_gain: 1.0,
            gain_from: "description".to_owned(),
            friction_up_a: 0.0,
            friction_down_a: 0.0,
        }
    }

    /// Reads one that was made of this rig and this hand.
    ///
    /// # Errors
    /// Where there is none, or it is of another motor or hand.
    pub fn open(path: &Path, rig: &Rig, design: &[f64]) -> Result<Self, DeployError> {
        let wrong = |what: String| DeployError::Calibration { path: path.to_owned(), what };
        let bytes = read_limited(path, LARGEST).map_err(|error| wrong(error.to_string()))?;
        let text = String::from_utf8_lossy(&bytes);
        let read: Self = toml::from_str(&text).map_err(|error| wrong(error.message().to_owned()))?;
        if read.motor_sha256 != motor_hash(rig) {
            return Err(wrong("it is of another motor: [motor] of the rig has changed since".to_owned()));
        }
        if read.design_sha256 != design_hash(design) {
            return Err(wrong("it is of another hand: the run's design is not the one that was measured".to_owned()));
        }
        if !(read.zero_rad.is_finite() && (0.1..=10.0).contains(&read.torque_gain)) {
            return Err(wrong("its numbers cannot be".to_owned()));
        }
        Ok(read)
    }

    /// Writes it, whole or not at all.
    ///
    /// # Errors
    /// The disk's.
    pub fn write(&self, path: &Path) -> Result<(), DeployError> {
        let text = toml::to_string(self)
            .map_err(|error| DeployError::Calibration { path: path.to_owned(), what: error.to_string() })?;
        let head = "# Written by `hwasp deploy calibrate`.\n";
        replace(&Disk, path, format!("{head}{text}").as_bytes()).map_err(file("written", path))
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// SHA-256 of what `rig.toml` says of the motor.
pub fn motor_hash(rig: &Rig) -> String {
    let mut motor = rig.motor.clone();
    hex(&Sha256::digest(format!("{:?}", written(&mut motor)).as_bytes()))
}

/// SHA-256 of a design as built.
pub fn design_hash(design: &[f64]) -> String {
    let bytes: Vec<u8> = design.iter().flat_map(|x| x.to_le_bytes()).collect();
    hex(&Sha256::digest(bytes))
}

/// Refuses a hand whose springs do not hold it open with the palm down.
///
/// # Errors
/// [`DeployError::Droops`], at the joint that is worst.
pub fn stands(hand: &HandDescription, design: &[f64]) -> Result<(), DeployError> {
    let wanted = || DeployError::Value {
        name: "design",
        value: format!("{} numbers", design.len()),
        limits: format!("{DESIGN_LEN} of a hand"),
    };
    let design: &[f64; DESIGN_LEN] = design.try_into().map_err(|_| wanted())?;
    let joints =
        [("thumb's proximal joint", "thumb's distal joint"), ("fingers' proximal joints", "fingers' distal joints")];
    let mut worst: Option<(f64, DeployError)> = None;
    for (finger, (proximal, distal)) in [false, true].into_iter().zip(joints) {
        let found = droop(hand, design, finger);
        for (i, joint) in [proximal, distal].into_iter().enumerate() {
            let (springs, weight) = (1e3 * found.springs[i], 1e3 * found.gravity[i]);
            if springs <= weight && worst.as_ref().is_none_or(|(margin, _)| springs - weight < *margin) {
                worst = Some((springs - weight, DeployError::Droops { joint, springs, weight }));
            }
        }
    }
    worst.map_or(Ok(()), |(_, error)| Err(error))
}

#[cfg(test)]
mod tests {
    use hwasp_tasks::hand::{PAPER_HWASP, SMALL_CENTRE};

    use super::*;

    #[test]
    fn a_hand_that_droops_is_refused() {
        let hand = HandDescription::default();
        assert!(stands(&hand, &SMALL_CENTRE).is_ok() && stands(&hand, &PAPER_HWASP).is_ok());
        let mut weak = PAPER_HWASP;
        weak[10] = 1.0; // 6.1 N·mm against 7.8
        let error = stands(&hand, &weak).unwrap_err().to_string();
        assert!(error.contains("fingers' proximal joints open with 6.10 N·mm"), "{error}");
        assert!(stands(&hand, &[0.0; 3]).is_err());
    }

    #[test]
    fn a_calibration_is_of_one_motor_and_one_hand() {
        let path = std::env::temp_dir().join(format!("hwasp-calibration-{}.toml", std::process::id()));
        let (rig, design) = (Rig::default(), PAPER_HWASP);
        let made =
            Calibration { date: "2026-11-29T12:00:00Z".to_owned(), zero_rad: 2.5, ..Calibration::ideal(&rig, &design) };
        made.write(&path).unwrap();
        assert_eq!(Calibration::open(&path, &rig, &design).unwrap(), made);
        let mut other = rig.clone();
        other.motor.id = 7;
        assert!(Calibration::open(&path, &other, &design).unwrap_err().to_string().contains("another motor"));
        assert!(Calibration::open(&path, &rig, &SMALL_CENTRE).unwrap_err().to_string().contains("another hand"));
        std::fs::remove_file(&path).unwrap();
        let error = Calibration::open(&path, &rig, &design).unwrap_err().to_string();
        assert!(error.contains("`hwasp deploy calibrate` makes it anew"), "{error}");
    }
}
