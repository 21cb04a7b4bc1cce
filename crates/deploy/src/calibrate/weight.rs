//! What a known weight on the spool says of the motor.

use hwasp_tasks::hand::HandDescription;

use super::onset::{SLACK, SLOWLY, Sweep, median, sweep};
use crate::drive::Drive;
use crate::error::DeployError;

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
    use super::*;

    #[test]
    fn a_weight_tells_gain_and_friction() {
        // 1 kg on 8 mm is 78.5 N·mm; a motor with 0.9 of its torque and 10 N·mm of friction.
        let (hand, per_ampere) = (HandDescription::default(), 0.9 * 3.0 / 2.3);
        let weight = 9.81 * 0.008;
        let found = weighed((weight + 0.01) / per_ampere, (weight - 0.01) / per_ampere, 1.0, &hand).unwrap();
        assert!((found.gain - 0.9).abs() < 1e-9 && (found.friction - 0.01).abs() < 1e-9, "{found:?}");
        assert!(weighed(0.01, 0.01, 1.0, &hand).unwrap_err().to_string().contains("--weight is right"));
    }
}
