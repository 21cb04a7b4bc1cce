//! What a state of the masses is worth.

use hwasp_diff::Scalar;

/// How the reward passes from "get there" to "spare the motor".
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Switch {
    /// By a logistic function of this slope, c (the authors' code).
    Soft {
        /// The slope c, a pure number.
        sharpness: f64,
    },
    /// At once (the paper's two stages): the limit c → ∞.
    Hard,
}

impl Switch {
    /// The slope c of a soft one.
    pub fn sharpness(self) -> Option<f64> {
        match self {
            Self::Soft { sharpness } => Some(sharpness),
            Self::Hard => None,
        }
    }
}

/// The weights of the reward (paper, appendix A, first equation; values from the authors' code).
///
/// With the error e = α·|y2 - h| + β·|v2| and the cost of the force F = γ·|f|, at most `F_max` = γ·`f_max`:
///
/// - soft: R = -e - \[F + (`F_max` - F)·sigmoid(c·(e - ε))\]
/// - hard: R = -e - (`F_max` where e > ε, else F)
///
/// | | stiffness | bar length |
/// |---|---|---|
/// | α `position` (1/m), β `speed` (s/m), γ `force` (1/N) | 10, 0.5, 2 | 1, 0.05, 2 |
/// | ε `threshold`, c of `switch` | 0.1, 10 | 0.08, 50 |
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reward {
    /// Weight of the distance to the goal, α, 1/m.
    pub position: f64,
    /// Weight of the speed, β, s/m.
    pub speed: f64,
    /// Weight of the motor's force, γ, 1/N.
    pub force: f64,
    /// The error below which the force is looked at, ε, a pure number.
    pub threshold: f64,
    /// How sharply.
    pub switch: Switch,
}

impl Reward {
    /// Where spring stiffnesses are optimised.
    pub const STIFFNESS: Self =
        Self { position: 10.0, speed: 0.5, force: 2.0, threshold: 0.1, switch: Switch::Soft { sharpness: 10.0 } };

    /// Where the bar's length is optimised.
    pub const BAR: Self =
        Self { position: 1.0, speed: 0.05, force: 2.0, threshold: 0.08, switch: Switch::Soft { sharpness: 50.0 } };

    /// The reward at this distance from the goal (m), speed (m/s) and motor force (N, of at most `force_limit`), all of
    /// either sign.
    #[inline]
    pub fn value(&self, distance: f64, speed: f64, force: f64, force_limit: f64) -> f64 {
        let error = self.position * distance.abs() + self.speed * speed.abs();
        let least = self.force * force.abs();
        let most = self.force * force_limit;
        let far = match self.switch {
            Switch::Soft { sharpness } => (sharpness * (error - self.threshold)).sigmoid(),
            Switch::Hard => f64::from(u8::from(error > self.threshold)),
        };
        -error - (least + (most - least) * far)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: error 10·0.02 + 0.5·0.4 = 0.4, F = 2·1.5 = 3, `F_max` = 10, sigmoid(10·0.3) = 0.952574.
    #[test]
    fn soft_reward_by_hand() {
        let r = Reward::STIFFNESS.value(-0.02, 0.4, -1.5, 5.0);
        assert!((r - (-0.4 - (3.0 + 7.0 * 0.952_574_126_822_433_3))).abs() < 1e-12, "{r}");
    }

    #[test]
    fn the_hard_reward_is_the_limit_of_the_soft_one() {
        for base in [Reward::STIFFNESS, Reward::BAR] {
            let hard = Reward { switch: Switch::Hard, ..base };
            for i in 0..40 {
                let distance = f64::from(i) * 0.01 - 0.2003;
                let (speed, force) = (0.1, 1.0);
                let wanted = hard.value(distance, speed, force, 5.0);
                let off = |sharpness| {
                    let soft = Reward { switch: Switch::Soft { sharpness }, ..base };
                    (soft.value(distance, speed, force, 5.0) - wanted).abs()
                };
                assert!(off(1e6) < 1e-9, "at {distance} m: {}", off(1e6));
                assert!(off(10.0) > 1e-9, "a soft switch is not hard, at {distance} m");
            }
        }
    }

    #[test]
    fn the_sigmoid_does_not_overflow() {
        let r = Reward { switch: Switch::Soft { sharpness: 1e9 }, ..Reward::BAR };
        assert_eq!(r.value(0.0, 0.0, 0.0, 5.0), 0.0);
        assert_eq!(r.value(1.0, 0.0, 0.0, 5.0), -11.0);
    }
}
