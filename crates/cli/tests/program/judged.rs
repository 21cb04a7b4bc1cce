//! Results judged under other settings than they were trained with, and in great numbers.

use std::process::Command;

use crate::sandbox::Sandbox;

/// `eval --set task.stiffness_total_max="200 N/m"` doubled every spring of a trained run, printed a return of -6318 instead of -2859
/// and still said "hardware as built". `play` reads the same arguments in the same way.
#[test]
fn another_machine_is_no_other_world() {
    let sandbox = Sandbox::new("another-machine");
    for (experiment, out) in [("mass-spring", "run"), ("bar-length", "bar")] {
        let line = format!("train {experiment} --env-steps 4000 --set train.evaluation_episodes=2 --quiet --out {out}");
        assert!(sandbox.run(&line).status.success());
    }
    let refused = |run: &str, setting: &str, what: &str| {
        // Behind one that is no fault: the message names the one that is.
        let output = sandbox.run(&format!("eval {run} --episodes 2 --set task.goal=0.3m --set {setting}"));
        let told = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{setting}: {told}");
        let message = format!("error: --set {setting} changes {what}: {run} was trained for another machine\n");
        assert!(told.starts_with(&message), "{told}");
    };
    refused("bar", "task.interface_stiffness=100N/m", "the law");
    for (setting, what) in [
        ("task.stiffness_total_max=200N/m", "the design's parameters or their limits"),
        ("task.segments=11", "the design's parameters or their limits"),
        ("task.motor_limit=6N", "the motors or their limits"),
        ("controller.hidden=[8]", "the controller's network"),
        ("controller.observation_scale=[0.2,0.5]", "how the controller sees what it observes"),
        ("controller.sees_design=true", "whether the controller sees the design"),
        ("design.placement=fixed", "where the design's parameters sit, or the values of those that are fixed"),
        ("noise.train=false", "which parameters the policy has"),
    ] {
        refused("run", setting, what);
    }
}

/// `eval --set task.reward.heat=0` was refused as "another machine": the term alone read the command of the knee beside the law,
/// so that training samples it in another way. Terms, ends and success belong to the world.
#[test]
#[cfg(feature = "mujoco")]
fn a_robot_is_judged_by_other_terms_and_ends() {
    let sandbox = Sandbox::new("other-terms");
    let short = "--set train.steps_per_iteration=400 --set train.episode_steps=100 --set train.evaluation_episodes=2";
    let output = sandbox.run(&format!("train hopper --env-steps 800 {short} --quiet --out run"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let eval = |set: &[&str]| -> serde_json::Value {
        let line = set.iter().fold("eval run --episodes 4 --json".to_owned(), |line, set| line + " --set " + set);
        let output = sandbox.run(&line);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let (plain, cold) = (eval(&[]), eval(&["task.reward.heat=0"]));
    assert_eq!(cold["terms"]["heat"], 0.0);
    assert_eq!(cold["terms"]["forward"], plain["terms"]["forward"]);
    let without = eval(&["task.reward={alive=1}", "task.ends={long=\"step>5\"}", "task.success=\"step>3\""]);
    assert_eq!(without["ends"]["named"]["long"], 4);
    assert_eq!(without["success"][0]["successes"], 4);
}

/// What `--set` changed was held against the checkpoint of a run that had not come to its end.
#[test]
fn a_run_without_an_end_is_judged_in_another_world() {
    let sandbox = Sandbox::new("unfinished-judged");
    sandbox.put_stopped_run();
    let output = sandbox.run("eval run --episodes 2 --set task.goal=30cm");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn another_world_is_named_before_the_figures() {
    let sandbox = Sandbox::with_run("another-world");
    let first = |line: &str| {
        let output = sandbox.run(line);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let told = first("eval run --episodes 2 --set task.goal=\"30cm\" --set ppo.discount=0.9");
    assert_eq!(told.lines().next(), Some("  under task.goal = 30cm, ppo.discount = 0.9:"));
    let json: serde_json::Value =
        serde_json::from_str(&first("eval run --episodes 2 --json --set task.goal=\"30cm\"")).unwrap();
    assert_eq!(json["under"], serde_json::json!(["task.goal=\"30cm\""]));
    assert!(!first("eval run --episodes 2").contains("under"));
}

/// An evaluation kept every step of every episode, 47 kB of each: 20,000 of them took 940 MB, and a training whose evaluation was
/// large ended in an abort after its last iteration.
#[test]
#[cfg(target_os = "linux")]
fn many_episodes_take_little_memory() {
    let sandbox = Sandbox::with_run("many-episodes");
    let mut shell = Command::new("/bin/sh");
    // kB of address space, libraries included.
    shell.args(["-c", "ulimit -v 700000; exec \"$0\" eval run --episodes 20000 --json", env!("CARGO_BIN_EXE_hwasp")]);
    let output = shell.current_dir(sandbox.path("")).env_clear().output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["episodes"], 20000);
}
