//! Bad inputs and what the program says of each: a table, from which docs/errors.md is made.
//!
//! `HWASP_WRITE_DOCS=1 cargo test -p hwasp-cli --test program errors` writes the document anew.

mod checkpoints;
#[cfg(feature = "cluster")]
mod cluster;
mod commands;
mod experiments;
mod folders;
mod projects;
#[cfg(feature = "mujoco")]
mod robots;
mod system;
mod tables;

use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use crate::sandbox::Sandbox;

const INTRODUCTION: &str = "\
# Errors

    hwasp check my.toml      # all that is wrong with an experiment, at once

What the program says of inputs that are wrong, {count} of them: search this page for the message you got. The exit status
is 0 if all went well, 1 if something failed on the way, 2 if what was asked for is wrong (nothing was begun then), 130 if
the program was asked to stop. Messages go to standard error; `os error` numbers are those of Linux. The page is written
by the tests, which make every mistake on it.
";

/// Some inputs of one kind.
struct Group {
    title: &'static str,
    cases: &'static [Case],
}

/// An input that is wrong.
struct Case {
    /// What is wrong, in a few words.
    what: &'static str,
    given: Given,
    /// As typed into a shell.
    line: &'static str,
    code: i32,
    when: When,
    /// Whether it prints a result all the same.
    prints: bool,
}

/// What there is in the folder before.
#[derive(Clone, Copy)]
enum Given {
    Nothing,
    /// A file `mine.toml`.
    File(&'static str),
    Made(fn(&Sandbox)),
}

/// When it goes wrong.
#[derive(Clone, Copy)]
enum When {
    AtOnce,
    /// The training, with the folder `run`, is under way when this happens, and is asked to stop then.
    UnderWay(fn(&Sandbox)),
    /// At once, if the system keeps this user from something; the message, for users who may do everything.
    Bound(&'static str),
}

const fn case(what: &'static str, given: Given, line: &'static str) -> Case {
    Case { what, given, line, code: 2, when: When::AtOnce, prints: false }
}

impl Case {
    /// It fails on the way.
    const fn late(self) -> Self {
        Self { code: 1, ..self }
    }

    /// What was found is told before the error.
    const fn printing(self) -> Self {
        Self { prints: true, ..self }
    }

    const fn when(self, when: When) -> Self {
        Self { when, ..self }
    }
}

/// One that `hwasp check mine.toml` reads.
const fn file(what: &'static str, text: &'static str) -> Case {
    case(what, Given::File(text), "hwasp check mine.toml")
}

const GROUPS: &[Group] = &[
    Group { title: "Experiment files", cases: experiments::CASES },
    #[cfg(feature = "mujoco")]
    Group { title: "Robots of one's own", cases: robots::CASES },
    Group { title: "Command lines", cases: commands::CASES },
    #[cfg(feature = "cluster")]
    Group { title: "Many machines", cases: cluster::CASES },
    Group { title: "Run folders", cases: folders::CASES },
    Group { title: "Checkpoints", cases: checkpoints::CASES },
    Group { title: "Metrics, policies and summaries", cases: tables::CASES },
    Group { title: "Projects", cases: projects::CASES },
    Group { title: "The system", cases: system::CASES },
];

#[test]
fn every_error_is_in_the_document() {
    let count: usize = GROUPS.iter().map(|group| group.cases.len()).sum();
    let mut text = INTRODUCTION.replace("{count}", &count.to_string());
    for group in GROUPS {
        let anchor = group.title.to_lowercase().replace(' ', "-").replace([',', '\''], "");
        write!(text, "\n- [{}](#{anchor})", group.title).unwrap();
    }
    text.push('\n');
    for group in GROUPS {
        write!(text, "\n## {}\n", group.title).unwrap();
        for (i, case) in group.cases.iter().enumerate() {
            let name = format!("errors/{}-{i}", group.title);
            let message = told(case, &Sandbox::new(&name));
            let Case { what, line, code, .. } = case;
            write!(text, "\n**{what}** (exit status {code})\n\n```text\n$ {line}\n{message}```\n").unwrap();
        }
    }
    // Without the engine there are fewer.
    if !cfg!(feature = "mujoco") {
        return;
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/errors.md");
    if std::env::var_os("HWASP_WRITE_DOCS").is_some() {
        fs::write(path, text).unwrap();
        return;
    }
    let there = fs::read_to_string(path).unwrap_or_default();
    let differs = (1..).zip(text.lines().zip(there.lines().chain([""]))).find(|(_, (new, old))| new != old);
    assert!(
        text == there,
        "docs/errors.md is not what the program says now; the first difference, line, now and there: {differs:?}\n\
         hint: `HWASP_WRITE_DOCS=1 cargo test -p hwasp-cli --test program errors` renews it; read the difference"
    );
}

/// What the program says of a case.
fn told(case: &Case, sandbox: &Sandbox) -> String {
    match case.given {
        Given::Nothing => {}
        Given::File(text) => sandbox.write("mine.toml", text),
        Given::Made(make) => make(sandbox),
    }
    let output = match case.when {
        When::UnderWay(meanwhile) => disturbed(case, sandbox, meanwhile),
        When::Bound(message) if fs::write(sandbox.path("locked/probe"), "").is_ok() => return message.to_owned(),
        _ => shell(case, sandbox).output().unwrap(),
    };
    let Case { what, line, code, .. } = case;
    let message = String::from_utf8(output.stderr).unwrap();
    let all = format!("{what}: {line}\n{message}");
    assert_eq!(output.status.code(), Some(*code), "{all}");
    assert_ne!(output.stdout.is_empty(), case.prints, "{all}{}", String::from_utf8_lossy(&output.stdout));
    assert!(message.starts_with("error: ") && message.ends_with('\n') && !message.contains("panicked"), "{all}");
    if let When::Bound(said) = case.when {
        assert_eq!(message, said);
    }
    // How far a training came that was stopped is chance.
    match message.split_once("stopped after ") {
        Some((before, after)) => {
            let after = after.trim_start_matches(|c: char| c.is_ascii_digit());
            format!("{before}stopped after STEPS{after}")
        }
        None => message,
    }
}

/// The command in a shell, where `hwasp` is the program.
fn shell(case: &Case, sandbox: &Sandbox) -> Command {
    let program = Path::new(env!("CARGO_BIN_EXE_hwasp"));
    let mut command = Command::new("/bin/sh");
    command.arg("-c").arg(format!("exec {}", case.line)).current_dir(sandbox.path("")).env_clear();
    let places = [program.parent().unwrap(), Path::new("/usr/bin"), Path::new("/bin")];
    command.env("PATH", std::env::join_paths(places).unwrap()).stdin(Stdio::null());
    command
}

/// Begins a training, does something once it has rows, and asks it to stop.
fn disturbed(case: &Case, sandbox: &Sandbox, meanwhile: fn(&Sandbox)) -> Output {
    let child = shell(case, sandbox).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let began = Instant::now();
    let rows = || fs::read_to_string(sandbox.path("run/metrics.csv")).map_or(0, |text| text.lines().count());
    while rows() < 3 {
        assert!(began.elapsed() < Duration::from_mins(1), "{}", case.what);
        std::thread::sleep(Duration::from_millis(2));
    }
    meanwhile(sandbox);
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    child.wait_with_output().unwrap()
}

/// Changes the bytes of a file.
fn change(sandbox: &Sandbox, name: &str, how: impl Fn(&mut Vec<u8>)) {
    let mut bytes = sandbox.read(name);
    how(&mut bytes);
    sandbox.write(name, bytes);
}
