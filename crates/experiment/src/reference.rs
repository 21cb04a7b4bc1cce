//! Everything that an experiment may set, as the rows of a reference and as a JSON Schema. Both are made from the same
//! descriptions that read the files.

use std::fmt::Write as _;

use hwasp_algos::{ArsSettings, BaselineSettings, CmaesConfig};
use hwasp_core::Dimension;
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
        field("name", Kind::Text(LONGEST_NAME), ["required", "1 to 100 characters"], "what plots and folders call it"),
        field("description", Kind::Text(LONGEST_DESCRIPTION), ["\"\"", "up to 2000 characters"], "what it is"),
        field("method", Kind::Choice(methods), ["\"hwasp\"", &listed], "how learner, policy and hardware are composed"),
        field("seed", Kind::Integer([0, i64::MAX as u64]), ["0", "0 to 2^63 - 1"], "root of all random streams"),
    ]
}

/// The keys of `[task]` that every problem has.
fn common(catalogue: &Catalogue) -> Vec<Field> {
    let listed = catalogue.problems().iter().map(|p| format!("`{}`", p.name())).collect::<Vec<_>>().join(", ");
    let horizon = Kind::Integer([1, MOST_STEPS as u64]);
    vec![
        field("problem", Kind::Open, ["required", &listed], "what is to be solved"),
        field("horizon", horizon, ["as the problem says", "1 to 100 000"], "steps of an episode"),
    ]
}

/// Every table beside `[task]`, in the order in which it is written.
fn tables(catalogue: &Catalogue) -> Vec<(String, Vec<Field>)> {
    let learners = LearnerSettings::new(catalogue.learners(), ROWS);
    let names: Vec<&'static str> = Vec::new();
    let mut algorithm = field("algorithm", Kind::Choice(names), ["", ""], "what improves the policy");
    algorithm.kind = Kind::Open;
    algorithm.default = format!("\"{}\"", learners.algorithm());
    algorithm.limits = learners.listed();
    let train = TrainSettings::new(1000, true);
    let mut tables = vec![
        ("controller".to_owned(), described(&mut ControllerSettings::new(0))),
        ("design".to_owned(), described(&mut DesignSettings::new(Method::Hwasp, Vec::new()))),
        ("noise".to_owned(), described(&mut NoiseSettings::of(1, Dimension::Force))),
        ("learner".to_owned(), vec![algorithm]),
    ];
    for (name, settings) in learners.names().zip(&learners.settings) {
        tables.push((name.to_owned(), described(&mut *settings.clone())));
    }
    tables.push(("baseline".to_owned(), described(&mut BaselineSettings::default())));
    tables.push(("search".to_owned(), described(&mut SearchSettings::new(&train, true))));
    tables.push(("cmaes".to_owned(), described(&mut CmaesConfig::default())));
    tables.push(("ars".to_owned(), described(&mut ArsSettings::new(false))));
    tables.push(("train".to_owned(), described(&mut TrainSettings::new(1000, true))));
    tables
}

/// The reference of all keys as Markdown: a table for each table of an experiment.
pub fn reference(catalogue: &Catalogue) -> String {
    let mut text = String::new();
    let mut section = |heading: &str, fields: &[Field]| {
        let _ = write!(text, "{heading}\n\n| key | default | meaning | limits |\n|---|---|---|---|\n");
        for field in fields {
            let _ = writeln!(text, "{}", field.row());
        }
        text.push('\n');
    };
    section("At the top:", &top());
    section("### `[task]`", &common(catalogue));
    // Problems that have the same settings share a table.
    let mut problems: Vec<(Vec<&str>, Vec<Field>)> = Vec::new();
    for problem in catalogue.problems() {
        let fields = described(&mut *problem.defaults());
        let keys = |fields: &[Field]| fields.iter().map(|field| field.key.clone()).collect::<Vec<_>>();
        match problems.iter_mut().find(|(_, known)| keys(known) == keys(&fields) && !fields.is_empty()) {
            Some((names, known)) => {
                for (known, field) in
                    known.iter_mut().zip(&fields).filter(|(known, field)| known.default != field.default)
                {
                    known.default = format!("{} ({}: {})", known.default, problem.name(), field.default);
                }
                names.push(problem.name());
            }
            None => problems.push((vec![problem.name()], fields)),
        }
    }
    for (names, fields) in &problems {
        let names = names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(" and ");
        if fields.is_empty() {
            section(&format!("For {names} there is nothing more to set."), &[]);
        } else {
            section(&format!("For {names}:"), fields);
        }
    }
    for (name, fields) in tables(catalogue) {
        section(&format!("### `[{name}]`"), &fields);
    }
    // A table of nothing is no table.
    text.replace(
        " there is nothing more to set.\n\n| key | default | meaning | limits |\n|---|---|---|---|\n",
        " there is nothing more to set.\n",
    )
}

/// The JSON Schema of experiment files: editors complete and check them by it.
pub fn schema(catalogue: &Catalogue) -> Value {
    let mut tables: Map<String, Value> =
        tables(catalogue).into_iter().map(|(name, fields)| (name, object_schema(&fields))).collect();
    let learners: Vec<&str> = catalogue.learners().iter().map(|learner| learner.name()).collect();
    if let Some(algorithm) = tables.get_mut("learner").and_then(|table| table.pointer_mut("/properties/algorithm")) {
        algorithm["enum"] = json!(learners);
    }
    tables.insert("task".to_owned(), task_schema(catalogue));
    let methods: Map<String, Value> = Method::ALL
        .iter()
        .map(|(name, _)| {
            let overlay = json!({ "type": "object", "additionalProperties": false, "properties": tables.clone() });
            ((*name).to_owned(), overlay)
        })
        .collect();
    let mut properties: Map<String, Value> = top().iter().map(|field| (field.key.clone(), field.schema())).collect();
    properties.extend(tables);
    properties.insert(
        "methods".to_owned(),
        json!({
            "type": "object",
            "description": "what differs when the method is this one",
            "additionalProperties": false,
            "properties": methods,
        }),
    );
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "hwasp experiment",
        "type": "object",
        "required": ["name", "task"],
        "additionalProperties": false,
        "properties": properties,
    })
}

/// `[task]`: the keys of all problems, and for each problem which of them it has.
fn task_schema(catalogue: &Catalogue) -> Value {
    let names: Vec<&str> = catalogue.problems().iter().map(|problem| problem.name()).collect();
    let mut rules = Vec::new();
    let mut all = Map::new();
    for problem in catalogue.problems() {
        let fields: Vec<Field> = common(catalogue).into_iter().chain(described(&mut *problem.defaults())).collect();
        let own = object_schema(&fields);
        for field in &fields {
            all.entry(field.key.clone()).or_insert_with(|| json!({}));
        }
        rules.push(json!({
            "if": { "properties": { "problem": { "const": problem.name() } }, "required": ["problem"] },
            "then": own,
        }));
    }
    all.insert("problem".to_owned(), json!({ "enum": names, "description": "what is to be solved" }));
    json!({ "type": "object", "properties": all, "allOf": rules })
}
