//! What is bought: its sizes by the standards that name them, and what it weighs.

use std::f64::consts::{FRAC_PI_4, PI};

use crate::workshop::{SeatedSpring, Workshop};

/// Densities of steel, and of silicone or EPDM sheet, kg/m³.
pub(crate) const STEEL: f64 = 7850.0;
pub(crate) const RUBBER: f64 = 1150.0;
/// Mass of the motor, kg: ROBOTIS e-Manual, "XM430-W210", weight.
pub const MOTOR_MASS: f64 = 0.082;

/// A retaining washer by DIN 6799 (an E-clip): the diameter of its groove, which names it; the shafts that it is for; its thickness and
/// the diameter that it takes on the shaft, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clip {
    /// Diameter of the groove, m.
    pub groove: f64,
    /// The thinnest and the thickest shaft, m.
    pub shaft: [f64; 2],
    /// Thickness, m; the groove is a little wider.
    pub thick: f64,
    /// Outer diameter on the shaft, m.
    pub outer: f64,
}

const fn clip(groove: f64, shaft: [f64; 2], thick: f64, outer: f64) -> Clip {
    Clip { groove, shaft, thick, outer }
}

/// DIN 6799, as makers list it. Where two sizes suit a shaft, the one with the deeper groove comes first.
const CLIPS: [Clip; 7] = [
    clip(1.2e-3, [1.4e-3, 2.0e-3], 0.3e-3, 3.25e-3),
    clip(1.5e-3, [2.0e-3, 2.5e-3], 0.4e-3, 4.25e-3),
    clip(1.9e-3, [2.5e-3, 3.0e-3], 0.5e-3, 4.8e-3),
    clip(2.3e-3, [3.0e-3, 4.0e-3], 0.6e-3, 6.3e-3),
    clip(3.2e-3, [4.0e-3, 5.0e-3], 0.6e-3, 7.3e-3),
    clip(4.0e-3, [5.0e-3, 7.0e-3], 0.7e-3, 9.3e-3),
    clip(5.0e-3, [6.0e-3, 8.0e-3], 0.7e-3, 11.3e-3),
];

/// Between cheeks and clips, m: a palm's lug may be that much wider than a link.
const CLIP_PLAY: f64 = 0.4e-3;
/// Beyond the grooves of an axle, m.
const AXLE_END: f64 = 0.8e-3;

/// An axle with a groove at each end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axle {
    /// Its length, m.
    pub length: f64,
    /// Between the inner sides of its grooves, m.
    pub between_grooves: f64,
    /// What sits in them; none where no standard one does, and a set collar holds the axle.
    pub clip: Option<Clip>,
}

/// The axle of a joint whose cheeks end `half_width`, m, from its middle.
pub(crate) fn axle(workshop: &Workshop, half_width: f64) -> Axle {
    let clip = CLIPS.into_iter().rfind(|clip| (clip.shaft[0] - 1e-9..=clip.shaft[1] + 1e-9).contains(&workshop.axle));
    let between_grooves = 2.0 * (half_width + CLIP_PLAY);
    let thick = clip.map_or(3e-3, |clip| clip.thick + 0.05e-3);
    Axle { length: between_grooves + 2.0 * (thick + AXLE_END), between_grooves, clip }
}

/// Mass of a round bar, kg.
pub(crate) fn bar(diameter: f64, length: f64) -> f64 {
    STEEL * FRAC_PI_4 * diameter * diameter * length
}

/// Mass of a clip, kg: half of the ring around its shaft.
pub(crate) fn clip_mass(clip: &Clip) -> f64 {
    0.5 * STEEL * FRAC_PI_4 * (clip.outer * clip.outer - clip.groove * clip.groove) * clip.thick
}

/// Mass of a spring, kg: coils that touch; its legs bend out to the circle and back along the axle, about a turn more.
pub(crate) fn spring_mass(spring: &SeatedSpring) -> f64 {
    let turns = spring.length / spring.wire;
    bar(spring.wire, turns * PI * (spring.outer - spring.wire))
}

/// A finger pad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pad {
    /// Along the joints, m.
    pub width: f64,
    /// Along the link, around the tip of a distal one, m.
    pub length: f64,
    /// How many a link has.
    pub count: usize,
}

/// What a pad of this thickness weighs, kg.
pub(crate) fn pad_mass(pad: &Pad, thick: f64) -> f64 {
    RUBBER * pad.width * pad.length * thick
}

/// The least friction between pad and object that training assumes of the middle of its range: what a tilted plate has to hold.
pub const PAD_FRICTION: f64 = 0.75;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axle_has_the_clips_of_its_diameter() {
        let axle = axle(&Workshop::default(), 0.0118);
        let clip = axle.clip.unwrap();
        assert_eq!(clip.groove, 1.9e-3);
        assert!((axle.between_grooves - 0.0244).abs() < 1e-12 && (axle.length - 0.0271).abs() < 1e-9, "{axle:?}");
        let thick = Workshop { axle: 0.015, ..Workshop::default() };
        assert_eq!(super::axle(&thick, 0.0118).clip, None);
    }

    /// A pin of 2.5 mm and 27 mm weighs 1.04 g by the density of steel.
    #[test]
    fn masses_are_those_of_their_shapes() {
        assert!((bar(0.0025, 0.027) - 1.040e-3).abs() < 1e-6);
        let spring = SeatedSpring { wire: 0.38e-3, outer: 5.26e-3, length: 2.6e-3 };
        assert!((spring_mass(&spring) - 0.0933e-3).abs() < 1e-6, "{}", spring_mass(&spring));
    }
}
