//! Motor, spool and tendons.

use super::super::error::{HandError, positive, within};

/// The one motor and the three tendons on its spool. The pulleys and springs in the joints are designed.
#[derive(Clone, Debug, PartialEq)]
pub struct TransmissionDescription {
    /// Stiffness of each tendon, N/m. 5000 \[M\]; see the joints' damping for why not more.
    pub tendon_stiffness: f64,
    /// The most that the three tendons pull together, N. 75 \[M\]: 0.60 N·m at the spool, 20 % of the motor's stall torque,
    /// where the hardware decides success. See [`EASY`](Self::EASY).
    pub tension_limit: f64,
    /// Radius of the spool, m. 8 mm \[M\].
    pub spool_radius: f64,
    /// How much tendon the spool can wind, m. 45 mm \[M\].
    pub travel: f64,
    /// The most it winds or unwinds in an environment step, m. 0.2 mm \[M\].
    pub step_limit: f64,
    /// Joint angles at which the tendons are just taut with nothing wound, rad, in the order of
    /// [`KINDS`](super::super::names::KINDS). 0 \[P\].
    pub reference: [f64; 4],
    /// The motor's torque per current, N·m/A. 3.0 N·m at 2.3 A (Dynamixel XM430-W210-T at stall) \[S\].
    pub torque_constant: f64,
}

impl Default for TransmissionDescription {
    fn default() -> Self {
        Self {
            tendon_stiffness: 5000.0,
            tension_limit: 75.0,
            spool_radius: 0.008,
            travel: 0.045,
            step_limit: 0.0002,
            reference: [0.0; 4],
            torque_constant: 3.0 / 2.3,
        }
    }
}

impl TransmissionDescription {
    /// The tension limit, N, at which nearly any design grasps: 1.0 A in the motor.
    pub const EASY: f64 = 163.0;

    /// The motor's current, A, while the three tendons pull `tension`, N, together.
    pub fn current(&self, tension: f64) -> f64 {
        tension * self.spool_radius / self.torque_constant
    }

    pub(in crate::hand) fn check(&self) -> Result<(), HandError> {
        for (name, value, unit) in [
            ("transmission.tendon_stiffness", self.tendon_stiffness, "N/m"),
            ("transmission.tension_limit", self.tension_limit, "N"),
            ("transmission.spool_radius", self.spool_radius, "m"),
            ("transmission.travel", self.travel, "m"),
            ("transmission.step_limit", self.step_limit, "m"),
            ("transmission.torque_constant", self.torque_constant, "N·m/A"),
        ] {
            positive(name, value, unit)?;
        }
        for &angle in &self.reference {
            within("transmission.reference", angle, -std::f64::consts::PI, std::f64::consts::PI, "rad")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_easy_limit_is_one_ampere() {
        let motor = TransmissionDescription::default();
        assert!((motor.current(TransmissionDescription::EASY) - 1.0).abs() < 1e-3);
        assert!((motor.current(motor.tension_limit) * motor.torque_constant - 0.6).abs() < 1e-12);
    }
}
