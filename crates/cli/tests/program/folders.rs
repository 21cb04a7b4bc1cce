//! Folders that cannot be written, and runs that are none or are damaged.

use std::fmt::Write;
use std::fs;

use crate::sandbox::{Sandbox, TINY};

#[test]
fn what_exists_is_not_overwritten() {
    let sandbox = Sandbox::with_run("exists");
    let contents = || {
        let files = fs::read_dir(sandbox.path("run")).unwrap().map(|file| file.unwrap().path());
        let mut files: Vec<_> = files.map(|path| (path.clone(), fs::read(path).unwrap())).collect();
        files.sort();
        files
    };
    let before = contents();
    sandbox.write("file", "precious");
    let refused = sandbox.refused(&[&format!("{TINY} --seed 1 --out run"), &format!("{TINY} --out file")]);
    insta::assert_snapshot!(refused);
    assert_eq!(contents(), before);
    assert_eq!(sandbox.read("file"), b"precious");
}

#[test]
fn an_empty_folder_is_used() {
    let sandbox = Sandbox::new("empty-out");
    fs::create_dir(sandbox.path("run")).unwrap();
    assert!(sandbox.run(&format!("{TINY} --out run")).status.success());
    assert!(sandbox.path("run/summary.json").is_file());
}

#[test]
fn a_folder_under_a_file() {
    let sandbox = Sandbox::new("under-a-file");
    sandbox.write("file", "");
    insta::assert_snapshot!(
        sandbox.refused(&[&format!("{TINY} --out file/run"), &format!("{TINY} --out file/run/deep")])
    );
}

#[cfg(unix)]
#[test]
fn a_folder_that_may_not_be_written() {
    use std::os::unix::fs::PermissionsExt;
    let sandbox = Sandbox::new("read-only");
    let locked = sandbox.path("locked");
    fs::create_dir(&locked).unwrap();
    fs::set_permissions(&locked, fs::Permissions::from_mode(0o555)).unwrap();
    if fs::write(locked.join("probe"), "").is_ok() {
        return; // permissions do not bind this user
    }
    let refused = sandbox.refused(&[&format!("{TINY} --out locked/run")]);
    // No snapshot, since not everybody who runs the tests can make it.
    assert!(refused.contains("error: cannot create locked/run: Permission denied"), "{refused}");
    assert!(refused.contains("hint: name another folder with --out"), "{refused}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_place_where_nothing_can_be_created() {
    insta::assert_snapshot!(Sandbox::new("proc").refused(&[&format!("{TINY} --out /proc/run")]));
}

#[test]
fn folders_that_are_no_run() {
    let sandbox = Sandbox::with_run("no-run");
    fs::create_dir(sandbox.path("empty")).unwrap();
    insta::assert_snapshot!(sandbox.refused(&[
        "eval nowhere",
        "eval run/summary.json",
        "eval empty",
        "plot nowhere",
        "plot run empty",
    ]));
    assert!(!sandbox.path("curves.svg").exists());
}

#[test]
fn an_unfinished_run() {
    let sandbox = Sandbox::with_run("unfinished");
    fs::remove_file(sandbox.path("run/policy.safetensors")).unwrap();
    fs::remove_file(sandbox.path("run/metrics.csv")).unwrap();
    insta::assert_snapshot!(sandbox.refused(&["eval run", "plot run"]));
}

#[test]
fn a_damaged_policy() {
    let sandbox = Sandbox::with_run("damaged-policy");
    let sound = sandbox.read("run/policy.safetensors");
    let mut not_finite = sound.clone();
    let last = not_finite.len() - 4;
    not_finite[last..].copy_from_slice(&f32::NAN.to_le_bytes());
    let mut huge_header = sound.clone();
    huge_header[..8].copy_from_slice(&u64::MAX.to_le_bytes());
    let mut transcript = String::new();
    for (what, bytes) in [
        ("empty", &[][..]),
        ("cut in its header", &sound[..100]),
        ("cut in its data", &sound[..sound.len() - 4]),
        ("a header of 2^64 bytes", &huge_header),
        ("NaN", &not_finite),
        ("text", b"these are no weights"),
    ] {
        sandbox.write("run/policy.safetensors", bytes);
        write!(transcript, "# {what}\n{}", sandbox.refused(&["eval run"])).unwrap();
    }
    insta::assert_snapshot!(transcript);
}

#[test]
fn a_policy_of_another_experiment() {
    let sandbox = Sandbox::with_run("other-policy");
    sandbox.replace("run/experiment.toml", "[controller]\nhidden = [16]", "[controller]\nhidden = [8]");
    insta::assert_snapshot!(sandbox.refused(&["eval run"]));
}

#[test]
fn a_changed_experiment() {
    let sandbox = Sandbox::with_run("changed-experiment");
    sandbox.replace("run/experiment.toml", "gae_lambda = 0.95", "gae_lambda = 7");
    sandbox.replace("run/experiment.toml", "seed = 0", "seed = \"zero\"");
    insta::assert_snapshot!(sandbox.refused(&["eval run", "plot run"]));
}

#[test]
fn damaged_metrics() {
    let sandbox = Sandbox::with_run("damaged-metrics");
    let sound = String::from_utf8(sandbox.read("run/metrics.csv")).unwrap();
    let header = sound.lines().next().unwrap().to_owned();
    let mut transcript = String::new();
    for (what, text) in [
        ("empty", String::new()),
        ("another table", "a,b\n1,2\n".into()),
        ("a row of two fields", format!("{sound}2,3\n")),
        ("a word for a number", format!("{header}\n0,many,0,0,0,0,0,0,0\n")),
        ("another run's rows", format!("{sound}0,1200,0,0,0,0,0,0,0\n")),
    ] {
        sandbox.write("run/metrics.csv", text);
        write!(transcript, "# {what}\n{}", sandbox.refused(&["plot run"])).unwrap();
    }
    insta::assert_snapshot!(transcript);
}

#[test]
fn a_run_without_rows_is_drawn_with_a_note() {
    let sandbox = Sandbox::with_run("no-rows");
    let header = String::from_utf8(sandbox.read("run/metrics.csv")).unwrap().lines().next().unwrap().to_owned();
    sandbox.write("run/metrics.csv", header + "\n");
    insta::assert_snapshot!(sandbox.transcript(&["plot run"]));
}

#[test]
fn pictures_in_no_format_or_nowhere() {
    let sandbox = Sandbox::with_run("picture-format");
    insta::assert_snapshot!(sandbox.refused(&["plot run --out curves.jpg", "plot run --out curves"]));
    insta::assert_snapshot!("picture_nowhere", sandbox.transcript(&["plot run --out nowhere/curves.svg"]));
}
