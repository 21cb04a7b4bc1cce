//! Experiments: the list, checks, drawings, and files with faults.

use crate::sandbox::{Sandbox, without_figures};

/// Without the engine there are fewer.
#[cfg(feature = "mujoco")]
#[test]
fn the_list() {
    insta::assert_snapshot!(Sandbox::new("list").transcript(&["list"]));
}

#[test]
fn sound_experiments() {
    let sandbox = Sandbox::new("check");
    insta::assert_snapshot!(without_figures(&sandbox.transcript(&[
        "check mass-spring",
        "check mass-spring --method minimal",
        "check mass-spring --set design.placements.stiffness[0..3]=episode",
        "check reach --method episode",
        "check reach --method fixed --set train.env_steps=1e6",
        "check reach --set train.steps_per_iteration=2048 --set train.episodes_per_iteration=8",
        "check reach --set train.steps_per_iteration=1000",
    ])));
}

/// A robot from a model: what its design sets, its reward, and what one episode an iteration is worth.
#[cfg(feature = "mujoco")]
#[test]
fn a_sound_robot() {
    let sandbox = Sandbox::new("check-robot");
    let told =
        sandbox.transcript(&["check hopper --set train.steps_per_iteration=0 --set train.episodes_per_iteration=1"]);
    assert!(told.contains("one episode an iteration teaches the design nothing"), "{told}");
    insta::assert_snapshot!(without_figures(&told));
    // Its start follows a parameter of the law.
    let gripper = sandbox.transcript(&["check tendon-gripper"]);
    assert!(gripper.contains("[exit 0]") && gripper.contains("that shape no model"), "{gripper}");
}

/// A task that is over as it begins passed without a word, and so did a spring that shakes because its effort is held.
#[cfg(feature = "mujoco")]
#[test]
fn what_would_not_train_is_warned_of() {
    let sandbox = Sandbox::new("check-doubts");
    let over = sandbox.transcript(&["check hopper --set task.ends=time>0.01"]);
    assert!(over.contains("8 of 8 episodes ended within 3 steps"), "{over}");
    let shakes = sandbox.transcript(&["check five-bar --set task.frame_skip=10"]);
    assert!(shakes.contains("warning     the law's spring on joint.front_hip has 7.500 N*m/rad"), "{shakes}");
    let sound = sandbox.transcript(&["check five-bar", "check hopper"]);
    assert!(!sound.contains("the law's spring") && !sound.contains("ended within"), "{sound}");
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

/// It is text of the language: it can stand in an experiment, and a law that calls it is drawn as the formula that it stands for.
#[cfg(feature = "mujoco")]
#[test]
fn the_library_of_laws() {
    let sandbox = Sandbox::new("laws");
    let output = sandbox.run("laws");
    let library = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && library.contains("\"torsion_spring(angle: rad"), "{library}");
    let arm = include_str!("../../../../experiments/balanced-arm.toml");
    std::fs::create_dir(sandbox.path("robots")).unwrap();
    sandbox.write("robots/arm.xml", include_str!("../../../../experiments/robots/arm.xml"));
    let law = "command.shoulder - stiffness * 0.1 m * 0.1 m * sin(joint.shoulder.pos)";
    assert!(arm.contains(law));
    let torque = "-stiffness * (joint.shoulder.pos - 0.2 rad)";
    let drawn = |law_there: &str, tables: &str| {
        let text = arm.replace(law, law_there).replace("N/m", "N*m/rad");
        sandbox.write("mine.toml", format!("{text}\n{tables}"));
        let output = sandbox.run("graph mine.toml");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let by_hand = drawn(torque, "");
    let by_name = "torsion_spring(joint.shoulder.pos, stiffness, 0.2)";
    assert_eq!(drawn(by_name, ""), by_hand);
    assert_eq!(drawn(by_name, &format!("[task.define]\n{library}")), by_hand);
}
