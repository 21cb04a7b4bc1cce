//! Experiments: the list, checks, drawings, and files with faults.

use crate::sandbox::Sandbox;

/// Without the engine there are fewer.
#[cfg(feature = "mujoco")]
#[test]
fn the_list() {
    insta::assert_snapshot!(Sandbox::new("list").transcript(&["list"]));
}

#[test]
fn sound_experiments() {
    let sandbox = Sandbox::new("check");
    insta::assert_snapshot!(sandbox.transcript(&[
        "check mass-spring",
        "check mass-spring --method minimal",
        "check mass-spring --set design.placements.stiffness[0..3]=episode",
        "check reach --method episode",
        "check reach --method fixed --set train.env_steps=1e6",
        "check reach --set train.steps_per_iteration=2048 --set train.episodes_per_iteration=8",
        "check reach --set train.steps_per_iteration=1000",
    ]));
}

#[test]
fn the_law_as_a_graph() {
    let sandbox = Sandbox::new("graph");
    insta::assert_snapshot!(sandbox.transcript(&["graph reach"]));
    insta::assert_snapshot!(
        "graph_files",
        sandbox.transcript(&["graph reach --out law.dot", "graph mass-spring --method minimal --out law.SVG"])
    );
    assert_eq!(sandbox.read("law.dot"), sandbox.run("graph reach").stdout);
    let svg = String::from_utf8(sandbox.read("law.SVG")).unwrap();
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"), "{svg}");
    assert!(svg.contains("mass-spring · minimal"), "{svg}");
}
