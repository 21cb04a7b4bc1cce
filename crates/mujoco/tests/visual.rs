//! Leaving out what is only seen: masses and motion stay to the bit, and designs keep their effect.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use common::{HOPPER, files, mesh, path, run, spec};
use hwasp_mujoco::engine::{Inventory, Spec};

fn geoms(inventory: &Inventory) -> Vec<&str> {
    inventory.geoms.iter().map(|geom| geom.name.as_deref().unwrap_or_default()).collect()
}

/// The badge gives the torso mass, so it stays; the sock is on a body with an inertia of its own, and goes.
#[test]
fn masses_and_motion_stay_to_the_bit() {
    for mode in ["auto", "true"] {
        let text = HOPPER.replace("inertiafromgeom=\"auto\"", &format!("inertiafromgeom=\"{mode}\""));
        let (mut full, mut lean) = (spec(&text), spec(&text));
        assert!(lean.discard_visual().unwrap(), "{mode}");
        let (mut a, mut b) = (full.compile().unwrap(), lean.compile().unwrap());
        let (full, kept) = (a.inventory(), b.inventory());
        assert_eq!(full.bodies, kept.bodies, "{mode}");
        assert_eq!(run(&mut a, 100), run(&mut b, 100), "{mode}");
        let gone: Vec<&str> = geoms(&full).into_iter().filter(|geom| !geoms(&kept).contains(geom)).collect();
        // Where all inertias follow from geoms, that of the foot does too.
        assert_eq!(gone, if mode == "auto" { vec!["sock"] } else { vec![] });
        assert!(!lean.to_mjcf().unwrap().contains("<texture"));
        spec(&lean.to_mjcf().unwrap()).compile().unwrap();
    }
}

/// A longer leg weighs more, whether the visuals are there or not.
#[test]
fn designs_keep_their_effect() {
    let changed = |lean: bool| {
        let mut spec = spec(HOPPER);
        assert!(!lean || spec.discard_visual().unwrap());
        for (text, value) in [("geom.torso.size[1]", 0.3), ("geom.shin.size[1]", 0.3), ("geom.badge.size[0]", 0.05)] {
            spec.set(&path(text), value).unwrap();
        }
        spec.compile().unwrap()
    };
    let (mut full, mut lean) = (changed(false), changed(true));
    assert_eq!(full.inventory().bodies, lean.inventory().bodies);
    assert_eq!(run(&mut full, 100), run(&mut lean, 100));
}

#[test]
fn meshes_that_are_only_seen_go() {
    let text = r#"<mujoco><asset><mesh name="seen" file="seen.obj"/><mesh name="felt" file="felt.obj"/></asset><worldbody>
        <body name="part"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><freejoint/>
        <geom name="seen" type="mesh" mesh="seen" contype="0" conaffinity="0"/><geom name="felt" type="mesh" mesh="felt"/></body>
        </worldbody></mujoco>"#;
    let set = files(&[("m.xml", text), ("seen.obj", &mesh(0.1)), ("felt.obj", &mesh(0.2))]);
    let mut spec = Spec::parse("m.xml", &set).unwrap();
    assert!(spec.discard_visual().unwrap());
    let inventory = spec.compile().unwrap().inventory();
    assert_eq!(geoms(&inventory), ["felt"]);
    let written = spec.to_mjcf().unwrap();
    assert!(written.contains("felt.obj") && !written.contains("seen.obj"), "{written}");
}

/// What something else names stays: a geom of a sensor, the geom that a tendon goes around.
#[test]
fn what_is_named_stays() {
    let mut spec = spec(
        r#"<mujoco><worldbody><site name="a" pos="-0.2 0 1"/><body name="arm" pos="0 0 1"><joint name="j" axis="0 1 0"/>
           <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
           <geom name="pulley" type="cylinder" size="0.05 0.02" euler="90 0 0" contype="0" conaffinity="0"/>
           <geom name="seen" size="0.02" contype="0" conaffinity="0"/>
           <geom name="target" size="0.02" contype="0" conaffinity="0"/><site name="b" pos="0.1 0 0"/></body></worldbody>
           <tendon><spatial name="t"><site site="a"/><geom geom="pulley"/><site site="b"/></spatial></tendon>
           <sensor><framepos name="s" objtype="geom" objname="target"/></sensor></mujoco>"#,
    );
    let length = |spec: &mut Spec| {
        let mut simulation = spec.compile().unwrap();
        simulation.forward().unwrap();
        simulation.tendon_length(simulation.tendon("t").unwrap()).to_bits()
    };
    let before = length(&mut spec);
    assert!(spec.discard_visual().unwrap());
    assert_eq!(length(&mut spec), before);
    assert_eq!(geoms(&spec.compile().unwrap().inventory()), ["pulley", "target"]);
}

#[test]
fn a_model_that_does_not_compile_is_an_error() {
    let mut spec = spec("<mujoco><worldbody><body name='b'><freejoint/></body></worldbody></mujoco>");
    assert!(spec.discard_visual().unwrap_err().to_string().contains("`b` moves and has no mass"));
}
