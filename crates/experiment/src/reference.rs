//! Everything that an experiment may set, as the rows of a reference and as a JSON Schema. Both are made from the same
//! descriptions that read the files.

use std::fmt::Write as _;

use hwasp_algos::{ArsSettings, BaselineSettings, BoConfig, CmaesConfig, RandomConfig};
use hwasp_core::{Dimension, Port};
use hwasp_settings::{Field, Kind, described, object_schema};
use serde_json::{Map, Value, json};

use crate::built::MOST_STEPS;
use crate::catalogue::Catalogue;
use crate::controller::ControllerSettings;
use crate::design::DesignSettings;
use crate::experiment::{LONGEST_DESCRIPTION, LONGEST_NAME};
use crate::learner::LearnerSettings;
use crate::method::Method;
use crate::noise::NoiseSettings;
use crate::polish::PolishSettings;
use crate::search::SearchSettings;
use crate::train::TrainSettings;

/// Rows of an iteration, for defaults that depend on them.
const ROWS: usize = 4000;

fn field(key: &str, kind: Kind, [default, limits]: [&str; 2], meaning: &str) -> Field {
    let [default, limits, meaning] = [default, limits, meaning].map(str::to_owned);
    Field { key: key.to_owned(), kind, default, limits, meaning }
}

/// The keys at the top.
fn top() -> Vec<Field> {
    let methods: Vec<&str> = Method::ALL.iter().map(|(name, _)| *name).collect();
    let listed = methods.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    vec![
        field("name", Kind::Line(LONGEST_NAME), ["required", "1 to 100 characters"], "what plots and folders call it"),
        field("description", Kind::Text(LONGEST_DESCRIPTION), ["\"\"", "up to 2000 characters"], "what it is"),
        field("method", Kind::Choice(methods), ["\"hwasp\"", &listed], "how learner, policy and hardware are composed"),
        field("seed", Kind::Integer([0, i64::MAX as u64]), ["0", "0 to 2^63 - 1"], "root of all random streams"),
    ]
}

/// The keys of `[task]` that every problem has.
fn common(catalogue: &Catalogue) -> Vec<Field> {
    let listed = catalogue.problems().iter().map(|p| format!("`{}`", p.name())).collect::<Vec<_>>().join(", ");
    let horizon = Kind::Integer([1, MOST_STEPS as u64]);
    let names = catalogue.problems().iter().map(|problem| problem.name().to_owned()).collect();
    vec![
        field("problem", Kind::Names(names), ["required", &listed], "what is to be solved"),
        field("horizon", horizon, ["as the problem says", "1 to 100 000"], "steps of an episode"),
    ]
}

/// Every table beside `[task]`, in the order in which it is written.
fn tables(catalogue: &Catalogue) -> Vec<(String, Vec<Field>)> {
    let learners = LearnerSettings::new(catalogue.learners(), ROWS);
    let names: Vec<String> = learners.names().map(str::to_owned).collect();
    let default = format!("\"{}\"", learners.algorithm());
    let algorithm = field("algorithm", Kind::Names(names), [&default, &learners.listed()], "what improves the policy");
    let train = TrainSettings::new(1000, true);
    let force = Port { name: "force".to_owned(), dimension: Dimension::Force };
    let mut tables = vec![
        ("controller".to_owned(), described(&mut ControllerSettings::new(0, None))),
        ("design".to_owned(), described(&mut DesignSettings::new(Method::Hwasp, Vec::new()))),
        ("noise".to_owned(), described(&mut NoiseSettings::of(1, vec![force]))),
        ("learner".to_owned(), vec![algorithm]),
    ];
    for (name, settings) in learners.names().zip(&learners.settings) {
        tables.push((name.to_owned(), described(&mut *settings.clone())));
    }
    tables.push(("baseline".to_owned(), described(&mut BaselineSettings::default())));
    tables.push(("search".to_owned(), described(&mut SearchSettings::new(&train, true))));
    tables.push(("cmaes".to_owned(), described(&mut CmaesConfig::default())));
    tables.push(("ars".to_owned(), described(&mut ArsSettings::new(false))));
    tables.push(("bo".to_owned(), described(&mut BoConfig::default())));
    tables.push(("random".to_owned(), described(&mut RandomConfig::default())));
    tables.push(("train".to_owned(), described(&mut TrainSettings::new(1000, true))));
    tables.push(("polish".to_owned(), described(&mut PolishSettings::default())));
    tables
}

/// What a table is for, where its name does not say it.
fn purpose(table: &str) -> &'static str {
    match table {
        "design" => "Where each design parameter sits and begins: [hardware.md](hardware.md) says what the places do.",
        "noise" => "The Gaussian noise by which training explores.",
        "learner" => {
            "What the methods `hwasp`, `minimal`, `episode` and `fixed` train by, and each candidate of those that end in `-rl`."
        }
        "baseline" => "What estimates values beside the learner.",
        "search" => "For the methods `cmaes`, `ars`, `cmaes-rl`, `ars-rl`, `bo-rl` and `random-rl`.",
        "cmaes" => "For the methods `cmaes` and `cmaes-rl`.",
        "ars" => "For the methods `ars` and `ars-rl`.",
        "bo" => "For the method `bo-rl`.",
        "random" => "For the method `random-rl`.",
        "train" => "How long, in which portions, and how the result is judged.",
        "polish" => {
            "For every method: the last part of a training fixes the design and trains the controller further in the world where the \
             result has to work. It begins with the trained controller and a fresh learner of the same settings."
        }
        _ => "",
    }
}

/// The reference of all keys as Markdown: a table for each table of an experiment.
pub fn reference(catalogue: &Catalogue) -> String {
    let mut text = section("At the top:", &top());
    text.push_str(&section("### `[task]`", &common(catalogue)));
    for (problems, fields) in by_settings(catalogue) {
        let names = problems.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(" and ");
        if fields.is_empty() {
            let _ = writeln!(text, "For {names} there is nothing more to set.\n");
        } else {
            text.push_str(&section(&format!("For {names}:"), &fields));
        }
    }
    for (name, fields) in tables(catalogue) {
        text.push_str(&section(format!("### `[{name}]`\n\n{}", purpose(&name)).trim_end(), &fields));
    }
    text.truncate(text.trim_end().len());
    text.push('\n');
    text
}

/// One table of the reference below its heading.
fn section(heading: &str, fields: &[Field]) -> String {
    let mut text = format!("{heading}\n\n| key | default | meaning | limits |\n|---|---|---|---|\n");
    for field in fields {
        let _ = writeln!(text, "{}", field.row());
    }
    text.push('\n');
    text
}

/// The settings of every problem; problems that have the same ones share them, each default with the name of its problem.
fn by_settings(catalogue: &Catalogue) -> Vec<(Vec<&str>, Vec<Field>)> {
    let keys = |fields: &[Field]| fields.iter().map(|field| field.key.clone()).collect::<Vec<_>>();
    let mut all: Vec<(Vec<&str>, Vec<Field>)> = Vec::new();
    for problem in catalogue.problems() {
        let fields = described(&mut *problem.defaults());
        let Some((names, known)) = all.iter_mut().find(|(_, known)| keys(known) == keys(&fields) && !fields.is_empty())
        else {
            all.push((vec![problem.name()], fields));
            continue;
        };
        for (known, field) in known.iter_mut().zip(&fields).filter(|(known, field)| known.default != field.default) {
            known.default = format!("{} ({}: {})", known.default, problem.name(), field.default);
        }
        names.push(problem.name());
    }
    all
}

/// The JSON Schema of experiment files (draft 7): editors complete and check them by it.
pub fn schema(catalogue: &Catalogue) -> Value {
    let mut tables: Map<String, Value> =
        tables(catalogue).into_iter().map(|(name, fields)| (name, object_schema(&fields))).collect();
    tables.insert("task".to_owned(), task_schema(catalogue));
    // Each table stands once, and is named wherever a file may have it: at the top and below every method.
    let named: Map<String, Value> =
        tables.keys().map(|name| (name.clone(), json!({ "$ref": format!("#/definitions/{name}") }))).collect();
    let overlay = json!({ "type": "object", "additionalProperties": false, "properties": named });
    let methods: Map<String, Value> =
        Method::ALL.iter().map(|(name, _)| ((*name).to_owned(), json!({ "$ref": "#/definitions/method" }))).collect();
    let mut properties: Map<String, Value> = top().iter().map(|field| (field.key.clone(), field.schema())).collect();
    properties["name"]["minLength"] = json!(1);
    properties.extend(named);
    // A file says which problem it is about; what a method changes need not.
    properties["task"] = json!({ "allOf": [{ "$ref": "#/definitions/task" }, { "required": ["problem"] }] });
    properties.insert(
        "methods".to_owned(),
        json!({
            "type": "object",
            "description": "what differs when the method is this one",
            "additionalProperties": false,
            "properties": methods,
        }),
    );
    let mut definitions = tables;
    definitions.insert("method".to_owned(), overlay);
    json!({
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "hwasp experiment",
        "type": "object",
        "required": ["name", "task"],
        "additionalProperties": false,
        "properties": properties,
        "definitions": definitions,
    })
}

/// `[task]`: the keys of all problems, and for each problem which of them it has.
fn task_schema(catalogue: &Catalogue) -> Value {
    let mut rules = Vec::new();
    let mut all: Vec<(String, Vec<Value>)> = Vec::new();
    for problem in catalogue.problems() {
        let fields: Vec<Field> = common(catalogue).into_iter().chain(described(&mut *problem.defaults())).collect();
        for field in &fields {
            let schema = field.schema();
            match all.iter_mut().find(|(key, _)| *key == field.key) {
                Some((_, known)) if known.contains(&schema) => {}
                Some((_, known)) => known.push(schema),
                None => all.push((field.key.clone(), vec![schema])),
            }
        }
        let own: Vec<String> = fields.iter().map(|field| field.key.clone()).collect();
        let own_schemas = object_schema(&fields);
        rules.push(json!({
            "if": { "properties": { "problem": { "const": problem.name() } }, "required": ["problem"] },
            "then": { "propertyNames": { "enum": own }, "properties": own_schemas["properties"] },
        }));
    }
    // Without a problem, as below a method, a key may be that of any.
    let properties: Map<String, Value> = all
        .into_iter()
        .map(|(key, mut schemas)| {
            let schema = if schemas.len() == 1 { schemas.remove(0) } else { json!({ "anyOf": schemas }) };
            (key, schema)
        })
        .collect();
    json!({ "type": "object", "additionalProperties": false, "properties": properties, "allOf": rules })
}
