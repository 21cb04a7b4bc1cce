//! What can be said of a design from balances of forces: whether it droops, what it can pinch, what that lifts.

use super::description::{FingerDescription, HandDescription};
use super::error::{HandError, positive};
use super::space::{DESIGN_LEN, KINDS_LEN};

/// A digit under its own weight, palm down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Droop {
    /// Torques of gravity about proximal and distal joint, N·m; positive closes.
    pub gravity: [f64; 2],
    /// Torques of the springs, N·m, which open.
    pub springs: [f64; 2],
}

impl Droop {
    /// Whether the springs hold the open digit against its weight.
    pub fn holds(&self) -> bool {
        self.springs.iter().zip(self.gravity).all(|(spring, weight)| *spring > weight)
    }
}

/// The open thumb (`false`) or finger (`true`) of a design, palm down.
pub fn droop(hand: &HandDescription, design: &[f64; DESIGN_LEN], finger: bool) -> Droop {
    let (digit, first) = digit_of(hand, finger);
    let open = hand.joint.range[0];
    let (proximal_lean, distal_lean) = (hand.joint.rest_angle - open, hand.joint.rest_angle - 2.0 * open);
    let (proximal, distal) = (&digit.proximal, &digit.distal);
    let of_distal = distal.mass * distal.centre * distal_lean.sin();
    let of_both = (proximal.mass * proximal.centre + distal.mass * proximal.length) * proximal_lean.sin() + of_distal;
    Droop {
        gravity: [hand.gravity * of_both, hand.gravity * of_distal],
        springs: [first, first + 1].map(|kind| design[4 + kind] * (open + design[8 + kind])),
    }
}

/// What the springs of the four kinds of joints have to open with, N·m, so that `margin`, N·m, is left at every pose with the palm
/// down. An open digit leans outward, where its weight closes it most; further on springs only gain and the weight only loses.
pub fn opening_torques(hand: &HandDescription, margin: f64) -> [f64; KINDS_LEN] {
    let [thumb, finger] = [false, true].map(|finger| droop(hand, &[0.0; DESIGN_LEN], finger).gravity);
    [thumb[0], thumb[1], finger[0], finger[1]].map(|weight| weight + margin)
}

fn digit_of(hand: &HandDescription, finger: bool) -> (&FingerDescription, usize) {
    if finger { (&hand.fingers[0], 2) } else { (&hand.thumb, 0) }
}

/// Which ratios of proximal to distal joint torque can pinch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PinchBand {
    /// The least, where friction pulls the digit down.
    pub lo: f64,
    /// The largest, where it pushes it up.
    pub hi: f64,
}

/// A digit that presses with an upright distal link on the upright side of an object in the middle of the hand.
#[derive(Clone, Copy, Debug)]
struct Pinch {
    /// Of the contact: how far below the proximal and the distal joint, m.
    below: [f64; 2],
    /// And how far outward of them, m (negative: inward).
    outward: [f64; 2],
    /// Joint angles, rad.
    angles: [f64; 2],
}

impl Pinch {
    /// None if the proximal link cannot reach.
    fn new(hand: &HandDescription, digit: &FingerDescription, width: f64, below: f64) -> Option<Self> {
        let base = digit.base[1].abs();
        let distal_joint = 0.5 * width + digit.distal.radius;
        let lean = (distal_joint - base) / digit.proximal.length;
        (lean.abs() < 1.0).then(|| {
            let lean = lean.asin();
            Self {
                below: [digit.proximal.length * lean.cos() + below, below],
                outward: [0.5 * width - base, -digit.distal.radius],
                angles: [hand.joint.rest_angle - lean, lean],
            }
        })
    }

    /// Joint torques per newton of normal force, m, where friction pushes the digit up by `friction` newtons of it.
    fn levers(&self, friction: f64) -> [f64; 2] {
        [0, 1].map(|j| self.below[j] + self.outward[j] * friction)
    }
}

/// The band of torque ratios of a fingertip pinch: an object of `width` (m) held by friction (coefficient) at `below` (m)
/// under the distal joints, whose links are upright. `None` if the links do not reach. Where spring torques are small the
/// ratio of a design is that of its pulleys.
pub fn pinch_band(hand: &HandDescription, width: f64, below: f64, friction: f64) -> Option<PinchBand> {
    let pinch = Pinch::new(hand, &hand.thumb, width, below)?;
    let ratio = |friction: f64| {
        let levers = pinch.levers(friction);
        levers[0] / levers[1]
    };
    // A quotient of two straight lines is monotonic between the ends of the cone.
    let (a, b) = (ratio(-friction), ratio(friction));
    Some(PinchBand { lo: a.min(b), hi: a.max(b) })
}

/// The ratio of proximal to distal joint torque that thumb (`false`) or finger (`true`) of a design have in the pose of
/// [`pinch_band`], springs included, while its tendon pulls `tension` (N). `None` if the links do not reach or the tendon
/// does not overcome both springs.
pub fn torque_ratio(
    hand: &HandDescription,
    design: &[f64; DESIGN_LEN],
    finger: bool,
    width: f64,
    tension: f64,
) -> Option<f64> {
    let (digit, first) = digit_of(hand, finger);
    // The pose does not depend on where along the upright distal link the contact is.
    let angles = Pinch::new(hand, digit, width, 0.0)?.angles;
    let torque = |j: usize| {
        let kind = first + j;
        design[kind] * tension - design[4 + kind] * (angles[j] + design[8 + kind])
    };
    let (proximal, distal) = (torque(0), torque(1));
    (proximal > 0.0 && distal > 0.0).then(|| proximal / distal)
}

/// A lift by the fingertips.
///
/// | field | default | purpose | must be |
/// |---|---|---|---|
/// | `width` | 0.08 m | of the object | within the reach of the links |
/// | `below` | 0.03 m | of the contacts under the distal joints | > 0 |
/// | `friction` | 0.5 | coefficient at the contacts | > 0 |
/// | `safety` | 1.5 | how much more than the weight friction could carry | > 0 |
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PinchLift {
    /// Width of the object, m.
    pub width: f64,
    /// Height of the contacts below the distal joints, m.
    pub below: f64,
    /// Coefficient of friction.
    pub friction: f64,
    /// Safety factor against slipping.
    pub safety: f64,
}

impl Default for PinchLift {
    fn default() -> Self {
        Self { width: 0.080, below: 0.030, friction: 0.5, safety: 1.5 }
    }
}

/// What a pinch asks of tendons and motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PinchTension {
    /// Normal force of the thumb, N: as much as that of both fingers.
    pub thumb_force: f64,
    /// Tension of the thumb's tendon, N.
    pub thumb: f64,
    /// Tension of each finger's, N.
    pub finger: f64,
    /// Of the three together, N.
    pub total: f64,
    /// Motor torque, N·m.
    pub motor_torque: f64,
}

impl PinchLift {
    /// Per digit and joint, the tension, N, that carries its torque: this much, and this much more per newton of the thumb's
    /// normal force. `None` if the links do not reach.
    fn tensions(&self, hand: &HandDescription, design: &[f64; DESIGN_LEN]) -> Option<[[(f64, f64); 2]; 2]> {
        let of = |finger: bool| {
            let ((digit, first), share) = (digit_of(hand, finger), if finger { 0.5 } else { 1.0 });
            let pinch = Pinch::new(hand, digit, self.width, self.below)?;
            // The object's weight hangs on the digits, evenly by their normal forces.
            let levers = pinch.levers(-self.friction / self.safety);
            Some([0, 1].map(|j| {
                let spring = design[4 + first + j] * (pinch.angles[j] + design[8 + first + j]).max(0.0);
                (spring / design[first + j], share * levers[j] / design[first + j])
            }))
        };
        Some([of(false)?, of(true)?])
    }

    fn check(&self) -> Result<(), HandError> {
        positive("width", self.width, "m")?;
        positive("below", self.below, "m")?;
        positive("friction", self.friction, "")?;
        positive("safety", self.safety, "")
    }

    /// What lifting `mass`, kg, takes: an estimate, as each tendon is given what the more demanding of its joints needs,
    /// where the other one would give way until the links embrace the object. Embracing takes less than half of it.
    /// `None` if the links do not reach the object.
    pub fn needs(
        &self,
        hand: &HandDescription,
        design: &[f64; DESIGN_LEN],
        mass: f64,
    ) -> Result<Option<PinchTension>, HandError> {
        self.check()?;
        positive("mass", mass, "kg")?;
        let Some(tensions) = self.tensions(hand, design) else { return Ok(None) };
        let thumb_force = self.safety * mass * hand.gravity / (2.0 * self.friction);
        let [thumb, finger] = tensions
            .map(|joints| joints.iter().map(|(spring, lever)| spring + lever * thumb_force).fold(0.0, f64::max));
        let total = thumb + 2.0 * finger;
        let motor_torque = total * hand.transmission.spool_radius;
        Ok(Some(PinchTension { thumb_force, thumb, finger, total, motor_torque }))
    }

    /// The largest mass, kg, that the transmission's tension limit lifts; see [`needs`](Self::needs). Zero if the springs
    /// take it all; `None` if the links do not reach the object.
    pub fn capacity(&self, hand: &HandDescription, design: &[f64; DESIGN_LEN]) -> Result<Option<f64>, HandError> {
        self.check()?;
        let Some([thumb, finger]) = self.tensions(hand, design) else { return Ok(None) };
        let limit = hand.transmission.tension_limit;
        // The total is the largest of four straight lines, so the first of them to reach the limit decides.
        let force = thumb
            .iter()
            .flat_map(|t| finger.iter().map(move |f| (limit - t.0 - 2.0 * f.0) / (t.1 + 2.0 * f.1)))
            .fold(f64::INFINITY, f64::min);
        Ok(Some((force * 2.0 * self.friction / (self.safety * hand.gravity)).max(0.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::space::{PAPER_HWASP, SMALL_CENTRE};
    use super::*;

    #[test]
    fn an_open_finger_weighs_on_its_joints() {
        let hand = HandDescription::default();
        let finger = droop(&hand, &PAPER_HWASP, true);
        assert!((finger.gravity[0] - 7.8e-3).abs() < 0.1e-3, "{finger:?}");
        assert!((finger.gravity[1] - 1.7e-3).abs() < 0.05e-3, "{finger:?}");
        assert!((finger.springs[0] - 6.1e-3 * 1.9).abs() < 1e-12 && finger.holds());
        let mut weak = PAPER_HWASP;
        weak[10] = 1.0; // 6.1 N·mm at the proximal joint
        assert!(!droop(&hand, &weak, true).holds() && droop(&hand, &weak, false).holds());
    }

    #[test]
    fn pinch_bands_are_those_computed_by_hand() {
        let hand = HandDescription::default();
        for (width, lo, hi) in [(0.04, 2.43, 3.02), (0.06, 2.28, 3.21), (0.08, 2.07, 3.31), (0.10, 1.79, 3.32)] {
            let band = pinch_band(&hand, width, 0.03, 0.5).unwrap();
            assert!((band.lo - lo).abs() < 0.006 && (band.hi - hi).abs() < 0.006, "{width} m: {band:?}");
        }
        assert_eq!(pinch_band(&hand, 0.2, 0.03, 0.5), None);
    }

    /// A thumb on an object of 80 mm: sin(lean) = (0.052 - 0.035)/0.05, so the joints are at 0.7854 - 0.3469 and 0.3469 rad.
    #[test]
    fn springs_take_their_share_of_the_torque() {
        let hand = HandDescription::default();
        let ratio = torque_ratio(&hand, &PAPER_HWASP, false, 0.08, 25.0).unwrap();
        let by_hand = (0.25 - 6.2e-3 * 2.438_5) / (0.1875 - 6.1e-3 * 1.846_9);
        assert!((ratio - by_hand).abs() < 1e-4, "{ratio}, not {by_hand}");
        assert!((torque_ratio(&hand, &PAPER_HWASP, true, 0.08, 1e9).unwrap() - 3.0 / 2.6).abs() < 1e-6);
        assert_eq!(torque_ratio(&hand, &PAPER_HWASP, false, 0.08, 1.0), None);
        assert_eq!(torque_ratio(&hand, &PAPER_HWASP, false, 0.2, 25.0), None);
    }

    #[test]
    fn half_a_kilogram_takes_most_of_the_motor() {
        let hand = HandDescription::default();
        let needs = PinchLift::default().needs(&hand, &SMALL_CENTRE, 0.5).unwrap().unwrap();
        assert!((needs.thumb_force - 7.36).abs() < 0.01, "{needs:?}");
        // About 163 N and 1.31 N·m over widths; 174 N at 80 mm: (0.5546 + 0.0146)/0.010 + 2·(0.2773 + 0.0146)/0.005.
        assert!((needs.total - 173.7).abs() < 0.3 && (needs.motor_torque - 1.39).abs() < 0.01, "{needs:?}");
    }

    #[test]
    fn capacity_is_what_takes_the_limit() {
        for (design, limit) in [(SMALL_CENTRE, 75.0), (PAPER_HWASP, 163.0), (PAPER_HWASP, 20.0)] {
            let mut hand = HandDescription::default();
            hand.transmission.tension_limit = limit;
            for width in [0.04, 0.06, 0.1] {
                let lift = PinchLift { width, ..PinchLift::default() };
                let mass = lift.capacity(&hand, &design).unwrap().unwrap();
                let needs = lift.needs(&hand, &design, mass).unwrap().unwrap();
                assert!((needs.total - limit).abs() < 1e-9, "{mass} kg at {limit} N: {needs:?}");
            }
        }
        let mut hand = HandDescription::default();
        hand.transmission.tension_limit = 1.0;
        assert_eq!(PinchLift::default().capacity(&hand, &SMALL_CENTRE), Ok(Some(0.0)));
        let none = PinchLift { width: 0.0, ..PinchLift::default() };
        assert!(none.capacity(&hand, &SMALL_CENTRE).unwrap_err().to_string().starts_with("width = 0 m"));
    }
}
