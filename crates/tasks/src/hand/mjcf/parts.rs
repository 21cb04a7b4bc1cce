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

/// A lamp above.
pub(super) fn light() -> Element {
    Element::new("light").set("pos", "0.3 -0.3 1").set("dir", "-0.3 0.3 -1").set("diffuse", "0.4 0.4 0.4")
}

/// The view from the side, a little in front of the thumb, that shows floor, object and palm.
pub(super) fn camera(hand: &HandDescription) -> Element {
    let middle = 0.5 * hand.palm.home_height;
    Element::new("camera")
        .set("name", CAMERA)
        .set_all("pos", &[0.50, -0.22, middle + 0.10])
        // Level, and aimed at the middle between palm and floor.
        .set("xyaxes", "0.22 0.5 0 -0.05 0.022 0.2984")
        .set("fovy", 45)
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
    let (palm, [x, y, z]) = (&hand.palm, hand.palm.half_size);
    // A solid box; as it does not turn, nothing depends on it.
    let inertia = [y * y + z * z, x * x + z * z, x * x + y * y].map(|sum| palm.mass / 3.0 * sum);
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
        .set_all("pos", &[0.0, 0.0, z]);
    Element::new("body")
        .set("name", PALM)
        .set_all("pos", &home)
        .set("gravcomp", 1)
        .with(inertial(palm.mass, [0.0, 0.0, z], inertia))
        .with_all(slides)
        .with(of_the_hand(shape).set("rgba", "0.35 0.37 0.40 1"))
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
    let colour = if index.is_multiple_of(2) { "0.25 0.45 0.70 1" } else { "0.45 0.65 0.85 1" };
    Element::new("body")
        .set("name", LINK_BODIES[index])
        .with(inertial(link.mass, [0.0, 0.0, link.centre], link.inertia))
        .with(spring(joint, index, drive))
        .with(of_the_hand(shape).set("rgba", colour))
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
        .set("rgba", "0.90 0.55 0.20 1");
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
