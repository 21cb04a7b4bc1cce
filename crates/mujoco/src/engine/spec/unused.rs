//! Fields that the compiler passes over, so that nobody designs with a number that does nothing.

use mujoco_rs::mujoco_c::mjtLimited;
use mujoco_rs::prelude::{MjtGeomBase as Shape, MjtJoint, MjtTrn};
use mujoco_rs::wrappers::mj_editing::{
    MjsActuator, MjsBody, MjsGeom, MjsJoint, MjsOrientation, MjsSite, MjsTendon, MjtInertiaFromGeom, MjtOrientation,
};

use super::find::{Item, parent};
use super::{FieldPath, Spec};

impl Spec {
    /// Why a change of the number would have no effect.
    pub(super) fn unused(&self, path: &FieldPath, place: usize, item: Item<'_>) -> Option<String> {
        let (field, index) = (path.field(), path.index());
        match item {
            Item::Body(_) if place == 0 => Some("the world stays where it is".to_owned()),
            Item::Body(body) => turned(field, body.alt()).or_else(|| self.inertia(field, body)),
            Item::Geom(geom) => placed(field, index, geom.alt(), geom.fromto(), geom.type_())
                .or_else(|| self.mass(field, geom))
                .or_else(|| sized(field, index, geom.type_())),
            Item::Site(site) => of_site(field, index, site),
            Item::Joint(joint) => of_joint(field, index, joint),
            Item::Actuator(actuator) => of_actuator(field, actuator),
            Item::Tendon(tendon) => of_tendon(field, tendon),
            Item::Equality(_) | Item::Options(_) => None,
        }
    }

    /// Whether the body's mass and inertia follow from its geoms.
    pub(super) fn inferred(&self, body: &MjsBody) -> bool {
        match Item::Body(body).compiler().unwrap_or(self.inner.compiler()).inertiafromgeom() {
            MjtInertiaFromGeom::mjINERTIAFROMGEOM_TRUE => true,
            MjtInertiaFromGeom::mjINERTIAFROMGEOM_AUTO => body.ipos()[0].is_nan(),
            MjtInertiaFromGeom::mjINERTIAFROMGEOM_FALSE => false,
        }
    }

    fn inertia(&self, field: &str, body: &MjsBody) -> Option<String> {
        let full = !body.fullinertia()[0].is_nan();
        match field {
            "mass" | "ipos" | "inertia" | "fullinertia" if self.inferred(body) => Some(
                "the body's mass and inertia follow from its geoms; set `mass`, `density` or `size` of a geom"
                    .to_owned(),
            ),
            "inertia" if full => Some("the inertia is written as `fullinertia`; set that".to_owned()),
            "fullinertia" if !full => Some("the inertia is written as its diagonal; set `inertia`".to_owned()),
            _ => None,
        }
    }

    fn mass(&self, field: &str, geom: &MjsGeom) -> Option<String> {
        if !matches!(field, "mass" | "density") {
            return None;
        }
        let (place, body) = parent(&self.inner, geom)?;
        if place == 0 {
            Some("the geom belongs to the world, which does not move".to_owned())
        } else if !self.inferred(body) {
            Some("the body has an `inertial` of its own; set `mass` and `inertia` of the body".to_owned())
        } else if field == "density" && !geom.mass().is_nan() {
            Some("the geom has a mass; set `mass`".to_owned())
        } else {
            None
        }
    }
}

/// Orientations are written in one of several ways.
fn turned(field: &str, alt: &MjsOrientation) -> Option<String> {
    let way = match alt.type_ {
        MjtOrientation::mjORIENTATION_QUAT => "quat",
        MjtOrientation::mjORIENTATION_EULER => "euler",
        MjtOrientation::mjORIENTATION_AXISANGLE => "axisangle",
        MjtOrientation::mjORIENTATION_XYAXES => "xyaxes",
        MjtOrientation::mjORIENTATION_ZAXIS => "zaxis",
    };
    (matches!(field, "quat" | "euler") && field != way).then(|| match way {
        "quat" | "euler" => format!("the orientation is written as `{way}`; set that"),
        _ => format!("the orientation is written as `{way}`; write it as `quat` or `euler` to set it"),
    })
}

fn placed(field: &str, index: usize, alt: &MjsOrientation, fromto: &[f64; 6], shape: Shape) -> Option<String> {
    let ends = !fromto[0].is_nan();
    // Of a capsule or cylinder the first size is a radius, and of the others two are alike; the ends say the rest.
    match field {
        "fromto" if !ends => Some("the place is written as `pos`; set that, or write `fromto`".to_owned()),
        "pos" | "quat" | "euler" if ends => Some("`fromto` says the place; set that".to_owned()),
        "size" if ends && index > 0 && shape != Shape::mjGEOM_MESH => {
            Some("`fromto` says the length; set that, and the radius by `size[0]`".to_owned())
        }
        _ => turned(field, alt),
    }
}

/// Shapes with fewer sizes.
fn sized(field: &str, index: usize, shape: Shape) -> Option<String> {
    let (count, what) = match shape {
        Shape::mjGEOM_SPHERE => (1, "a sphere has one size, its radius"),
        Shape::mjGEOM_CAPSULE => (2, "a capsule has two sizes, radius and half length"),
        Shape::mjGEOM_CYLINDER => (2, "a cylinder has two sizes, radius and half length"),
        Shape::mjGEOM_ELLIPSOID | Shape::mjGEOM_BOX | Shape::mjGEOM_PLANE => (3, ""),
        Shape::mjGEOM_MESH | Shape::mjGEOM_SDF => (0, "a mesh has the size of its file"),
        Shape::mjGEOM_HFIELD => (0, "a height field has the size of its asset"),
    };
    (field == "size" && index >= count).then(|| what.to_owned())
}

fn of_site(field: &str, index: usize, site: &MjsSite) -> Option<String> {
    placed(field, index, site.alt(), site.fromto(), site.type_()).or_else(|| sized(field, index, site.type_()))
}

fn of_joint(field: &str, index: usize, joint: &MjsJoint) -> Option<String> {
    let free = joint.type_() == MjtJoint::mjJNT_FREE;
    let ball = joint.type_() == MjtJoint::mjJNT_BALL;
    let sprung = joint.springdamper().iter().all(|&value| value > 0.0);
    match field {
        "pos" | "range" | "margin" if free => Some("a free joint has no anchor and no limits".to_owned()),
        "axis" | "ref" | "springref" | "actuatorfrcrange" if free || ball => {
            Some("only hinges and slides have it".to_owned())
        }
        "range" if ball && index == 0 => Some("the range of a ball joint begins at 0".to_owned()),
        "range" | "margin" => unlimited(joint.limited(), "limited"),
        "actuatorfrcrange" => unlimited(joint.actfrclimited(), "actuatorfrclimited"),
        "stiffness" | "damping" if sprung => Some("`springdamper` says it".to_owned()),
        _ => None,
    }
}

fn of_actuator(field: &str, actuator: &MjsActuator) -> Option<String> {
    match field {
        "ctrlrange" => unlimited(actuator.ctrllimited(), "ctrllimited"),
        "forcerange" => unlimited(actuator.forcelimited(), "forcelimited"),
        "actrange" => unlimited(actuator.actlimited(), "actlimited"),
        "cranklength" if actuator.trntype() != MjtTrn::mjTRN_SLIDERCRANK => {
            Some("only an actuator of a slider-crank has a crank".to_owned())
        }
        _ => None,
    }
}

fn of_tendon(field: &str, tendon: &MjsTendon) -> Option<String> {
    match field {
        "range" | "margin" => unlimited(tendon.limited(), "limited"),
        "actuatorfrcrange" => unlimited(tendon.actfrclimited(), "actuatorfrclimited"),
        _ => None,
    }
}

fn unlimited(limited: mjtLimited, name: &str) -> Option<String> {
    (limited == mjtLimited::mjLIMITED_FALSE).then(|| format!("the element has `{name}=\"false\"`"))
}
