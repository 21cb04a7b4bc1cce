//! Exports of a run.

use std::fs;

use crate::sandbox::{Sandbox, without_figures};

/// The files of a folder, by name.
fn listed(sandbox: &Sandbox, folder: &str) -> Vec<String> {
    let files = fs::read_dir(sandbox.path(folder)).unwrap();
    let mut files: Vec<_> = files.map(|file| file.unwrap().file_name().into_string().unwrap()).collect();
    files.sort();
    files
}

fn json(sandbox: &Sandbox, name: &str) -> serde_json::Value {
    serde_json::from_slice(&sandbox.read(name)).unwrap()
}

#[test]
fn everything_and_a_part() {
    let sandbox = Sandbox::with_run("export");
    let transcript = sandbox.transcript(&["export run", "export run --out there/onnx --onnx --samples 100"]);
    insta::assert_snapshot!(without_figures(&transcript));
    let forms = ["contract.json", "controller.json", "controller.onnx", "controller.safetensors", "export.json"];
    assert_eq!(listed(&sandbox, "run/export"), [&forms[..], &["policy.onnx"]].concat());
    let part = ["contract.json", "controller.onnx", "export.json", "policy.onnx", "samples.safetensors"];
    assert_eq!(listed(&sandbox, "there/onnx"), part);
    assert_eq!(sandbox.read("run/export/policy.onnx"), sandbox.read("there/onnx/policy.onnx"));
}

#[test]
fn the_contract_and_the_numbers() {
    let sandbox = Sandbox::with_run("export-contract");
    assert!(sandbox.run("export run --json").status.success());
    insta::assert_snapshot!(without_figures(&String::from_utf8(sandbox.read("run/export/contract.json")).unwrap()));
    let (contract, controller) =
        (json(&sandbox, "run/export/contract.json"), json(&sandbox, "run/export/controller.json"));
    assert_eq!((&controller["command"], &controller["design"]), (&contract["command"], &contract["design"]));
    let sizes: Vec<u64> =
        contract["network"]["sizes"].as_array().unwrap().iter().map(|n| n.as_u64().unwrap()).collect();
    for (layer, size) in controller["layers"].as_array().unwrap().iter().zip(sizes.windows(2)) {
        let weight = layer["weight"].as_array().unwrap();
        assert_eq!(weight.len() as u64, size[0]);
        assert!(weight.iter().all(|row| row.as_array().unwrap().len() as u64 == size[1]));
        assert_eq!(layer["bias"].as_array().unwrap().len() as u64, size[1]);
    }
    let design = String::from_utf8(sandbox.read("run/design.toml")).unwrap();
    assert!(design.contains(&format!("as_built = [{}]", contract["design"][0]["value"])), "{design}");
}

/// A second export takes the place of the first and keeps what it does not write itself; a stranger's file stays.
#[test]
fn exports_replace_exports_and_nothing_else() {
    let sandbox = Sandbox::with_run("export-again");
    assert!(sandbox.run("export run --onnx").status.success());
    sandbox.write("run/export/controller.onnx", "damaged");
    sandbox.write("run/export/notes.txt", "mine");
    assert!(sandbox.run("export run --safetensors").status.success());
    assert_eq!(sandbox.read("run/export/controller.onnx"), b"damaged");
    assert!(sandbox.run("export run").status.success());
    assert!(sandbox.read("run/export/controller.onnx").len() > 1000);
    assert_eq!(sandbox.read("run/export/notes.txt"), b"mine");

    fs::create_dir(sandbox.path("mine")).unwrap();
    sandbox.write("mine/controller.json", "precious");
    let before = listed(&sandbox, "mine");
    sandbox.refused(&["export run --out mine"]);
    assert_eq!((listed(&sandbox, "mine"), sandbox.read("mine/controller.json")), (before, b"precious".to_vec()));
}

#[test]
fn runs_that_are_damaged_export_nothing() {
    let sandbox = Sandbox::with_run("export-damaged");
    sandbox.write("run/policy.safetensors", "no weights");
    sandbox.refused(&["export run"]);
    fs::remove_file(sandbox.path("run/policy.safetensors")).unwrap();
    sandbox.refused(&["export run"]);
    sandbox.replace("run/experiment.toml", "seed = 0", "seed = -1");
    sandbox.refused(&["export run"]);
    fs::remove_file(sandbox.path("run/experiment.toml")).unwrap();
    sandbox.refused(&["export run"]);
    assert!(!sandbox.path("run/export").exists());
}
