//! What is said of a design without simulating it.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use crate::sandbox::{Sandbox, without_figures};

/// A sandbox with what `design` reads of the trained hand under results/, in the folder `hand`.
fn with_hand(name: &str) -> Sandbox {
    let sandbox = Sandbox::new(name);
    let trained = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../results/z-grasp");
    fs::create_dir(sandbox.path("hand")).unwrap();
    for file in ["experiment.toml", "design.toml"] {
        fs::copy(trained.join(file), sandbox.path("hand").join(file)).unwrap();
    }
    sandbox
}

/// The line of a `design.toml` that has the value of a group of one.
fn value_line<'t>(design: &'t str, group: &str) -> &'t str {
    let table = design.split_once(&format!("[{group}]\n")).expect("the group is there").1;
    table.lines().find(|line| line.starts_with("values = ")).expect("it has a value")
}

#[test]
fn a_hand() {
    let sandbox = with_hand("design-hand");
    insta::assert_snapshot!(sandbox.transcript(&["design hand --out pictures/here"]));
    assert!(String::from_utf8(sandbox.read("pictures/here/closing.svg")).unwrap().contains("motor travel (mm)"));
    assert!(sandbox.read("pictures/here/closing.png").starts_with(b"\x89PNG\r\n\x1a\n"));
    assert!(!sandbox.path("hand/closing.svg").exists());
    assert!(sandbox.run("design hand").status.success() && sandbox.path("hand/closing.svg").is_file());
}

#[test]
fn a_gear_and_a_bar_of_many_segments() {
    let sandbox = Sandbox::with_run("design-others");
    sandbox.run("train bar-length --seed 3 --env-steps 4000 --set train.evaluation_episodes=2 --quiet --out bar");
    insta::assert_snapshot!(without_figures(&sandbox.transcript(&["design run", "design bar"])));
}

#[test]
fn a_design_as_json() {
    let sandbox = with_hand("design-json");
    let output = sandbox.run("design hand --json");
    let printed: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(output.status.success() && !sandbox.path("hand/closing.svg").exists());
    let radius = &printed["groups"][0];
    assert_eq!((&radius["name"], &radius["unit"]), (&"thumb_proximal_radius".into(), &"m".into()));
    let value = radius["values"][0].as_f64().unwrap();
    let design = String::from_utf8(sandbox.read("hand/design.toml")).unwrap();
    assert_eq!(format!("values = [{value}]"), value_line(&design, "thumb_proximal_radius"));
    assert!((radius["position"][0].as_f64().unwrap() - (value - 0.002) / 0.010).abs() < 1e-9);
    let hand = &printed["hand"];
    assert_eq!((&hand["tension_limit"], &hand["joints"][3]["joint"]), (&75.0.into(), &"finger_distal".into()));
    let points = hand["closing"].as_array().unwrap();
    assert_eq!(points[1]["travel"], 0.001);
    assert!((points.last().unwrap()["total_tension"].as_f64().unwrap() - 75.0).abs() < 1e-6);

    let with_chart = sandbox.run("design hand --json --out pictures");
    assert_eq!(with_chart.stdout, output.stdout);
    assert!(sandbox.path("pictures/closing.png").is_file());
}

#[test]
fn designs_that_are_none() {
    let sandbox = with_hand("design-damaged");
    let sound = String::from_utf8(sandbox.read("hand/design.toml")).unwrap();
    let radius = value_line(&sound, "thumb_proximal_radius");
    let first = &sound[sound.find("[finger_distal_preload]").unwrap()..sound.find("[finger_distal_radius]").unwrap()];
    let mut transcript = String::new();
    for (what, text) in [
        ("no TOML", "radius: 1".to_owned()),
        ("another design", "[gear]\nunit = \"\"\nlimits = [0.0, 1.0]\ntotal = 1.0\ntotal_as_built = 1.0\nvalues = [1.0]\nas_built = [1.0]\n".into()),
        ("a radius of nothing", sound.replace(radius, "values = [0.0]")),
        ("no number", sound.replace(radius, "values = [nan]")),
        ("two radii", sound.replace(radius, "values = [0.008, 0.008]")),
        ("one group more", format!("{sound}\n{}", first.replace("finger_distal_preload", "gear"))),
    ] {
        sandbox.write("hand/design.toml", text);
        write!(transcript, "# {what}\n{}", sandbox.refused(&["design hand"])).unwrap();
    }
    fs::remove_file(sandbox.path("hand/design.toml")).unwrap();
    write!(transcript, "# no design\n{}", sandbox.refused(&["design hand", "design nowhere"])).unwrap();
    insta::assert_snapshot!(transcript);
}

/// A folder that cannot be written costs the picture only: by then the text is printed.
#[test]
fn a_chart_that_cannot_be_written() {
    let sandbox = with_hand("design-unwritable");
    fs::create_dir(sandbox.path("hand/closing.svg")).unwrap();
    sandbox.write("file", "");
    for (line, error) in [
        ("design hand", "error: `hand/closing.svg` cannot be written: "),
        ("design hand --out file/deep", "error: cannot create file/deep: "),
    ] {
        let output = sandbox.run(line);
        let (told, errors) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        assert_eq!(output.status.code(), Some(1), "{errors}");
        assert!(told.contains("free closing") && !told.contains("closing.png"), "{told}");
        assert!(errors.starts_with(error) && errors.contains("hint: name another folder with --out"), "{errors}");
    }
}

/// What a parameter changes of a model: what it sets, and what follows of that.
#[cfg(feature = "mujoco")]
#[test]
fn what_another_design_changes() {
    let sandbox = Sandbox::new("design-changes");
    insta::assert_snapshot!(sandbox.transcript(&[
        "design hopper --at shank=0.6m --at gear=100",
        "design hopper --at rest=0.1rad",
        "design hopper",
    ]));
    let output = sandbox.run("design hopper --at shank=0.6m --json");
    let printed: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let changes = printed[0]["changes"].as_array().unwrap();
    let of = |name: &str| {
        changes.iter().find(|change| change["name"] == name).unwrap_or_else(|| panic!("{name}: {printed}"))
    };
    let (size, mass) = (of("geom.shank.size[1]"), of("mass of body.shank"));
    assert_eq!((size["before"].as_f64(), size["after"].as_f64()), (Some(0.25), Some(0.3)));
    // A capsule of radius 0.035 m and density 900 kg/m3: a cylinder of the length and a ball.
    let capsule =
        |length: f64| 900.0 * std::f64::consts::PI * (0.035_f64.powi(2) * length + 4.0 / 3.0 * 0.035_f64.powi(3));
    for (at, length) in [("before", 0.5), ("after", 0.6)] {
        assert!((mass[at].as_f64().unwrap() - capsule(length)).abs() < 1e-9, "{mass}");
    }
    let height = of("height of body.torso at the start");
    assert!((height["after"].as_f64().unwrap() - 1.35).abs() < 1e-9, "{height}");
}
