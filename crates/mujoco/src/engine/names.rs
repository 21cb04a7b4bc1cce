//! From names of an MJCF text to indices, once.

use std::fmt;
use std::ops::Range;

use mujoco_rs::prelude::{MjModel, MjtObjBase};

use super::Simulation;

/// A geom of the model. Indices hold for all simulations of the same MJCF text; in another they may name something else.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct GeomId(pub(super) usize);

/// A body of the model, as [`GeomId`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BodyId(pub(super) usize);

impl BodyId {
    /// Its place among the bodies of the [`Inventory`](super::Inventory).
    pub fn index(self) -> usize {
        self.0
    }
}

/// An actuator of the model, as [`GeomId`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ActuatorId(pub(super) usize);

impl ActuatorId {
    /// Where its control stands in [`Simulation::ctrl`], for actuators with one control each (all but plugins).
    pub fn index(self) -> usize {
        self.0
    }
}

/// A tendon of the model, as [`GeomId`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct TendonId(pub(super) usize);

impl TendonId {
    /// Its place among the tendons of the [`Inventory`](super::Inventory).
    pub fn index(self) -> usize {
        self.0
    }
}

/// A site of the model, as [`GeomId`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SiteId(pub(super) usize);

impl SiteId {
    /// Its place among the sites of the [`Inventory`](super::Inventory).
    pub fn index(self) -> usize {
        self.0
    }
}

/// A sensor of the model, as [`GeomId`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SensorId(pub(super) usize);

/// A keyframe of the model, as [`GeomId`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct KeyframeId(pub(super) usize);

/// A camera of the model, as [`GeomId`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct CameraId(pub(super) usize);

/// Where a joint stands in the state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct JointAddress {
    /// In [`Simulation::qpos`]: 1 for hinges and slides, 4 (w, x, y, z) for balls, 7 (position, then w, x, y, z) for free
    /// joints.
    pub qpos: Range<usize>,
    /// In [`Simulation::qvel`] and generalised forces: 1, 3 or 6 (linear in the world's frame, angular in the body's).
    pub dof: Range<usize>,
}

impl JointAddress {
    /// That of a joint by its index, which the model has.
    pub(super) fn of(model: &MjModel, joint: usize) -> Self {
        Self {
            qpos: range(model.jnt_qposadr(), joint, model.nq() as usize),
            dof: range(model.jnt_dofadr(), joint, model.nv() as usize),
        }
    }
}

/// What a name stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Kind {
    /// A body.
    Body,
    /// A geom.
    Geom,
    /// A joint.
    Joint,
    /// An actuator.
    Actuator,
    /// A tendon.
    Tendon,
    /// A camera.
    Camera,
    /// A site.
    Site,
    /// A sensor.
    Sensor,
    /// A keyframe.
    Keyframe,
    /// An equality constraint.
    Equality,
    /// The model's options, of which there is one set, without a name.
    Options,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Body => "body",
            Self::Geom => "geom",
            Self::Joint => "joint",
            Self::Actuator => "actuator",
            Self::Tendon => "tendon",
            Self::Camera => "camera",
            Self::Site => "site",
            Self::Sensor => "sensor",
            Self::Keyframe => "keyframe",
            Self::Equality => "equality",
            Self::Options => "option",
        })
    }
}

/// Nothing of that kind has that name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the model has no {kind} `{name}`; {}", known(*.kind, .names))]
pub struct UnknownName {
    /// What was looked for.
    pub kind: Kind,
    /// The name that was looked for.
    pub name: String,
    /// The names that the model has for things of that kind.
    pub names: Vec<String>,
}

fn known(kind: Kind, names: &[String]) -> String {
    if names.is_empty() { format!("it names no {kind}") } else { format!("it has: {}", names.join(", ")) }
}

impl Simulation {
    /// The geom of that name.
    pub fn geom(&self, name: &str) -> Result<GeomId, UnknownName> {
        self.look_up(Kind::Geom, name).map(GeomId)
    }

    /// The body of that name. The world's is `world`.
    pub fn body(&self, name: &str) -> Result<BodyId, UnknownName> {
        self.look_up(Kind::Body, name).map(BodyId)
    }

    /// The actuator of that name.
    pub fn actuator(&self, name: &str) -> Result<ActuatorId, UnknownName> {
        self.look_up(Kind::Actuator, name).map(ActuatorId)
    }

    /// The tendon of that name.
    pub fn tendon(&self, name: &str) -> Result<TendonId, UnknownName> {
        self.look_up(Kind::Tendon, name).map(TendonId)
    }

    /// The site of that name.
    pub fn site(&self, name: &str) -> Result<SiteId, UnknownName> {
        self.look_up(Kind::Site, name).map(SiteId)
    }

    /// The sensor of that name.
    pub fn sensor(&self, name: &str) -> Result<SensorId, UnknownName> {
        self.look_up(Kind::Sensor, name).map(SensorId)
    }

    /// The keyframe of that name.
    pub fn keyframe(&self, name: &str) -> Result<KeyframeId, UnknownName> {
        self.look_up(Kind::Keyframe, name).map(KeyframeId)
    }

    /// The camera of that name.
    pub fn camera(&self, name: &str) -> Result<CameraId, UnknownName> {
        self.look_up(Kind::Camera, name).map(CameraId)
    }

    /// Where the joint of that name stands in the state.
    pub fn joint(&self, name: &str) -> Result<JointAddress, UnknownName> {
        Ok(JointAddress::of(self.model(), self.look_up(Kind::Joint, name)?))
    }

    /// Compares every name: the engine's own look-up wants a C string, and this is done once.
    fn look_up(&self, kind: Kind, name: &str) -> Result<usize, UnknownName> {
        let (object, count) = objects(self.model(), kind);
        let names = || (0..count).map(|id| self.model().id_to_name(object, id));
        names().position(|known| known == Some(name)).ok_or_else(|| UnknownName {
            kind,
            name: name.to_owned(),
            names: names().flatten().map(str::to_owned).collect(),
        })
    }
}

/// How the engine calls a kind, and how many it has.
pub(super) fn objects(model: &MjModel, kind: Kind) -> (MjtObjBase, usize) {
    match kind {
        Kind::Body => (MjtObjBase::mjOBJ_BODY, model.body_mass().len()),
        Kind::Geom => (MjtObjBase::mjOBJ_GEOM, model.geom_size().len()),
        Kind::Joint => (MjtObjBase::mjOBJ_JOINT, model.jnt_qposadr().len()),
        Kind::Actuator => (MjtObjBase::mjOBJ_ACTUATOR, model.nactuator() as usize),
        Kind::Tendon => (MjtObjBase::mjOBJ_TENDON, model.ntendon() as usize),
        Kind::Camera => (MjtObjBase::mjOBJ_CAMERA, model.ncam() as usize),
        Kind::Site => (MjtObjBase::mjOBJ_SITE, model.nsite() as usize),
        Kind::Sensor => (MjtObjBase::mjOBJ_SENSOR, model.nsensor() as usize),
        Kind::Keyframe => (MjtObjBase::mjOBJ_KEY, model.nkey() as usize),
        Kind::Equality => (MjtObjBase::mjOBJ_EQUALITY, model.neq() as usize),
        Kind::Options => (MjtObjBase::mjOBJ_UNKNOWN, 0),
    }
}

/// From the address of one joint to that of the next; joints stand in their order.
///
/// # Panics
/// If there is no such joint, or it has no coordinate: the model and what is looked up in it do not belong together.
fn range(addresses: &[i32], id: usize, end: usize) -> Range<usize> {
    let address = |at: i32| usize::try_from(at).expect("the engine gives every joint an address");
    let found = address(addresses[id])..addresses.get(id + 1).map_or(end, |&next| address(next));
    assert!(!found.is_empty(), "joint {id} has no coordinate: {found:?}");
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joint_ends_where_the_next_one_begins() {
        let addresses = [0, 7, 8];
        assert_eq!([0, 1, 2].map(|id| range(&addresses, id, 9)), [0..7, 7..8, 8..9]);
    }

    /// A joint that is not there had the range 0..0: whoever read its state read nothing, and said nothing of it.
    #[test]
    #[should_panic(expected = "index out of bounds")]
    fn a_joint_that_is_not_there_has_no_range() {
        range(&[0, 7], 2, 9);
    }

    #[test]
    #[should_panic(expected = "joint 1 has no coordinate: 7..7")]
    fn a_joint_without_coordinates_has_no_range() {
        range(&[0, 7], 1, 7);
    }

    #[test]
    #[should_panic(expected = "the engine gives every joint an address")]
    fn a_joint_without_an_address_has_no_range() {
        range(&[0, -1], 1, 7);
    }
}
