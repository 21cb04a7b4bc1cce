//! A hand's transmission by statics: what it weighs, pinches and lifts, and how it closes in the air.

use hwasp_plot::{Plot, closing_plot};
use hwasp_tasks::hand::names::KINDS;
use hwasp_tasks::hand::{
    ClosingPoint, DESIGN_LEN, Droop, FreeClosing, HandDescription, HandError, PAPER_HWASP, PAPER_MINIMAL, PinchBand,
    PinchLift, PinchTension, closing_chart, closing_end, droop, pinch_band, torque_ratio,
};
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

use super::judged::HandJudgements;

/// Widths of the pinched objects, m: the range that the tasks draw from.
const WIDTHS: [f64; 4] = [0.040, 0.060, 0.080, 0.100];
/// The heaviest object of the tasks, kg.
pub(super) const HEAVIEST: f64 = 0.5;
/// Points of the picture.
const POINTS: usize = 451;

/// A figure for the thumb and for either finger.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DigitPair<T> {
    /// The thumb's.
    pub thumb: T,
    /// Either finger's.
    pub finger: T,
}

impl<T> DigitPair<T> {
    fn of(figure: impl Fn(bool) -> T) -> Self {
        Self { thumb: figure(false), finger: figure(true) }
    }
}

/// The transmission at one kind of joint.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JointReport {
    /// Thumb or finger, proximal or distal.
    pub joint: &'static str,
    /// Radius of the pulley (m), stiffness (N·m/rad) and preload (rad) of the spring.
    pub design: [f64; 3],
    /// The same of the paper's HWasP (table 2).
    pub paper_hwasp: [f64; 3],
    /// And of its HWasP-Minimal.
    pub paper_minimal: [f64; 3],
    /// Torque of gravity with the palm down and the hand open, N·m; it closes.
    pub weight: f64,
    /// Torque of the spring there, N·m; it opens.
    pub spring: f64,
    /// How much of it is left, N·m: negative where the joint droops shut.
    pub margin: f64,
}

/// A pinch by the fingertips, 30 mm below the distal joints.
#[derive(Clone, Debug, PartialEq)]
pub struct PinchReport {
    /// Width of the object, m.
    pub width: f64,
    /// The ratios of proximal to distal torque that hold it; none if the links do not reach.
    pub band: Option<PinchBand>,
    /// Those that the design has, springs included, with a third of the limit in each tendon; none where a spring wins.
    pub torque_ratio: DigitPair<Option<f64>>,
    /// What it lifts at the limit, kg.
    pub capacity: Option<f64>,
    /// What lifting 500 g takes.
    pub heaviest: Option<PinchTension>,
}

impl Serialize for PinchReport {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut fields = serializer.serialize_struct("PinchReport", 6)?;
        fields.serialize_field("width", &self.width)?;
        fields.serialize_field("band", &self.band.map(|band| [band.lo, band.hi]))?;
        fields.serialize_field("torque_ratio", &self.torque_ratio)?;
        fields.serialize_field("capacity", &self.capacity)?;
        fields.serialize_field("tension_for_500_g", &self.heaviest.map(|needs| needs.total))?;
        fields.serialize_field("motor_torque_for_500_g", &self.heaviest.map(|needs| needs.motor_torque))?;
        fields.end()
    }
}

/// What statics say of a hand. SI units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HandReport {
    /// The most that the three tendons pull together, N.
    pub tension_limit: f64,
    /// The four kinds of joints: thumb proximal, thumb distal, finger proximal, finger distal.
    pub joints: Vec<JointReport>,
    /// Whether the open digits stay open with the palm down.
    pub stays_open: DigitPair<bool>,
    /// Radius of the proximal pulley over that of the distal one: the ratio of torques but for the springs.
    pub pulley_ratio: DigitPair<f64>,
    /// Pinches of objects from small to large.
    pub pinches: Vec<PinchReport>,
    /// What the motor winds in free closing, m: until its tension is spent, or all there is.
    pub closing_end: f64,
    /// Whether its tension is spent there.
    pub spends_its_tension: bool,
    /// Free closing, a point per mm of travel and one at the end.
    #[serde(serialize_with = "write_points")]
    pub closing: Vec<ClosingPoint>,
    /// What its blocks come to.
    pub judged: HandJudgements,
    #[serde(skip)]
    chart: Vec<ClosingPoint>,
}

impl HandReport {
    /// Of a `design` (SI, within the limits of a range) in a hand.
    pub fn new(hand: &HandDescription, design: &[f64; DESIGN_LEN]) -> Result<Self, HandError> {
        let droops = DigitPair::of(|finger| droop(hand, design, finger));
        let end = closing_end(hand, design);
        let mut wound = hand.clone();
        wound.transmission.travel = end;
        let joints: Vec<JointReport> = (0..KINDS.len()).map(|kind| joint(design, &droops, kind)).collect();
        let pinches: Vec<PinchReport> =
            WIDTHS.into_iter().map(|width| pinch(hand, design, width)).collect::<Result<_, _>>()?;
        let spends_its_tension = end < hand.transmission.travel;
        Ok(Self {
            tension_limit: hand.transmission.tension_limit,
            judged: HandJudgements::of(hand, (&joints, &pinches), (end, spends_its_tension)),
            joints,
            stays_open: DigitPair { thumb: droops.thumb.holds(), finger: droops.finger.holds() },
            pulley_ratio: DigitPair { thumb: design[0] / design[1], finger: design[2] / design[3] },
            pinches,
            closing_end: end,
            spends_its_tension,
            closing: (0..(1e3 * end).ceil() as u32)
                .map(|mm| 1e-3 * f64::from(mm))
                .chain([end])
                .map(|travel| point(hand, design, travel))
                .collect(),
            chart: closing_chart(&wound, design, POINTS),
        })
    }

    /// The points of its picture.
    pub fn chart(&self) -> &[ClosingPoint] {
        &self.chart
    }

    /// The picture of free closing.
    pub fn closing_plot(&self, title: &str) -> Plot {
        closing_plot(&self.chart, self.tension_limit, title)
    }
}

fn joint(design: &[f64; DESIGN_LEN], droops: &DigitPair<Droop>, kind: usize) -> JointReport {
    let of = |design: &[f64; DESIGN_LEN]| [0, 4, 8].map(|group| design[group + kind]);
    let digit = if kind < 2 { droops.thumb } else { droops.finger };
    let (weight, spring) = (digit.gravity[kind % 2], digit.springs[kind % 2]);
    JointReport {
        joint: KINDS[kind],
        design: of(design),
        paper_hwasp: of(&PAPER_HWASP),
        paper_minimal: of(&PAPER_MINIMAL),
        weight,
        spring,
        margin: spring - weight,
    }
}

fn pinch(hand: &HandDescription, design: &[f64; DESIGN_LEN], width: f64) -> Result<PinchReport, HandError> {
    let lift = PinchLift { width, ..PinchLift::default() };
    let each = hand.transmission.tension_limit / 3.0;
    Ok(PinchReport {
        width,
        band: pinch_band(hand, width, lift.below, lift.friction),
        torque_ratio: DigitPair::of(|finger| torque_ratio(hand, design, finger, width, each)),
        capacity: lift.capacity(hand, design)?,
        heaviest: lift.needs(hand, design, HEAVIEST)?,
    })
}

fn point(hand: &HandDescription, design: &[f64; DESIGN_LEN], travel: f64) -> ClosingPoint {
    let (thumb, finger) = (FreeClosing::thumb(hand, design, travel), FreeClosing::finger(hand, design, travel));
    ClosingPoint { travel, thumb, finger, total_tension: thumb.tension + 2.0 * finger.tension }
}

/// One object per point, as scripts like it.
fn write_points<S: Serializer>(points: &[ClosingPoint], serializer: S) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Point {
        travel: f64,
        thumb_angles: [f64; 2],
        thumb_tension: f64,
        finger_angles: [f64; 2],
        finger_tension: f64,
        total_tension: f64,
    }
    serializer.collect_seq(points.iter().map(|p| Point {
        travel: p.travel,
        thumb_angles: p.thumb.angles,
        thumb_tension: p.thumb.tension,
        finger_angles: p.finger.angles,
        finger_tension: p.finger.tension,
        total_tension: p.total_tension,
    }))
}
