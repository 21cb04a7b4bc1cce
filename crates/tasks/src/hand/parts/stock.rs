//! What a hand is built of beside the printed parts, and the widths that follow from it.

use super::super::description::{HandDescription, LinkDescription};
use super::super::error::{HandError, positive, within};
use super::super::names::{DIGITS, KINDS};
use super::super::space::DESIGN_LEN;

/// What is bought, and what a printer can do. The defaults are our choice.
///
/// | field | default | purpose | must be |
/// |---|---|---|---|
/// | `line_diameter` | 0.6 mm | the tendon: braided polyethylene that holds several times 75 N | positive |
/// | `shaft_diameter` | 2 mm | of the joints' shafts | positive |
/// | `leg_diameter` | 1 mm | the wire of the springs' legs, and the pins of the distal pulleys | positive |
/// | `spring_diameter` | 10 mm | the coil of a spring, outside | above the holes for its legs |
/// | `spring_length` | 2.4 mm | the coil along the shaft | positive |
/// | `clearance` | 0.2 mm | between parts that move on each other; half of it around shafts and legs | positive |
/// | `wall` | 0.6 mm | the thinnest wall that the printer makes | positive |
#[derive(Clone, Debug, PartialEq)]
pub struct Stock {
    /// Diameter of the tendon's line, m.
    pub line_diameter: f64,
    /// Diameter of the shafts, m.
    pub shaft_diameter: f64,
    /// Diameter of legs and pins, m.
    pub leg_diameter: f64,
    /// Outer diameter of the springs, m.
    pub spring_diameter: f64,
    /// Length of the springs' coils, m.
    pub spring_length: f64,
    /// Between moving parts, m.
    pub clearance: f64,
    /// The thinnest wall, m.
    pub wall: f64,
}

impl Default for Stock {
    fn default() -> Self {
        Self {
            line_diameter: 0.6e-3,
            shaft_diameter: 2e-3,
            leg_diameter: 1e-3,
            spring_diameter: 10e-3,
            spring_length: 2.4e-3,
            clearance: 0.2e-3,
            wall: 0.6e-3,
        }
    }
}

/// Flanges of a pulley, m.
pub(super) const FLANGE: f64 = 1.8e-3;
/// The part of a prong beside the spring's pocket, m.
pub(super) const PRONG: f64 = 1.6e-3;
/// Cheeks, m.
pub(super) const CHEEK: f64 = 3.8e-3;
/// Of a link's window to its sides, m.
pub(super) const FRAME: f64 = 4e-3;

impl Stock {
    /// Radius of a hole for a shaft.
    pub(super) fn bore(&self) -> f64 {
        0.5 * (self.shaft_diameter + 0.5 * self.clearance)
    }

    /// Radius of a hole for a leg or a pin.
    pub(super) fn leg_hole(&self) -> f64 {
        0.5 * (self.leg_diameter + self.clearance)
    }

    /// From the shaft to legs and pins.
    pub(super) fn leg_circle(&self) -> f64 {
        0.5 * self.spring_diameter - 0.8 * self.leg_diameter
    }

    /// Radius of the hole that the line ends in.
    pub(super) fn line_hole(&self) -> f64 {
        0.5 * self.line_diameter + self.clearance
    }

    /// Radius of the recess for its knot.
    pub(super) fn knot(&self) -> f64 {
        2.5 * self.line_diameter
    }

    /// Half of a groove: two turns of line side by side.
    pub(super) fn groove(&self) -> f64 {
        self.line_diameter + self.clearance
    }

    /// Half of the channel of the line in links and palm.
    pub(super) fn channel(&self) -> f64 {
        self.groove() + self.clearance
    }

    /// Half of a pulley.
    pub(super) fn pulley(&self) -> f64 {
        self.groove() + FLANGE
    }

    /// Where the prongs begin, from the middle.
    pub(super) fn prong(&self) -> f64 {
        self.pulley() + self.clearance
    }

    /// Where the spring's pocket begins.
    pub(super) fn pocket(&self) -> f64 {
        self.prong() + PRONG
    }

    /// Where the prongs end.
    pub(super) fn prong_end(&self) -> f64 {
        self.pocket() + self.spring_length + self.clearance
    }

    /// Where the cheeks begin.
    pub(super) fn cheek(&self) -> f64 {
        self.prong_end() + self.clearance
    }

    /// Where the cheeks end: half of a link's width.
    pub(super) fn half_width(&self) -> f64 {
        self.cheek() + CHEEK
    }

    /// Radius of the spring's pocket.
    pub(super) fn pocket_radius(&self) -> f64 {
        0.5 * self.spring_diameter + 2.5 * self.clearance
    }

    /// Radius of the bottom of a groove, for a line that lies `radius` from the shaft.
    pub(super) fn groove_bottom(&self, radius: f64) -> f64 {
        radius - 0.5 * self.line_diameter
    }

    /// From the shaft to the hole that the line ends in: it opens to the groove.
    pub(super) fn line_end(&self, radius: f64) -> f64 {
        radius.max(self.bore() + self.wall + self.line_hole())
    }

    /// Radius of a pulley's flanges.
    pub(super) fn rim(&self, radius: f64) -> f64 {
        self.line_end(radius) + self.line_hole() + 2.0 * self.clearance
    }

    /// From a joint to where the whole width of a link begins or its fork ends: clear of the other link and of any pulley.
    pub(super) fn setback(&self, link_radius: f64) -> f64 {
        self.rim(link_radius).max(link_radius) + 1.5 * self.clearance
    }

    /// Radius of the palm's lugs.
    pub(super) fn lug(&self) -> f64 {
        self.leg_circle() + self.leg_hole() + 4.0 * self.wall
    }

    /// From a joint to the end of the palm's pocket, on the side where a proximal link stands `tilt`, rad, from straight down:
    /// its side cuts the palm's lower face radius/cos away.
    pub(super) fn reach(&self, hand: &HandDescription, tilt: f64) -> f64 {
        let radius = hand.thumb.proximal.radius.max(hand.fingers[0].proximal.radius);
        radius / tilt.cos() + 2.5 * self.clearance
    }

    /// Whether this hand can be built of it.
    pub(super) fn check(&self, hand: &HandDescription, design: &[f64; DESIGN_LEN]) -> Result<(), HandError> {
        hand.check()?;
        for (name, value) in [
            ("stock.line_diameter", self.line_diameter),
            ("stock.shaft_diameter", self.shaft_diameter),
            ("stock.leg_diameter", self.leg_diameter),
            ("stock.spring_length", self.spring_length),
            ("stock.clearance", self.clearance),
            ("stock.wall", self.wall),
        ] {
            positive(name, value, "m")?;
        }
        // Leg holes clear of the shaft's.
        let least = 2.0 * (self.bore() + self.wall + self.leg_hole() + 0.8 * self.leg_diameter);
        within("stock.spring_diameter", self.spring_diameter, least, 1.0, "m")?;
        self.check_swing(hand)?;
        for (digit, description) in DIGITS.iter().zip(hand.digits()) {
            self.check_link(&format!("{digit}.proximal"), &description.proximal, 2.0)?;
            self.check_link(&format!("{digit}.distal"), &description.distal, 1.0)?;
            self.check_base(digit, description.base, hand)?;
        }
        let [first, second] = &hand.fingers;
        if (&first.proximal, &first.distal) != (&second.proximal, &second.distal) {
            let message = "the two fingers have different links, and one part is to serve both".to_owned();
            return Err(HandError::Part { part: "finger_proximal_link", message });
        }
        let apart = (first.base[0] - second.base[0]).abs();
        within("|finger1.base[0] - finger2.base[0]|", apart, 2.0 * self.half_width(), 1.0, "m")?;
        for kind in 0..KINDS.len() {
            let digit = if kind < 2 { &hand.thumb } else { &hand.fingers[0] };
            let least = self.bore() + self.wall + 0.5 * self.line_diameter;
            let most = digit.proximal.radius.min(digit.distal.radius);
            within(&format!("{}_radius", KINDS[kind]), design[kind], least, most, "m")?;
            within(&format!("{}_preload", KINDS[kind]), design[8 + kind], 0.0, f64::MAX, "rad")?;
        }
        Ok(())
    }

    /// Room for `ends` joints and a window between them, and for everything that sits beside a pulley.
    fn check_link(&self, name: &str, link: &LinkDescription, ends: f64) -> Result<(), HandError> {
        within(&format!("{name}.radius"), link.radius, self.half_width().max(self.lug() + self.wall), 1.0, "m")?;
        let least = ends * self.setback(link.radius) + 2.0 * (FRAME + self.wall) - (2.0 - ends) * link.radius;
        within(&format!("{name}.length"), link.length, least.max(0.0), 1.0, "m")
    }

    fn check_base(&self, name: &str, base: [f64; 3], hand: &HandDescription) -> Result<(), HandError> {
        let half = hand.palm.half_size;
        let across = half[0] - self.half_width();
        within(&format!("{name}.base[0]"), base[0], -across, across, "m")?;
        let reach = self.reach(hand, hand.joint.range[1] - hand.joint.rest_angle);
        within(&format!("|{name}.base[1]|"), base[1].abs(), reach, half[1] - self.lug(), "m")?;
        within(&format!("{name}.base[2]"), base[2], 0.0, 0.0, "m")
    }

    /// Links swing clear of the palm's lower face, and the pocket that they swing in leaves a roof.
    fn check_swing(&self, hand: &HandDescription) -> Result<(), HandError> {
        let radius = hand.thumb.proximal.radius.max(hand.fingers[0].proximal.radius);
        let most = (self.setback(radius) / radius).atan();
        within("joint.rest_angle", hand.joint.rest_angle, 0.0, most, "rad")?;
        let inward = hand.joint.range[1] - hand.joint.rest_angle;
        within("joint.range[1] - joint.rest_angle", inward, 0.0, most, "rad")?;
        let least = 0.5 * (self.setback(radius) + 4.0 * self.wall);
        within("palm.half_size[2]", hand.palm.half_size[2], least, 1.0, "m")
    }
}
