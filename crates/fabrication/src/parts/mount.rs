//! What sits on the palm: how high everything is, and where the lines run.
//!
//! ```text
//!    z ▲   centring ring
//!      ┌──────────────────┐  flange plate, on the robot: ISO 9409-1-50-4-M6
//!      └──┬────────────┬──┘
//!      ┌──┤   motor    ├──┐  cage
//!      │  │            │  │
//!      │  └──┬──────┬──┘  │
//!    ┌─┴─────│ hub  │─────┴─┐
//!    │ ───▶──│ drum │──◀─── │  guide: a pin turns each line from upright to the drum
//!    └─┬─────┴──────┴─────┬─┘
//!    ══╪══════════════════╪══  palm
//! ```

use hwasp_tasks::hand::{DESIGN_LEN, HandDescription};

use super::Layout;

/// The motor, a Dynamixel XM430-W210: width, length and depth from horn to back, m. ROBOTIS e-Manual, "XM430-W210", dimensions.
pub(super) const MOTOR: [f64; 3] = [0.0285, 0.0465, 0.034];
/// From the horn's axis to the nearer end of the case, and from the front of the case to that of the horn, m. These two and
/// [`HORN_CIRCLE`] are not in the e-Manual's table, but in ROBOTIS' drawing of the X430 series alone: hold the test coupon against the
/// motor before the rest is printed.
pub(super) const MOTOR_AXIS: f64 = 0.011_25;
pub(super) const HORN: f64 = 2.5e-3;
/// From the horn's axis to its M2 threads, four of eight, m: horn HN12-N101.
pub(super) const HORN_CIRCLE: f64 = 8e-3;

/// ISO 9409-1-50-4-M6: radius of the circle of the screws and the pin, half of the centring diameter less play, holes, m.
pub(super) const FLANGE_CIRCLE: f64 = 0.025;
pub(super) const CENTRING: f64 = 0.5 * (0.0315 - 0.0002);
pub(super) const M6: f64 = 0.5 * 0.0066;
pub(super) const M6_HEAD: f64 = 0.5 * 0.0112;
/// Of a pin of 6 mm m6 that is pressed in: printed holes come out small.
pub(super) const FLANGE_PIN: f64 = 0.5 * 0.006_05;

/// Side of a square hole for an M3 screw, m.
pub(super) const SCREW: f64 = 3.4e-3;
/// Width and height of the room for a square nut M3, DIN 562 (5.5 mm and 1.8 mm), m.
pub(super) const NUT: [f64; 2] = [5.9e-3, 2.2e-3];
/// From the palm's top to its nuts, m.
pub(super) const NUT_UNDER: f64 = 9.8e-3;
/// Where the screws between cage, guide and palm are, from the middle in x and y, m.
pub(super) const POSTS: [f64; 2] = [0.031, 0.008];
/// Half of the well under the spool, m.
pub(super) const WELL: f64 = 8.5e-3;
/// From an axle to where its clip has room, m.
pub(super) const CLIP_ROOM: f64 = 3.4e-3;

/// Floor of the guide, play beside the drum, thickness of the hub, rubber between the motor and what clamps it, m.
pub(super) const FLOOR: f64 = 2e-3;
const PLAY: f64 = 1e-3;
pub(super) const HUB: f64 = 4e-3;
const RUBBER: f64 = 8e-4;
/// Feet of the cage; what of the flange plate sits in the cage; the plate itself, of which 4.3 mm are under the heads of screws of 10 mm,
/// so that these go 5.7 mm into the robot's threads, m.
pub(super) const FOOT: f64 = 4e-3;
const TONGUE: f64 = 8e-3;
const PLATE: f64 = 0.0105;

/// Pins that turn lines: radius and half length, m (ISO 2338, 3 x 10).
pub(crate) const TURN_PIN: [f64; 2] = [1.5e-3, 5e-3];

/// Screws between drum and hub, which clamp the lines' ends: four of M2.5 on this circle, m.
pub(super) const DRUM_CIRCLE: f64 = 4.5e-3;
/// Radius of the holes in which lines go down to them.
pub(super) const LINE_HOLE: f64 = 6e-4;

/// Levels along z from the palm's lower face, m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Levels {
    pub(super) palm: f64,
    pub(super) drum: f64,
    pub(super) hub: f64,
    pub(super) guide: f64,
    pub(super) case: f64,
    pub(super) tongue: f64,
    pub(super) cage: f64,
    pub(super) plate: f64,
}

impl Levels {
    pub(super) fn new(hand: &HandDescription, layout: &Layout<'_>) -> Self {
        let palm = 2.0 * hand.palm.half_size[2];
        let drum = palm + FLOOR + PLAY;
        let hub = drum + 4.0 * layout.flange() + 6.0 * layout.groove();
        let horn = hub + HUB;
        let tongue = horn + MOTOR[2] + RUBBER;
        Self {
            palm,
            drum,
            hub,
            guide: hub + 1.4 * PLAY,
            case: horn + HORN,
            tongue,
            cage: tongue + TONGUE,
            plate: tongue + TONGUE + PLATE,
        }
    }

    /// The middle of a digit's groove on the drum.
    pub(super) fn groove(&self, digit: usize, layout: &Layout<'_>) -> f64 {
        self.drum + layout.flange() + layout.groove() + digit as f64 * (layout.flange() + 2.0 * layout.groove())
    }
}

/// The way of a digit's line above the palm, seen from above. The spool's axis is in the middle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    /// Where it comes up.
    pub(super) exit: [f64; 2],
    /// Which way it leaves, to touch the drum, and how far it has to that.
    pub(super) along: [f64; 2],
    pub(super) length: f64,
    /// The middle of the pin that turns it.
    pub(super) pin: [f64; 2],
    /// The height of the pin's middle, m.
    pub(super) pin_height: f64,
    /// The height at which it runs, m.
    pub(super) height: f64,
}

impl Way {
    /// The point so far along it, m.
    pub(super) fn at(&self, far: f64) -> [f64; 2] {
        [0, 1].map(|i| self.exit[i] + far * self.along[i])
    }
}

/// The ways of thumb and fingers. All of them touch the drum on the side that winds them when it turns the same way.
pub(super) fn ways(hand: &HandDescription, design: &[f64; DESIGN_LEN], layout: &Layout<'_>) -> [Way; 3] {
    let (levels, line) = (Levels::new(hand, layout), layout.workshop.line);
    let digits = hand.digits();
    [0, 1, 2].map(|index| {
        let (digit, radius) = (digits[index], design[if index == 0 { 0 } else { 2 }]);
        let exit = [digit.base[0], digit.base[1] - digit.outward() * radius];
        let away = exit[0].hypot(exit[1]);
        let spool = hand.transmission.spool_radius;
        let (sin, cos) = (spool / away).acos().sin_cos();
        let touch = [exit[0] * cos - exit[1] * sin, exit[0] * sin + exit[1] * cos].map(|to| to * spool / away);
        let length = (touch[0] - exit[0]).hypot(touch[1] - exit[1]);
        let along = [0, 1].map(|i| (touch[i] - exit[i]) / length);
        let lever = TURN_PIN[0] + 0.5 * line;
        let height = levels.groove(index, layout);
        Way { exit, along, length, pin: [0, 1].map(|i| exit[i] + lever * along[i]), pin_height: height - lever, height }
    })
}
