//! Floor, palm, digits, object.
//!
//! What touches what is settled by bits: the hand has bit 1 and looks for nothing, the object has bit 2 and looks for the
//! hand, the floor looks for both. So links do not touch each other. How two things touch is settled by the one of higher
//! priority: the floor's rolling friction holds against the object, and the object's friction against the hand.

use super::super::description::{HandDescription, LinkDescription};
use super::super::names::{
    CAMERA, FLOOR, HOME, JOINTS, LINK_BODIES, LINK_GEOMS, OBJECT, OBJECT_GEOM, OBJECT_JOINT, PALM, PALM_GEOM,
    PALM_JOINTS,
};
use super::super::xml::Element;
use super::MjcfOptions;
use super::drive::{Drive, spring};

/// A lamp above, in front of the hand and to the left of the camera, whose shadows tell how high things are.
pub(super) fn light() -> Element {
    Element::new("light")
        .set("pos", "0.4 -0.7 1.2")
        .set("dir", "-0.30 0.52 -0.80")
        .set("directional", true)
        .set("diffuse", "0.55 0.55 0.55")
        .set("specular", "0.2 0.2 0.2")
}

/// The view from one side, a little from above and from the thumb's end, that shows the floor and the palm up to 0.4 m.
pub(super) fn camera(hand: &HandDescription) -> Element {
    /// From the x axis towards the fingers, and up; rad.
    const AZIMUTH: f64 = -0.55;
    const ELEVATION: f64 = 0.28;
    /// From the eye to the middle of the scene, m.
    const DISTANCE: f64 = 0.78;
    let ((sin, cos), (rise, run)) = (AZIMUTH.sin_cos(), ELEVATION.sin_cos());
    let middle = [0.0, 0.0, 0.6 * hand.palm.home_height];
    let towards = [run * cos, run * sin, rise];
    let eye = [0, 1, 2].map(|i| middle[i] + DISTANCE * towards[i]);
    Element::new("camera")
        .set("name", CAMERA)
        .set_all("pos", &eye)
        .set_all("xyaxes", &[-sin, cos, 0.0, -rise * cos, -rise * sin, run])
        .set("fovy", 32)
}

/// The floor. Its sliding friction is the object's.
pub(super) fn floor(hand: &HandDescription) -> Element {
    let object = &hand.object;
    Element::new("geom")
        .set("name", FLOOR)
        .set("type", "plane")
        .set("size", "1 1 0.1")
        .set("material", "squares")
        .set("contype", 0)
        .set("conaffinity", 3)
        .set("condim", 6)
        .set("priority", 2)
        .set_all("friction", &[object.friction, object.torsional_friction, object.rolling_friction])
}

/// The palm on three slides. Its coordinates are its position in the world.
pub(super) fn palm(hand: &HandDescription) -> Element {
    let palm = &hand.palm;
    let middle = [0.0, 0.0, palm.half_size[2]];
    let home = [0.0, 0.0, palm.home_height];
    let slides = PALM_JOINTS.iter().enumerate().map(|(axis, name)| {
        let mut direction = [0.0; 3];
        direction[axis] = 1.0;
        Element::new("joint").set("name", name).set("type", "slide").set_all("axis", &direction).set("ref", home[axis])
    });
    let shape = Element::new("geom")
        .set("name", PALM_GEOM)
        .set("type", "box")
        .set_all("size", &palm.half_size)
        .set_all("pos", &middle);
    Element::new("body")
        .set("name", PALM)
        .set_all("pos", &home)
        .set("gravcomp", 1)
        .with(inertial(palm.mass, middle, palm.inertia()))
        .with_all(slides)
        .with(of_the_hand(shape).set("rgba", "0.30 0.32 0.35 1"))
}

/// Digit `index` with its two links. In the frame of a link z points along it and x is the joint's axis: closing is
/// positive.
pub(super) fn digit(hand: &HandDescription, index: usize, drive: &Drive) -> Element {
    let digit = hand.digits()[index];
    let (outward, (sin, cos)) = (digit.outward(), hand.joint.rest_angle.sin_cos());
    let distal = link(hand, 2 * index + 1, &digit.distal, drive).set_all("pos", &[0.0, 0.0, digit.proximal.length]);
    link(hand, 2 * index, &digit.proximal, drive)
        .set_all("pos", &digit.base)
        .set_all("xyaxes", &[-outward, 0.0, 0.0, 0.0, outward * cos, sin])
        .with(distal)
}

fn link(hand: &HandDescription, index: usize, link: &LinkDescription, drive: &Drive) -> Element {
    let stop = &hand.joint;
    let joint = Element::new("joint")
        .set("name", JOINTS[index])
        .set("type", "hinge")
        .set("axis", "1 0 0")
        .set_all("range", &stop.range)
        .set("damping", stop.damping)
        .set("armature", stop.armature)
        .set_all("solreflimit", &stop.stop);
    let shape = Element::new("geom")
        .set("name", LINK_GEOMS[index])
        .set("type", "capsule")
        .set_all("fromto", &[0.0, 0.0, 0.0, 0.0, 0.0, link.length])
        .set("size", link.radius);
    Element::new("body")
        .set("name", LINK_BODIES[index])
        .with(inertial(link.mass, [0.0, 0.0, link.centre], link.inertia))
        .with(spring(joint, index, drive))
        .with(of_the_hand(shape).set("rgba", link_colour(index)))
}

/// The thumb red, the fingers blue; distal links paler.
pub(in crate::hand) fn link_colour(index: usize) -> &'static str {
    match index {
        0 => "0.74 0.24 0.16 1",
        1 => "0.92 0.45 0.34 1",
        _ if index.is_multiple_of(2) => "0.13 0.36 0.62 1",
        _ => "0.36 0.60 0.85 1",
    }
}

/// A free body whose one geom the tasks edit.
pub(super) fn object(hand: &HandDescription) -> Element {
    let object = &hand.object;
    let moment = 0.4 * object.mass * object.radius * object.radius;
    let shape = Element::new("geom")
        .set("name", OBJECT_GEOM)
        .set("type", "sphere")
        .set("size", object.radius)
        .set("contype", 2)
        .set("conaffinity", 1)
        .set("condim", 4)
        .set("priority", 1)
        .set_all("friction", &[object.friction, object.torsional_friction, 0.0])
        .set("rgba", "0.95 0.72 0.16 1");
    Element::new("body")
        .set("name", OBJECT)
        .set_all("pos", &[0.0, 0.0, object.radius])
        .with(inertial(object.mass, [0.0; 3], [moment; 3]))
        .with(Element::new("freejoint").set("name", OBJECT_JOINT))
        .with(shape)
}

/// The keyframe: the open hand at its height, held there.
pub(super) fn home(hand: &HandDescription, options: &MjcfOptions) -> Element {
    let height = hand.palm.home_height;
    let mut pose = vec![0.0, 0.0, height];
    pose.extend([hand.joint.range[0]; JOINTS.len()]);
    if options.object {
        pose.extend([0.0, 0.0, hand.object.radius, 1.0, 0.0, 0.0, 0.0]);
    }
    let drives = match options.drive {
        Drive::JointTorque => JOINTS.len(),
        Drive::NativeTendon { .. } => super::DIGITS.len(),
    };
    let mut control = vec![0.0, 0.0, height];
    control.extend(std::iter::repeat_n(0.0, drives));
    let key = Element::new("key").set("name", HOME).set_all("qpos", &pose).set_all("ctrl", &control);
    Element::new("keyframe").with(key)
}

fn of_the_hand(shape: Element) -> Element {
    shape.set("contype", 1).set("conaffinity", 0)
}

fn inertial(mass: f64, centre: [f64; 3], inertia: [f64; 3]) -> Element {
    Element::new("inertial").set("mass", mass).set_all("pos", &centre).set_all("diaginertia", &inertia)
}
