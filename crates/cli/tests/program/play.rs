//! `hwasp play`. What is rendered is tested in `hwasp-report`, where there is an OpenGL to draw with.

use crate::sandbox::Sandbox;

#[test]
fn folders_that_are_no_runs() {
    let sandbox = Sandbox::new("play-nothing");
    sandbox.write("file", "");
    insta::assert_snapshot!(sandbox.refused(&["play nowhere", "play file"]));
}

/// The problems in Rust said nothing of how they look: there was a film of robots from models and of the hand alone.
#[test]
fn every_problem_is_seen() {
    for (problem, told) in
        [("reach", "gear "), ("pendulum", "gear "), ("mass-spring", "10 springs, "), ("bar-length", "a bar of ")]
    {
        let sandbox = Sandbox::new(&format!("play-{problem}"));
        let train = format!("train {problem} --env-steps 60000 --set train.evaluation_episodes=4 --quiet --out run");
        let train = sandbox.run(&train);
        assert!(train.status.success(), "{}", String::from_utf8_lossy(&train.stderr));
        assert!(sandbox.run("play run --episodes 1").status.success());
        let film = String::from_utf8(sandbox.read("run/play/film.html")).unwrap();
        assert!(film.contains("<figure class=\"player\"") && film.contains(&format!("episode 0: {told}")), "{problem}");
        let scene = String::from_utf8(sandbox.read("run/play/scene.html")).unwrap();
        assert!(scene.contains("\"form\":\"") && scene.contains(&format!("\"about\":\"{told}")), "{problem}");
        assert!(sandbox.read("run/play/episode-0.gif").starts_with(b"GIF89a"), "{problem}");
        assert!(sandbox.path("run/play/sheet.png").is_file(), "{problem}");
        assert!(sandbox.run("report run").status.success());
        let report = String::from_utf8(sandbox.read("run/report.html")).unwrap();
        assert!(report.contains("The best and the worst") && report.contains(told), "{problem}");
    }
}

#[test]
fn pages_alone_and_films_without_their_encoder() {
    let sandbox = Sandbox::with_run("play-formats");
    assert!(sandbox.run("play run --episodes 1 --html --out pages").status.success());
    let files = std::fs::read_dir(sandbox.path("pages")).unwrap().map(|file| file.unwrap().file_name());
    let mut files: Vec<_> = files.collect();
    files.sort();
    assert_eq!(files, ["film.html", "scene.html"]);
    insta::assert_snapshot!(
        sandbox.transcript(&["play run --episodes 1 --format webm", "play run --html --format gif"])
    );
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
        ["1 joint, 1 actuator", "The best and the worst", "reward: effort", "robots/arm.xml", "return, of place"]
    {
        assert!(report.contains(text), "{text}");
    }
}

/// With EGL its films are rendered; without it that is said, and they are drawn.
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
    assert!(sandbox.path("run/play/sheet.png").is_file() && told.contains("episode-0-sphere.gif"), "{told}");
    assert!(remarks.is_empty() || remarks.contains("the films are drawings"), "{remarks}");
}
