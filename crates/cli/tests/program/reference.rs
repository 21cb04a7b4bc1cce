//! The schema of experiment files, and the reference of their keys in docs/experiments.md.
//!
//! `HWASP_WRITE_DOCS=1 cargo test -p hwasp-cli --test program reference` writes the reference anew.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::sandbox::Sandbox;

/// Around the generated part of the page.
const MARKS: [&str; 2] = ["<!-- keys -->\n", "<!-- end of keys -->\n"];

/// The reference was written by hand beside the source, and compared with comments in it: keys could stand there that no file may
/// have, with limits that were others.
#[test]
fn every_key_is_in_the_reference() {
    let output = Sandbox::new("reference").run("schema --reference");
    assert!(output.status.success());
    let reference = String::from_utf8(output.stdout).unwrap();
    // Without the engine's problems it is another one.
    if !cfg!(feature = "mujoco") {
        return;
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/experiments.md");
    let page = fs::read_to_string(&path).unwrap();
    let (before, rest) = page.split_once(MARKS[0]).unwrap();
    let (there, after) = rest.split_once(MARKS[1]).unwrap();
    if std::env::var_os("HWASP_WRITE_DOCS").is_some() {
        fs::write(&path, format!("{before}{}\n{reference}\n{}{after}", MARKS[0], MARKS[1])).unwrap();
        return;
    }
    let rows = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
    let lacking: Vec<_> = rows(&reference).into_iter().filter(|row| !rows(there).contains(row)).collect();
    let beyond: Vec<_> = rows(there).into_iter().filter(|row| !rows(&reference).contains(row)).collect();
    assert!(
        there.trim() == reference.trim(),
        "docs/experiments.md lacks {lacking:#?} and has {beyond:#?}\nhint: `HWASP_WRITE_DOCS=1 cargo test -p hwasp-cli --test program \
         reference` writes it anew; read the difference"
    );
}

#[test]
fn the_schema_knows_every_table_and_problem() {
    let sandbox = Sandbox::new("schema");
    let output = sandbox.run("schema --out hwasp.schema.json");
    assert_eq!(String::from_utf8_lossy(&output.stdout), "hwasp.schema.json\n");
    let schema: Value = serde_json::from_slice(&sandbox.read("hwasp.schema.json")).unwrap();
    assert_eq!(schema["required"], serde_json::json!(["name", "task"]));
    let problems = schema.pointer("/definitions/task/properties/problem/enum").unwrap();
    assert!(problems.as_array().unwrap().contains(&"bar-length".into()), "{problems}");
    // What a resolved experiment has, the schema has.
    sandbox.put_run();
    let text = String::from_utf8(sandbox.read("run/experiment.toml")).unwrap();
    let table: toml::Table = text.parse().unwrap();
    for (name, value) in &table {
        let known = schema.pointer(&format!("/definitions/{name}/properties"));
        let Some(keys) = value.as_table() else {
            assert!(schema["properties"][name].is_object(), "{name}");
            continue;
        };
        for key in keys.keys() {
            assert!(known.unwrap()[key].is_object(), "{name}.{key}");
        }
    }
    // One table is not told seven times over.
    assert!(sandbox.read("hwasp.schema.json").len() < 150_000);
}
