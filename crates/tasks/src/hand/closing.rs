//! Free closing: how far a digit is closed by what the motor has wound, with nothing in the way and without gravity.

use super::description::{HandDescription, JointDescription, TransmissionDescription};
use super::space::DESIGN_LEN;

/// A digit in free closing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FreeClosing {
    /// Tension of the tendon, N.
    pub tension: f64,
    /// Proximal and distal joint angle, rad.
    pub angles: [f64; 2],
}

/// The two joints of a digit and the tendon over them.
struct Digit<'a> {
    radius: [f64; 2],
    stiffness: [f64; 2],
    preload: [f64; 2],
    reference: [f64; 2],
    joint: &'a JointDescription,
    tendon_stiffness: f64,
}

impl Digit<'_> {
    /// Tendon and springs in balance: f·r = k·(θ + p), unless a stop is in the way.
    fn angle(&self, j: usize, tension: f64) -> f64 {
        let free = self.radius[j] * tension / self.stiffness[j] - self.preload[j];
        free.clamp(self.joint.range[0], self.joint.range[1])
    }

    fn at(&self, tension: f64) -> FreeClosing {
        FreeClosing { tension, angles: [self.angle(0, tension), self.angle(1, tension)] }
    }

    /// What has to be wound for this tension: it grows with it, in straight pieces.
    fn travel(&self, tension: f64) -> f64 {
        let taken_up = |j: usize| self.radius[j] * (self.angle(j, tension) - self.reference[j]);
        taken_up(0) + taken_up(1) + tension / self.tendon_stiffness
    }

    /// The tensions at which a joint leaves one stop and reaches the other, from small to large.
    fn bends(&self) -> [f64; 4] {
        let [open, closed] = self.joint.range;
        let at = |j: usize, angle: f64| (self.stiffness[j] * (angle + self.preload[j]) / self.radius[j]).max(0.0);
        let mut bends = [at(0, open), at(1, open), at(0, closed), at(1, closed)];
        bends.sort_by(f64::total_cmp);
        bends
    }

    /// The inverse of [`travel`](Self::travel), piece by piece.
    fn tension(&self, travel: f64) -> f64 {
        let mut from = (0.0, self.travel(0.0));
        if travel <= from.1 {
            return 0.0;
        }
        for bend in self.bends() {
            let to = (bend, self.travel(bend));
            if travel <= to.1 {
                return from.0 + (to.0 - from.0) * (travel - from.1) / (to.1 - from.1);
            }
            from = to;
        }
        from.0 + (travel - from.1) * self.tendon_stiffness
    }
}

impl FreeClosing {
    /// The thumb when the motor has wound `travel`, m.
    pub fn thumb(hand: &HandDescription, design: &[f64; DESIGN_LEN], travel: f64) -> Self {
        Self::of(hand, design, 0, travel)
    }

    /// Either finger when the motor has wound `travel`, m.
    pub fn finger(hand: &HandDescription, design: &[f64; DESIGN_LEN], travel: f64) -> Self {
        Self::of(hand, design, 2, travel)
    }

    /// The digit whose proximal joint is of kind `first`.
    fn of(hand: &HandDescription, design: &[f64; DESIGN_LEN], first: usize, travel: f64) -> Self {
        let pair = |at: usize| [design[at + first], design[at + first + 1]];
        let TransmissionDescription { tendon_stiffness, reference, .. } = &hand.transmission;
        let digit = Digit {
            radius: pair(0),
            stiffness: pair(4),
            preload: pair(8),
            reference: [reference[first], reference[first + 1]],
            joint: &hand.joint,
            tendon_stiffness: *tendon_stiffness,
        };
        digit.at(digit.tension(travel))
    }
}

/// A point of the closing chart.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClosingPoint {
    /// What the motor has wound, m.
    pub travel: f64,
    /// The thumb.
    pub thumb: FreeClosing,
    /// Either finger.
    pub finger: FreeClosing,
    /// Tension of the three tendons together, N, before the motor's limit.
    pub total_tension: f64,
}

/// The free closing chart of a design, at `points` values of the motor's travel from 0 to all of it.
pub fn closing_chart(hand: &HandDescription, design: &[f64; DESIGN_LEN], points: usize) -> Vec<ClosingPoint> {
    let last = points.saturating_sub(1).max(1) as f64;
    (0..points)
        .map(|i| {
            let travel = hand.transmission.travel * i as f64 / last;
            let (thumb, finger) = (FreeClosing::thumb(hand, design, travel), FreeClosing::finger(hand, design, travel));
            ClosingPoint { travel, thumb, finger, total_tension: thumb.tension + 2.0 * finger.tension }
        })
        .collect()
}

/// The travel of the motor, m, at which free closing alone takes all the tension that it has; all of its travel if that is
/// never so.
pub fn closing_end(hand: &HandDescription, design: &[f64; DESIGN_LEN]) -> f64 {
    let spare = |travel: f64| {
        let (thumb, finger) = (FreeClosing::thumb(hand, design, travel), FreeClosing::finger(hand, design, travel));
        hand.transmission.tension_limit - thumb.tension - 2.0 * finger.tension
    };
    let (mut within, mut beyond) = (0.0, hand.transmission.travel);
    if spare(beyond) >= 0.0 {
        return beyond;
    }
    // The tension grows with the travel: halving finds the place to the last bits.
    for _ in 0..60 {
        let middle = 0.5 * (within + beyond);
        if spare(middle) >= 0.0 { within = middle } else { beyond = middle }
    }
    within
}

#[cfg(test)]
mod tests {
    use super::super::space::{PAPER_HWASP, PAPER_MINIMAL, SMALL_CENTRE};
    use super::*;

    fn close(what: &str, got: FreeClosing, angles: [f64; 2], tension: f64) {
        for j in 0..2 {
            assert!((got.angles[j] - angles[j]).abs() < 1e-3, "{what}: {got:?}, not {angles:?} rad");
        }
        assert!((got.tension - tension).abs() < 0.006, "{what}: {got:?}, not {tension} N");
    }

    /// Figures that were computed apart from this code.
    #[test]
    fn the_papers_designs_close_as_computed() {
        let hand = HandDescription::default();
        let (thumb, finger) = (FreeClosing::thumb, FreeClosing::finger);
        close("HWasP thumb, 4 mm", thumb(&hand, &PAPER_HWASP, 0.004), [0.225, 0.196], 1.38);
        close("HWasP thumb, 8 mm", thumb(&hand, &PAPER_HWASP, 0.008), [0.478, 0.389], 1.54);
        close("HWasP finger, 4 mm", finger(&hand, &PAPER_HWASP, 0.004), [0.290, 0.862], 4.45);
        close("HWasP finger, 8 mm", finger(&hand, &PAPER_HWASP, 0.008), [0.987, 1.487], 5.87);
        close("Minimal thumb, 4 mm", thumb(&hand, &PAPER_MINIMAL, 0.004), [0.417, 0.0], 3.13);
        close("Minimal finger, 8 mm", finger(&hand, &PAPER_MINIMAL, 0.008), [1.172, 0.160], 7.50);
    }

    /// The chart is in balance everywhere: what is wound is what the pulleys took up and the tendon's stretch.
    #[test]
    fn all_that_is_wound_is_somewhere() {
        let hand = HandDescription::default();
        for design in [PAPER_HWASP, PAPER_MINIMAL, SMALL_CENTRE] {
            let chart = closing_chart(&hand, &design, 46);
            assert_eq!((chart[0].travel, chart[45].travel), (0.0, 0.045));
            for pair in chart.windows(2) {
                for (first, [before, after]) in
                    [(0, [pair[0].thumb, pair[1].thumb]), (2, [pair[0].finger, pair[1].finger])]
                {
                    assert!(before.tension < after.tension && before.angles[0] <= after.angles[0]);
                    let taken_up = design[first] * after.angles[0] + design[first + 1] * after.angles[1];
                    assert!((taken_up + after.tension / 5000.0 - pair[1].travel).abs() < 1e-12, "{after:?}");
                }
            }
            assert_eq!(chart[45].thumb.angles, [1.57, 1.57]);
        }
    }
    #[test]
    fn closing_ends_where_the_motor_has_no_more() {
        let mut hand = HandDescription::default();
        for design in [PAPER_HWASP, PAPER_MINIMAL, SMALL_CENTRE] {
            let end = closing_end(&hand, &design);
            let tension = FreeClosing::thumb(&hand, &design, end).tension
                + 2.0 * FreeClosing::finger(&hand, &design, end).tension;
            assert!(end < 0.045 && (tension - 75.0).abs() < 1e-9, "{tension} N at {end} m");
        }
        hand.transmission.tension_limit = 1000.0;
        assert_eq!(closing_end(&hand, &PAPER_HWASP), 0.045);
    }
}
