//! What a model has: [`Inventory`].

use std::ops::Range;

use mujoco_rs::prelude::{MjModel, MjtGeomBase, MjtJoint, MjtTrn, MjtWrap};

use super::names::objects;
use super::sensor::quantity;
use super::{
    ActuatorId, BodyId, CameraId, GeomId, JointAddress, KeyframeId, Kind, Quantity, SensorId, Simulation, SiteId,
    TendonId,
};

/// Everything of a model that can be read, driven or named, in the order of the engine. Elements may have no name.
#[derive(Debug, Clone, PartialEq)]
pub struct Inventory {
    /// Bodies; the first is the world.
    pub bodies: Vec<BodyEntry>,
    /// Joints.
    pub joints: Vec<JointEntry>,
    /// Geoms.
    pub geoms: Vec<GeomEntry>,
    /// Sites.
    pub sites: Vec<SiteEntry>,
    /// Actuators.
    pub actuators: Vec<ActuatorEntry>,
    /// Tendons.
    pub tendons: Vec<TendonEntry>,
    /// Sensors.
    pub sensors: Vec<SensorEntry>,
    /// Cameras.
    pub cameras: Vec<(Option<String>, CameraId)>,
    /// Keyframes.
    pub keyframes: Vec<(Option<String>, KeyframeId)>,
    /// Length of [`Simulation::qpos`].
    pub nq: usize,
    /// Length of [`Simulation::qvel`], the degrees of freedom.
    pub nv: usize,
    /// Length of [`Simulation::ctrl`].
    pub nu: usize,
    /// Number of activations of actuators with dynamics of their own.
    pub na: usize,
    /// Length of a step, s.
    pub timestep: f64,
    /// Acceleration of gravity, m/s².
    pub gravity: [f64; 3],
}

/// A body.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyEntry {
    /// Its name.
    pub name: Option<String>,
    /// Its identity.
    pub id: BodyId,
    /// The body it belongs to; none for the world.
    pub parent: Option<BodyId>,
    /// Mass, kg.
    pub mass: f64,
    /// Mass with all bodies that belong to it, kg.
    pub subtree_mass: f64,
}

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum JointType {
    /// It turns about an axis: one coordinate, rad.
    Hinge,
    /// It moves along an axis: one coordinate, m.
    Slide,
    /// It turns about a point: a quaternion (w, x, y, z), three velocities, rad/s.
    Ball,
    /// Nothing holds it: a position (m) and a quaternion, six velocities.
    Free,
}

/// A joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointEntry {
    /// Its name.
    pub name: Option<String>,
    /// How it moves.
    pub kind: JointType,
    /// The body that it moves.
    pub body: BodyId,
    /// Lower and upper limit if it is limited, rad or m; of a ball joint 0 and the largest angle.
    pub range: Option<[f64; 2]>,
    /// Linear damping of each of its degrees of freedom, N·m·s/rad or N·s/m.
    pub damping: f64,
    /// Where it stands in the state.
    pub address: JointAddress,
}

/// A geom.
#[derive(Debug, Clone, PartialEq)]
pub struct GeomEntry {
    /// Its name.
    pub name: Option<String>,
    /// Its identity.
    pub id: GeomId,
    /// The body it belongs to.
    pub body: BodyId,
    /// Its shape, as MJCF calls it: `plane`, `sphere`, `capsule`, `mesh` …
    pub shape: &'static str,
    /// Whether it can touch others by its masks `contype` and `conaffinity`.
    pub collides: bool,
}

/// A site.
#[derive(Debug, Clone, PartialEq)]
pub struct SiteEntry {
    /// Its name.
    pub name: Option<String>,
    /// Its identity.
    pub id: SiteId,
    /// The body it belongs to.
    pub body: BodyId,
}

/// What an actuator drives.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Drive {
    /// A joint: its index in the inventory and its name.
    Joint(usize, Option<String>),
    /// A tendon.
    Tendon(TendonId, Option<String>),
    /// A site.
    Site(SiteId, Option<String>),
    /// Something else, as the engine calls it: a body by adhesion, a slider-crank.
    Other(&'static str),
}

/// An actuator.
#[derive(Debug, Clone, PartialEq)]
pub struct ActuatorEntry {
    /// Its name.
    pub name: Option<String>,
    /// Its identity.
    pub id: ActuatorId,
    /// What it drives.
    pub drives: Drive,
    /// Where its controls stand in [`Simulation::ctrl`]: mostly one.
    pub controls: Range<usize>,
    /// Lower and upper limit of its controls if they are limited, in their unit.
    pub control_range: Option<[f64; 2]>,
    /// Lower and upper limit of its force if it is limited, before the gear.
    pub force_range: Option<[f64; 2]>,
    /// The gear: what is driven moves one unit while the actuator moves so many.
    pub gear: f64,
    /// Where its activations stand in [`Simulation::activations`]; empty if it has no dynamics of its own.
    pub activations: Range<usize>,
}

/// The way of a tendon.
#[derive(Debug, Clone, PartialEq)]
pub enum TendonPath {
    /// A sum of joint coordinates with coefficients: indices of joints in the inventory, and m/rad or a ratio each.
    Fixed(Vec<(usize, f64)>),
    /// A way through space, past sites and around geoms.
    Spatial,
}

/// A tendon.
#[derive(Debug, Clone, PartialEq)]
pub struct TendonEntry {
    /// Its name.
    pub name: Option<String>,
    /// Its identity.
    pub id: TendonId,
    /// Its way. How its length depends on the state: [`Simulation::tendon_moment`].
    pub path: TendonPath,
    /// Shortest and longest length if it is limited, m.
    pub range: Option<[f64; 2]>,
}

/// A sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct SensorEntry {
    /// Its name.
    pub name: Option<String>,
    /// Its identity.
    pub id: SensorId,
    /// Its type, as MJCF calls it: `framepos`, `touch` …
    pub kind: &'static str,
    /// Where its values stand in [`Simulation::sensordata`].
    pub values: Range<usize>,
    /// What they measure.
    pub quantity: Quantity,
}

impl Simulation {
    /// What the model has.
    pub fn inventory(&self) -> Inventory {
        let model = self.model();
        Inventory {
            bodies: entries(model, Kind::Body, |name, i| BodyEntry {
                name,
                id: BodyId(i),
                parent: (i > 0).then(|| BodyId(index(model.body_parentid()[i]))),
                mass: model.body_mass()[i],
                subtree_mass: model.body_subtreemass()[i],
            }),
            joints: entries(model, Kind::Joint, |name, i| JointEntry {
                name,
                kind: joint_type(model.jnt_type()[i]),
                body: BodyId(index(model.jnt_bodyid()[i])),
                range: model.jnt_limited()[i].then(|| model.jnt_range()[i]),
                damping: model.dof_damping()[index(model.jnt_dofadr()[i])],
                address: JointAddress::of(model, i),
            }),
            geoms: entries(model, Kind::Geom, |name, i| GeomEntry {
                name,
                id: GeomId(i),
                body: BodyId(index(model.geom_bodyid()[i])),
                shape: shape(model.geom_type()[i]),
                collides: model.geom_contype()[i] != 0 || model.geom_conaffinity()[i] != 0,
            }),
            sites: entries(model, Kind::Site, |name, i| SiteEntry {
                name,
                id: SiteId(i),
                body: BodyId(index(model.site_bodyid()[i])),
            }),
            actuators: entries(model, Kind::Actuator, |name, i| ActuatorEntry {
                name,
                id: ActuatorId(i),
                drives: drive(model, i),
                controls: block(model.actuator_ctrladr()[i], model.actuator_ctrlnum()[i]),
                control_range: model.actuator_ctrllimited()[i].then(|| model.actuator_ctrlrange()[i]),
                force_range: model.actuator_forcelimited()[i].then(|| model.actuator_forcerange()[i]),
                gear: model.actuator_gear()[i][0],
                activations: block(model.actuator_actadr()[i], model.actuator_actnum()[i]),
            }),
            tendons: entries(model, Kind::Tendon, |name, i| TendonEntry {
                name,
                id: TendonId(i),
                path: tendon_path(model, i),
                range: model.tendon_limited()[i].then(|| model.tendon_range()[i]),
            }),
            sensors: entries(model, Kind::Sensor, |name, i| {
                let (kind, quantity) = quantity(model, i);
                SensorEntry { name, id: SensorId(i), kind, values: sensor_values(model, i), quantity }
            }),
            cameras: entries(model, Kind::Camera, |name, i| (name, CameraId(i))),
            keyframes: entries(model, Kind::Keyframe, |name, i| (name, KeyframeId(i))),
            nq: self.qpos().len(),
            nv: self.qvel().len(),
            nu: self.ctrl().len(),
            na: self.activations().len(),
            timestep: self.timestep(),
            gravity: model.opt().gravity,
        }
    }
}

fn entries<T>(model: &MjModel, kind: Kind, entry: impl Fn(Option<String>, usize) -> T) -> Vec<T> {
    let (_, count) = objects(model, kind);
    (0..count).map(|i| entry(name(model, kind, i), i)).collect()
}

pub(super) fn name(model: &MjModel, kind: Kind, id: usize) -> Option<String> {
    let (object, _) = objects(model, kind);
    model.id_to_name(object, id).filter(|name| !name.is_empty()).map(str::to_owned)
}

fn index(id: i32) -> usize {
    usize::try_from(id).expect("every joint, geom and site belongs to a body")
}

/// A block of an array; the engine writes -1 for the start of an empty one.
fn block(start: i32, count: i32) -> Range<usize> {
    let start = usize::try_from(start).unwrap_or_default();
    start..start + usize::try_from(count).unwrap_or_default()
}

/// Where a sensor's values stand.
pub(super) fn sensor_values(model: &MjModel, sensor: usize) -> Range<usize> {
    block(model.sensor_adr()[sensor], model.sensor_dim()[sensor])
}

fn joint_type(kind: MjtJoint) -> JointType {
    match kind {
        MjtJoint::mjJNT_FREE => JointType::Free,
        MjtJoint::mjJNT_BALL => JointType::Ball,
        MjtJoint::mjJNT_SLIDE => JointType::Slide,
        MjtJoint::mjJNT_HINGE => JointType::Hinge,
    }
}

fn shape(kind: MjtGeomBase) -> &'static str {
    match kind {
        MjtGeomBase::mjGEOM_PLANE => "plane",
        MjtGeomBase::mjGEOM_HFIELD => "hfield",
        MjtGeomBase::mjGEOM_SPHERE => "sphere",
        MjtGeomBase::mjGEOM_CAPSULE => "capsule",
        MjtGeomBase::mjGEOM_ELLIPSOID => "ellipsoid",
        MjtGeomBase::mjGEOM_CYLINDER => "cylinder",
        MjtGeomBase::mjGEOM_BOX => "box",
        MjtGeomBase::mjGEOM_MESH => "mesh",
        MjtGeomBase::mjGEOM_SDF => "sdf",
    }
}

fn drive(model: &MjModel, actuator: usize) -> Drive {
    let target = || index(model.actuator_trnid()[actuator][0]);
    match model.actuator_trntype()[actuator] {
        MjtTrn::mjTRN_JOINT | MjtTrn::mjTRN_JOINTINPARENT => Drive::Joint(target(), name(model, Kind::Joint, target())),
        MjtTrn::mjTRN_TENDON => Drive::Tendon(TendonId(target()), name(model, Kind::Tendon, target())),
        MjtTrn::mjTRN_SITE => Drive::Site(SiteId(target()), name(model, Kind::Site, target())),
        MjtTrn::mjTRN_SLIDERCRANK => Drive::Other("slidercrank"),
        MjtTrn::mjTRN_BODY => Drive::Other("body"),
        MjtTrn::mjTRN_SO3 => Drive::Other("orientation"),
        MjtTrn::mjTRN_UNDEFINED => Drive::Other("undefined"),
    }
}

fn tendon_path(model: &MjModel, tendon: usize) -> TendonPath {
    let wraps = block(model.tendon_adr()[tendon], model.tendon_num()[tendon]);
    let is_joint = |&wrap: &usize| model.wrap_type()[wrap] == MjtWrap::mjWRAP_JOINT;
    if !wraps.clone().any(|wrap| is_joint(&wrap)) {
        return TendonPath::Spatial;
    }
    TendonPath::Fixed(
        wraps.filter(is_joint).map(|wrap| (index(model.wrap_objid()[wrap]), model.wrap_prm()[wrap])).collect(),
    )
}
