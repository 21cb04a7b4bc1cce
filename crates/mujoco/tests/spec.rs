//! Numbers of a model, set by name before it is compiled.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use std::f64::consts::PI;

use common::{HOPPER, files, path, run, spec};
use hwasp_mujoco::engine::{BuildError, Kind, Quantity, Spec, SpecError};

fn message(result: Result<impl std::fmt::Debug, SpecError>) -> String {
    result.unwrap_err().to_string()
}

#[test]
fn values_are_those_of_the_text_in_si() {
    let spec = spec(HOPPER);
    for (text, value) in [
        ("geom.shin.size[1]", 0.25),
        ("geom.foot.fromto[3]", 0.2),
        ("geom.shin.friction", 0.9),
        ("geom.shin.density", 1000.0),
        ("body.shin.pos.z", -0.45),
        ("body.foot.mass", 0.7),
        ("body.foot.inertia[1]", 0.002),
        ("body.foot.euler[1]", 5.0 * PI / 180.0),
        ("site.toe.pos.x", 0.2),
        ("joint.knee.springref", -20.0 * PI / 180.0),
        ("joint.knee.range[0]", -150.0 * PI / 180.0),
        ("joint.knee.armature", 0.5),
        ("joint.rootx.axis[0]", 1.0),
        ("actuator.#0.gear", 200.0),
        ("actuator.knee.gear", 150.0),
        ("actuator.ankle.biasprm[1]", -40.0),
        ("actuator.hip.ctrlrange[1]", 1.0),
        ("option.gravity[2]", -9.81),
        ("option.timestep", 0.002),
    ] {
        let read = spec.field(&path(text)).unwrap();
        assert!((read - value).abs() < 1e-15, "{text}: {read}");
    }
    assert_eq!(
        message(spec.field(&path("geom.shin.mass"))),
        "`geom.shin.mass` has no value: the text gives none, so the compiler computes it"
    );
}

/// A longer shin, a heavier foot, another spring and another gear, and what the compiler makes of them.
#[test]
fn what_is_set_is_compiled() {
    let mut spec = spec(HOPPER);
    let before = spec.compile().unwrap();
    for (text, value) in [
        ("geom.shin.size[1]", 0.35),
        ("geom.shin.pos.z", -0.35),
        ("body.foot.pos.z", -0.7),
        ("body.foot.mass", 0.9),
        ("joint.knee.springref", -1.0),
        ("joint.knee.range[0]", -2.0),
        ("actuator.knee.gear", 90.0),
        ("option.timestep", 0.001),
    ] {
        spec.set(&path(text), value).unwrap();
        assert!((spec.field(&path(text)).unwrap() - value).abs() < 1e-15, "{text}");
    }
    let after = spec.compile().unwrap();
    // A capsule: a cylinder and the two halves of a sphere.
    let capsule = |half: f64| 1000.0 * PI * 0.04_f64.powi(2) * (2.0 * half + 4.0 / 3.0 * 0.04);
    let mass = |of: &hwasp_mujoco::engine::Simulation, name: &str| of.mass(of.body(name).unwrap());
    assert!((mass(&before, "shin") - capsule(0.25)).abs() < 1e-12);
    assert!((mass(&after, "shin") - capsule(0.35)).abs() < 1e-12);
    assert!((mass(&after, "foot") - 0.9).abs() < 1e-15);
    let inventory = after.inventory();
    let knee = inventory.joints.iter().find(|joint| joint.name.as_deref() == Some("knee")).unwrap();
    assert!(knee.range.is_some_and(|[low, high]| (low + 2.0).abs() < 1e-15 && high == 0.0));
    assert_eq!((inventory.timestep, inventory.actuators[1].gear), (0.001, 90.0));
}

/// Setting what is there already changes no bit, and a changed model compiled again moves like one whose text is changed.
#[test]
fn a_changed_model_moves_like_a_changed_text() {
    let mut original = spec(HOPPER);
    let plain = run(&mut original.compile().unwrap(), 100);
    let mut changed = spec(HOPPER);
    for text in ["geom.shin.size[1]", "body.foot.pos.z", "joint.knee.stiffness", "actuator.knee.gear"] {
        let value = changed.field(&path(text)).unwrap();
        changed.set(&path(text), value).unwrap();
    }
    assert_eq!(run(&mut changed.compile().unwrap(), 100), plain);
    changed.set(&path("geom.shin.size[1]"), 0.3).unwrap();
    let longer = run(&mut changed.compile().unwrap(), 100);
    assert_ne!(longer, plain);
    let mut text = spec(&HOPPER.replace("size=\"0.04 0.25\"", "size=\"0.04 0.3\""));
    assert_eq!(run(&mut text.compile().unwrap(), 100), longer);
    changed.set(&path("geom.shin.size[1]"), 0.25).unwrap();
    assert_eq!(run(&mut changed.compile().unwrap(), 100), plain);
}

#[test]
fn elements_go_by_name_by_joint_and_by_index() {
    let mut spec = spec(
        r#"<mujoco><worldbody><body name="a"><joint name="j"/><joint name="k" axis="0 1 0"/><geom size="0.1"/><geom size="0.2"/>
             </body></worldbody><actuator><motor joint="j"/><motor joint="j" gear="2"/><motor joint="k" gear="3"/>
             <motor name="j2" joint="k" gear="4"/></actuator></mujoco>"#,
    );
    assert_eq!(spec.field(&path("actuator.k.gear")), Ok(3.0));
    assert_eq!(spec.field(&path("actuator.j2.gear")), Ok(4.0));
    assert_eq!(spec.field(&path("geom.#1.size[0]")), Ok(0.2));
    assert_eq!(
        message(spec.field(&path("actuator.j.gear"))),
        "2 actuators without a name drive `j`; say which by its index, such as `actuator.#0`"
    );
    assert_eq!(
        message(spec.set(&path("geom.shin.size[0]"), 1.0)),
        "the model has no geom `shin`; it has 2 without a name: `geom.#0` to `geom.#1`"
    );
    assert_eq!(
        message(spec.field(&path("joint.i.armature"))),
        "the model has no joint `i`; did you mean `j`?; it has: j, k"
    );
    assert!(message(spec.field(&path("geom.#2.mass"))).starts_with("the model has no geom `#2`"));
    assert_eq!(message(spec.field(&path("tendon.flexor.width"))), "the model has no tendon `flexor`; it has no tendon");
    // The indices are those of the compiled model.
    let names: Vec<_> = spec.compile().unwrap().inventory().bodies.into_iter().map(|body| body.name).collect();
    assert_eq!(names, spec.names(Kind::Body).into_iter().map(Some).collect::<Vec<_>>());
    let mut hopper = common::spec(HOPPER);
    let compiled = hopper.compile().unwrap().inventory();
    let geoms: Vec<_> = compiled.geoms.into_iter().map(|geom| geom.name.unwrap()).collect();
    assert_eq!(hopper.names(Kind::Geom), geoms);
    assert_eq!(hopper.names(Kind::Actuator), ["hip", "knee", "ankle"]);
}

#[test]
fn a_value_outside_its_limits_is_told_with_them() {
    let mut spec = spec(HOPPER);
    for (text, value, said) in [
        ("geom.shin.size[0]", -0.1, "`geom.shin.size[0]` = -0.1 m is outside (0, 10000]"),
        ("geom.shin.size[0]", 0.0, "= 0 m is outside (0, 10000]"),
        ("geom.shin.size[0]", f64::NAN, "= NaN m is outside"),
        ("body.shin.pos.z", f64::INFINITY, "`body.shin.pos[2]` = inf m is outside [-10000, 10000]"),
        ("joint.knee.stiffness", -1.0, "`joint.knee.stiffness` = -1 N·m/rad is outside [0, 1000000000]"),
        ("joint.rootx.damping", -1.0, "= -1 N·s/m is outside [0, 1000000000]"),
        ("body.foot.mass", 0.0, "`body.foot.mass` = 0 kg is outside (0, 1000000]"),
        ("option.timestep", 0.0, "`option.timestep` = 0 s is outside [0.000001, 1]"),
    ] {
        let error = message(spec.set(&path(text), value));
        assert!(error.ends_with(said) || error.contains(said), "{text}: {error}");
    }
    assert_eq!(spec.limits(&path("geom.shin.size[0]")), Ok([0.0, 1e4]));
    assert_eq!(spec.quantity(&path("joint.knee.springref")), Ok(Quantity::Angle));
    assert_eq!(spec.quantity(&path("joint.rootx.springref")), Ok(Quantity::Length));
    assert_eq!(spec.quantity(&path("geom.shin.friction")), Ok(Quantity::Number));
    assert_eq!(spec.quantity(&path("geom.shin.friction[1]")), Ok(Quantity::Length));
}

#[test]
fn ranges_are_compared_when_both_ends_are_set() {
    let mut spec = spec(HOPPER);
    let [low, high] = ["joint.knee.range[0]", "joint.knee.range[1]"].map(path);
    // Both ends move up, the lower one first.
    spec.set(&low, 0.5).unwrap();
    assert_eq!(
        spec.compile().unwrap_err().to_string(),
        "the range `joint.knee.range` runs from 0.5 rad to 0 rad; its first number has to be below its second"
    );
    spec.set(&high, 0.7).unwrap();
    spec.compile().unwrap();
    let text = path("actuator.hip.ctrlrange[0]");
    spec.set(&text, 1.0).unwrap();
    assert!(matches!(spec.compile(), Err(BuildError::Range { .. })));
    spec.set(&text, -1.0).unwrap();
    spec.compile().unwrap();
}

#[test]
fn a_field_without_effect_is_refused() {
    let mut spec = spec(HOPPER);
    for (text, said) in [
        (
            "body.shin.mass",
            "the body's mass and inertia follow from its geoms; set `mass`, `density` or `size` of a geom",
        ),
        ("body.shin.ipos.x", "follow from its geoms"),
        ("body.foot.fullinertia[0]", "written as its diagonal; set `inertia`"),
        ("body.foot.quat[1]", "the orientation is written as `euler`; set that"),
        ("body.shin.euler[1]", "the orientation is written as `quat`; set that"),
        ("body.world.pos.x", "the world stays where it is"),
        ("geom.foot.density", "the body has an `inertial` of its own"),
        ("geom.floor.mass", "belongs to the world"),
        ("geom.foot.pos.x", "`fromto` says the place; set that"),
        ("geom.foot.size[1]", "`fromto` says the length"),
        ("geom.shin.fromto[0]", "the place is written as `pos`"),
        ("geom.shin.size[2]", "a capsule has two sizes, radius and half length"),
        ("geom.badge.size[1]", "a sphere has one size, its radius"),
        ("joint.rootx.range[0]", "limited=\"false\""),
        ("actuator.ankle.cranklength", "slider-crank"),
    ] {
        let result = spec.set(&path(text), 0.5);
        if text.starts_with("joint.rootx") {
            // Its limits are found out by the engine: a range makes them.
            result.unwrap();
            continue;
        }
        let error = message(result);
        assert!(error.contains("has no effect") && error.contains(said), "{text}: {error}");
    }
    let mut limited = common::spec(
        r#"<mujoco><worldbody><body name="a"><joint name="j" limited="false" springdamper="1 1"/><geom name="g" size="0.1" mass="1"/>
           </body><body name="b"><freejoint name="f"/><geom size="0.1"/></body></worldbody></mujoco>"#,
    );
    for (text, said) in [
        ("joint.j.range[0]", "the element has `limited=\"false\"`"),
        ("joint.j.stiffness", "`springdamper` says it"),
        ("joint.f.pos.x", "a free joint has no anchor"),
        ("joint.f.axis[0]", "only hinges and slides have it"),
        ("geom.g.density", "the geom has a mass; set `mass`"),
    ] {
        let error = message(limited.set(&path(text), 0.5));
        assert!(error.contains(said), "{text}: {error}");
    }
}

/// Springs of tendons rest where they are, until a length is set.
#[test]
fn a_springlength_is_set_as_a_whole() {
    let mut spec = spec(
        r#"<mujoco><worldbody><site name="s" pos="0 0 1"/><body name="a"><joint name="j" type="slide"/><geom size="0.1"/>
           <site name="t"/></body></worldbody><tendon><spatial name="t" stiffness="10"><site site="s"/><site site="t"/></spatial>
           </tendon></mujoco>"#,
    );
    let [low, high] = ["tendon.t.springlength", "tendon.t.springlength[1]"].map(path);
    assert!(matches!(spec.field(&low), Err(SpecError::Unset { .. })));
    spec.set(&low, 0.4).unwrap();
    assert_eq!((spec.field(&low), spec.field(&high)), (Ok(0.4), Ok(0.4)));
    let mut simulation = spec.compile().unwrap();
    simulation.forward().unwrap();
    // One metre long, 0.6 m too long, pulled up along z.
    assert!((simulation.qfrc_passive()[0] - 6.0).abs() < 1e-12, "{:?}", simulation.qfrc_passive());
    spec.set(&high, 0.9).unwrap();
    let mut simulation = spec.compile().unwrap();
    simulation.forward().unwrap();
    assert!((simulation.qfrc_passive()[0] - 1.0).abs() < 1e-12);
    spec.set(&low, 1.5).unwrap();
    assert!(matches!(spec.compile(), Err(BuildError::Range { .. })));
}

/// Parts from another file have the units of that file.
#[test]
fn attached_parts_keep_their_degrees() {
    let set = files(&[
        (
            "main.xml",
            r#"<mujoco><compiler angle="radian"/><asset><model name="arm" file="arm.xml"/></asset><worldbody><frame>
               <attach model="arm" body="arm" prefix="left_"/></frame></worldbody></mujoco>"#,
        ),
        (
            "arm.xml",
            r#"<mujoco><compiler angle="degree"/><worldbody><body name="arm"><joint name="j" range="-90 90"/>
               <geom name="g" size="0.1"/></body></worldbody></mujoco>"#,
        ),
    ]);
    let mut spec = Spec::parse("main.xml", &set).unwrap();
    let high = path("joint.left_j.range[1]");
    assert!((spec.field(&high).unwrap() - PI / 2.0).abs() < 1e-15);
    spec.set(&high, 1.0).unwrap();
    let range = spec.compile().unwrap().inventory().joints[0].range.unwrap();
    assert!((range[0] + PI / 2.0).abs() < 1e-15 && (range[1] - 1.0).abs() < 1e-15, "{range:?}");
    let mass = |spec: &mut Spec| spec.compile().unwrap().inventory().bodies[1].mass;
    let before = mass(&mut spec);
    spec.set(&path("geom.left_g.size[0]"), 0.2).unwrap();
    assert!((mass(&mut spec) / before - 8.0).abs() < 1e-12);
}

/// The text holds 15 digits, and asks for the same files.
#[test]
fn a_written_model_is_the_same_model() {
    let mut spec = spec(HOPPER);
    spec.set(&path("geom.shin.size[1]"), 0.123_456_789_012_345).unwrap();
    let text = spec.to_mjcf().unwrap();
    assert!(text.contains("0.123456789012345"), "{text}");
    let mut again = common::spec(&text);
    let (a, b) = (spec.compile().unwrap().inventory(), again.compile().unwrap().inventory());
    for (a, b) in a.bodies.iter().zip(&b.bodies) {
        assert!((a.mass - b.mass).abs() <= 1e-13 * a.mass, "{a:?} {b:?}");
    }
    assert_eq!((a.joints.len(), a.nu, a.timestep), (b.joints.len(), b.nu, b.timestep));
    assert_eq!(again.field(&path("geom.shin.size[1]")), Ok(0.123_456_789_012_345));
    let name = |spec: &Spec| spec.files().paths().map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(name(&spec), ["model.xml"]);
}

/// Where the text asks the compiler to fuse bodies, they can still be named afterwards.
#[test]
fn fused_bodies_can_still_be_named() {
    let mut spec = spec(
        r#"<mujoco><compiler fusestatic="true"/><worldbody><body name="arm"><joint name="j"/><geom name="g" size="0.1"/>
           <body name="tool" pos="0.1 0 0"><geom name="tool" size="0.05"/></body></body></worldbody></mujoco>"#,
    );
    let mass = |spec: &mut Spec| spec.compile().unwrap().inventory().bodies[1].mass;
    let before = mass(&mut spec);
    assert_eq!(spec.compile().unwrap().inventory().bodies.len(), 2);
    spec.set(&path("geom.tool.size[0]"), 0.1).unwrap();
    assert!(mass(&mut spec) > before);
    assert!(spec.to_mjcf().unwrap().contains("arm"));
}

/// Numbers that stand for "not given" are left alone, whatever the kind of the element.
#[test]
fn elements_of_every_type_are_taken() {
    let mut spec = spec(
        r#"<mujoco>
  <worldbody>
    <body name="a" pos="0 0 1"><joint name="j" axis="0 1 0" range="-1 1"/><geom name="a" size="0.1"/><site name="a"/></body>
    <body name="b" pos="1 0 1"><joint name="k" type="ball"/><geom name="b" size="0.1"/><site name="b" pos="0.1 0 0"/></body>
    <body name="c" pos="2 0 1" mocap="true"><geom size="0.1"/><site name="c"/></body>
    <frame name="f" pos="0 1 0" euler="0 0 90"><body><freejoint/><geom type="ellipsoid" size="0.1 0.2 0.3"/></body></frame>
    <frame axisangle="0 1 0 90"><geom type="cylinder" size="0.1 0.2" zaxis="0 1 0"/></frame>
    <site name="box" type="box" size="0.1 0.2 0.3" xyaxes="0 1 0 -1 0 0"/>
  </worldbody>
  <tendon>
    <fixed name="t"><joint joint="j" coef="1"/></fixed>
    <fixed name="u"><joint joint="j" coef="2"/></fixed>
    <spatial name="s"><site site="c"/><site site="a"/><pulley divisor="2"/><site site="a"/><site site="b"/></spatial>
  </tendon>
  <equality>
    <connect site1="a" site2="b"/><connect body1="a" anchor="0 0 0.1"/>
    <weld site1="a" site2="b"/><weld body1="a" body2="b"/>
    <joint joint1="j" polycoef="0 1 0 0 0"/><tendon tendon1="t" tendon2="u"/>
  </equality>
  <actuator>
    <motor joint="j"/><position joint="j" kp="1" dampratio="1"/><position joint="j" inheritrange="1"/><velocity joint="j"/>
    <intvelocity joint="j" actrange="-1 1"/><damper joint="j" ctrlrange="0 1"/><cylinder joint="j" diameter="0.1"/>
    <muscle tendon="s" lengthrange="0.1 2"/><adhesion body="a" ctrlrange="0 1"/><pid joint="j" kp="1" ki="1"/>
    <general site="a" refsite="b" gear="1 0 0 0 0 0"/><general jointinparent="k"/>
  </actuator>
  <sensor><touch site="a"/><rangefinder site="a"/><contact geom1="a" data="found force dist"/><clock/></sensor>
  <contact><pair geom1="a" geom2="b"/><exclude body1="a" body2="c"/></contact>
</mujoco>"#,
    );
    let before = spec.compile().unwrap().inventory();
    assert!(spec.discard_visual().unwrap());
    let after = spec.compile().unwrap().inventory();
    assert_eq!((&before.bodies, &before.actuators, &before.sensors), (&after.bodies, &after.actuators, &after.sensors));
    let mut again = common::spec(&spec.to_mjcf().unwrap());
    let drives =
        |of: &hwasp_mujoco::engine::Inventory| of.actuators.iter().map(|a| a.drives.clone()).collect::<Vec<_>>();
    assert_eq!(drives(&again.compile().unwrap().inventory()), drives(&after));
}
