//! Folders that hold runs.

use std::fs;

use serde_json::{Value, json};

use crate::client::{empty, get, serve, trained};

fn labels(list: &Value) -> Vec<String> {
    let label = |run: &Value| run["label"].as_str().unwrap().rsplit("folders/").next().unwrap().to_owned();
    list["runs"].as_array().unwrap().iter().map(label).collect()
}

/// A run that appears later comes behind those that are there, whose places are their names.
#[test]
fn a_folder_stands_for_the_runs_in_it() {
    let folder = empty("folders");
    trained(&folder.join("b"));
    trained(&folder.join("comparison/cells/m-seed0"));
    trained(&folder.join("notes/of/mine"));
    fs::create_dir_all(folder.join("notes/of/mine/deep")).unwrap();
    let server = serve(&[folder.join("comparison"), folder.clone(), folder.join("b")]);
    let list = get(&server, "/api/runs").json();
    assert_eq!(labels(&list), ["comparison/cells/m-seed0", "b"]);
    trained(&folder.join("a"));
    std::thread::sleep(std::time::Duration::from_millis(300));
    let list = get(&server, "/api/runs").json();
    assert_eq!(labels(&list), ["comparison/cells/m-seed0", "b", "a"]);
    assert_eq!((&list["waiting"], &list["full"]), (&json!([]), &json!(false)));
    assert_eq!(get(&server, "/api/runs/2").json()["index"], json!(2));
}

/// Its runs come behind those that lie nearer.
#[test]
fn a_folder_stands_for_the_comparisons_in_it() {
    let folder = empty("compared-folders");
    for run in ["compare-reach/cells/a-seed0", "compare-reach/cells/b-seed0", "z", "compare-reach/other/c"] {
        trained(&folder.join(run));
    }
    let list = get(&serve(std::slice::from_ref(&folder)), "/api/runs").json();
    assert_eq!(labels(&list), ["z", "compare-reach/cells/a-seed0", "compare-reach/cells/b-seed0"]);
}
