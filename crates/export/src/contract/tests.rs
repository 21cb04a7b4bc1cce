//! What contracts say, of a hand, of springs and of a robot from a file; and their schema.
#![allow(clippy::unwrap_used)] // helpers of tests are tests too

use std::path::Path;

use hwasp_training::Assembly;
use serde_json::{Map, Value};

use super::Contract;
use crate::deployed::Deployed;

/// The contract of an experiment before its training.
fn contract(experiment: &str, settings: &[(&str, &str)]) -> Value {
    let layers = hwasp_testing::layers(experiment);
    let layers = settings.iter().fold(layers, |layers, (key, value)| layers.with_override(key, value));
    let assembly = Assembly::new(&hwasp_testing::resolve(layers, Some("hwasp")).unwrap()).unwrap();
    let deployed = Deployed::new(&assembly, &assembly.init()).unwrap();
    serde_json::to_value(Contract::new(&deployed)).unwrap()
}

/// The entry of a list that is called so.
fn named<'v>(list: &'v Value, name: &str) -> &'v Map<String, Value> {
    let entries = list.as_array().unwrap();
    entries.iter().find(|entry| entry["name"] == name).unwrap_or_else(|| panic!("no {name}")).as_object().unwrap()
}

fn fact<'v>(contract: &'v Value, topic: &str, name: &str) -> &'v Map<String, Value> {
    named(&named(&contract["manual"], topic)["facts"], name)
}

fn keys(entry: &Map<String, Value>) -> Vec<&str> {
    entry.keys().map(String::as_str).collect()
}

#[test]
fn a_hand() {
    let told = contract("3d-grasp", &[("task.tension_limit", "60 N")]);
    let port = ["name", "unit", "meaning"];
    let sensed = [&port[..], &["frame", "sampled", "noise_std", "center", "scale"]].concat();
    let mut found = keys(named(&told["observation"], "object_z"));
    found.sort_unstable();
    assert_eq!(found, sorted(&sensed));
    let commanded = [&port[..], &["frame", "hold", "becomes", "target", "limits", "scale", "offset"]].concat();
    let palm = named(&told["command"], "palm_x");
    assert_eq!(sorted(&keys(palm)), sorted(&commanded));
    assert_eq!((&palm["target"]["limits"], &palm["target"]["start"]), (&[-0.15, 0.15].into(), &Value::Null));
    let motor = named(&told["command"], "motor");
    assert_eq!((&motor["hold"], &motor["target"]["start"]), (&0.0.into(), &0.0.into()));
    let speed = motor["target"]["speed_limits"][1].as_f64().unwrap();
    assert!((speed - 0.02).abs() < 1e-12, "{speed} m/s");
    // Numbers are those of the settings.
    assert_eq!(fact(&told, "transmission", "tension_limit")["value"], 60.0);
    assert_eq!(fact(&told, "start", "object_x")["range"], Value::from(vec![-0.05, 0.05]));
    assert_eq!(fact(&told, "success", "hold_steps")["value"], 100.0);
    // Whatever is referred to is there, and every fact says one thing.
    let frames: Vec<&Value> = told["frames"].as_array().unwrap().iter().map(|frame| &frame["name"]).collect();
    for port in ["observation", "command"].iter().flat_map(|ports| told[ports].as_array().unwrap()) {
        assert!(port.get("frame").is_none_or(|frame| frames.contains(&frame)), "{port}");
    }
    for fact in told["manual"].as_array().unwrap().iter().flat_map(|topic| topic["facts"].as_array().unwrap()) {
        let said = ["value", "range", "text", "names"].iter().filter(|kind| fact.get(kind).is_some()).count();
        assert_eq!(said, 1, "{fact}");
        assert!(!fact["meaning"].as_str().unwrap().is_empty(), "{fact}");
    }
}

fn sorted<'n>(names: &[&'n str]) -> Vec<&'n str> {
    let mut names = names.to_vec();
    names.sort_unstable();
    names
}

/// All of it but the numbers of the network and of the version.
#[test]
fn the_contract_of_a_hand() {
    let mut told = contract("z-grasp", &[]);
    for key in ["hwasp_version", "network", "design", "models", "state", "effort"] {
        told.as_object_mut().unwrap().remove(key);
    }
    insta::assert_snapshot!(serde_json::to_string_pretty(&told).unwrap());
}

/// Springs have no manual: whatever there is stands with their ports.
#[test]
fn springs() {
    let told = contract("mass-spring", &[]);
    assert!(["manual", "frames"].iter().all(|key| told.get(key).is_none()));
    assert_eq!(sorted(&keys(named(&told["observation"], "y1"))), ["center", "meaning", "name", "scale", "unit"]);
    assert_eq!(
        sorted(&keys(named(&told["command"], "motor"))),
        ["limits", "meaning", "name", "offset", "scale", "unit"]
    );
    assert!(told["about"].as_str().unwrap().starts_with("Two masses"));
    let faults: Vec<&str> =
        told["control"]["faults"].as_array().unwrap().iter().map(|fault| fault["name"].as_str().unwrap()).collect();
    assert_eq!(faults, ["not finite", "missing", "out of range"]);
}

/// Of every port that the controller has, the problems that come with the program say what it means.
#[test]
fn every_port_means_something() {
    for experiment in ["z-grasp", "3d-grasp", "mass-spring", "bar-length", "pendulum", "reach"] {
        let told = contract(experiment, &[]);
        for port in
            ["observation", "state", "command", "effort"].iter().flat_map(|ports| told[ports].as_array().unwrap())
        {
            assert!(port["meaning"].as_str().is_some_and(|meaning| !meaning.is_empty()), "{experiment}: {port}");
        }
    }
}

/// A robot from a file tells its experiment's formulas.
#[test]
fn a_robot_from_a_file() {
    let told = contract("hopper", &[]);
    let topics: Vec<&str> =
        told["manual"].as_array().unwrap().iter().map(|topic| topic["name"].as_str().unwrap()).collect();
    assert_eq!(topics, ["model", "observation", "start", "law", "ends"]);
    assert_eq!(fact(&told, "model", "simulation_steps")["value"], 4.0);
    assert_eq!(fact(&told, "start", "joint.*.vel")["text"], "uniform(-0.01, 0.01)");
    assert!(fact(&told, "ends", "ends")["text"].as_str().unwrap().starts_with("joint.rootz.pos < "));
    let becomes = |name: &str| named(&told["command"], name)["becomes"].as_str().unwrap().to_owned();
    assert_eq!(becomes("hip"), "the control of actuator `hip` of the model, held for the period");
    assert_eq!(becomes("knee"), "read by the law, held for the period");
}

/// `HWASP_WRITE_DOCS=1` writes it anew.
#[test]
fn the_schema_is_that_of_the_types() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/contract.schema.json");
    let schema = schemars::schema_for!(Contract);
    let text = format!("{}\n", serde_json::to_string_pretty(&schema).unwrap());
    if std::env::var_os("HWASP_WRITE_DOCS").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    let there = std::fs::read_to_string(&path).unwrap();
    let renew = "HWASP_WRITE_DOCS=1 cargo test -p hwasp-export --lib renews it";
    assert!(there == text, "docs/contract.schema.json is old: {renew}");
}
