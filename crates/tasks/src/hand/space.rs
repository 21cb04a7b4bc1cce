//! The twelve parameters of the transmission and the ranges that they are searched in.

use hwasp_core::{DesignError, DesignGroup, DesignSpace, Dimension, Initial};

/// Parameters of a design: pulley radius (m), spring stiffness (N·m/rad) and spring preload (rad), four of each in the order
/// of [`KINDS`](super::names::KINDS).
pub const DESIGN_LEN: usize = 12;

/// Kinds of joints: those of the thumb, and those that the two fingers share.
pub const KINDS_LEN: usize = 4;

/// What the paper's HWasP found (table 2).
pub const PAPER_HWASP: [f64; DESIGN_LEN] =
    [0.0100, 0.0075, 0.0030, 0.0026, 0.0062, 0.0061, 0.0061, 0.0059, 2.0, 1.5, 1.9, 1.1];

/// What the paper's HWasP-Minimal found (table 2).
pub const PAPER_MINIMAL: [f64; DESIGN_LEN] =
    [0.0081, 0.0061, 0.0050, 0.0040, 0.0070, 0.0092, 0.0082, 0.0092, 3.2, 3.1, 3.4, 3.1];

/// The centre of the small range. Our choice: the fingers' pulleys half as large as the thumb's, as two fingers press
/// against one thumb with equal tensions, and springs that hold the open hand against gravity.
pub const SMALL_CENTRE: [f64; DESIGN_LEN] =
    [0.010, 0.006, 0.005, 0.003, 0.006, 0.006, 0.006, 0.006, 2.0, 1.75, 2.0, 1.75];

/// A design that a search with a controller by hand found at a tension limit of 75 N: what such a hand can do.
pub const SEARCHED: [f64; DESIGN_LEN] =
    [0.0109, 0.0097, 0.0077, 0.0053, 0.0057, 0.006, 0.009, 0.006, 2.0, 0.36, 2.06, 0.63];

/// Limits of radius (m), stiffness (N·m/rad) and preload (rad) in the large range. Our choice: what fits into a finger of
/// 24 mm, and springs from barely holding a finger open to needing most of the motor.
const LARGE: [(f64, f64); 3] = [(0.002, 0.012), (0.002, 0.012), (0.0, 4.0)];

/// How much narrower than the large range the small one is (paper, section 6).
const NARROWER: f64 = 8.0;

/// What the three groups of four measure.
const QUANTITIES: [Dimension; 3] = [Dimension::Length, Dimension::TorsionalStiffness, Dimension::Angle];

/// The names of the twelve, in their order.
const NAMES: [&str; DESIGN_LEN] = [
    "thumb_proximal_radius",
    "thumb_distal_radius",
    "finger_proximal_radius",
    "finger_distal_radius",
    "thumb_proximal_stiffness",
    "thumb_distal_stiffness",
    "finger_proximal_stiffness",
    "finger_distal_stiffness",
    "thumb_proximal_preload",
    "thumb_distal_preload",
    "finger_proximal_preload",
    "finger_distal_preload",
];

/// One of the twelve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandParameter {
    /// Joint and quantity.
    pub name: &'static str,
    /// What it measures.
    pub dimension: Dimension,
    /// Its lower and upper limit, SI.
    pub limits: (f64, f64),
}

/// Where the design is searched.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum HandRange {
    /// Radius 2 to 12 mm, stiffness 2 to 12 N·mm/rad, preload 0 to 4 rad, at every joint.
    #[default]
    Large,
    /// An eighth of the large range's widths around [`SMALL_CENTRE`], clipped into the large range.
    Small,
    /// Lower and upper limits of every parameter, SI.
    Bounds([(f64, f64); DESIGN_LEN]),
}

impl HandRange {
    /// Lower and upper limit of every parameter, SI.
    pub fn bounds(&self) -> [(f64, f64); DESIGN_LEN] {
        match *self {
            Self::Bounds(bounds) => bounds,
            Self::Large => std::array::from_fn(|i| LARGE[i / 4]),
            Self::Small => std::array::from_fn(|i| {
                let (lo, hi) = LARGE[i / 4];
                let half = 0.5 * (hi - lo) / NARROWER;
                ((SMALL_CENTRE[i] - half).max(lo), (SMALL_CENTRE[i] + half).min(hi))
            }),
        }
    }

    /// Every parameter's name, limits and what it measures.
    pub fn parameters(&self) -> [HandParameter; DESIGN_LEN] {
        let bounds = self.bounds();
        std::array::from_fn(|i| HandParameter { name: NAMES[i], dimension: QUANTITIES[i / 4], limits: bounds[i] })
    }

    /// The middle of every parameter's limits, SI.
    pub fn middle(&self) -> [f64; DESIGN_LEN] {
        self.bounds().map(|(lo, hi)| 0.5 * (lo + hi))
    }

    /// The design space: twelve groups of one parameter, `thumb_proximal_radius` to `finger_distal_preload`, as each joint
    /// has limits of its own and is best spoken of by its name.
    pub(super) fn space(&self, initial: &[Initial; DESIGN_LEN]) -> Result<DesignSpace, DesignError> {
        let groups = self.parameters().into_iter().zip(initial).map(|(parameter, &initial)| {
            let HandParameter { name, dimension, limits: (lo, hi) } = parameter;
            DesignGroup { name: name.to_owned(), dimension, lo, hi, count: 1, initial }
        });
        DesignSpace::new(groups.collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_small_range_is_an_eighth_around_its_centre() {
        let bounds = HandRange::Small.bounds();
        for (i, wanted) in [(0, (0.009_375, 0.010_625)), (3, (0.002_375, 0.003_625)), (4, (0.005_375, 0.006_625))] {
            assert!(
                (bounds[i].0 - wanted.0).abs() < 1e-12 && (bounds[i].1 - wanted.1).abs() < 1e-12,
                "{:?}",
                bounds[i]
            );
        }
        assert_eq!((bounds[8], bounds[9]), ((1.75, 2.25), (1.5, 2.0)));
        for ((small, large), middle) in bounds.iter().zip(HandRange::Large.bounds()).zip(HandRange::Small.middle()) {
            assert!(small.0 >= large.0 && small.1 <= large.1 && middle > small.0);
        }
    }

    #[test]
    fn parameters_are_called_by_joint_and_quantity() {
        let space = HandRange::Large.space(&[Initial::Logit { half_width: 1.0 }; DESIGN_LEN]).unwrap();
        assert_eq!(space.len(), DESIGN_LEN);
        let names = space.names();
        assert_eq!(
            (&*names[0], &*names[5], &*names[11]),
            ("thumb_proximal_radius", "thumb_distal_stiffness", "finger_distal_preload")
        );
        assert_eq!(space.groups()[8].dimension, Dimension::Angle);
        assert!(
            HandRange::Bounds([(1.0, 1.0); DESIGN_LEN])
                .space(&[Initial::Logit { half_width: 1.0 }; DESIGN_LEN])
                .is_err()
        );
    }
}
