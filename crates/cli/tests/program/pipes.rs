//! Readers that go away, names that are no text.

use std::io::pipe;
use std::process::{Command, Stdio};

use crate::sandbox::{Sandbox, TINY};

/// A pipe that nobody reads.
fn broken() -> Stdio {
    let (_, writer) = pipe().unwrap();
    writer.into()
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let sandbox = Sandbox::with_run("broken-pipe");
    for line in ["list", "check reach", "graph reach", "eval run", "eval run --json", "plot run"] {
        let output = sandbox.command(line).stdout(broken()).stderr(Stdio::piped()).output().unwrap();
        assert!(output.status.success() && output.stderr.is_empty(), "{line}: {output:?}");
    }
}

#[test]
fn a_training_that_nobody_watches_comes_to_its_end() {
    let sandbox = Sandbox::new("unwatched");
    let mut command = sandbox.command(&format!("{TINY} --out run"));
    let status = command.stdout(broken()).stderr(broken()).status().unwrap();
    assert!(status.success(), "{status}");
    assert!(sandbox.path("run/summary.json").is_file());
}

#[cfg(unix)]
#[test]
fn names_need_not_be_utf_8() {
    use std::os::unix::ffi::OsStrExt;
    let sandbox = Sandbox::new("no-utf-8");
    let mut command: Command = sandbox.command(&format!("{TINY} --out"));
    let output = command.arg(std::ffi::OsStr::from_bytes(b"r\xffn")).output().unwrap();
    assert!(output.status.success(), "{output:?}");
}
