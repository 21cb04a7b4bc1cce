//! What experiments may set of a grasping problem.

use hwasp_core::Dimension;
use hwasp_settings::{Fields, Item, Kind, Settings, choice};

use super::bench::Bench;
use crate::hand::{HandDescription, HandRange, PalmMotion, TendonHandSettings, opening_torques};

/// The most shapes of a list, in which one may stand several times.
const MOST_SHAPES: usize = 100;

choice! {
    /// The limits within which the hand's twelve parameters are searched.
    pub enum HandRangeKind {
        /// All that fits into a finger.
        Large = "large",
        /// An eighth of it, around a sensible hand.
        Small = "small",
    }
}

choice! {
    /// Shapes of objects.
    pub enum ShapeKind {
        /// A ball.
        Sphere = "sphere",
        /// A cuboid.
        Box = "box",
        /// A cylinder, upright unless it is laid.
        Cylinder = "cylinder",
        /// An ellipsoid.
        Ellipsoid = "ellipsoid",
    }
}

choice! {
    /// From where the controller sees the object.
    pub enum Viewpoint {
        /// Its place in the world, as the paper has it.
        World = "world",
        /// Its place relative to the palm: the difference of what both sensors say.
        Palm = "palm",
    }
}

impl ShapeKind {
    /// All of them.
    pub const EACH: [Self; 4] = [Self::Sphere, Self::Box, Self::Cylinder, Self::Ellipsoid];
}

impl From<HandRangeKind> for HandRange {
    fn from(kind: HandRangeKind) -> Self {
        match kind {
            HandRangeKind::Large => Self::Large,
            HandRangeKind::Small => Self::Small,
        }
    }
}

/// Where an object's inertia comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Inertia {
    /// Each principal moment drawn from this range alone, kg·m², as the paper has it; triples that no rigid body has are
    /// drawn again.
    Independent([f64; 2]),
    /// That of a homogeneous body of its mass, shape and size.
    Physical,
}

/// What is grasped, from where, and what disturbs it. Every quantity that varies can be widened, narrowed or switched off.
/// The defaults are the paper's (section 6, appendix B).
#[derive(Clone, Debug, PartialEq)]
pub struct GraspTaskSettings {
    /// How the palm may move: the problem's, and nothing to be set.
    pub palm: PalmMotion,
    /// Limits of the design.
    pub range: HandRangeKind,
    /// The most the three tendons pull together, N.
    pub tension_limit: f64,
    /// Of each tendon, N/m.
    pub tendon_stiffness: f64,
    /// What the springs have to spare at every pose, palm down, N·m; none where hands may droop.
    pub opening_margin: Option<f64>,
    /// Shapes of objects.
    pub shapes: Vec<ShapeKind>,
    /// Edges of the bounding box, from and to, m.
    pub size: [f64; 2],
    /// Mass, from and to, kg.
    pub mass: [f64; 2],
    /// How much heavier objects are in training.
    pub safety_factor: f64,
    /// Between which fractions of training that factor grows from 1.
    pub safety_growth: [f64; 2],
    /// Friction, from and to.
    pub friction: [f64; 2],
    /// Each principal moment.
    pub inertia: Inertia,
    /// Height of the palm above the object at the start, from and to, m.
    pub height: [f64; 2],
    /// The object's place, ± m.
    pub offset: f64,
    /// The same at the start of training, ± m; none where it does not change.
    pub offset_initial: Option<f64>,
    /// Between which fractions of training it grows.
    pub offset_growth: [f64; 2],
    /// The object's turn, ± rad.
    pub yaw: f64,
    /// Share of cylinders that lie.
    pub lying: f64,
    /// From where the controller sees the object.
    pub viewpoint: Viewpoint,
    /// What is sensed, how late, and what the hand really does.
    pub bench: Bench,
    /// Standard deviation of positions, sensed and reached, m.
    pub position_noise: f64,
    /// Of the motor's travel, m.
    pub travel_noise: f64,
    /// Of the disturbing force, N.
    pub disturbance_force: f64,
    /// Of the disturbing torque, N·m.
    pub disturbance_torque: f64,
    /// Off the reward of a step, per metre between palm and object.
    pub distance_penalty: f64,
    /// Reward of a step for each distal link that touches the object.
    pub contact_reward: f64,
    /// Off the reward of a step, per metre that the palm is told to move sideways.
    pub sideways_penalty: f64,
    /// Reward of training per metre by which the palm comes nearer to being above the object.
    pub approach_reward: f64,
}

impl GraspTaskSettings {
    /// The defaults of a problem.
    pub(super) fn new(palm: PalmMotion) -> Self {
        Self {
            palm,
            range: HandRangeKind::Large,
            tension_limit: 75.0,
            tendon_stiffness: HandDescription::default().transmission.tendon_stiffness,
            opening_margin: None,
            shapes: ShapeKind::EACH.to_vec(),
            size: [0.040, 0.100],
            mass: [0.1, 0.5],
            safety_factor: 1.0,
            safety_growth: [0.3, 0.6],
            friction: [0.5, 1.0],
            inertia: Inertia::Independent([1e-4, 5e-3]),
            height: [0.150, 0.250],
            offset: if palm == PalmMotion::Spatial { 0.05 } else { 0.0 },
            offset_initial: None,
            offset_growth: [0.1, 0.6],
            yaw: 0.0,
            lying: 0.0,
            viewpoint: Viewpoint::World,
            bench: Bench::default(),
            position_noise: 1e-3,
            travel_noise: 8e-5,
            disturbance_force: 0.02,
            disturbance_torque: 0.002,
            distance_penalty: 2.0,
            contact_reward: 0.1,
            sideways_penalty: 0.0,
            approach_reward: 0.0,
        }
    }

    /// The hand that grasps: everything about it that is not designed.
    pub fn hand(&self) -> HandDescription {
        let mut hand = HandDescription::default();
        hand.transmission.tension_limit = self.tension_limit;
        hand.transmission.tendon_stiffness = self.tendon_stiffness;
        hand
    }

    /// What of its law can be chosen.
    pub fn law(&self) -> TendonHandSettings {
        let opening = self.opening_margin.map(|margin| opening_torques(&self.hand(), margin));
        TendonHandSettings { palm: self.palm, range: self.range.into(), opening, ..TendonHandSettings::default() }
    }
}

impl Settings for GraspTaskSettings {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        let length = Dimension::Length;
        fields.choice("range", &mut self.range, "limits of the twelve parameters");
        let about = "the most the three tendons pull together; 163 N is the easy variant";
        fields.quantity("tension_limit", &mut self.tension_limit, Dimension::Force, 1.0..=1000.0, about);
        let about = "of each of the three tendons";
        fields.quantity("tendon_stiffness", &mut self.tendon_stiffness, Dimension::Stiffness, 100.0..=1e6, about);
        let about = "torque that the springs have to spare at every pose with the palm down; preloads and stiffnesses that are too \
                     small for it are built as those that suffice";
        let example = (Dimension::Torque, 1e-3);
        fields.optional_quantity("opening_margin", &mut self.opening_margin, example, 0.0..=0.02, about);
        fields.choices(
            "shapes",
            &mut self.shapes,
            MOST_SHAPES,
            "of objects; one that stands there twice is drawn twice as often",
        );
        fields.span("size", &mut self.size, length, 0.01..=0.2, "edges of the object's bounding box");
        fields.span("mass", &mut self.mass, Dimension::Mass, 1e-3..=10.0, "of the object");
        let about = "objects are heavier by it in training than those of evaluations";
        fields.number("safety_factor", &mut self.safety_factor, 1.0..=10.0, about);
        let about = "between which fractions of training that factor grows from 1";
        fields.fractions("safety_growth", &mut self.safety_growth, about);
        fields.span("friction", &mut self.friction, Dimension::None, 0.0..=10.0, "of the object on hand and floor");
        self.inertia_field(fields);
        let about = "of the palm above the object's top at the start";
        fields.span("height", &mut self.height, length, 0.0..=0.4, about);
        fields.quantity("offset", &mut self.offset, length, 0.0..=0.1, "the object's place in x and y, ±");
        let about = "the same at the start of training, from where it grows: a curriculum";
        fields.optional_quantity("offset_initial", &mut self.offset_initial, (length, 0.01), 0.0..=0.1, about);
        let about = "between which fractions of training it grows";
        fields.fractions("offset_growth", &mut self.offset_growth, about);
        fields.quantity("yaw", &mut self.yaw, Dimension::Angle, 0.0..=4.0, "the object's turn about the vertical, ±");
        fields.number("lying", &mut self.lying, 0.0..=1.0, "share of cylinders that lie on their side");
        let about = "where the observed object is: in the `world`, as in the paper, or relative to the `palm`";
        fields.choice("viewpoint", &mut self.viewpoint, about);
        self.bench.fields(fields);
        let about = "standard deviation of sensed positions and of the palm's target";
        fields.quantity("position_noise", &mut self.position_noise, length, 0.0..=0.05, about);
        fields.quantity("travel_noise", &mut self.travel_noise, length, 0.0..=0.005, "the same of the motor's travel");
        let about = "standard deviation on palm and object, redrawn each step";
        fields.quantity("disturbance_force", &mut self.disturbance_force, Dimension::Force, 0.0..=100.0, about);
        fields.quantity("disturbance_torque", &mut self.disturbance_torque, Dimension::Torque, 0.0..=100.0, about);
        let about = "off the reward of a step, per metre between palm and object";
        fields.number("distance_penalty", &mut self.distance_penalty, 0.0..=1000.0, about);
        let about = "reward of a step for each distal link that touches the object";
        fields.number("contact_reward", &mut self.contact_reward, 0.0..=1000.0, about);
        let about = "off the reward of a step, per metre that the palm is told to move sideways in it";
        fields.number("sideways_penalty", &mut self.sideways_penalty, 0.0..=1e5, about);
        let about = "in training only: reward per metre by which the palm comes nearer to being above the object, off it when the \
                     palm leaves";
        fields.number("approach_reward", &mut self.approach_reward, 0.0..=1e5, about);
    }
}

impl GraspTaskSettings {
    /// A range of moments, or a word.
    fn inertia_field(&mut self, fields: &mut Fields<'_, '_>) {
        const LIMITS: std::ops::RangeInclusive<f64> = 1e-7..=1.0;
        let item = match self.inertia {
            Inertia::Physical => Item::from("physical"),
            Inertia::Independent(range) => Item::List(range.map(Item::Float).to_vec()),
        };
        let default = if let Inertia::Independent(range) = self.inertia { range } else { [1e-4, 5e-3] };
        let about = "each principal moment, kg·m²; or \"physical\", from mass, shape and size";
        let number = Kind::Number([*LIMITS.start(), *LIMITS.end()]);
        let span = Kind::List { of: Box::new(number), length: [1, 2], single: true };
        fields.default("1e-4 to 5e-3").limits("1e-7 to 1");
        fields.kind(Kind::AnyOf(vec![Kind::Choice(vec!["physical"]), span]));
        fields.open("inertia", about, Some(item), |section, node| {
            self.inertia = match node.text() {
                Some("physical") => Inertia::Physical,
                _ => Inertia::Independent(section.span_of("inertia", node, Dimension::None, default, &LIMITS)),
            };
        });
    }
}
