//! Every field of every kind of element, set to every hostile value: an error or a model, and never the end of the process.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use common::{path, spec};
use hwasp_mujoco::engine::{FieldPath, Kind, Spec, SpecError};

/// One element of each kind and of each type that matters, with every way to write it.
const ZOO: &str = r#"<mujoco>
  <compiler angle="radian"/>
  <option timestep="0.002"/>
  <worldbody>
    <geom name="floor" type="plane" size="0 0 1"/>
    <site name="anchor" pos="0 0 1"/>
    <body name="inferred" pos="0 0 0.5">
      <joint name="slide" type="slide" axis="1 0 0" range="-1 1" actuatorfrcrange="-9 9"/>
      <joint name="hinge" axis="0 1 0" range="-1 1" stiffness="1" springref="0.1" damping="1"/>
      <geom name="sphere" size="0.1"/>
      <geom name="capsule" type="capsule" size="0.05" fromto="0 0 0 0 0 0.2" mass="0.1"/>
      <geom name="box" type="box" size="0.1 0.1 0.1" euler="0 0.1 0"/>
      <site name="tip" pos="0 0.1 0" size="0.01"/>
      <body name="explicit" pos="0 0 0.3" euler="0.1 0 0">
        <inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>
        <joint name="ball" type="ball" range="0 1"/>
        <geom name="cylinder" type="cylinder" size="0.05 0.05"/>
        <geom name="ellipsoid" type="ellipsoid" size="0.05 0.06 0.07"/>
        <site name="end" pos="0.1 0 0"/>
      </body>
    </body>
    <body name="full" pos="1 0 0.5">
      <inertial pos="0 0 0" mass="1" fullinertia="0.01 0.01 0.01 0 0 0"/>
      <freejoint name="free"/>
      <geom name="loose" size="0.1"/>
      <site name="grip"/>
    </body>
    <body name="crank" pos="0 1 0.5">
      <joint name="crank" axis="0 1 0"/>
      <geom size="0.05"/>
      <site name="crank" pos="0.1 0 0"/>
      <site name="slider" pos="0 0 0.3"/>
    </body>
  </worldbody>
  <tendon>
    <spatial name="spatial" stiffness="1" damping="1" range="0 3" width="0.01" springlength="0.5 1">
      <site site="anchor"/><site site="tip"/>
    </spatial>
    <fixed name="fixed" range="-1 1"><joint joint="hinge" coef="0.1"/></fixed>
  </tendon>
  <equality>
    <connect name="connect" body1="full" body2="world" anchor="0 0 0"/>
    <weld name="weld" body1="full"/>
    <joint name="joint" joint1="slide" joint2="hinge"/>
  </equality>
  <actuator>
    <motor name="motor" joint="slide" gear="2" ctrlrange="-1 1" forcerange="-1 1"/>
    <position name="position" joint="hinge" kp="3" kv="1"/>
    <general name="filter" joint="hinge" dyntype="filter" dynprm="0.1" actlimited="true" actrange="-1 1"/>
    <muscle name="muscle" tendon="spatial" ctrlrange="0 1" lengthrange="0.3 1.5"/>
    <general name="site" site="tip" gear="0 0 1 0 0 0"/>
    <general name="slidercrank" cranksite="crank" slidersite="slider" cranklength="0.4"/>
    <motor name="cable" tendon="fixed"/>
  </actuator>
</mujoco>"#;

const VALUES: [f64; 22] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MAX,
    f64::MIN,
    f64::MIN_POSITIVE,
    -f64::MIN_POSITIVE,
    5e-324,
    0.0,
    -0.0,
    -1.0,
    1.0,
    1e-12,
    1e-3,
    0.5,
    1e3,
    1e4,
    -1e4,
    1e6,
    1e9,
    -1e9,
    1e30,
];

/// All fields of the kind's elements, by their names and indices.
fn paths(spec: &Spec, kind: Kind) -> Vec<FieldPath> {
    // A field that no kind has makes the error that lists them.
    let fields = match format!("{kind}.x.nothing").parse::<FieldPath>() {
        Err(SpecError::UnknownField { fields, .. }) => fields,
        other => panic!("{other:?}"),
    };
    let elements: Vec<String> = match kind {
        Kind::Options => vec!["option".to_owned()],
        kind => (0..spec.names(kind).len()).map(|index| format!("{kind}.#{index}")).collect(),
    };
    let mut paths = Vec::new();
    for (element, field) in elements.iter().flat_map(|element| fields.iter().map(move |field| (element, field))) {
        paths.extend((0..).map_while(|index| format!("{element}.{field}[{index}]").parse().ok()));
    }
    paths
}

#[test]
fn no_value_ends_the_process() {
    let kinds =
        [Kind::Body, Kind::Geom, Kind::Joint, Kind::Site, Kind::Actuator, Kind::Tendon, Kind::Equality, Kind::Options];
    let (mut set, mut refused, mut compiled, mut moved) = (0, 0, 0, 0);
    for kind in kinds {
        let all = paths(&spec(ZOO), kind);
        assert!(all.len() >= 11, "{kind}: {}", all.len());
        for path in all {
            let mut spec = spec(ZOO);
            let before = spec.field(&path);
            for value in VALUES {
                if let Err(error) = spec.set(&path, value) {
                    assert!(matches!(error, SpecError::Value { .. } | SpecError::Unused { .. }), "{path}: {error}");
                    refused += 1;
                    continue;
                }
                set += 1;
                assert!(value.is_finite() && value.abs() <= 1e9, "{path} took {value}");
                if let Ok(mut simulation) = spec.compile() {
                    compiled += 1;
                    simulation.ctrl_mut().fill(0.5);
                    moved += usize::from(simulation.step(20).is_ok());
                    let _ = (simulation.energy(), simulation.inventory());
                }
            }
            // The model is still good.
            if let Ok(value) = before {
                let mut spec = common::spec(ZOO);
                if spec.set(&path, value).is_ok() {
                    spec.compile().unwrap_or_else(|error| panic!("{path}: {error}"));
                }
            }
        }
    }
    println!("{set} values set, {refused} refused, {compiled} models compiled, {moved} moved");
    assert!(compiled > 1000 && refused > 1000);
}

/// Several hostile values at once, drawn from all fields.
#[test]
fn no_mixture_of_values_ends_the_process() {
    let kinds =
        [Kind::Body, Kind::Geom, Kind::Joint, Kind::Site, Kind::Actuator, Kind::Tendon, Kind::Equality, Kind::Options];
    let all: Vec<FieldPath> = kinds.into_iter().flat_map(|kind| paths(&spec(ZOO), kind)).collect();
    let mut state = 1_u64;
    let mut draw = |below: usize| {
        // Knuth's MMIX; the upper bits are the random ones.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let mut compiled = 0;
    for _ in 0..800 {
        let mut spec = spec(ZOO);
        for _ in 0..8 {
            let (path, value) = (&all[draw(all.len())], VALUES[draw(VALUES.len())]);
            let _ = spec.set(path, value);
        }
        if let Ok(mut simulation) = spec.compile() {
            compiled += 1;
            simulation.ctrl_mut().fill(0.5);
            let _ = simulation.step(20);
        }
    }
    assert!(compiled > 150, "{compiled}");
}

/// Two hostile values at once, of all pairs of fields of an element that belong together.
#[test]
fn no_pair_of_values_ends_the_process() {
    for (a, b) in [
        ("joint.hinge.range[0]", "joint.hinge.range[1]"),
        ("actuator.motor.ctrlrange[0]", "actuator.motor.ctrlrange[1]"),
        ("actuator.motor.forcerange[0]", "actuator.motor.forcerange[1]"),
        ("actuator.muscle.gainprm[0]", "actuator.muscle.gainprm[1]"),
        ("actuator.filter.actrange[0]", "actuator.filter.actrange[1]"),
        ("tendon.spatial.springlength", "tendon.spatial.springlength[1]"),
        ("tendon.spatial.range[0]", "tendon.spatial.range[1]"),
        ("geom.box.size[0]", "geom.box.size[1]"),
        ("geom.capsule.fromto[2]", "geom.capsule.fromto[5]"),
        ("body.explicit.mass", "body.explicit.inertia[0]"),
        ("body.explicit.inertia[0]", "body.explicit.inertia[1]"),
        ("joint.hinge.axis[1]", "joint.hinge.axis[0]"),
        ("body.inferred.quat[0]", "body.inferred.quat[1]"),
        ("option.timestep", "joint.hinge.stiffness"),
    ]
    .map(|(a, b)| (path(a), path(b)))
    {
        let mut spec = spec(ZOO);
        for x in VALUES {
            for y in VALUES {
                if spec.set(&a, x).is_ok() & spec.set(&b, y).is_ok()
                    && let Ok(mut simulation) = spec.compile()
                {
                    let _ = simulation.step(10);
                }
            }
        }
    }
}

/// The same in texts, which the engine takes.
#[test]
fn no_text_ends_the_process() {
    let set = |text: &str| {
        Spec::parse("model.xml", &common::files(&[("model.xml", text)])).and_then(|mut spec| spec.compile())
    };
    for (from, to) in [
        ("pos=\"0 0 0.5\"", "pos=\"0 0 inf\""),
        ("pos=\"0 0 0.5\"", "pos=\"0 0 nan\""),
        ("pos=\"0 0 0.5\"", "pos=\"0 0 1e300\""),
        ("size=\"0.1\"", "size=\"1e30\""),
        ("size=\"0.1\"", "size=\"nan\""),
        ("pos=\"0 0 0.3\" euler=\"0.1 0 0\"", "quat=\"1e-300 0 0 0\""),
        ("pos=\"0 0 0.3\" euler=\"0.1 0 0\"", "quat=\"0 0 0 0\""),
        ("stiffness=\"1\"", "stiffness=\"inf\""),
        ("gear=\"2\"", "gear=\"nan\""),
        ("timestep=\"0.002\"", "timestep=\"0\""),
        ("timestep=\"0.002\"", "timestep=\"-1\""),
        ("mass=\"1\"", "mass=\"1e300\""),
    ] {
        let text = ZOO.replacen(from, to, 1);
        assert_ne!(text, ZOO, "{from}");
        let error = set(&text).expect_err(to).to_string();
        assert!(error.starts_with("model.xml"), "{to}: {error}");
    }
    set(ZOO).unwrap();
}
