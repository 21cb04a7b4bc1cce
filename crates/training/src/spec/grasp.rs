//! What the grasping problems have in `[task]`.

use std::ops::RangeInclusive;

use hwasp_core::Dimension;
use hwasp_tasks::hand::{HandDescription, HandRange};
use serde::{Serialize, Serializer};

use super::names::named;
use super::quantity;
use super::section::Section;
use super::tree::Value;
use super::values::with_unit;

/// The most shapes of a list, in which one may stand several times.
const MOST_SHAPES: usize = 100;

named! {
    /// The limits within which the hand's twelve parameters are searched.
    pub enum HandRangeKind {
        /// All that fits into a finger.
        Large = "large",
        /// An eighth of it, around a sensible hand.
        Small = "small",
    }
}

named! {
    /// Shapes of objects.
    pub enum ObjectKind {
        /// A ball.
        Sphere = "sphere",
        /// A cuboid.
        Box = "box",
        /// A cylinder.
        Cylinder = "cylinder",
        /// An ellipsoid.
        Ellipsoid = "ellipsoid",
    }
}

named! {
    /// From where the controller sees the object.
    pub enum ViewpointKind {
        /// Its place in the world.
        World = "world",
        /// Its place relative to the palm.
        Palm = "palm",
    }
}

impl From<HandRangeKind> for HandRange {
    fn from(kind: HandRangeKind) -> Self {
        match kind {
            HandRangeKind::Large => Self::Large,
            HandRangeKind::Small => Self::Small,
        }
    }
}

/// From a quantity to another of its dimension, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpanSpec {
    /// From here.
    pub from: f64,
    /// To there; the same where nothing varies.
    pub to: f64,
    /// What it measures.
    pub dimension: Dimension,
}

/// What is grasped, from where, and what disturbs it. Every quantity that varies can be widened, narrowed or switched off.
///
/// | key | default | meaning | limits |
/// |---|---|---|---|
/// | `range` | "large" | limits of the twelve parameters: `large` or `small` | |
/// | `tension_limit` | "75 N" | the most the three tendons pull together; 163 N is the easy variant | 1 to 1000 N |
/// | `shapes` | all four | of `sphere`, `box`, `cylinder`, `ellipsoid` | 1 to 100 of them |
/// | `size` | 40 to 100 mm | edges of the object's bounding box | 10 to 200 mm |
/// | `mass` | 100 to 500 g | of the object | 0.001 to 10 kg |
/// | `safety_factor` | 1.0 | objects are heavier by it in training than those of evaluations | 1 to 10 |
/// | `safety_growth` | [0.3, 0.6] | between which fractions of training that factor grows from 1 | 0 to 1, in order |
/// | `friction` | 0.5 to 1 | of the object on hand and floor | 0 to 10 |
/// | `inertia` | 1e-4 to 5e-3 | each principal moment, kg·m²; or "physical", from mass, shape and size | 1e-7 to 1 |
/// | `height` | 150 to 250 mm | of the palm above the object's top at the start | 0 to 400 mm |
/// | `offset` | "0 mm" (3d-grasp: "50 mm") | the object's place in x and y, ± | 0 to 100 mm |
/// | `offset_initial` | "none" | the same at the start of training, from where it grows: a curriculum | 0 to 100 mm |
/// | `offset_growth` | [0.1, 0.6] | between which fractions of training it grows | 0 to 1, in order |
/// | `yaw` | "0 rad" | the object's turn about the vertical, ± | 0 to 4 rad |
/// | `lying` | 0.0 | share of cylinders that lie on their side | 0 to 1 |
/// | `viewpoint` | "world" | where the observed object is: in the `world`, as in the paper, or relative to the `palm` | |
/// | `position_noise` | "1 mm" | standard deviation of sensed positions and of the palm's target | 0 to 50 mm |
/// | `travel_noise` | "0.08 mm" | the same of the motor's travel | 0 to 5 mm |
/// | `disturbance_force`, `disturbance_torque` | "0.02 N", "0.002 N·m" | standard deviation on palm and object, redrawn each step | 0 to 100 |
/// | `distance_penalty` | 2.0 | off the reward of a step, per metre between palm and object | 0 to 1000 |
/// | `contact_reward` | 0.1 | reward of a step for each distal link that touches the object | 0 to 1000 |
/// | `approach_reward` | 0.0 | in training only: reward per metre by which the palm comes nearer to being above the object, off it when the palm leaves | 0 to 1e5 |
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GraspProblem {
    /// Limits of the design.
    pub range: HandRangeKind,
    /// The most the three tendons pull together, N.
    #[serde(serialize_with = "quantity::newtons")]
    pub tension_limit: f64,
    /// Shapes of objects.
    pub shapes: Vec<ObjectKind>,
    /// Edges of the bounding box, m.
    pub size: SpanSpec,
    /// Mass, kg.
    pub mass: SpanSpec,
    /// How much heavier objects are in training.
    pub safety_factor: f64,
    /// Between which fractions of training that factor grows from 1.
    pub safety_growth: [f64; 2],
    /// Friction.
    pub friction: SpanSpec,
    /// Each principal moment, kg·m²; none for what mass, shape and size give.
    #[serde(serialize_with = "write_inertia")]
    pub inertia: Option<SpanSpec>,
    /// Height of the palm above the object at the start, m.
    pub height: SpanSpec,
    /// The object's place, ± m.
    #[serde(serialize_with = "quantity::metres")]
    pub offset: f64,
    /// The same at the start of training, ± m; none where it does not change.
    #[serde(serialize_with = "write_length", skip_serializing_if = "Option::is_none")]
    pub offset_initial: Option<f64>,
    /// Between which fractions of training it grows.
    pub offset_growth: [f64; 2],
    /// The object's turn, ± rad.
    #[serde(serialize_with = "quantity::radians")]
    pub yaw: f64,
    /// Share of cylinders that lie.
    pub lying: f64,
    /// From where the controller sees the object.
    pub viewpoint: ViewpointKind,
    /// Standard deviation of positions, sensed and reached, m.
    #[serde(serialize_with = "quantity::metres")]
    pub position_noise: f64,
    /// Of the motor's travel, m.
    #[serde(serialize_with = "quantity::metres")]
    pub travel_noise: f64,
    /// Of the disturbing force, N.
    #[serde(serialize_with = "quantity::newtons")]
    pub disturbance_force: f64,
    /// Of the disturbing torque, N·m.
    #[serde(serialize_with = "quantity::newton_metres")]
    pub disturbance_torque: f64,
    /// Off the reward of a step, per metre between palm and object.
    pub distance_penalty: f64,
    /// Reward of a step for each distal link that touches the object.
    pub contact_reward: f64,
    /// Reward of training per metre by which the palm comes nearer to being above the object.
    pub approach_reward: f64,
}

impl GraspProblem {
    /// The hand that grasps: everything about it that is not designed.
    pub fn hand(&self) -> HandDescription {
        let mut hand = HandDescription::default();
        hand.transmission.tension_limit = self.tension_limit;
        hand
    }

    /// The keys, for messages to other problems.
    pub(super) const KEYS: &'static [&'static str] = &[
        "range",
        "tension_limit",
        "shapes",
        "size",
        "mass",
        "safety_factor",
        "safety_growth",
        "friction",
        "inertia",
        "height",
        "offset",
        "offset_initial",
        "offset_growth",
        "yaw",
        "lying",
        "viewpoint",
        "position_noise",
        "travel_noise",
        "disturbance_force",
        "disturbance_torque",
        "distance_penalty",
        "contact_reward",
        "approach_reward",
    ];

    /// Reads what is set; `spatial` for 3D-Grasp.
    pub(super) fn read(s: &mut Section<'_>, spatial: bool) -> Self {
        let length = Dimension::Length;
        Self {
            range: s.choice("range", HandRangeKind::ALL).unwrap_or(HandRangeKind::Large),
            tension_limit: s.quantity("tension_limit", Dimension::Force, 75.0, &(1.0..=1000.0)),
            shapes: read_shapes(s),
            size: span(s, "size", length, (0.040, 0.100), &(0.01..=0.2)),
            mass: span(s, "mass", Dimension::Mass, (0.1, 0.5), &(1e-3..=10.0)),
            safety_factor: s.number("safety_factor", 1.0, 1.0..=10.0),
            safety_growth: s.fractions("safety_growth", [0.3, 0.6]),
            friction: span(s, "friction", Dimension::None, (0.5, 1.0), &(0.0..=10.0)),
            inertia: if s.is_text("inertia", "physical") {
                None
            } else {
                Some(span(s, "inertia", Dimension::None, (1e-4, 5e-3), &(1e-7..=1.0)))
            },
            height: span(s, "height", length, (0.150, 0.250), &(0.0..=0.4)),
            offset: s.quantity("offset", length, if spatial { 0.05 } else { 0.0 }, &(0.0..=0.1)),
            offset_initial: s.optional_quantity("offset_initial", length, 0.01, &(0.0..=0.1)),
            offset_growth: s.fractions("offset_growth", [0.1, 0.6]),
            yaw: s.quantity("yaw", Dimension::Angle, 0.0, &(0.0..=4.0)),
            lying: s.number("lying", 0.0, 0.0..=1.0),
            viewpoint: s.choice("viewpoint", ViewpointKind::ALL).unwrap_or(ViewpointKind::World),
            position_noise: s.quantity("position_noise", length, 1e-3, &(0.0..=0.05)),
            travel_noise: s.quantity("travel_noise", length, 8e-5, &(0.0..=0.005)),
            disturbance_force: s.quantity("disturbance_force", Dimension::Force, 0.02, &(0.0..=100.0)),
            disturbance_torque: s.quantity("disturbance_torque", Dimension::Torque, 0.002, &(0.0..=100.0)),
            distance_penalty: s.number("distance_penalty", 2.0, 0.0..=1000.0),
            contact_reward: s.number("contact_reward", 0.1, 0.0..=1000.0),
            approach_reward: s.number("approach_reward", 0.0, 0.0..=1e5),
        }
    }
}

fn read_shapes(s: &mut Section<'_>) -> Vec<ObjectKind> {
    let all = || ObjectKind::ALL.iter().map(|&(_, kind)| kind).collect();
    let Some(node) = s.take("shapes") else { return all() };
    let Value::List(items) = &node.value else {
        s.wrong("shapes", node, "is not a list", Some("write it like [\"sphere\", \"box\"]".into()));
        return all();
    };
    if items.len() > MOST_SHAPES {
        let hint = "a shape that stands there twice is drawn twice as often".to_owned();
        s.wrong(
            "shapes",
            node,
            &format!("has {} items, but at most {MOST_SHAPES} are possible", items.len()),
            Some(hint),
        );
        return all();
    }
    let shapes: Vec<ObjectKind> = items
        .iter()
        .enumerate()
        .filter_map(|(i, item)| s.chosen(&format!("shapes[{i}]"), item, ObjectKind::ALL))
        .collect();
    if items.is_empty() {
        s.wrong("shapes", node, "is empty", Some("leave it out for all shapes".into()));
        return all();
    }
    if shapes.is_empty() { all() } else { shapes }
}

/// A pair of quantities, the smaller one first, or one for both.
fn span(
    s: &mut Section<'_>,
    key: &'static str,
    dimension: Dimension,
    (from, to): (f64, f64),
    range: &RangeInclusive<f64>,
) -> SpanSpec {
    let default = SpanSpec { from, to, dimension };
    let Some(node) = s.take(key) else { return default };
    let ends = match &node.value {
        Value::List(items) => &items[..],
        _ => std::slice::from_ref(node),
    };
    let hint = || Some(format!("write [from, to], such as [{}]", default.shown().join(", ")));
    if !(1..=2).contains(&ends.len()) {
        s.wrong(key, node, "is not a pair", hint());
        return default;
    }
    let read: Vec<f64> =
        ends.iter().filter_map(|end| s.checked_quantity(key, end, dimension, default.from, range)).collect();
    if read.len() < ends.len() {
        return default;
    }
    let (from, to) = (read[0], read[read.len() - 1]);
    if from > to {
        s.wrong(key, node, "begins above its end", hint());
        return default;
    }
    SpanSpec { from, to, dimension }
}

impl SpanSpec {
    /// Both ends.
    pub fn ends(&self) -> [f64; 2] {
        [self.from, self.to]
    }

    /// As it is written in files.
    fn shown(&self) -> [String; 2] {
        self.ends().map(|end| match self.dimension {
            Dimension::None => super::fault::show(end),
            dimension => format!("\"{}\"", with_unit(end, dimension)),
        })
    }
}

impl Serialize for SpanSpec {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.dimension {
            Dimension::None => serializer.collect_seq(self.ends()),
            dimension => serializer.collect_seq(self.ends().map(|end| with_unit(end, dimension))),
        }
    }
}

#[allow(clippy::ref_option, reason = "serde's signature")]
fn write_length<S: Serializer>(length: &Option<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    length.map(|length| with_unit(length, Dimension::Length)).serialize(serializer)
}

#[allow(clippy::ref_option, reason = "serde's signature")]
fn write_inertia<S: Serializer>(span: &Option<SpanSpec>, serializer: S) -> Result<S::Ok, S::Error> {
    match span {
        Some(span) => span.serialize(serializer),
        None => serializer.serialize_str("physical"),
    }
}
