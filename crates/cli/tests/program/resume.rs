//! Trainings that are interrupted, by signals in real processes, and resumed.

use std::fs;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use crate::sandbox::Sandbox;

const LONG: &str = "train reach --env-steps 120000 --set train.evaluation_episodes=20 --checkpoint-every 0";

fn begin(sandbox: &Sandbox, line: &str) -> Child {
    sandbox.command(line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

fn wait_for(what: &str, done: impl Fn() -> bool) {
    let began = Instant::now();
    while !done() {
        assert!(began.elapsed() < Duration::from_mins(1), "{what}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Waits until a run has some checkpoints more than `before`.
fn wait_for_checkpoints(sandbox: &Sandbox, run: &str, iteration: usize) {
    wait_for("no checkpoint", || {
        let rows = fs::read_to_string(sandbox.path(run).join("metrics.csv")).map_or(0, |text| text.lines().count());
        rows > iteration + 1 && sandbox.path(run).join("checkpoints/best.safetensors").exists()
    });
}

fn signal(child: &Child, name: &str) {
    assert!(Command::new("kill").args([name, &child.id().to_string()]).status().unwrap().success());
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The files that have to be the same, the times out of them.
fn result(sandbox: &Sandbox, run: &str) -> (Vec<u8>, Vec<u8>, Vec<String>) {
    let metrics = String::from_utf8(sandbox.read(&format!("{run}/metrics.csv"))).unwrap();
    let untimed = metrics.lines().map(|line| {
        let mut fields: Vec<&str> = line.split(',').collect();
        fields.remove(2);
        fields.join(",")
    });
    let file = |name: &str| sandbox.read(&format!("{run}/{name}"));
    (file("policy.safetensors"), file("design.toml"), untimed.collect())
}

#[test]
fn a_training_that_was_asked_to_stop_says_how_to_go_on_and_does_so_to_the_bit() {
    let sandbox = Sandbox::new("asked-to-stop");
    assert!(sandbox.run(&format!("{LONG} --out whole --quiet")).status.success());
    for (name, by) in [("ctrl-c", "-INT"), ("term", "-TERM")] {
        let child = begin(&sandbox, &format!("{LONG} --out {name}"));
        wait_for_checkpoints(&sandbox, name, 3);
        signal(&child, by);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130), "{output:?}");
        let told = stderr(&output);
        assert!(told.contains("of 120000 steps\n  = hint: `hwasp train --resume"), "{told}");
        assert!(sandbox.run(&format!("eval {name} --episodes 5")).status.success());
        let output = sandbox.run(&format!("train --resume {name} --threads 2"));
        assert!(output.status.success(), "{output:?}");
        assert!(stderr(&output).contains("resuming reach (hwasp, seed 0) after"), "{output:?}");
        assert_eq!(result(&sandbox, name), result(&sandbox, "whole"));
        let log = String::from_utf8(sandbox.read(&format!("{name}/train.log"))).unwrap();
        assert!(log.contains(" INFO training reach") && log.contains(" INFO resuming reach"), "{log}");
    }
}

/// Killed at moments that no one chooses, resumed, killed again.
#[test]
fn a_training_that_is_killed_again_and_again_ends_with_the_same_bits() {
    let sandbox = Sandbox::new("killed");
    for (method, rest) in [("hwasp", ""), ("cmaes", ""), ("cmaes-rl", "--set search.inner_env_steps=6000")] {
        let (whole, many) = (format!("{method}-whole"), format!("{method}-many"));
        let line = format!("{LONG} --method {method} {rest} --quiet --out");
        assert!(sandbox.run(&format!("{line} {whole}")).status.success());
        let mut child = begin(&sandbox, &format!("{line} {many}"));
        wait_for("no folder", || sandbox.path(&many).join("experiment.toml").exists());
        let mut kills = 0;
        for pause in [5, 40, 90] {
            std::thread::sleep(Duration::from_millis(pause));
            if child.try_wait().unwrap().is_some() {
                break;
            }
            child.kill().unwrap();
            child.wait().unwrap();
            kills += 1;
            child = begin(
                &sandbox,
                &format!("train --resume {many} --quiet --checkpoint-every 0 --threads {}", 1 + kills % 2),
            );
        }
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{method}: {output:?}");
        assert!(kills > 0, "{method}");
        assert_eq!(result(&sandbox, &many), result(&sandbox, &whole), "{method} after {kills} kills");
    }
}

#[test]
fn the_second_signal_ends_the_program_at_once() {
    let sandbox = Sandbox::new("second-signal");
    // An evaluation of a million episodes: nobody waits for that.
    let line = "train reach --env-steps 2400 --set train.evaluation_episodes=1000000 --out run --quiet";
    let mut child = begin(&sandbox, line);
    wait_for("no checkpoint", || sandbox.path("run/checkpoints/iteration-00000002.safetensors").exists());
    signal(&child, "-INT");
    std::thread::sleep(Duration::from_millis(100));
    assert!(child.try_wait().unwrap().is_none(), "the first one waits for what is under way");
    let began = Instant::now();
    signal(&child, "-INT");
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(began.elapsed() < Duration::from_secs(5));
}

#[test]
fn a_folder_in_use() {
    let sandbox = Sandbox::new("in-use");
    let mut child = begin(&sandbox, "train reach --env-steps 1e11 --out busy --quiet --checkpoint-every 0");
    wait_for_checkpoints(&sandbox, "busy", 2);
    let output = sandbox.run("train --resume busy");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains(&format!("busy is in use by process {}", child.id())), "{output:?}");
    child.kill().unwrap();
    child.wait().unwrap();
}

/// Ctrl-C ended `compare` with exit status 1, as if something had failed, where the help promises 130.
#[test]
fn a_comparison_that_was_stopped_goes_on_in_the_middle_of_its_cells() {
    let sandbox = Sandbox::new("compare-stopped");
    let line = "compare reach --methods hwasp,cmaes-rl --seeds 2 --env-steps 120000 --threads 2 \
                --set train.evaluation_episodes=5 --set search.inner_env_steps=6000 --quiet --out";
    assert!(sandbox.run(&format!("{line} whole")).status.success());
    let child = begin(&sandbox, &format!("{line} many"));
    wait_for("no rows", || {
        let text = fs::read_to_string(sandbox.path("many/cells/hwasp-seed0/metrics.csv"));
        text.is_ok_and(|text| text.lines().count() > 3)
    });
    signal(&child, "-INT");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{output:?}");
    assert!(stderr(&output).contains("the same command goes on with them"), "{output:?}");
    let table = fs::read_to_string(sandbox.path("many/table.md")).unwrap();
    assert!(table.contains(" is not finished: ") && !table.contains(" failed: "), "{table}");
    assert!(sandbox.path("many/cells/hwasp-seed0/checkpoints").is_dir());
    assert!(sandbox.run(&format!("{line} many")).status.success());
    for cell in ["hwasp-seed0", "hwasp-seed1", "cmaes-rl-seed0", "cmaes-rl-seed1"] {
        assert_eq!(result(&sandbox, &format!("many/cells/{cell}")), result(&sandbox, &format!("whole/cells/{cell}")));
        let left = fs::read_dir(sandbox.path(&format!("many/cells/{cell}/checkpoints"))).unwrap().count();
        assert_eq!(left, 0, "a finished cell keeps no checkpoints");
    }
}

/// The same of `reproduce`, which runs a grid for each of its experiments.
#[test]
fn a_reproduction_that_was_stopped_says_so() {
    let sandbox = Sandbox::new("reproduce-stopped");
    let child = begin(&sandbox, "reproduce table1 --quick --threads 2 --out paper");
    wait_for("no rows", || {
        let text = fs::read_to_string(sandbox.path("paper/paper-mass-spring/cells/hwasp-seed0/metrics.csv"));
        text.is_ok_and(|text| text.lines().count() > 2)
    });
    signal(&child, "-INT");
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{output:?}");
    assert!(output.stdout.is_empty() && stderr(&output).contains("the same command goes on with them"), "{output:?}");
    // It begins none of the other experiments.
    assert!(!sandbox.path("paper/paper-mass-spring-50").exists());
}

#[test]
fn logs_as_json_and_by_level() {
    let sandbox = Sandbox::new("logs");
    let tiny = "train reach --env-steps 2400 --set train.evaluation_episodes=20";
    let output = sandbox.run(&format!("{tiny} --log-format json --log-level debug --checkpoint-every 0 --out run"));
    assert!(output.status.success());
    let line = |line: &str| serde_json::from_str::<serde_json::Value>(line).unwrap();
    let told = stderr(&output);
    let lines: Vec<_> = told.lines().map(line).collect();
    assert!(lines.iter().any(|l| l["level"] == "INFO" && l["message"].as_str().unwrap().starts_with("training reach")));
    assert!(lines.iter().any(|l| l["level"] == "DEBUG" && l["message"] == "checkpoint" && l["iteration"] == 1));
    let log = String::from_utf8(sandbox.read("run/train.log")).unwrap();
    let logged: Vec<_> = log.lines().map(line).collect();
    assert_eq!(logged.len(), lines.len());
    let output = sandbox.run("train reach --log-format json --resume nowhere");
    let output_json = stderr(&sandbox.run("train --log-format json --resume nowhere"));
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(line(output_json.trim_end())["level"], "ERROR");
    assert!(stderr(&sandbox.run(&format!("{tiny} --log-level warn --out other"))).is_empty());
}

/// A damaged newest checkpoint is told, set aside, and the one before it used.
#[test]
fn a_damaged_checkpoint_is_told() {
    let sandbox = Sandbox::new("damaged-checkpoint");
    assert!(sandbox.run(&format!("{LONG} --out whole --quiet")).status.success());
    let child = begin(&sandbox, &format!("{LONG} --out run --quiet"));
    wait_for_checkpoints(&sandbox, "run", 5);
    signal(&child, "-INT");
    child.wait_with_output().unwrap();
    let mut names: Vec<_> = fs::read_dir(sandbox.path("run/checkpoints")).unwrap().map(|f| f.unwrap().path()).collect();
    names.sort();
    let newest = names.last().unwrap();
    fs::write(newest, &fs::read(newest).unwrap()[..1000]).unwrap();
    let output = sandbox.run("train --resume run");
    assert!(output.status.success(), "{output:?}");
    let told = stderr(&output);
    assert!(told.starts_with("warning: run/checkpoints/iteration-") && told.contains("it is set aside"), "{told}");
    assert_eq!(result(&sandbox, "run"), result(&sandbox, "whole"));
}
