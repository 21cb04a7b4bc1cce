//! Folders that are there already, and runs that are empty. `errors` has those that are damaged.

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
    sandbox.refused(&[&format!("{TINY} --seed 1 --out run"), &format!("{TINY} --out file"), "compare reach --out run"]);
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
fn a_plot_of_a_run_and_of_what_is_none_draws_nothing() {
    let sandbox = Sandbox::with_run("no-run");
    fs::create_dir(sandbox.path("empty")).unwrap();
    sandbox.refused(&["plot run empty"]);
    assert!(!sandbox.path("curves.svg").exists());
}

#[test]
fn a_run_without_rows_is_drawn_with_a_note() {
    let sandbox = Sandbox::with_run("no-rows");
    let header = String::from_utf8(sandbox.read("run/metrics.csv")).unwrap().lines().next().unwrap().to_owned();
    sandbox.write("run/metrics.csv", header + "\n");
    insta::assert_snapshot!(sandbox.transcript(&["plot run"]));
}
