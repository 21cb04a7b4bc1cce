//! Help texts.

use crate::sandbox::Sandbox;

#[test]
fn help_of_the_program() {
    let sandbox = Sandbox::new("help");
    insta::assert_snapshot!(sandbox.transcript(&["--help"]));
}

#[test]
fn the_version() {
    let output = Sandbox::new("version").run("--version");
    assert_eq!(String::from_utf8_lossy(&output.stdout), concat!("hwasp ", env!("CARGO_PKG_VERSION"), "\n"));
}

#[test]
fn help_of_every_command() {
    let sandbox = Sandbox::new("help-commands");
    let lines = ["train", "eval", "design", "play", "plot", "compare", "reproduce", "check", "list", "graph", "init"]
        .map(|command| format!("{command} --help"));
    insta::assert_snapshot!(sandbox.transcript(&lines.each_ref().map(String::as_str)));
}

#[test]
fn without_arguments_the_help_is_shown_as_an_error() {
    let output = Sandbox::new("no-arguments").run("");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("Usage: hwasp [OPTIONS] <COMMAND>"));
}
