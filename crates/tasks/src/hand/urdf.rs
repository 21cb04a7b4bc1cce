//! The hand's links and joints as a URDF, for planners and viewers.
//!
//! A URDF knows neither springs nor tendons, and its joints are taken for driven ones: the transmission is in the MJCF alone.

use std::f64::consts::PI;

use super::description::{FingerDescription, HandDescription, LinkDescription};
use super::error::HandError;
use super::mjcf::link_colour;
use super::names::{JOINTS, KIND_OF_JOINT, LINK_BODIES, LINK_PARTS, MOUNT_PARTS, PALM, PALM_PART, PULLEY_PARTS};
use super::space::DESIGN_LEN;
use super::xml::Element;

/// The link that the palm is fixed to; it has no mass, as some readers want of the first one.
const BASE: &str = "base";

/// The links with their inertias, joints with their limits, capsules to collide with and the meshes of
/// the printed parts, `NAME.stl` in millimetres beside the file. Frames, names, masses and inertias are those of
/// [`mjcf`](super::mjcf); `design` (SI) says how strong and how fast the joints can be.
pub fn urdf(hand: &HandDescription, design: &[f64; DESIGN_LEN]) -> Result<String, HandError> {
    hand.check()?;
    let fixed =
        Element::new("joint").set("name", "palm_mount").set("type", "fixed").with(parent(BASE)).with(child(PALM));
    let digits = hand.digits().into_iter().enumerate().flat_map(|(index, digit)| {
        let (first, second) = (2 * index, 2 * index + 1);
        [
            link(first, &digit.proximal),
            joint(hand, design, first, PALM, base(hand, digit)),
            link(second, &digit.distal),
            joint(hand, design, second, LINK_BODIES[first], origin([0.0, 0.0, digit.proximal.length], [0.0; 3])),
        ]
    });
    let robot = Element::new("robot")
        .set("name", "underactuated_hand")
        .with(Element::new("link").set("name", BASE))
        .with(palm(hand))
        .with(fixed)
        .with_all(digits);
    Ok(format!("<?xml version=\"1.0\"?>\n{}", robot.to_text()))
}

fn palm(hand: &HandDescription) -> Element {
    let palm = &hand.palm;
    let size = palm.half_size.map(|half| 2.0 * half);
    let middle = [0.0, 0.0, palm.half_size[2]];
    Element::new("link")
        .set("name", PALM)
        .with(inertial(palm.mass, middle, palm.inertia()))
        .with(visual(PALM_PART, "0.30 0.32 0.35 1"))
        .with_all(MOUNT_PARTS.map(|part| visual(part, "0.55 0.57 0.60 1")))
        .with(collision(middle, Element::new("box").set_all("size", &size)))
}

/// A capsule is a cylinder and two spheres.
fn link(index: usize, link: &LinkDescription) -> Element {
    let kind = KIND_OF_JOINT[index];
    let sphere = || Element::new("sphere").set("radius", link.radius);
    let cylinder = Element::new("cylinder").set("radius", link.radius).set("length", link.length);
    let [x, y, z] = link.inertia;
    Element::new("link")
        .set("name", LINK_BODIES[index])
        .with(inertial(link.mass, [0.0, 0.0, link.centre], [x, y, z]))
        .with(visual(LINK_PARTS[kind], link_colour(index)))
        .with(visual(PULLEY_PARTS[kind], "0.85 0.85 0.85 1"))
        .with(collision([0.0, 0.0, 0.5 * link.length], cylinder))
        .with(collision([0.0; 3], sphere()))
        .with(collision([0.0, 0.0, link.length], sphere()))
}

fn joint(hand: &HandDescription, design: &[f64; DESIGN_LEN], index: usize, from: &str, origin: Element) -> Element {
    let (joint, motor, radius) = (&hand.joint, &hand.transmission, design[KIND_OF_JOINT[index]]);
    let limit = Element::new("limit")
        .set("lower", joint.range[0])
        .set("upper", joint.range[1])
        .set("effort", motor.tension_limit * radius)
        .set("velocity", motor.step_limit / hand.step_time() / radius);
    Element::new("joint")
        .set("name", JOINTS[index])
        .set("type", "revolute")
        .with(parent(from))
        .with(child(LINK_BODIES[index]))
        .with(origin)
        .with(Element::new("axis").set("xyz", "1 0 0"))
        .with(limit)
        .with(Element::new("dynamics").set("damping", joint.damping))
}

/// Where a digit begins on the palm: z along the open link, x along the joint's axis. Turned about x, then about z for
/// digits that open along y.
fn base(hand: &HandDescription, digit: &FingerDescription) -> Element {
    let yaw = if digit.outward() > 0.0 { PI } else { 0.0 };
    origin(digit.base, [PI - hand.joint.rest_angle, 0.0, yaw])
}

fn origin(position: [f64; 3], angles: [f64; 3]) -> Element {
    Element::new("origin").set_all("xyz", &position).set_all("rpy", &angles)
}

fn inertial(mass: f64, centre: [f64; 3], [xx, yy, zz]: [f64; 3]) -> Element {
    let moments =
        Element::new("inertia").set("ixx", xx).set("ixy", 0).set("ixz", 0).set("iyy", yy).set("iyz", 0).set("izz", zz);
    Element::new("inertial").with(origin(centre, [0.0; 3])).with(Element::new("mass").set("value", mass)).with(moments)
}

fn visual(part: &str, rgba: &str) -> Element {
    let mesh = Element::new("mesh").set("filename", format_args!("{part}.stl")).set("scale", "0.001 0.001 0.001");
    let material = Element::new("material").set("name", format_args!("{part}_colour"));
    Element::new("visual")
        .with(Element::new("geometry").with(mesh))
        .with(material.with(Element::new("color").set("rgba", rgba)))
}

fn collision(centre: [f64; 3], shape: Element) -> Element {
    Element::new("collision").with(origin(centre, [0.0; 3])).with(Element::new("geometry").with(shape))
}

fn parent(link: &str) -> Element {
    Element::new("parent").set("link", link)
}

fn child(link: &str) -> Element {
    Element::new("child").set("link", link)
}

#[cfg(test)]
mod tests {
    use super::super::space::SEARCHED;
    use super::*;

    fn text() -> String {
        urdf(&HandDescription::default(), &SEARCHED).unwrap()
    }

    #[test]
    fn every_link_and_joint_is_there_once_and_every_mesh_is_a_part() {
        let text = text();
        let named = |tag: &str, name: &str| text.matches(&format!("<{tag} name=\"{name}\"")).count();
        for name in LINK_BODIES.into_iter().chain([BASE, PALM]) {
            assert_eq!(named("link", name), 1, "{name}");
        }
        assert_eq!(text.matches("<link name").count(), 8);
        for name in JOINTS {
            assert_eq!(named("joint", name), 1, "{name}");
        }
        for (kind, count) in [1, 1, 2, 2].into_iter().enumerate() {
            for part in [LINK_PARTS[kind], PULLEY_PARTS[kind]] {
                assert_eq!(text.matches(&format!("filename=\"{part}.stl\"")).count(), count, "{part}");
            }
        }
        for part in MOUNT_PARTS.into_iter().chain([PALM_PART]) {
            assert_eq!(text.matches(&format!("filename=\"{part}.stl\"")).count(), 1, "{part}");
        }
        assert_eq!(text.matches("<mesh ").count(), 19);
    }

    /// All of the tension in one tendon, all of the motor's speed: 75 N and 0.2 mm in 10 ms, over 10.9 mm.
    #[test]
    fn joints_are_as_strong_and_fast_as_their_pulleys_let_them() {
        let text = text();
        let limit =
            text.split("<joint name=\"thumb_proximal\"").nth(1).and_then(|rest| rest.split("<limit").nth(1)).unwrap();
        let number = |key: &str| -> f64 {
            limit.split(&format!("{key}=\"")).nth(1).and_then(|rest| rest.split('"').next()).unwrap().parse().unwrap()
        };
        assert_eq!((number("lower"), number("upper")), (0.0, 1.57));
        assert!((number("effort") - 0.8175).abs() < 1e-12 && (number("velocity") - 0.02 / 0.0109).abs() < 1e-12);
    }
}
