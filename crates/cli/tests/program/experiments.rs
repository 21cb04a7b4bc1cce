//! Experiments: the list, checks, drawings, and files with faults.

use crate::sandbox::Sandbox;

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
        "check reach --method fixed --set train.env_steps=1e6",
    ]));
}

#[test]
fn experiments_that_do_not_exist() {
    let refused = Sandbox::new("no-experiment").refused(&["train reahc", "check nowhere.toml", "graph ."]);
    insta::assert_snapshot!(refused);
}

#[test]
fn broken_toml() {
    let sandbox = Sandbox::new("broken-toml");
    sandbox.write("broken.toml", "name = \"x\"\n[task\nproblem = \"reach\"\n");
    sandbox.write("latin1.toml", b"name = \"x\"\ndescription = \"f\xfcr\"\n");
    sandbox.write("empty.toml", "");
    let refused = sandbox.refused(&["check broken.toml", "train latin1.toml", "check empty.toml"]);
    insta::assert_snapshot!(refused);
}

#[test]
fn several_faults_at_once() {
    let sandbox = Sandbox::new("faults");
    let file = "name = \"x\"\nsed = 3\n[task]\nproblem = \"stiffness\"\nsegments = 0\n[ppo]\nclip_ratio = 7\n\
                [noise]\neffort = \"3 mm\"\n[methods.other]\nx = 1\n";
    sandbox.write("faults.toml", file);
    insta::assert_snapshot!(sandbox.refused(&["check faults.toml --set seed=-1"]));
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

#[test]
fn drawings_in_no_format() {
    let refused = Sandbox::new("graph-format").refused(&["graph reach --out law.pdf", "graph reach --out law"]);
    insta::assert_snapshot!(refused);
}

#[test]
fn a_drawing_that_cannot_be_written_fails_on_the_way() {
    insta::assert_snapshot!(Sandbox::new("graph-nowhere").transcript(&["graph reach --out nowhere/law.svg"]));
}
