//! Helical torsion springs of round wire: rate, stress, and what becomes of the coil when it is wound up.
//!
//! The formulas are those of Shigley's Mechanical Engineering Design (Budynas and Nisbett, 10th edition), section 10-12;
//! strengths of music wire from its table 10-4.

use std::f64::consts::{PI, TAU};

/// 64/2π is what bending of the wire alone gives per turn; springs in use are 6 % softer, for their coils rub on each
/// other and on the mandrel (Shigley, equation 10-50). Per radian it is 10.8·2π = 67.86.
const RATE_PER_TURN: f64 = 10.8;

/// Young's modulus of music wire, Pa.
pub const MUSIC_WIRE_MODULUS: f64 = 207e9;

/// A spring, SI. The load winds it up: the coil closes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorsionSpring {
    /// Diameter of the wire, m.
    pub wire: f64,
    /// Outer diameter of the free coil, m.
    pub outer: f64,
    /// Turns of the body.
    pub turns: f64,
    /// Length of each of the two straight legs, m.
    pub leg: f64,
    /// Young's modulus of the wire, Pa.
    pub modulus: f64,
    /// Tensile strength of the wire, Pa.
    pub strength: f64,
}

/// Tensile strength of music wire (ASTM A228) of a diameter (m), Pa: 2211 MPa·mm^0.145 / d^0.145, for 0.1 to 6.5 mm.
pub fn music_wire_strength(wire: f64) -> f64 {
    2211e6 / (1e3 * wire).powf(0.145)
}

impl TorsionSpring {
    /// Mean diameter of the free coil, m.
    pub fn mean(&self) -> f64 {
        self.outer - self.wire
    }

    /// Inner diameter of the free coil, m.
    pub fn inner(&self) -> f64 {
        self.outer - 2.0 * self.wire
    }

    /// Mean diameter over wire diameter.
    pub fn index(&self) -> f64 {
        self.mean() / self.wire
    }

    /// Turns that bend: those of the body, and what the legs add (equation 10-48).
    pub fn active_turns(&self) -> f64 {
        self.turns + 2.0 * self.leg / (3.0 * PI * self.mean())
    }

    /// Torque per angle, N·m/rad.
    pub fn rate(&self) -> f64 {
        self.modulus * self.wire.powi(4) / (TAU * RATE_PER_TURN * self.mean() * self.active_turns())
    }

    /// Bending stress at the inside of the coil, Pa, under a torque, N·m (equations 10-43 and 10-44).
    pub fn stress(&self, torque: f64) -> f64 {
        let c = self.index();
        let curvature = (4.0 * c * c - c - 1.0) / (4.0 * c * (c - 1.0));
        curvature * 32.0 * torque / (PI * self.wire.powi(3))
    }

    /// What of an angle (rad) between the legs the body takes, in turns; the legs bend by the rest.
    fn wound(&self, angle: f64) -> f64 {
        angle / TAU * self.turns / self.active_turns()
    }

    /// Inner diameter, m, wound up by an angle, rad: the same wire in more turns (equation 10-51).
    pub fn inner_wound(&self, angle: f64) -> f64 {
        self.turns * self.mean() / (self.turns + self.wound(angle)) - self.wire
    }

    /// Length of the body, m, wound up by an angle, rad: close coils, which get more.
    pub fn length_wound(&self, angle: f64) -> f64 {
        self.wire * (self.turns + 1.0 + self.wound(angle))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const INCH: f64 = 0.0254;
    /// lbf·in.
    const POUND_INCH: f64 = 0.112_984_829;
    /// lbf/in².
    const PSI: f64 = 6_894.757;

    fn near(found: f64, wanted: f64, share: f64) {
        assert!((found / wanted - 1.0).abs() < share, "{found} instead of {wanted}");
    }

    /// Shigley's example 10-8: a stock spring of 0.072 in music wire, 4 1/4 turns, 19/32 in outside, legs of 1 in, on a pin
    /// of 0.400 in. The book has E = 28.5 Mpsi for this wire; its results are given to three or four figures.
    #[test]
    fn the_textbooks_stock_spring() {
        let spring = TorsionSpring {
            wire: 0.072 * INCH,
            outer: 19.0 / 32.0 * INCH,
            turns: 4.25,
            leg: INCH,
            modulus: 28.5e6 * PSI,
            strength: music_wire_strength(0.072 * INCH),
        };
        near(spring.strength, 294.4e3 * PSI, 3e-3);
        near(spring.mean(), 0.5218 * INCH, 1e-4);
        near(spring.index(), 7.247, 1e-3);
        near(spring.active_turns(), 4.657, 1e-3);
        near(spring.rate() * TAU, 29.2 * POUND_INCH, 2e-3);
        // At the yield strength, 229.6 kpsi, the torque is 7.546 lbf·in.
        let torque = 7.546 * POUND_INCH;
        near(spring.stress(torque), 229.6e3 * PSI, 1e-3);
        // The body turns by 0.236 turns under it, and the pin has 0.0223 in left.
        let angle = torque / spring.rate();
        near(spring.wound(angle), 0.236, 3e-3);
        near(spring.inner_wound(angle) - 0.400 * INCH, 0.0223 * INCH, 1e-2);
        near(spring.length_wound(angle), 0.072 * INCH * 5.486, 1e-3);
    }

    /// A maker's example (Acxess Spring, "Torsion spring rate"): 0.035 in wire, 1/2 in outside, 3 coils, E = 30 Mpsi, legs
    /// left out: 2.988 lbf·in per turn.
    #[test]
    fn a_makers_example() {
        let (wire, outer) = (0.035 * INCH, 0.5 * INCH);
        let spring = TorsionSpring { wire, outer, turns: 3.0, leg: 0.0, modulus: 30e6 * PSI, strength: 1e9 };
        near(spring.rate() * TAU, 2.988 * POUND_INCH, 1e-3);
        near(RATE_PER_TURN * TAU, 67.86, 1e-4);
    }
}
