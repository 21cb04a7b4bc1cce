//! Trainings and what can be done with them.

use std::fs;

use crate::sandbox::{Sandbox, TINY, without_figures};

#[test]
fn a_training_and_its_evaluation() {
    let sandbox = Sandbox::new("train");
    let transcript = sandbox.transcript(&[TINY, TINY, "eval runs/reach-hwasp-seed0", "eval runs/reach-hwasp-seed0-2"]);
    insta::assert_snapshot!(without_figures(&transcript));
}

#[test]
fn a_training_of_a_mechanism_with_many_parts() {
    let sandbox = Sandbox::new("train-springs");
    let line =
        "train bar-length --method minimal --seed 3 --env-steps 4000 --set train.evaluation_episodes=2 --out run";
    insta::assert_snapshot!(without_figures(&sandbox.transcript(&[line])));
}

#[test]
fn the_same_bits_with_one_thread_and_two() {
    let sandbox = Sandbox::new("threads");
    sandbox.transcript(&[&format!("{TINY} --out one"), &format!("{TINY} --out two --threads 2")]);
    assert_eq!(sandbox.read("one/policy.safetensors"), sandbox.read("two/policy.safetensors"));
    assert_ne!(sandbox.read("one/provenance.json"), sandbox.read("two/provenance.json"));
}

#[test]
fn an_evaluation_as_json_is_that_of_the_summary() {
    let sandbox = Sandbox::with_run("eval-json");
    let output = sandbox.run("eval run --json");
    let printed: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let summary: serde_json::Value = serde_json::from_slice(&sandbox.read("run/summary.json")).unwrap();
    assert_eq!(printed, summary["evaluation"]);
    insta::assert_snapshot!(without_figures(&String::from_utf8(output.stdout).unwrap()));
}

#[test]
fn an_evaluation_of_other_episodes() {
    let sandbox = Sandbox::with_run("eval-other");
    let evaluation = |line: &str| -> serde_json::Value {
        serde_json::from_slice(&sandbox.run(&format!("eval run --json {line}")).stdout).unwrap()
    };
    let usual = evaluation("");
    let other = evaluation("--episodes 30 --seed 9");
    assert_eq!((&other["episodes"], &other["seed"]), (&30.into(), &9.into()));
    assert_ne!(usual["return"], other["return"]);
    assert_eq!(other, evaluation("--episodes 30 --seed 9 --threads 2"));
}

#[test]
fn shapes_of_what_has_none() {
    let output = Sandbox::with_run("eval-shapes").run("eval run --per-shape");
    assert!(output.status.success());
    assert_eq!(String::from_utf8_lossy(&output.stderr), "note: reach knows no success here, and so no rates of it\n");
}

#[test]
fn quiet_is_quiet() {
    let output = Sandbox::new("quiet").run(&format!("{TINY} --quiet"));
    assert!(output.status.success() && output.stdout.is_empty() && output.stderr.is_empty(), "{output:?}");
}

#[test]
fn tensorboard_is_written_if_asked_for() {
    let sandbox = Sandbox::new("tensorboard");
    sandbox
        .transcript(&[&format!("{TINY} --quiet --out with --tensorboard"), &format!("{TINY} --quiet --out without")]);
    let files = fs::read_dir(sandbox.path("with/tensorboard")).unwrap();
    let names: Vec<_> = files.map(|file| file.unwrap().file_name().into_string().unwrap()).collect();
    assert!(names.len() == 1 && names[0].starts_with("events.out.tfevents."), "{names:?}");
    assert!(!sandbox.path("without/tensorboard").exists());
    // The folder beside the other files changes nothing for those who read them.
    assert_eq!(sandbox.read("with/policy.safetensors"), sandbox.read("without/policy.safetensors"));
    assert!(sandbox.run("eval with").status.success());
}

#[test]
fn plots() {
    let sandbox = Sandbox::with_run("plot");
    sandbox.run(&format!("{TINY} --quiet --seed 1 --out other"));
    insta::assert_snapshot!(sandbox.transcript(&[
        "plot run",
        "plot run other --title Gears --out both.svg",
        "plot run other --out both.PNG"
    ]));
    let svg = |name: &str| String::from_utf8(sandbox.read(name)).unwrap();
    let (one, both) = (svg("curves.svg"), svg("both.svg"));
    assert!(one.contains("discounted return") && one.contains("gear") && !one.contains("Gears"), "{one}");
    assert!(both.contains("Gears"), "{both}");
    let png = sandbox.read("both.PNG");
    assert!(png.starts_with(b"\x89PNG\r\n\x1a\n") && png.len() > 10_000, "{} bytes", png.len());
}

/// A comparison, another into its folder, and the same again, which trains nothing.
#[test]
fn a_comparison() {
    let sandbox = Sandbox::new("compare");
    let small = "compare reach --seeds 2 --env-steps 12000 --set train.evaluation_episodes=5 --threads 1 --out both";
    let output = sandbox.transcript(&[
        &format!("{small} --methods hwasp,fixed:middle --quiet"),
        &format!("{small} --methods hwasp,fixed:middle --set ppo.clip_ratio=0.1"),
    ]);
    insta::assert_snapshot!(output);
    assert!(String::from_utf8_lossy(&sandbox.read("both/table.md")).contains("| fixed:middle | 2 of 2 |"));
    let again = sandbox.run(&format!("{small} --methods hwasp,fixed:middle"));
    assert!(String::from_utf8_lossy(&again.stderr).contains("4 cells, 4 of them there already"));
}
