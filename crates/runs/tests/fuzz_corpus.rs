//! Every input that the fuzzer found worth keeping, and every one that once broke something, again.

#![allow(clippy::unwrap_used, clippy::print_stdout)] // helpers of tests are tests too; what a test prints is seen where it fails

#[path = "../../../fuzz/src/lib.rs"]
#[allow(unreachable_pub)] // there it is a library
mod fuzz;

use std::fs;
use std::path::Path;

/// All inputs of a target, in the order of their names.
fn replay(target: &str, body: fn(&[u8])) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz");
    let mut files: Vec<_> = ["corpus", "artifacts"]
        .iter()
        .filter_map(|folder| fs::read_dir(root.join(folder).join(target)).ok())
        .flat_map(|entries| entries.map(|entry| entry.unwrap().path()))
        .collect();
    files.sort();
    assert!(!files.is_empty(), "no inputs for {target}");
    for file in files {
        println!("{}", file.display());
        body(&fs::read(&file).unwrap());
    }
}

#[test]
fn experiments() {
    replay("experiment", fuzz::experiment);
}

#[test]
fn checkpoints() {
    replay("checkpoint", fuzz::checkpoint);
}

#[test]
fn states() {
    replay("state", fuzz::state);
}

#[test]
fn policies() {
    replay("policy", fuzz::policy);
}

#[test]
fn metrics() {
    replay("metrics", fuzz::metrics);
}

#[test]
fn formulas() {
    replay("formula", fuzz::formula);
}

#[test]
fn robots() {
    replay("robot", fuzz::robot);
}
