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
    let commands = "train eval design export parts tolerances play watch plot report compare reproduce check schema list laws graph init";
    let deploy = ["init", "check", "calibrate", "run", "replay", "identify", "trials"]
        .map(|command| format!("deploy {command} --help"));
    let lines = commands
        .split(' ')
        .map(|command| format!("{command} --help"))
        .chain(["deploy --help".to_owned()])
        .chain(deploy);
    let lines: Vec<String> = lines.collect();
    insta::assert_snapshot!(sandbox.transcript(&lines.iter().map(String::as_str).collect::<Vec<_>>()));
}

#[test]
fn without_arguments_the_help_is_shown_as_an_error() {
    let output = Sandbox::new("no-arguments").run("");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("Usage: hwasp [OPTIONS] <COMMAND>"));
}
