//! `hwasp play`. What is rendered is tested in `hwasp-report`, where there is an OpenGL to draw with.

use crate::sandbox::Sandbox;

#[test]
fn runs_without_looks_and_folders_that_are_none() {
    let sandbox = Sandbox::with_run("play-reach");
    sandbox.write("file", "");
    insta::assert_snapshot!(sandbox.refused(&["play run", "play nowhere", "play file"]));
    assert!(!sandbox.path("run/play").exists());
}

/// A robot from a model: trained, filmed, judged with a faster law, and asked for tendons that it does not have.
#[cfg(feature = "mujoco")]
#[test]
fn a_robot_from_a_model_is_seen_and_judged() {
    let sandbox = Sandbox::new("play-model");
    let train = "train balanced-arm --env-steps 4000 --set train.evaluation_episodes=4 --quiet --out run";
    assert!(sandbox.run(train).status.success());
    let output = sandbox.run("play run --episodes 2");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(String::from_utf8_lossy(&output.stdout).contains("film.html"));
    let film = String::from_utf8(sandbox.read("run/play/film.html")).unwrap();
    assert!(film.contains("<figure class=\"player\"") && film.contains("episode 1") && !film.contains("episode 2"));
    let told = |line: &str| String::from_utf8(sandbox.run(line).stdout).unwrap();
    let (held, fast) = (told("eval run --episodes 4"), told("eval run --episodes 4 --law-rate physics"));
    assert!(held.contains("hardware as built") && fast.contains("law at the rate of the physics"));
    assert_ne!(held.lines().nth(1), fast.lines().nth(1), "a held law is another one");
    insta::assert_snapshot!(sandbox.refused(&["eval run --native-tendons", "export run --urdf"]));
    // Whatever is written of it names things that it has.
    assert!(sandbox.run("report run").status.success());
    let report = String::from_utf8(sandbox.read("run/report.html")).unwrap();
    for text in
        ["1 joint, 1 actuator", "The best and the worst", "reward: effort", "robots/arm.xml", "undiscounted, of place"]
    {
        assert!(report.contains(text), "{text}");
    }
}

/// With EGL there are GIFs as well; without it that is said, and the film is there all the same.
#[cfg(feature = "mujoco")]
#[test]
fn a_hand_is_filmed_with_and_without_a_renderer() {
    let sandbox = Sandbox::new("play-z-grasp");
    let trained = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../results/z-grasp");
    std::fs::create_dir(sandbox.path("run")).unwrap();
    for name in ["experiment.toml", "policy.safetensors"] {
        std::fs::copy(trained.join(name), sandbox.path("run").join(name)).unwrap();
    }
    let output = sandbox.run("play run --episodes 1 --width 160 --height 160");
    let (told, remarks) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{remarks}");
    let film = String::from_utf8(sandbox.read("run/play/film.html")).unwrap();
    assert!(told.contains("film.html") && film.contains("above the floor"));
    assert!(sandbox.path("run/play/sheet.png").is_file() != remarks.contains("note: "), "{remarks}");
}
