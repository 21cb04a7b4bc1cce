//! What has to be measured on a hand before it is driven: where its tendons begin to pull, how much friction there is, and how much
//! torque its motor gives per current.

use std::fmt::Write;
use std::path::Path;

use hwasp_runs::files::{Disk, read_limited, replace};
use hwasp_settings::written;
use hwasp_tasks::hand::{DESIGN_LEN, HandDescription, droop};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::controller::Targets;
use crate::drive::{Drive, Finish, Manner, Motion, Progress, Senses};
use crate::error::{DeployError, file};
use crate::record::{Phase, Step};
use crate::rig::Rig;

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

/// The spool winds or unwinds slowly, and what it takes is kept.
#[derive(Clone, Debug)]
pub struct Sweep {
    goal: f64,
    step: f64,
    /// It ends at this current, A, of either sign.
    most: f64,
    left: u32,
    samples: Vec<(f64, f64)>,
}

/// The longest sweep, steps.
const LONGEST: u32 = 3000;

impl Sweep {
    /// To so much wound, m, by `step`, m, a step, or until the motor takes `most`, A.
    pub fn to(goal: f64, step: f64, most: f64) -> Self {
        Self { goal, step, most, left: LONGEST, samples: Vec::with_capacity(LONGEST as usize) }
    }

    /// What was wound, m, and what it took, A, step by step.
    pub fn samples(&self) -> &[(f64, f64)] {
        &self.samples
    }
}

impl Motion for Sweep {
    fn phase(&self) -> Phase {
        Phase::Measure
    }

    fn step(&mut self, senses: &Senses, targets: &mut Targets, manner: &Manner) -> Progress {
        let current = senses.motor.map_or(f64::NAN, |motor| manner.spool.sign * motor.current);
        self.samples.push((senses.wound, current));
        self.left -= 1;
        let way = self.goal - targets.travel;
        targets.travel += way.clamp(-self.step, self.step);
        if way.abs() <= self.step || current.abs() >= self.most || self.left == 0 {
            Progress::Done
        } else {
            Progress::Going
        }
    }

    fn tell(&self, _: &mut Step) {}
}

/// Where a spool that winds slack tendons begins to pull.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Onset {
    /// Wound, m.
    pub at: f64,
    /// What it took before, A.
    pub before: f64,
}

/// The least rise of the current that counts, A: eight steps of its sensor.
const RISE: f64 = 0.02;
/// How far behind the rise the line goes that leads back to the onset, m.
const LINE: f64 = 4e-4;
/// The fewest samples of a line.
const FEWEST: usize = 5;

/// Finds the onset in samples of a slow winding, m and A.
///
/// # Errors
/// Where the current never rises, or from the beginning on.
pub fn onset(samples: &[(f64, f64)]) -> Result<Onset, DeployError> {
    let none = |what: &str, hint| Err(DeployError::Measured { what: what.to_owned(), hint });
    // The motor has to start first: what it takes for that is no tension.
    let begin = samples.len() / 20;
    let quiet = &samples[begin.min(samples.len())..(samples.len() / 4).max(begin)];
    if quiet.len() < FEWEST {
        return none(
            "there are too few samples",
            "see that the motor turns, and that the line is slack when it begins",
        );
    }
    let before = median(quiet.iter().map(|(_, current)| *current));
    let noise = median(quiet.iter().map(|(_, current)| (current - before).abs()));
    let threshold = before + RISE.max(6.0 * noise);
    let rises = |i: &usize| samples[*i..].iter().take(FEWEST).all(|(_, current)| *current > threshold);
    let Some(first) = (begin..samples.len().saturating_sub(FEWEST)).find(rises) else {
        return none(
            "the tendons never begin to pull",
            "see that they are on the spool, or wind them up by hand by a turn",
        );
    };
    if first <= begin + quiet.len() / 2 {
        return none(
            "the tendons pull from the beginning",
            "see that [motor] winding is right, and that the hand opens freely",
        );
    }
    let from = samples[first].0;
    let line: Vec<_> = samples[first..].iter().take_while(|(wound, _)| wound - from <= LINE).copied().collect();
    let line = if line.len() < FEWEST { &samples[first..first + FEWEST] } else { &line[..] };
    let n = line.len() as f64;
    let (mx, my) = (line.iter().map(|p| p.0).sum::<f64>() / n, line.iter().map(|p| p.1).sum::<f64>() / n);
    let sxx: f64 = line.iter().map(|p| (p.0 - mx).powi(2)).sum();
    let slope = line.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum::<f64>() / sxx;
    // A line that does not rise leads nowhere: the rise itself is the best there is.
    let at = if slope > 0.0 && sxx > 0.0 { mx - (my - before) / slope } else { from };
    Ok(Onset { at: at.clamp(from - 2.0 * LINE, from), before })
}

/// The middle of some numbers; not a number where there are none.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// How slowly the spool turns while it is measured, m a step: 4 mm/s.
const SLOWLY: f64 = 4e-5;
/// How much is paid out before, m.
const SLACK: f64 = 0.012;
/// The current at which the tendons surely pull, A.
const PULLS: f64 = 0.25;

/// What a drive with a provisional zero found: where its tendons begin to pull, as tendon by that zero, m, and the friction, A.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// By the provisional zero, m.
    pub onset: f64,
    /// A.
    pub friction_up: f64,
    /// A.
    pub friction_down: f64,
}

fn sweep(drive: &mut Drive<'_>, sweep: &mut Sweep) -> Result<(), DeployError> {
    match drive.run(sweep) {
        Finish::Done => Ok(()),
        Finish::Ended(verdict) => Err(DeployError::Stopped {
            cause: verdict.cause.map_or_else(String::new, |cause| cause.name().to_owned()),
            state: "the motor is free".to_owned(),
        }),
    }
}

/// Pays out, winds until the tendons pull, and pays out again. The motor holds when it begins and when it ends.
///
/// # Errors
/// Where a rule ended it, or nothing is found.
pub fn find(drive: &mut Drive<'_>) -> Result<Found, DeployError> {
    let begin = drive.targets().travel;
    let mut down = Sweep::to(begin - SLACK, 2.5 * SLOWLY, f64::INFINITY);
    sweep(drive, &mut down)?;
    // What a slack spool takes to unwind: the last half of the way.
    let samples = down.samples();
    let friction_down = -median(samples[samples.len() / 2..].iter().map(|(_, current)| *current));
    let mut up = Sweep::to(begin + 2.0 * SLACK, SLOWLY, PULLS);
    sweep(drive, &mut up)?;
    let onset = onset(up.samples())?;
    sweep(drive, &mut Sweep::to(onset.at - 1e-3, 2.5 * SLOWLY, f64::INFINITY))?;
    Ok(Found { onset: onset.at, friction_up: onset.before.max(0.0), friction_down: friction_down.max(0.0) })
}

/// What a weight says of the motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weighed {
    /// Torque per current as a multiple of the data sheet's.
    pub gain: f64,
    /// Friction, N·m.
    pub friction: f64,
}

/// From what lifting and lowering a mass on the spool took, A: friction is with the one and against the other.
///
/// # Errors
/// Where the figures are no weight's.
pub fn weighed(up: f64, down: f64, mass: f64, hand: &HandDescription) -> Result<Weighed, DeployError> {
    let transmission = &hand.transmission;
    let (middle, half) = (0.5 * (up + down), 0.5 * (up - down));
    let gain = mass * hand.gravity * transmission.spool_radius / (transmission.torque_constant * middle);
    if !(gain.is_finite() && (0.3..=3.0).contains(&gain)) {
        return Err(DeployError::Measured {
            what: format!("lifting {mass} kg took {up:.3} A and lowering {down:.3} A, a gain of {gain:.2}"),
            hint: "see that the whole weight hangs freely on one line from the spool, and that --weight is right",
        });
    }
    Ok(Weighed { gain, friction: (half * transmission.torque_constant * gain).max(0.0) })
}

/// Lifts and lowers a mass, kg, that hangs on the spool.
///
/// # Errors
/// Where a rule ended it, or the figures are no weight's.
pub fn weigh(drive: &mut Drive<'_>, mass: f64, hand: &HandDescription) -> Result<Weighed, DeployError> {
    let begin = drive.targets().travel;
    let mut up = Sweep::to(begin + SLACK, SLOWLY, f64::INFINITY);
    sweep(drive, &mut up)?;
    let mut down = Sweep::to(begin, SLOWLY, f64::INFINITY);
    sweep(drive, &mut down)?;
    let last_half = |samples: &[(f64, f64)]| median(samples[samples.len() / 2..].iter().map(|(_, current)| *current));
    weighed(last_half(up.samples()), last_half(down.samples()), mass, hand)
}

#[cfg(test)]
mod tests {
    use hwasp_tasks::hand::{PAPER_HWASP, SMALL_CENTRE};

    use super::*;

    /// A slack winding with friction, then three tendons of 5 N/mm on a spool of 8 mm: 0.092 A/mm.
    fn winding(onset: f64, friction: f64, noise: f64) -> Vec<(f64, f64)> {
        let step = |i: usize| {
            let wound = SLOWLY * i as f64;
            let pull = (wound - onset).max(0.0) * 15_000.0 * 0.008 / (3.0 / 2.3);
            // A noise that repeats, as good as any.
            let off = noise * f64::sin(12.9898 * i as f64);
            (wound, friction + pull + off)
        };
        (0..400).map(step).collect()
    }

    #[test]
    fn the_onset_is_where_the_tendons_begin_to_pull() {
        for (at, friction, noise) in [(0.008, 0.03, 0.0), (0.010, 0.0, 0.003), (0.0125, 0.06, 0.002)] {
            let found = onset(&winding(at, friction, noise)).unwrap();
            assert!((found.at - at).abs() < 1e-4, "{found:?}, not {at} m");
            assert!((found.before - friction).abs() < 0.003, "{found:?}");
        }
    }

    #[test]
    fn what_is_no_onset_is_told() {
        let never = onset(&winding(1.0, 0.03, 0.0)).unwrap_err().to_string();
        assert!(never.contains("never begin to pull"), "{never}");
        assert!(onset(&[]).is_err());
    }

    #[test]
    fn a_weight_tells_gain_and_friction() {
        // 1 kg on 8 mm is 78.5 N·mm; a motor with 0.9 of its torque and 10 N·mm of friction.
        let (hand, per_ampere) = (HandDescription::default(), 0.9 * 3.0 / 2.3);
        let weight = 9.81 * 0.008;
        let found = weighed((weight + 0.01) / per_ampere, (weight - 0.01) / per_ampere, 1.0, &hand).unwrap();
        assert!((found.gain - 0.9).abs() < 1e-9 && (found.friction - 0.01).abs() < 1e-9, "{found:?}");
        assert!(weighed(0.01, 0.01, 1.0, &hand).unwrap_err().to_string().contains("--weight is right"));
    }

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
