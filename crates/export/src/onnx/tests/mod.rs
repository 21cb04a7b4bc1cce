//! Models as they were written, read back and run by an interpreter of their operators, against the program itself.
#![allow(clippy::unwrap_used)] // helpers of tests are tests too

mod runtime;

use std::collections::BTreeSet;
use std::fs;

use hwasp_core::{Actor, Policy, Purpose, Stream, stream};
use hwasp_diff::{Program, Scalar};
use hwasp_training::Assembly;
use prost::Message;
use rand::RngExt;
use safetensors::SafeTensors;

use self::runtime::{Tensor, run};
use super::graph::Graph;
use super::law::{Value, law};
use super::proto::{DOUBLE, FLOAT, ModelProto};
use super::{ElementType, models};
use crate::contract::Contract;
use crate::deployed::Deployed;

/// How far apart answers may be: some units in the last place of single precision.
const MOST: f64 = 2e-6;

/// An experiment with parameters drawn at random, so that every one of them counts.
fn deployed(experiment: &str, method: &str, settings: &[(&str, &str)]) -> Deployed {
    let layers = hwasp_testing::layers(experiment);
    let layers = settings.iter().fold(layers, |layers, (key, value)| layers.with_override(key, value));
    let assembly = Assembly::new(&hwasp_testing::resolve(layers, Some(method)).unwrap()).unwrap();
    Deployed::new(&assembly, &random_params(&assembly)).unwrap()
}

fn random_params(assembly: &Assembly) -> Vec<f32> {
    let mut random = stream(5, Purpose::Samples, 0, 0);
    let inputs = assembly.policy.obs_dim();
    let mut params: Vec<f32> = (0..assembly.policy.param_count()).map(|_| random.random_range(-0.3..0.3)).collect();
    // Weights of the first layer as large as make the units turn.
    params[..inputs].iter_mut().for_each(|weight| *weight *= 5.0);
    // Scales of observations are positive.
    let scaling = assembly.policy.normalizer_params();
    params[scaling.start + scaling.len() / 2..scaling.end].iter_mut().for_each(|scale| *scale = scale.abs() + 0.05);
    params
}

/// The models of it, read back.
fn written(deployed: &Deployed) -> [ModelProto; 2] {
    let files = models(deployed, &Contract::new(deployed)).unwrap();
    [&files[0], &files[1]].map(|file| ModelProto::decode(&file.contents[..]).unwrap())
}

/// Observations around the centre, and states of any size.
fn inputs(deployed: &Deployed, rows: usize) -> (Vec<f32>, Vec<f64>) {
    let random = &mut stream(6, Purpose::Samples, 0, 0);
    let normalizer = deployed.normalizer();
    let scaling: Vec<_> = normalizer.center().iter().zip(normalizer.scale()).collect();
    let draw = |random: &mut Stream| random.random_range(-3.0..3.0);
    let observations = (0..rows).flat_map(|_| {
        let row: Vec<f32> = scaling.iter().map(|&(center, scale)| (center + scale * draw(random)) as f32).collect();
        row
    });
    let observations = observations.collect();
    let states = (0..rows * deployed.env.state.len()).map(|_| 0.05 * draw(random)).collect();
    (observations, states)
}

/// The largest difference, as a share of `size`.
fn apart(given: &Tensor, wanted: &[f64], size: impl Fn(usize) -> f64) -> f64 {
    assert_eq!(given.data.len(), wanted.len());
    let difference = |(i, (a, b)): (usize, (&f64, &f64))| (a - b).abs() / size(i);
    given.data.iter().zip(wanted).enumerate().map(difference).fold(0.0, f64::max)
}

/// Both models of an experiment do what the program does.
fn agree(experiment: &str, method: &str, settings: &[(&str, &str)]) {
    let deployed = deployed(experiment, method, settings);
    let rows = 150; // two whole blocks and a part of one
    let (observations, states) = inputs(&deployed, rows);
    let (commands, efforts) = deployed.act(&observations, &states);
    let wide = |values: &[f32]| values.iter().map(|&x| f64::from(x)).collect::<Vec<f64>>();
    let tensor = |kind, data: Vec<f64>| Tensor { kind, dims: vec![rows, data.len() / rows], data };
    let ports = &deployed.env.command;
    let range = |i: usize| ports[i % ports.len()].hi - ports[i % ports.len()].lo;
    let [alone, whole] = written(&deployed);

    let out = run(&alone, &[("observation", tensor(FLOAT, wide(&observations)))]);
    assert_eq!((out.len(), out["command"].kind), (1, FLOAT));
    let off = apart(&out["command"], &commands, range);
    assert!(off < MOST, "{experiment} {method}: the controller is off by {off} of the motors' range");

    let mut given = vec![("observation", tensor(DOUBLE, wide(&observations)))];
    if !states.is_empty() {
        given.push(("state", tensor(DOUBLE, states)));
    }
    let out = run(&whole, &given);
    assert!(out.values().all(|tensor| tensor.kind == DOUBLE));
    let off = apart(&out["command"], &commands, range);
    assert!(off < MOST, "{experiment} {method}: the policy's command is off by {off} of the motors' range");
    assert_eq!(out.contains_key("effort"), !efforts.is_empty());
    if let Some(effort) = out.get("effort") {
        let largest = efforts.iter().fold(0.0_f64, |most, effort| most.max(effort.abs()));
        let off = apart(effort, &efforts, |_| largest);
        assert!(off < MOST, "{experiment} {method}: the effort is off by {off} of its largest");
    }
    // It is about something: commands differ.
    let distinct: BTreeSet<u64> = commands.iter().map(|c| c.to_bits()).collect();
    assert!(distinct.len() > rows / 2, "{experiment}: only {} different commands", distinct.len());
}

#[test]
fn springs_in_the_graph_in_the_action_and_fixed() {
    for method in ["hwasp", "minimal", "fixed"] {
        agree("mass-spring", method, &[]);
    }
}

/// A controller that saw the design is exported for hardware that stays: with the observation as its only input it does what
/// the trained one does.
#[test]
fn a_controller_that_saw_the_design() {
    for (method, hidden) in [("episode", "[32, 32]"), ("hwasp", "[]")] {
        let settings = [("controller.sees_design", "true"), ("controller.hidden", hidden)];
        agree("mass-spring", method, &settings);
        let layers =
            settings.iter().fold(hwasp_testing::layers("mass-spring"), |l, (key, value)| l.with_override(key, value));
        let assembly = Assembly::new(&hwasp_testing::resolve(layers, Some(method)).unwrap()).unwrap();
        let exported = deployed("mass-spring", method, &settings);
        assert_eq!((assembly.policy.obs_dim(), exported.policy.obs_dim()), (12, 2));
        let params = random_params(&assembly);
        let design = assembly.built(&params);
        let trained = assembly.deployed(&design).unwrap();
        let (observations, states) = inputs(&exported, 20);
        let (commands, _) = exported.act(&observations, &states);
        let mut actor = Actor::new(&trained, trained.controller_params(&params), 1.0, 1);
        for (r, seen) in observations.chunks_exact(2).enumerate() {
            let mut input = [0.0; 12];
            trained.normalizer(&[]).apply(&[f64::from(seen[0]), f64::from(seen[1])], &mut input[..2]);
            trained.see_design(&design, &mut input[2..]);
            actor.act(&input, &states[r * 4..][..4], 1, None);
            let (lo, hi) = (exported.env.command[0].lo, exported.env.command[0].hi);
            let off = (actor.action(0)[0].clamp(lo, hi) - commands[r]).abs() / (hi - lo);
            assert!(off < MOST, "{method}: off by {off} of the motors' range");
        }
    }
}

/// Whose effort, a length, is the same whatever is commanded.
#[test]
fn a_rigid_bar() {
    agree("bar-length", "hwasp", &[]);
    agree("bar-length", "minimal", &[("task.segments", "1")]);
}

#[test]
fn gears() {
    agree("pendulum", "hwasp", &[]);
    agree("reach", "cmaes", &[]);
}

#[test]
fn networks_of_every_kind() {
    let wide = ("controller.output_gain", "1");
    agree("mass-spring", "hwasp", &[("controller.activation", "relu"), ("controller.squash", "false"), wide]);
    agree("mass-spring", "hwasp", &[("controller.hidden", "[]"), ("controller.squash", "true")]);
    agree("mass-spring", "hwasp", &[("controller.hidden", "[7, 5, 3]"), ("controller.squash", "true")]);
}

/// Centre, scale and clip of a controller that was trained with running statistics, in every form of it. Observations are within
/// three scales of the centre, and it sees one and a half.
#[test]
fn running_statistics() {
    let settings = [
        ("controller.observation_center", "[0.0, 0.0]"),
        ("controller.observation_scale", "[1.0, 1.0]"),
        ("controller.normalize_observations", "true"),
        ("controller.observation_clip", "1.5"),
    ];
    for method in ["hwasp", "minimal"] {
        agree("mass-spring", method, &settings);
    }
    let deployed = deployed("mass-spring", "hwasp", &settings);
    let (normalizer, contract) = (deployed.normalizer(), Contract::new(&deployed));
    assert!(normalizer.center() != [0.0, 0.0] && normalizer.scale() != [1.0, 1.0]);
    let json = crate::controller::json(&deployed, &contract).unwrap();
    let told: serde_json::Value = serde_json::from_slice(&json.contents).unwrap();
    let tensors = crate::controller::safetensors(&deployed, &contract).unwrap();
    let tensors = SafeTensors::deserialize(&tensors.contents).unwrap();
    let tensor = |name: &str| -> Vec<f64> {
        let data = tensors.tensor(name).unwrap();
        data.data().as_chunks().0.iter().map(|&b| f64::from(f32::from_le_bytes(b))).collect()
    };
    assert_eq!([tensor("observation.lowest"), tensor("observation.highest")], [[-1.5; 2], [1.5; 2]]);
    for (i, observed) in told["observation"].as_array().unwrap().iter().enumerate() {
        let number = |key: &str| observed[key].as_f64().unwrap();
        let wanted = [normalizer.center()[i], normalizer.scale()[i], 1.5];
        assert_eq!(["center", "scale", "clip"].map(number), wanted);
        assert_eq!([tensor("observation.center")[i], tensor("observation.scale")[i]], wanted[..2]);
    }
    // Without them nothing is clipped, and nothing says so.
    let plain = self::deployed("mass-spring", "hwasp", &[]);
    let told = serde_json::to_value(Contract::new(&plain)).unwrap();
    assert!(told["observation"][0].get("clip").is_none());
}

#[test]
fn hands() {
    for experiment in ["z-grasp", "3d-grasp"] {
        for method in ["hwasp", "minimal"] {
            agree(experiment, method, &[]);
        }
    }
}

/// The models say nothing of what is not there.
#[test]
fn a_law_without_a_state_and_no_law() {
    let folder = std::env::temp_dir().join(format!("hwasp-laws-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let arm = r#"<mujoco><worldbody><body name="arm">
        <joint name="shoulder" axis="0 1 0"/><geom size="0.05" pos="0.3 0 0"/>
        </body></worldbody><actuator><motor name="motor" joint="shoulder" ctrlrange="-1 1"/></actuator></mujoco>"#;
    fs::write(folder.join("arm.xml"), arm).unwrap();
    let task = "name = 'arm'\n[task]\nproblem = 'model'\nmodel = 'arm.xml'\nhorizon = 10\nobserve = ['joint.shoulder.pos']\nreward = { still = '-joint.shoulder.vel^2' }";
    let gear = "[task.design]\ngear = { limits = [1, 3] }\n[task.law]\n'actuator.motor' = 'gear * command.motor'";
    let weight = "[task.design.radius]\nlimits = ['0.04 m', '0.06 m']\nsets = ['geom.#0.size[0] = radius']";
    for (name, rest, methods) in [("geared", gear, ["hwasp", "minimal"]), ("bare", weight, ["episode", "fixed"])] {
        let path = folder.join(format!("{name}.toml"));
        fs::write(&path, format!("{task}\n{rest}\n")).unwrap();
        for method in methods {
            agree(path.to_str().unwrap(), method, &[]);
        }
    }
    fs::remove_dir_all(&folder).unwrap();
}

/// Whoever has one model alone has all of the contract.
#[test]
fn the_contract_is_in_both_models() {
    for experiment in ["z-grasp", "mass-spring", "hopper"] {
        let deployed = deployed(experiment, "hwasp", &[]);
        let file = Contract::new(&deployed).file().unwrap();
        let told: serde_json::Value = serde_json::from_slice(&file.contents).unwrap();
        for model in written(&deployed) {
            let [metadata] = &model.metadata_props[..] else { panic!("{:?}", model.metadata_props) };
            assert_eq!(metadata.key, "contract");
            assert_eq!(serde_json::from_str::<serde_json::Value>(&metadata.value).unwrap(), told);
        }
    }
}

#[test]
fn what_a_model_says_of_itself() {
    let deployed = deployed("pendulum", "hwasp", &[]);
    let [alone, whole] = written(&deployed);
    assert_eq!((alone.ir_version, alone.opset_import[0].version), (8, 17));
    let contract: serde_json::Value = serde_json::from_str(&alone.metadata_props[0].value).unwrap();
    assert_eq!((&contract["task"], &contract["control"]["rate_hz"]), (&"pendulum".into(), &20.0.into()));
    let graph = whole.graph.unwrap();
    let doc: Vec<_> = graph.input.iter().chain(&graph.output).map(|value| value.doc_string.as_str()).collect();
    assert_eq!(
        doc,
        ["cos, sin, speed (rad/s)", "angle (rad), speed (rad/s)", "motor (N·m) in [-2, 2]", "torque (N·m)"]
    );
    // The design can be found, and changed, by its name.
    let gear = graph.initializer.iter().find(|tensor| tensor.name == "design.gear").unwrap();
    assert_eq!((gear.dims.len(), gear.raw_data.as_slice()), (0, &deployed.design[0].to_le_bytes()[..]));
}

/// Every operation of a traced law, against the same law on plain numbers.
#[test]
fn every_operation_of_a_law() {
    fn arithmetic<T: Scalar>(u: &[T], c: &[T]) -> Vec<T> {
        let (a, b) = (c[0], c[1]);
        vec![
            -a + b.exp() - (a.abs() + 1.0).ln(),
            (b.abs() + u[0]).sqrt() * a.sin() / (b.cos() + 3.0),
            (a * b).tanh().min(b.sigmoid()).max(a * 0.1),
            u[0].exp() + u[0],
            a.less(b).gate((a.abs() + 0.5).ln()) + b.less(a).gate(b.atan()) + u[0].less(T::constant(0.5)),
        ]
    }
    let names = ["p", "q", "r", "s", "t"].map(str::to_owned);
    let program = Program::trace(&["u"], &["a", "b"], |u, c| names.iter().cloned().zip(arithmetic(u, c)).collect());
    let deployed = deployed("reach", "hwasp", &[]);
    let mut graph = Graph::new("law", &Contract::new(&deployed).models.policy);
    graph.0.output.clear();
    graph.numbers("u", &[], &[0.7], ElementType::Float64);
    let value = |name: &str, by_row| Value { name: name.to_owned(), by_row };
    let outputs = law(&mut graph, &program, &[value("u", false)], &[value("a", true), value("b", true)]);
    assert_eq!(outputs.iter().map(|o| o.by_row).collect::<Vec<_>>(), [true, true, true, false, true]);
    let (a, b) = ([0.3, -2.0, 0.0, 1.5], [-1.2, 0.4, 5.0, -0.1]);
    let column = |data: [f64; 4]| Tensor { kind: DOUBLE, dims: vec![4, 1], data: data.to_vec() };
    let values = runtime::values(&graph.0, &[("a", column(a)), ("b", column(b))]);
    for (r, (&a, &b)) in a.iter().zip(&b).enumerate() {
        for (output, wanted) in outputs.iter().zip(arithmetic(&[0.7], &[a, b])) {
            let given = &values[&output.name].data;
            assert_eq!(given[if output.by_row { r } else { 0 }], wanted, "{} at {a}, {b}", output.name);
        }
    }
    let ops: BTreeSet<&str> = graph.0.node.iter().map(|node| node.op_type.as_str()).collect();
    assert_eq!(ops.len(), 20, "{ops:?}");
}
