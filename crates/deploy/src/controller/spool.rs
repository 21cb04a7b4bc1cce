//! Between the motor's shaft and the tendons.

use hwasp_tasks::hand::TransmissionDescription;

use crate::rig::Winding;

/// The spool on the motor's shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spool {
    /// m.
    pub radius: f64,
    /// 1 or -1: which way winds.
    pub sign: f64,
    /// The motor's position with nothing wound, rad.
    pub zero: f64,
    /// Torque of the shaft per current, calibrated, N·m/A.
    pub torque_per_current: f64,
    /// The most current for the tension that the hand is made for, A.
    pub current: f64,
    /// The most that it winds, m.
    pub travel: f64,
}

impl Spool {
    /// The spool of a hand: calibrated `zero`, rad, and `gain`, the real torque per current as a multiple of the data sheet's.
    pub fn new(hand: &TransmissionDescription, winding: Winding, zero: f64, gain: f64) -> Self {
        let torque_per_current = hand.torque_constant * gain;
        Self {
            radius: hand.spool_radius,
            sign: winding.sign(),
            zero,
            torque_per_current,
            current: hand.tension_limit * hand.spool_radius / torque_per_current,
            travel: hand.travel,
        }
    }

    /// What is wound at a position of the motor, m.
    pub fn wound(&self, position: f64) -> f64 {
        self.sign * (position - self.zero) * self.radius
    }

    /// The position of the motor, rad, with so much wound, m.
    pub fn position(&self, wound: f64) -> f64 {
        self.zero + self.sign * wound / self.radius
    }

    /// The torque that winds, N·m, at a current, A. Training knows no torque that unwinds: it is none.
    pub fn torque(&self, current: f64) -> f64 {
        (self.sign * current * self.torque_per_current).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_and_back() {
        let hand = TransmissionDescription::default();
        for winding in [Winding::Positive, Winding::Negative] {
            let spool = Spool::new(&hand, winding, 2.5, 0.9);
            assert!((spool.wound(spool.position(0.02)) - 0.02).abs() < 1e-15);
            assert_eq!(spool.wound(2.5), 0.0);
            let pulling = winding.sign() * spool.current;
            assert!((spool.torque(pulling) - 0.6).abs() < 1e-12);
            assert_eq!(spool.torque(-pulling), 0.0);
        }
        // 81.5 of the motor's 4096 ticks per turn for a millimetre.
        let ticks = 4096.0 / std::f64::consts::TAU * 0.001 / hand.spool_radius;
        assert!((ticks - 81.5).abs() < 0.05, "{ticks}");
    }
}
