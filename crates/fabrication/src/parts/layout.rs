//! The widths of printed parts, as they follow from workshop, springs and hand.

use super::mount::{NUT, NUT_UNDER, POSTS};
use crate::error::PartError;
use crate::solid::around;
use crate::workshop::{SeatedSpring, Workshop};
use hwasp_tasks::hand::DESIGN_LEN;
use hwasp_tasks::hand::names::{DIGITS, KINDS};
use hwasp_tasks::hand::{HandDescription, LinkDescription};
use hwasp_tasks::hand::{positive, within};

/// What the parts of a hand are laid out by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layout<'a> {
    pub(super) workshop: &'a Workshop,
    /// The springs of each of [`KINDS`].
    pub(super) springs: &'a [SeatedSpring; 4],
}

/// Flanges of a pulley, m.
const FLANGE: f64 = 1e-3;
/// The part of a prong between pulley and springs, m.
const PRONG: f64 = 1e-3;
/// Cheeks, m.
const CHEEK: f64 = 2.6e-3;
/// From the axle to the pins of distal pulleys, m, if there is room for them.
pub(super) const PIN_CIRCLE: f64 = 4.2e-3;
/// Of a link's window to its sides, m.
pub(super) const FRAME: f64 = 4e-3;

/// The way out where springs need more room than there is.
const NARROWER: &str =
    "have a smaller `spring_room`, `springs`, `line` or `print_clearance`: `hwasp parts RUN --bench KEY=VALUE`";
/// The way out where they are too wide.
const SLIMMER: &str = "have a smaller `coil_room`, `axle`, `line` or `wall`, or a larger `hole_pitch`: `hwasp parts RUN --bench KEY=VALUE`";

impl Layout<'_> {
    /// Radius of a hole for an axle.
    pub(super) fn bore(&self) -> f64 {
        self.workshop.bore()
    }

    /// Radius of a hole for a pin.
    pub(super) fn pin_hole(&self) -> f64 {
        0.5 * (self.workshop.pin + self.workshop.print_clearance)
    }

    /// From the axle to the pins.
    pub(super) fn pin_circle(&self) -> f64 {
        PIN_CIRCLE.max(self.bore() + self.workshop.wall + self.pin_hole())
    }

    /// Radius of a hole for a spring's leg.
    pub(super) fn leg_hole(&self, kind: usize) -> f64 {
        self.workshop.leg_hole(&self.springs[kind])
    }

    /// From the axle to the legs.
    pub(super) fn leg_circle(&self, kind: usize) -> f64 {
        self.workshop.leg_circle(&self.springs[kind])
    }

    /// Radius of the pockets for springs and their legs.
    pub(super) fn pocket_radius(&self, kind: usize) -> f64 {
        self.leg_circle(kind) + 0.5 * self.springs[kind].wire + self.workshop.print_clearance
    }

    /// Radius of the hole that the line ends in.
    pub(super) fn line_hole(&self) -> f64 {
        0.5 * self.workshop.line + self.workshop.print_clearance
    }

    /// Radius of the recess for its knot.
    pub(super) fn knot(&self) -> f64 {
        2.5 * self.workshop.line
    }

    /// Half of a groove: two turns of line side by side.
    pub(super) fn groove(&self) -> f64 {
        self.workshop.line + self.workshop.print_clearance
    }

    /// Half of the channel of the line in links and palm.
    pub(super) fn channel(&self) -> f64 {
        self.groove() + self.workshop.print_clearance
    }

    /// Thickness of a pulley's flanges.
    pub(super) fn flange(&self) -> f64 {
        FLANGE.max(self.workshop.wall)
    }

    /// Half of a pulley.
    pub(super) fn pulley(&self) -> f64 {
        self.groove() + self.flange()
    }

    /// Where the prongs begin, from the middle.
    pub(super) fn prong(&self) -> f64 {
        self.pulley() + self.workshop.print_clearance
    }

    /// Thickness of a prong where a spring takes all the room that it has.
    pub(super) fn plate(&self) -> f64 {
        PRONG.max(self.workshop.wall)
    }

    /// Where the recess for the line's knot begins.
    pub(super) fn recess(&self) -> f64 {
        self.prong() + self.plate()
    }

    /// Where the springs' pocket begins on a side with so many of them; nowhere without springs.
    pub(super) fn pocket(&self, kind: usize, springs: u32) -> Option<f64> {
        let depth = f64::from(springs) * self.springs[kind].length + self.workshop.print_clearance;
        (springs > 0).then(|| self.prong_end() - depth)
    }

    /// Where the prongs end.
    pub(super) fn prong_end(&self) -> f64 {
        let most = f64::from(self.workshop.sides()[0]);
        self.recess() + most * self.workshop.spring_room + self.workshop.print_clearance
    }

    /// Where the cheeks begin.
    pub(super) fn cheek(&self) -> f64 {
        self.prong_end() + self.workshop.print_clearance
    }

    /// Thickness of the cheeks.
    pub(super) fn cheek_width(&self) -> f64 {
        CHEEK.max(self.workshop.wall)
    }

    /// Where the cheeks end: half of a link's width.
    pub(super) fn half_width(&self) -> f64 {
        self.cheek() + self.cheek_width()
    }

    /// Radius of the bottom of a groove, for a line that lies `radius` from the axle.
    pub(super) fn groove_bottom(&self, radius: f64) -> f64 {
        radius - 0.5 * self.workshop.line
    }

    /// From the axle of a distal joint to the hole that the line ends in: outside of the groove, and its knot outside of the
    /// springs' pocket.
    pub(super) fn line_end(&self, kind: usize, radius: f64) -> f64 {
        radius.max(self.pocket_radius(kind) + self.workshop.wall + self.knot())
    }

    /// Radius of a pulley's flanges: a wall beyond a line's hole at the line.
    pub(super) fn rim(&self, radius: f64) -> f64 {
        around(radius + self.line_hole() + self.workshop.wall)
    }

    /// Radius of the flange that line and pins end in.
    pub(super) fn pinned_rim(&self, kind: usize, radius: f64) -> f64 {
        let line = self.line_end(kind, radius) + self.line_hole();
        around(line.max(self.pin_circle() + self.pin_hole()) + self.workshop.wall)
    }

    /// From a joint to where the whole width of a link begins or its fork ends: clear of the other link and of any pulley.
    pub(super) fn setback(&self, link_radius: f64) -> f64 {
        self.rim(link_radius).max(link_radius) + 1.5 * self.workshop.print_clearance
    }

    /// Radius of the palm's lugs.
    pub(super) fn lug(&self) -> f64 {
        let widest = (0..KINDS.len()).map(|kind| self.leg_circle(kind) + self.leg_hole(kind)).fold(0.0, f64::max);
        widest + 4.0 * self.workshop.wall
    }

    /// From a joint to the end of the palm's pocket, on the side where a proximal link stands `tilt`, rad, from straight down:
    /// its side cuts the palm's lower face radius/cos away.
    pub(super) fn reach(&self, hand: &HandDescription, tilt: f64) -> f64 {
        let radius = hand.thumb.proximal.radius.max(hand.fingers[0].proximal.radius);
        radius / tilt.cos() + 2.5 * self.workshop.print_clearance
    }

    /// Whether this hand can be built so.
    pub(super) fn check(&self, hand: &HandDescription, design: &[f64; DESIGN_LEN]) -> Result<(), PartError> {
        hand.check()?;
        self.check_springs()?;
        self.check_swing(hand)?;
        self.check_mount(hand)?;
        for (digit, description) in DIGITS.iter().zip(hand.digits()) {
            self.check_link(&format!("{digit}.proximal"), &description.proximal, 2.0)?;
            self.check_link(&format!("{digit}.distal"), &description.distal, 1.0)?;
            self.check_base(digit, description.base, hand)?;
        }
        let [first, second] = &hand.fingers;
        if (&first.proximal, &first.distal) != (&second.proximal, &second.distal) {
            let message = "the two fingers have different links, and one part is to serve both".to_owned();
            return Err(PartError::Part { part: "finger_proximal_link", message });
        }
        let apart = (first.base[0] - second.base[0]).abs();
        within("|finger1.base[0] - finger2.base[0]|", apart, 2.0 * self.half_width(), 1.0, "m")?;
        for kind in 0..KINDS.len() {
            let digit = if kind < 2 { &hand.thumb } else { &hand.fingers[0] };
            // The last bit of a sum is nothing.
            let least = (self.workshop.least_groove() + 0.5 * self.workshop.line) * (1.0 - 1e-9);
            let most = digit.proximal.radius.min(digit.distal.radius);
            within(&format!("{}_radius", KINDS[kind]), design[kind], least, most, "m")?;
            within(&format!("{}_preload", KINDS[kind]), design[8 + kind], 0.0, f64::MAX, "rad")?;
        }
        Ok(())
    }

    /// Springs that are springs, and that fit into the room of the workshop.
    fn check_springs(&self) -> Result<(), PartError> {
        for (kind, spring) in KINDS.iter().zip(self.springs) {
            for (what, value) in [("wire", spring.wire), ("outer", spring.outer), ("length", spring.length)] {
                positive(&format!("{kind} spring {what}"), value, "m")?;
            }
            let hint = "choose the springs anew for this workshop: `hwasp parts RUN`";
            for (what, needed, room) in
                [("long", spring.length, self.workshop.spring_room), ("wide", spring.outer, self.workshop.coil_room)]
            {
                let what = format!("a spring of {kind} that is so {what}");
                self::room(what, needed, room * (1.0 + 1e-9), hint)?;
            }
        }
        Ok(())
    }

    /// Room for `ends` joints and a window between them, and for everything that sits beside a pulley.
    fn check_link(&self, name: &str, link: &LinkDescription, ends: f64) -> Result<(), PartError> {
        let wall = self.workshop.wall;
        room(format!("a joint of {name}, from cheek to cheek,"), 2.0 * self.half_width(), 2.0 * link.radius, NARROWER)?;
        let hint = "have a thinner `pad`: `hwasp parts RUN --bench pad=…`";
        room(format!("the pad of {name}"), self.workshop.pad, FRAME - wall, hint)?;
        let pockets = (0..KINDS.len()).map(|kind| self.pocket_radius(kind)).fold(0.0, f64::max);
        let across = (pockets + wall + 2.0 * self.knot()).max(self.lug());
        let across = across.max(self.pin_circle() + self.pin_hole()) + wall;
        room(format!("what is around an axle of {name}"), across, link.radius, SLIMMER)?;
        let least = ends * self.setback(link.radius) + 2.0 * (FRAME + wall) - (2.0 - ends) * link.radius;
        Ok(within(&format!("{name}.length"), link.length, least.max(0.0), 1.0, "m")?)
    }

    fn check_base(&self, name: &str, base: [f64; 3], hand: &HandDescription) -> Result<(), PartError> {
        let half = hand.palm.half_size;
        let across = half[0] - self.half_width();
        within(&format!("{name}.base[0]"), base[0], -across, across, "m")?;
        let reach = self.reach(hand, hand.joint.range[1] - hand.joint.rest_angle);
        within(&format!("|{name}.base[1]|"), base[1].abs(), reach, half[1] - self.lug(), "m")?;
        Ok(within(&format!("{name}.base[2]"), base[2], 0.0, 0.0, "m")?)
    }

    /// The palm has room for screws, nuts and the well, and the spool for the line's ends.
    fn check_mount(&self, hand: &HandDescription) -> Result<(), PartError> {
        let half = hand.palm.half_size;
        within("palm.half_size[0]", half[0], POSTS[0] + NUT[0], 1.0, "m")?;
        within("palm.half_size[2]", half[2], 0.5 * (NUT_UNDER + NUT[1] + 4.0 * self.workshop.wall), 1.0, "m")?;
        let inward = self.reach(hand, hand.joint.range[1] - hand.joint.rest_angle);
        for (name, digit) in DIGITS.iter().zip(hand.digits()) {
            let least = inward + POSTS[1] + 0.5 * NUT[0] + 4.0 * self.workshop.wall;
            within(&format!("|{name}.base[1]|"), digit.base[1].abs(), least, 1.0, "m")?;
        }
        Ok(within("transmission.spool_radius", hand.transmission.spool_radius, 7.5e-3, 9e-3, "m")?)
    }

    /// Links swing clear of the palm's lower face, and the pocket that they swing in leaves a roof.
    fn check_swing(&self, hand: &HandDescription) -> Result<(), PartError> {
        let radius = hand.thumb.proximal.radius.max(hand.fingers[0].proximal.radius);
        let most = (self.setback(radius) / radius).atan();
        within("joint.rest_angle", hand.joint.rest_angle, 0.0, most, "rad")?;
        let inward = hand.joint.range[1] - hand.joint.rest_angle;
        within("joint.range[1] - joint.rest_angle", inward, 0.0, most, "rad")?;
        let least = 0.5 * (self.setback(radius) + 4.0 * self.workshop.wall);
        Ok(within("palm.half_size[2]", hand.palm.half_size[2], least, 1.0, "m")?)
    }
}

fn room(what: String, needed: f64, room: f64, hint: &'static str) -> Result<(), PartError> {
    if needed <= room { Ok(()) } else { Err(PartError::Room { what, needed, room, hint }) }
}
