//! The reference in the documents is what the code reads.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use std::fs;
use std::path::Path;

/// `HWASP_WRITE_DOCS=1 cargo test -p hwasp-model --test reference` writes both anew.
#[test]
fn names_functions_and_fields_are_in_the_document() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/formulas.md");
    let there = fs::read_to_string(&path).unwrap();
    let mut wanted = there.clone();
    for (what, text) in [("names", hwasp_model::reference()), ("fields", hwasp_model::settable())] {
        let begin = format!("<!-- {what}: written by the tests of hwasp-model -->\n");
        let end = format!("<!-- end of {what} -->\n");
        let (before, rest) = wanted.split_once(&begin).unwrap();
        let (_, after) = rest.split_once(&end).unwrap();
        wanted = format!("{before}{begin}{text}{end}{after}");
    }
    if std::env::var_os("HWASP_WRITE_DOCS").is_some() {
        fs::write(path, wanted).unwrap();
        return;
    }
    assert!(
        there == wanted,
        "docs/formulas.md is old: HWASP_WRITE_DOCS=1 cargo test -p hwasp-model --test reference renews it"
    );
}
