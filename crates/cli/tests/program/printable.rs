//! Other people's text, and the form of messages.

use std::process::Command;

use crate::sandbox::Sandbox;

/// Where the sources are, wherever the program was built.
const CHECKOUT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// The program with arguments that hold any characters.
fn run(sandbox: &Sandbox, arguments: &[&str]) -> (Option<i32>, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hwasp"));
    let output = command.args(arguments).current_dir(sandbox.path("")).env_clear().output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (output.status.code(), text(output.stdout), text(output.stderr))
}

/// Names with escapes, line breaks and marks that turn the direction of writing reached the terminal as they were: from arguments,
/// from folders' names, from error messages of the command line.
#[test]
fn nothing_in_names_moves_the_cursor() {
    let sandbox = Sandbox::new("printable");
    for (arguments, told) in [
        (&["train", "reach", "--out", "a\nb"][..], "it has characters that cannot be printed, such as a line break"),
        (&["eval", "a\u{1b}[2Jb"], "it has characters that cannot be printed, such as a line break"),
        (&["eval", "a\u{202e}b"], "a\u{fffd}b does not exist"),
        (&["reproduce", "\u{1b}[31mfig"], "[31mfig` is none of the paper's figures"),
        (&["train", "reach", "--seed", "\u{1b}[2J"], "it has to be a whole number"),
        (&["init", "lamp", "--name", "a\u{2066}b", "--path", CHECKOUT], "`a\u{fffd}b` is no name for a package"),
    ] {
        let (code, stdout, stderr) = run(&sandbox, arguments);
        assert_eq!((code, &*stdout), (Some(2), ""), "{stderr}");
        assert!(stderr.contains(told), "{arguments:?}: {stderr}");
        let raw = |c: char| c.is_control() && c != '\n' || ('\u{202a}'..='\u{202e}').contains(&c) || c == '\u{2066}';
        assert!(!stderr.contains(raw), "{stderr:?}");
    }
}

/// Results name files as messages do: a mark that turns the direction of writing went through standard output.
#[test]
fn nothing_in_results_turns_the_writing() {
    let sandbox = Sandbox::new("printable-results");
    let (code, stdout, stderr) = run(&sandbox, &["graph", "reach", "--out", "a\u{202e}b.svg"]);
    assert_eq!((code, &*stdout, &*stderr), (Some(0), "a\u{fffd}b.svg\n", ""));
    assert!(sandbox.path("a\u{202e}b.svg").is_file());
}

/// Errors of the command line stayed plain under `--log-format json`, so that a script could read all messages but these.
#[test]
fn errors_of_the_command_line_are_json_too() {
    let sandbox = Sandbox::new("json-errors");
    for arguments in [&["--log-format", "json", "trian"][..], &["train", "--sed", "3", "reach", "--log-format=json"]] {
        let (code, stdout, stderr) = run(&sandbox, arguments);
        assert_eq!((code, &*stdout), (Some(2), ""), "{stderr}");
        let line: serde_json::Value = serde_json::from_str(&stderr).unwrap();
        assert_eq!(line["level"], "ERROR");
        assert!(line["message"].as_str().unwrap().starts_with("error: un"), "{line}");
    }
    let (code, help, stderr) = run(&sandbox, &["--log-format", "json", "--help"]);
    assert_eq!((code, &*stderr), (Some(0), ""));
    assert!(help.contains("Usage: hwasp"));
}

/// A training whose learning rate was nearly nothing ended as if it had learned something.
#[test]
fn a_training_that_changes_nothing_says_so() {
    let sandbox = Sandbox::new("nothing-changed");
    let still = "--set ppo.learning_rate=1e-9 --set design.learning_rate_scale=0 --set noise.learning_rate_scale=0";
    let train = "train reach --env-steps 2400 --set train.evaluation_episodes=2 --out";
    let warning = "warning: the training changed nothing: ";
    let told = |line: &str| String::from_utf8(sandbox.run(line).stderr).unwrap();
    let still = told(&format!("{train} still {still}"));
    assert!(still.contains(warning), "{still}");
    let moved = told(&format!("{train} moved"));
    assert!(!moved.contains(warning), "{moved}");
    // One that is resumed at its end has nothing left to change.
    sandbox.put_stopped_run();
    let resumed = told("train --resume run");
    assert!(resumed.contains("resuming reach") && !resumed.contains(warning), "{resumed}");
}

/// The same trainings in a comparison had their row without a remark, as if their methods could do no better.
#[test]
fn a_comparison_of_trainings_that_change_nothing_says_so() {
    let sandbox = Sandbox::new("nothing-compared");
    // CMA-ES reads none of these.
    let line = "compare reach --methods hwasp,cmaes --seeds 2 --env-steps 20000 --set train.evaluation_episodes=2 --set \
                ppo.learning_rate=1e-9 --set design.learning_rate_scale=0 --set noise.learning_rate_scale=0 --out both";
    let remark = "Trainings that changed nothing: every update was rejected, too small";
    // The second time all cells are there.
    for _ in 0..2 {
        let output = sandbox.run(line);
        let (table, told) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
        assert!(table.contains(remark) && table.contains("\n- hwasp, seeds 0, 1\n"), "{table}");
        assert!(!table.contains("- cmaes, seed"), "{table}");
        assert!(told.contains("warning: hwasp, seeds 0, 1: the training changed nothing: every update"), "{told}");
    }
    assert!(sandbox.run("report both").status.success());
    let html = String::from_utf8(sandbox.read("both/report.html")).unwrap();
    assert!(html.contains("Trainings that changed nothing") && html.contains("<li>hwasp, seeds 0, 1</li>"), "{html}");
}

/// `--set train=[]` was lost where another option set a key of the table: `--env-steps` made a table of it.
#[test]
fn a_list_for_a_table_is_refused_before_other_options() {
    let sandbox = Sandbox::new("list-for-a-table");
    let told = sandbox.refused(&["train reach --set train=[] --env-steps 2400 --out run"]);
    assert!(told.contains("! error: train is [], and a table for --env-steps 2400\n!  --> --set train=[]\n"), "{told}");
}
