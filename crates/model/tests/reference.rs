//! The reference in the documents is what the code reads.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use std::fs;
use std::path::Path;

/// `HWASP_WRITE_DOCS=1 cargo test -p hwasp-model --test reference` writes it anew.
#[test]
fn names_and_functions_are_in_the_document() {
    const BEGIN: &str = "<!-- names: written by the tests of hwasp-model -->\n";
    const END: &str = "<!-- end of names -->\n";
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/own_robot.md");
    let there = fs::read_to_string(&path).unwrap();
    let (before, rest) = there.split_once(BEGIN).unwrap();
    let (_, after) = rest.split_once(END).unwrap();
    let wanted = format!("{before}{BEGIN}{}{END}{after}", hwasp_model::reference());
    if std::env::var_os("HWASP_WRITE_DOCS").is_some() {
        fs::write(path, wanted).unwrap();
        return;
    }
    assert!(
        there == wanted,
        "docs/own_robot.md is old: HWASP_WRITE_DOCS=1 cargo test -p hwasp-model --test reference renews it"
    );
}
