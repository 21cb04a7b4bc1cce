//! Help texts, and the reference of the command line in `docs/command_line.md`.
//!
//! `HWASP_WRITE_DOCS=1 cargo test -p hwasp-cli --test program reference` writes the reference anew.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use crate::sandbox::Sandbox;

const INTRODUCTION: &str = "\
# The command line

    hwasp help train

Every command says what it does and takes. This page is what they say, written by the tests. In a checkout
`cargo run --release -- train …` builds the program where needed and runs it.
";

#[test]
fn the_version() {
    let output = Sandbox::new("version").run("--version");
    assert_eq!(String::from_utf8_lossy(&output.stdout), concat!("hwasp ", env!("CARGO_PKG_VERSION"), "\n"));
}

#[test]
fn every_command_is_in_the_reference() {
    let sandbox = Sandbox::new("help");
    let mut page = INTRODUCTION.to_owned();
    let mut waiting = vec!["hwasp".to_owned()];
    while let Some(command) = waiting.pop() {
        let output = sandbox.run(&command.replacen("hwasp", "help", 1));
        assert!(output.status.success(), "{command}");
        let help = String::from_utf8(output.stdout).unwrap();
        let lines = help.lines().map(str::trim_end).fold(String::new(), |text, line| text + line + "\n");
        write!(page, "\n## {command}\n\n```text\n{}\n```\n", lines.trim_end()).unwrap();
        waiting.extend(subcommands(&help).into_iter().rev().map(|name| format!("{command} {name}")));
    }
    // Without the engine there are fewer.
    if !cfg!(feature = "mujoco") {
        return;
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/command_line.md");
    if std::env::var_os("HWASP_WRITE_DOCS").is_some() {
        fs::write(path, page).unwrap();
        return;
    }
    let there = fs::read_to_string(path).unwrap_or_default();
    let differs = (1..).zip(page.lines().zip(there.lines().chain([""]))).find(|(_, (new, old))| new != old);
    assert!(
        page == there,
        "docs/command_line.md is not what the program says now; the first difference, line, now and there: {differs:?}\n\
         hint: `HWASP_WRITE_DOCS=1 cargo test -p hwasp-cli --test program reference` renews it; read the difference"
    );
}

/// The commands that a help text names, but for `help`.
fn subcommands(help: &str) -> Vec<&str> {
    let list = help.split_once("\nCommands:\n").map_or("", |(_, list)| list.split("\n\n").next().unwrap_or_default());
    list.lines()
        .filter_map(|line| line.strip_prefix("  ").filter(|line| !line.starts_with(' '))?.split(' ').next())
        .filter(|&name| name != "help")
        .collect()
}

#[test]
fn without_arguments_it_greets() {
    let output = Sandbox::new("no-arguments").run("");
    let greeting = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && greeting.starts_with("hwasp: hardware as policy."), "{greeting}");
    assert_eq!(greeting.matches("\n  hwasp ").count(), 3);
}
