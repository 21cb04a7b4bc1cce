//! What URDF lacks, added.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use common::{files, path};
use hwasp_mujoco::engine::{BuildError, Drive, JointType, Spec};

const INERTIA: &str = r#"<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/>"#;

/// A base, a link on a hinge, a link on a slide, and a tool that is fixed to it.
fn robot() -> String {
    let link = |name: &str, mass: f64| {
        format!(
            r#"<link name="{name}"><inertial><origin xyz="0 0 0.1"/><mass value="{mass}"/>{INERTIA}</inertial>
               <visual><geometry><sphere radius="0.02"/></geometry></visual>
               <collision><geometry><box size="0.1 0.1 0.2"/></geometry></collision></link>"#
        )
    };
    let joint = |name: &str, kind: &str, parent: &str, child: &str| {
        format!(
            r#"<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/><origin xyz="0 0 0.2"/>
               <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="5" velocity="1"/></joint>"#
        )
    };
    let links =
        [("base", 3.0), ("arm", 1.0), ("hand", 0.5), ("tool", 0.2)].map(|(name, mass)| link(name, mass)).concat();
    let joints = joint("shoulder", "revolute", "base", "arm")
        + &joint("wrist", "prismatic", "arm", "hand")
        + &joint("mount", "fixed", "hand", "tool");
    format!("<robot name=\"arm\">{links}{joints}</robot>")
}

fn parse(text: &str) -> Result<Spec, BuildError> {
    Spec::parse("arm.urdf", &files(&[("arm.urdf", text)]))
}

#[test]
fn a_urdf_becomes_a_robot_on_a_floor() {
    let mut spec = parse(&robot()).unwrap();
    spec.add_floor().unwrap();
    spec.free_base().unwrap();
    spec.add_motor("shoulder", "lift", 2.0, [-3.0, 4.0]).unwrap();
    spec.add_motor("wrist", "push", 10.0, [-1.0, 1.0]).unwrap();
    // Fixed links keep their names.
    assert_eq!(spec.field(&path("body.tool.pos.z")), Ok(0.2));
    spec.set(&path("body.base.pos.z"), 0.3).unwrap();
    let mut simulation = spec.compile().unwrap();
    let inventory = simulation.inventory();
    let kinds: Vec<_> = inventory.joints.iter().map(|joint| (joint.name.as_deref().unwrap(), joint.kind)).collect();
    assert_eq!(kinds, [("root", JointType::Free), ("shoulder", JointType::Hinge), ("wrist", JointType::Slide)]);
    assert_eq!((inventory.nq, inventory.nv, inventory.nu), (9, 8, 2));
    assert!((inventory.bodies[1].subtree_mass - 4.7).abs() < 1e-12);
    let [lift, push] = &inventory.actuators[..] else { panic!("{:?}", inventory.actuators) };
    assert_eq!(lift.drives, Drive::Joint(1, Some("shoulder".to_owned())));
    assert_eq!((lift.gear, lift.control_range), (2.0, Some([-3.0, 4.0])));
    assert_eq!((push.gear, push.controls.clone()), (10.0, 1..2));

    // It falls on the floor and stays on it.
    let base = simulation.body("base").unwrap();
    simulation.step(1500).unwrap();
    simulation.forward().unwrap();
    let height = simulation.body_position(base)[2];
    assert!(height > -0.01 && height < 0.25, "{height}");
    simulation.ctrl_mut()[0] = 1.5;
    simulation.forward().unwrap();
    assert!((simulation.qfrc_actuator()[6] - 3.0).abs() < 1e-12, "{:?}", simulation.qfrc_actuator());
}

/// By default the base is fixed to the world, as URDF has it.
#[test]
fn a_base_is_fixed_until_it_is_let_free() {
    let mut spec = parse(&robot()).unwrap();
    assert_eq!(spec.compile().unwrap().inventory().nv, 2);
    spec.free_base().unwrap();
    assert_eq!(spec.compile().unwrap().inventory().nv, 8);
    assert_eq!(spec.free_base().unwrap_err().to_string(), "the base `base` has a joint already");
}

#[test]
fn a_moving_link_without_inertia_is_told() {
    let text = robot().replacen("<mass value=\"0.5\"/>", "<mass value=\"0\"/>", 1);
    let bare = text.replace(INERTIA, r#"<inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/>"#);
    let error = parse(&bare).and_then(|mut spec| spec.compile()).unwrap_err();
    assert!(matches!(&error, BuildError::NoInertia { body, .. } if body == "arm"), "{error}");
    assert_eq!(
        error.to_string(),
        "arm.urdf: the body `arm` moves and has no mass or no inertia; give the link an `<inertial>` with mass and inertia \
         (URDF), or the body a geom with mass (MJCF)"
    );
}

#[test]
fn what_cannot_be_added_is_told() {
    let mut spec = parse(&robot()).unwrap();
    spec.add_floor().unwrap();
    spec.add_motor("shoulder", "lift", 1.0, [-1.0, 1.0]).unwrap();
    spec.free_base().unwrap();
    let messages = [
        spec.add_floor(),
        spec.add_motor("sholder", "turn", 1.0, [-1.0, 1.0]),
        spec.add_motor("root", "turn", 1.0, [-1.0, 1.0]),
        spec.add_motor("wrist", "lift", 1.0, [-1.0, 1.0]),
        spec.add_motor("wrist", "", 1.0, [-1.0, 1.0]),
        spec.add_motor("wrist", "a\0b", 1.0, [-1.0, 1.0]),
        spec.add_motor("wrist", "turn", f64::NAN, [-1.0, 1.0]),
        spec.add_motor("wrist", "turn", 1.0, [1.0, 1.0]),
        spec.add_motor("wrist", "turn", 1.0, [0.0, f64::INFINITY]),
    ]
    .map(|result| result.unwrap_err().to_string());
    assert_eq!(
        messages,
        [
            "the name `floor` is taken by another geom",
            "the model has no joint `sholder`; did you mean `shoulder`?; it has: root, shoulder, wrist",
            "a motor drives a hinge or a slide; `root` is a ball or free joint",
            "the name `lift` is taken by another actuator",
            "\"\" is no name (for the new actuator)",
            "\"a\\0b\" is no name (for the new actuator)",
            "the gear NaN of the motor `turn` is outside [-1e9, 1e9]",
            "the limits [1, 1] of the motor `turn` are no range within [-1e9, 1e9]",
            "the limits [0, inf] of the motor `turn` are no range within [-1e9, 1e9]",
        ]
    );
    spec.compile().unwrap();
    let mut two = common::spec(
        "<mujoco><worldbody><body name='a'><geom size='1'/></body><body name='b'><geom size='1'/></body></worldbody></mujoco>",
    );
    assert_eq!(
        two.free_base().unwrap_err().to_string(),
        "the world has several bodies (a, b); only a robot with one base can be let free"
    );
    assert!(common::spec("<mujoco/>").free_base().is_err());
}
