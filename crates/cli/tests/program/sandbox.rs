//! Empty folders to run the program in.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

/// A training that takes milliseconds: two iterations.
pub(crate) const TINY: &str = "train reach --env-steps 2400 --set train.evaluation_episodes=20";

/// An empty folder of a test's own.
pub(crate) struct Sandbox(PathBuf);

impl Sandbox {
    /// Empties it, should an earlier test run have left something.
    pub(crate) fn new(name: &str) -> Self {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// One with a finished run in the folder `run`, without its checkpoints.
    pub(crate) fn with_run(name: &str) -> Self {
        let sandbox = Self::new(name);
        sandbox.put_run();
        sandbox
    }

    /// Puts a finished run into the folder `run`, without its checkpoints.
    pub(crate) fn put_run(&self) {
        static RUN: OnceLock<Sandbox> = OnceLock::new();
        let trained = RUN.get_or_init(|| {
            let sandbox = Sandbox::new("trained-once");
            assert!(sandbox.run(&format!("{TINY} --out run")).status.success());
            sandbox
        });
        copy_files(&trained.path("run"), &self.path("run"));
    }

    /// Puts a run into the folder `run` that was stopped after its second iteration: with its checkpoints,
    /// without what is written last.
    pub(crate) fn put_stopped_run(&self) {
        static RUN: OnceLock<Sandbox> = OnceLock::new();
        let stopped = RUN.get_or_init(|| {
            let sandbox = Sandbox::new("stopped-once");
            assert!(sandbox.run(&format!("{TINY} --checkpoint-every 0 --out run")).status.success());
            for last in ["policy.safetensors", "design.toml", "curves.svg", "summary.json"] {
                fs::remove_file(sandbox.path("run").join(last)).unwrap();
            }
            sandbox
        });
        copy_files(&stopped.path("run"), &self.path("run"));
        copy_files(&stopped.path("run/checkpoints"), &self.path("run/checkpoints"));
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    pub(crate) fn write(&self, name: &str, contents: impl AsRef<[u8]>) {
        fs::write(self.path(name), contents).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }

    /// Changes a text file; the text has to be there.
    pub(crate) fn replace(&self, name: &str, from: &str, to: &str) {
        let text = String::from_utf8(self.read(name)).unwrap();
        assert!(text.contains(from), "{name} has no {from:?}:\n{text}");
        self.write(name, text.replace(from, to));
    }

    /// Lets the summary of the run in `run` forget of which experiment it is, as old ones do, so that that can be changed.
    pub(crate) fn forget_experiment(&self) {
        let summary = String::from_utf8(self.read("run/summary.json")).unwrap();
        let kept: Vec<&str> = summary.lines().filter(|line| !line.contains("\"experiment_sha256\"")).collect();
        assert!(kept.len() < summary.lines().count(), "{summary}");
        self.write("run/summary.json", kept.join("\n"));
    }

    /// The program with words parted by spaces, in this folder, with nothing of the caller's environment.
    pub(crate) fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_hwasp"));
        command.args(line.split_whitespace()).current_dir(&self.0).env_clear().stdin(Stdio::null());
        // Without a PATH the system looks for other programs in places of its own.
        command.env("PATH", "/nowhere");
        command
    }

    pub(crate) fn run(&self, line: &str) -> Output {
        let output = self.command(line).output().unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(!stderr.contains("panicked"), "{line}\n{stderr}");
        output
    }

    /// What a user sees of some commands.
    pub(crate) fn transcript(&self, lines: &[&str]) -> String {
        lines.iter().map(|line| shown(line, &self.run(line))).collect::<Vec<_>>().join("\n")
    }

    /// The same for commands that ask for what is wrong: each ends with status 2 and prints no result.
    pub(crate) fn refused(&self, lines: &[&str]) -> String {
        let mut text = String::new();
        for line in lines {
            let output = self.run(line);
            let shown = shown(line, &output);
            assert_eq!(output.status.code(), Some(2), "{shown}");
            assert!(output.stdout.is_empty(), "{shown}");
            let _ = writeln!(text, "{shown}");
        }
        text
    }
}

/// Copies the files of a folder, not the folders in it.
fn copy_files(from: &Path, to: &Path) {
    fs::create_dir(to).unwrap();
    for file in fs::read_dir(from).unwrap().map(Result::unwrap).filter(|file| file.path().is_file()) {
        fs::copy(file.path(), to.join(file.file_name())).unwrap();
    }
}

fn shown(line: &str, output: &Output) -> String {
    let mut text = format!("$ hwasp {line}\n{}", String::from_utf8_lossy(&output.stdout));
    for line in String::from_utf8_lossy(&output.stderr).lines() {
        let _ = writeln!(text, "{}", format!("! {line}").trim_end());
    }
    match output.status.code() {
        Some(code) => writeln!(text, "[exit {code}]"),
        None => writeln!(text, "[{}]", output.status),
    }
    .unwrap();
    text
}

/// Replaces numbers with a decimal point and speeds by `#`, with the spaces that aligned them.
pub(crate) fn without_figures(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(start) = rest.find(|c: char| c.is_ascii_digit()) {
        let number = &rest[start..];
        let length = number.find(|c: char| !c.is_ascii_digit() && !matches!(c, '.' | ',')).unwrap_or(number.len());
        let (number, after) = number.split_at(length);
        let number = number.trim_end_matches(['.', ',']);
        let after = if after.len() + number.len() < rest.len() - start { &rest[start + number.len()..] } else { after };
        out.push_str(&rest[..start]);
        if number.contains('.') || after.starts_with(" steps/s") || after.starts_with("k steps/s") {
            let kept = out.trim_end_matches('-').trim_end_matches(' ').len();
            let spaced = out[kept..].contains(' ');
            out.truncate(kept);
            out.push_str(if spaced { " #" } else { "#" });
        } else {
            out.push_str(number);
        }
        rest = after;
    }
    out + rest
}
