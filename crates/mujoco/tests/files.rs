//! Models of several files, and what goes wrong with them.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use common::{HOPPER, files, mesh, spec};
use hwasp_mujoco::engine::{BuildError, FileError, Files, Spec};

const MESHES: &str = r#"<mujoco><compiler meshdir="meshes"/><asset><mesh name="part" file="part.obj"/></asset>
  <worldbody><body name="part"><freejoint/><geom type="mesh" mesh="part" density="1000"/></body></worldbody></mujoco>"#;

fn mass(files: &Files, main: &str, body: &str) -> f64 {
    let simulation = Spec::parse(main, files).unwrap().compile().unwrap();
    simulation.mass(simulation.body(body).unwrap())
}

#[test]
fn includes_and_meshes_are_found_relative_to_their_text() {
    let files = files(&[
        ("robots/leg.xml", r#"<mujoco><include file="../common/floor.xml"/><include file="parts/arm.xml"/></mujoco>"#),
        (
            "common/floor.xml",
            r#"<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1"/></worldbody></mujoco>"#,
        ),
        (
            "robots/parts/arm.xml",
            r#"<mujocoinclude><compiler meshdir="../assets"/><asset><mesh file="part.obj"/></asset><worldbody><body name="arm">
               <freejoint/><geom type="mesh" mesh="part" density="600"/></body></worldbody></mujocoinclude>"#,
        ),
        ("assets/part.obj", &mesh(0.1)),
    ]);
    // A sixth of a cube.
    assert!((mass(&files, "robots/leg.xml", "arm") - 600.0 * 1e-3 / 6.0).abs() < 1e-6);
}

/// The engine keeps meshes for later models by name and time of change, and compares contents carelessly: of these two
/// sets it would take one for the other.
#[test]
fn meshes_of_other_sets_are_not_mistaken() {
    let set = |size: f64| files(&[("model.xml", MESHES), ("meshes/part.obj", &mesh(size))]);
    for (size, expected) in [(0.1, 1.0 / 6.0), (0.3, 27.0 / 6.0), (0.1, 1.0 / 6.0), (0.2, 8.0 / 6.0)] {
        let mass = mass(&set(size), "model.xml", "part");
        assert!((mass - expected).abs() < 1e-6, "{size} m: {mass} kg");
    }
}

/// URDF names meshes by packages.
#[test]
fn meshes_of_urdf_are_found_by_package() {
    let robot = |name: &str| {
        format!(
            r#"<robot name="r"><mujoco><compiler meshdir="x"/></mujoco><link name="l"><inertial><mass value="2"/>
               <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial><collision><geometry>
               <mesh filename="{name}"/></geometry></collision></link></robot>"#
        )
    };
    let parse = |name: &str| {
        let text = robot(name);
        let set = files(&[("arm/urdf/arm.urdf", &text), ("arm/meshes/leg.obj", &mesh(0.1)), ("b/leg.obj", &mesh(0.2))]);
        Spec::parse("arm/urdf/arm.urdf", &set).and_then(|mut spec| spec.compile())
    };
    for name in ["package://robot/meshes/leg.obj", "../../meshes/leg.obj", "file:///home/me/arm/meshes/leg.obj"] {
        assert_eq!(parse(name).unwrap().inventory().geoms.len(), 1, "{name}");
    }
    assert_eq!(
        parse("package://robot/leg.obj").unwrap_err().to_string(),
        "arm/urdf/arm.urdf: the mesh `package://robot/leg.obj` may be one of several files: arm/meshes/leg.obj, b/leg.obj"
    );
    assert_eq!(
        parse("package://robot/foot.obj").unwrap_err().to_string(),
        "arm/urdf/arm.urdf: the mesh `package://robot/foot.obj` is not among the files of the model"
    );
}

#[test]
fn faults_name_file_and_line() {
    let error = |texts: &[(&str, &str)]| {
        let set = files(texts);
        Spec::parse(texts[0].0, &set).and_then(|mut spec| spec.compile()).unwrap_err().to_string()
    };
    let include = "<mujoco>\n\n<include file='parts.xml'/></mujoco>";
    assert_eq!(
        error(&[("a/m.xml", "<mujoco>\n<worldbody>\n<boddy/></worldbody></mujoco>")]),
        "a/m.xml, line 3: Schema violation: unrecognized element (element `boddy`)"
    );
    assert_eq!(
        error(&[("a/m.xml", "<mujoco>\n<worldbody>\n<body></worldbody></mujoco>")]),
        "a/m.xml, line 3: the text is no XML: error mismatched element"
    );
    assert_eq!(
        error(&[(
            "a/m.xml",
            "<mujoco>\n<worldbody>\n<body name='shin'><freejoint/><geom size='-1'/></body></worldbody></mujoco>"
        )]),
        "a/m.xml, line 3: size 0 must be positive in geom"
    );
    assert_eq!(error(&[("a/m.xml", include)]), "a/m.xml, line 3: Error opening file 'parts.xml' (element `include`)");
    assert_eq!(
        error(&[("a/m.xml", include), ("a/parts.xml", "<mujoco>\n<worldbody>\n\n<boddy/></worldbody></mujoco>")]),
        "a/parts.xml, line 4: Schema violation: unrecognized element (element `boddy`)"
    );
    assert_eq!(
        error(&[("a/m.xml", include), ("a/parts.xml", "<mujoco>\n<worldbody>\n<body></worldbody></mujoco>")]),
        "a/parts.xml, line 3: the text is no XML: error mismatched element"
    );
    assert_eq!(
        error(&[
            ("a/m.xml", include),
            ("a/parts.xml", "<mujoco>\n<worldbody><body name='shin'><freejoint/></body></worldbody></mujoco>")
        ]),
        "a/parts.xml, line 2: the body `shin` moves and has no mass or no inertia; give the link an `<inertial>` with mass \
         and inertia (URDF), or the body a geom with mass (MJCF)"
    );
    assert_eq!(error(&[("m.xml", "<sdf/>")]), "m.xml: Unrecognized XML model type: 'sdf'");
    assert_eq!(
        error(&[("m.xml", "solid leg")]),
        "m.xml: the file is no XML text; a model is MJCF (`<mujoco>`) or URDF (`<robot>`)"
    );
    assert_eq!(
        error(&[("m.xml", "<mujoco>\n<size memory='1T'/></mujoco>")]),
        "m.xml: `<size memory>` asks for 1099511627776 bytes; the most is 16G"
    );
}

#[test]
fn a_file_that_is_not_there_is_told_with_those_that_are() {
    let set = files(&[("leg.xml", HOPPER), ("arm.xml", HOPPER)]);
    let error = Spec::parse("hopper.xml", &set).unwrap_err();
    assert!(matches!(&error, BuildError::NoFile { path, .. } if path == "hopper.xml"));
    assert_eq!(error.to_string(), "there is no file `hopper.xml` among those of the model; it has: arm.xml, leg.xml");
}

#[test]
fn texts_that_the_engine_could_not_stand_are_refused() {
    let parse = |bytes: &[u8]| Spec::parse("m.xml", &Files::new([("m.xml", bytes)]).unwrap()).unwrap_err().to_string();
    assert_eq!(parse(b"<mujoco>\n<body name='\xff'/></mujoco>"), "m.xml, line 2: the text is not UTF-8 here");
    assert_eq!(parse(b"<mujoco model='&#xD800;'/>"), "m.xml, line 1: `&#xD800;` is no character");
    assert!(parse(b"").contains("no XML text"));
    // The engine passes over what stands before the first element.
    let body = b"<mujoco><worldbody><geom name='\xff' size='1'/></worldbody></mujoco>";
    for before in [b"x".as_slice(), b"\xff\xfe", b"\0", b"=", b"<!-- -->"] {
        let main = b"<mujoco><include file='i.xml'/></mujoco>".as_slice();
        let set = Files::new([("m.xml", main), ("i.xml", &[before, body].concat())]).unwrap();
        let error = Spec::parse("m.xml", &set).expect_err("no name");
        assert!(error.to_string().contains("UTF-8") || error.to_string().contains("no XML"), "{before:?}: {error}");
    }
}

#[test]
fn paths_are_relative_and_plain() {
    for bad in ["", "/leg.xml", "../leg.xml", "a//b", "a/./b", "a\\b", "c:leg.xml", "a/", "leg\0"] {
        let error = Files::new([(bad, b"".as_slice())]).unwrap_err();
        assert!(matches!(error, FileError::Path { .. }), "{bad}: {error}");
    }
    assert!(matches!(Files::new([("a", b"".as_slice()), ("a", b"")]), Err(FileError::Twice(_))));
    let set = files(&[("b/leg.xml", "<mujoco/>"), ("a.xml", "")]);
    assert_eq!(set.paths().collect::<Vec<_>>(), ["a.xml", "b/leg.xml"]);
    assert_eq!(set.get("b/leg.xml").map(AsRef::as_ref), Some(b"<mujoco/>".as_slice()));
}

#[test]
fn warnings_are_told_once() {
    let mut spec = spec(
        r#"<mujoco><compiler settotalmass="14"/><worldbody><body><freejoint/><geom size="0.1"/></body></worldbody></mujoco>"#,
    );
    assert_eq!(spec.warnings(), [""; 0]);
    for _ in 0..3 {
        spec.compile().unwrap();
        assert!(matches!(spec.warnings(), [warning] if warning.contains("settotalmass")), "{:?}", spec.warnings());
    }
}

/// One specification per thread, and one that is handed over.
#[test]
fn specifications_move_between_threads() {
    let set = files(&[("model.xml", MESHES), ("meshes/part.obj", &mesh(0.1))]);
    let masses: Vec<f64> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..4).map(|_| scope.spawn(|| mass(&set, "model.xml", "part"))).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    assert!(masses.windows(2).all(|pair| pair[0].to_bits() == pair[1].to_bits()), "{masses:?}");
    let mut moved = Spec::parse("model.xml", &set).unwrap();
    let simulation = std::thread::spawn(move || moved.compile().unwrap()).join().unwrap();
    assert_eq!(simulation.mass(simulation.body("part").unwrap()), masses[0]);
}
