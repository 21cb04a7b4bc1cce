//! Where the tendons begin to pull, and the friction of a slack spool.

use hwasp_tasks::grasp::Targets;

use crate::drive::{Drive, Finish, Manner, Motion, Progress, Senses};
use crate::error::DeployError;
use crate::record::Phase;

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
/// The fewest samples of a line, and that have to have risen.
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
    let at = samples[begin + split(&samples[begin..(first + FEWEST).min(samples.len())])].0;
    Ok(Onset { at, before })
}

/// Where samples that were flat begin to be on another line: the split that leaves the least squares. Weak springs give way at once, so
/// that the first rise is small and the next one slow; all samples on both sides together tell where it is.
fn split(samples: &[(f64, f64)]) -> usize {
    let left = |part: &[(f64, f64)]| {
        let mean = part.iter().map(|p| p.1).sum::<f64>() / part.len() as f64;
        part.iter().map(|p| (p.1 - mean).powi(2)).sum::<f64>()
    };
    let right = |part: &[(f64, f64)]| {
        let n = part.len() as f64;
        let (mx, my) = (part.iter().map(|p| p.0).sum::<f64>() / n, part.iter().map(|p| p.1).sum::<f64>() / n);
        let sxx: f64 = part.iter().map(|p| (p.0 - mx).powi(2)).sum();
        let sxy: f64 = part.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum();
        let slope = if sxx > 0.0 { sxy / sxx } else { 0.0 };
        part.iter().map(|p| (p.1 - my - slope * (p.0 - mx)).powi(2)).sum::<f64>()
    };
    let rest = |i: usize| left(&samples[..i]) + right(&samples[i..]);
    let splits = FEWEST..samples.len().saturating_sub(FEWEST).max(FEWEST + 1);
    splits.map(|i| (i, rest(i))).min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(i, _)| i)
}

/// The middle of some numbers; not a number where there are none.
pub(super) fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// How slowly the spool turns while it is measured, m a step: 4 mm/s.
pub(super) const SLOWLY: f64 = 4e-5;
/// How much is paid out before, m.
pub(super) const SLACK: f64 = 0.012;
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

pub(super) fn sweep(drive: &mut Drive<'_>, sweep: &mut Sweep) -> Result<(), DeployError> {
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

#[cfg(test)]
mod tests {
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

    /// Springs that hardly hold the digits open: 5 mA at once, and 1 mA more with each mm, read in ticks of 2.69 mA.
    #[test]
    fn the_onset_of_weak_springs_is_found_too() {
        for at in [0.0081, 0.0113, 0.0135] {
            let samples: Vec<_> = (0..900)
                .map(|i| {
                    let wound = SLOWLY * f64::from(i);
                    let stretched = (wound - at).max(0.0);
                    let limit = (stretched - 0.015).max(0.0) * 92.0;
                    let current = 0.011
                        + (stretched * 92.0).min(0.005 + stretched)
                        + limit
                        + 0.001 * f64::sin(12.9898 * f64::from(i));
                    (wound, 0.00269 * (current / 0.00269).round())
                })
                .collect();
            let found = onset(&samples).unwrap();
            assert!((found.at - at).abs() < 2e-4, "{found:?}, not {at} m");
        }
    }

    #[test]
    fn what_is_no_onset_is_told() {
        let never = onset(&winding(1.0, 0.03, 0.0)).unwrap_err().to_string();
        assert!(never.contains("never begin to pull"), "{never}");
        assert!(onset(&[]).is_err());
    }
}
