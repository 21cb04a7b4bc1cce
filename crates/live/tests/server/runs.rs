//! What is told of runs that begin, grow, end, break and go.

use std::fs;
use std::time::Duration;

use hwasp_runs::Keeping;
use hwasp_training::Assembly;
use serde_json::{Value, json};

use crate::client::{ask, begin, empty, experiment, get, serve, trained, wait};

fn of(value: &Value, index: usize) -> &Value {
    &value["runs"][index]
}

#[test]
fn a_finished_run_is_told_in_full() {
    let folder = empty("finished");
    trained(&folder.join("run"));
    fs::write(folder.join("run/train.log"), "first\nlast \u{202e}\u{1b}[31mred\n").unwrap();
    let server = serve(std::slice::from_ref(&folder));
    let list = get(&server, "/api/runs").json();
    let run = of(&list, 0);
    assert_eq!(
        (&run["state"], &run["problem"], &run["method"]),
        (&json!("finished"), &json!("reach"), &json!("hwasp"))
    );
    assert_eq!((&run["env_steps"], &run["budget"], &run["left_s"]), (&json!(9600), &json!(9600), &Value::Null));
    let detail = get(&server, "/api/runs/0").json();
    let table = hwasp_runs::saved_metrics(&folder.join("run")).unwrap();
    let curve = &detail["curve"];
    assert_eq!((curve["env_steps"].as_array().unwrap().len(), &curve["width"]), (table.rows.len(), &json!(1)));
    let columns = curve["columns"].as_array().unwrap();
    let kinds: Vec<&str> = columns.iter().map(|column| column["kind"].as_str().unwrap()).collect();
    assert_eq!(kinds[..2], ["return", "return"]);
    assert!(kinds.contains(&"learner") && kinds.contains(&"design"), "{kinds:?}");
    let last = table.rows.last().unwrap();
    assert_eq!(columns[0]["last"], json!(last.undiscounted_return));
    let group = &detail["design"][0];
    let summary = hwasp_runs::saved_summary(&folder.join("run")).unwrap();
    let (name, design) = summary.design.iter().next().unwrap();
    assert_eq!((&group["name"], &group["limits"]), (&json!(name), &json!(design.limits)));
    assert_eq!((&group["total"], &group["values"]), (&json!(design.total), &json!(design.values)));
    assert_eq!(detail["summary"]["evaluation"]["return"]["mean"], json!(summary.evaluation.undiscounted_return.mean));
    // Nothing in a log turns the writing or moves a cursor.
    assert_eq!(detail["log"], json!(["first", "last \u{fffd}\u{fffd}[31mred"]));
}

#[test]
fn nothing_comes_where_nothing_is_new() {
    let folder = empty("tags");
    trained(&folder.join("run"));
    let server = serve(std::slice::from_ref(&folder));
    for path in ["/api/runs", "/api/runs/0"] {
        let tag = get(&server, path).header("etag").unwrap().to_owned();
        let again = ask(&server, "GET", path, &[("If-None-Match", &tag)]);
        assert_eq!((again.status, again.body.len()), (304, 0), "{path}");
    }
    let tag = get(&server, "/api/runs").header("etag").unwrap().to_owned();
    trained(&folder.join("run-2"));
    std::thread::sleep(Duration::from_millis(250));
    assert_eq!(ask(&server, "GET", "/api/runs", &[("If-None-Match", &tag)]).status, 200);
}

/// The writer is in the middle of a row, whenever somebody looks.
#[test]
fn a_curve_grows_row_by_row_and_half_a_row_waits() {
    let folder = empty("growing");
    let run = folder.join("run");
    trained(&folder.join("whole"));
    let text = fs::read_to_string(folder.join("whole/metrics.csv")).unwrap();
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    drop(begin(&run, &experiment(), Keeping::default()));
    let server = serve(std::slice::from_ref(&run));
    let points = |value: &Value| value["curve"]["env_steps"].as_array().unwrap().len();
    assert_eq!(points(&get(&server, "/api/runs/0").json()), 0);
    fs::write(run.join("metrics.csv"), &lines[0][..10]).unwrap();
    wait(&server, "/api/runs/0", |value| points(value) == 0 && value["faults"] == json!([]));
    fs::write(run.join("metrics.csv"), lines[..3].concat()).unwrap();
    let two = wait(&server, "/api/runs/0", |value| points(value) == 2);
    let epoch = two["curve"]["epoch"].as_str().unwrap().to_owned();
    let half = lines[..3].concat() + &lines[3][..lines[3].len() / 2];
    fs::write(run.join("metrics.csv"), half).unwrap();
    std::thread::sleep(Duration::from_millis(300));
    assert_eq!(points(&get(&server, "/api/runs/0").json()), 2);
    fs::write(run.join("metrics.csv"), lines[..5].concat()).unwrap();
    let since = format!("/api/runs/0?since={epoch}.1.2");
    // Of those that are known the last comes again: it may have grown.
    let rest = wait(&server, &since, |value| points(value) == 3);
    assert_eq!((&rest["curve"]["from"], &rest["curve"]["epoch"]), (&json!(1), &json!(epoch)));
    assert_eq!(rest["curve"]["columns"][0]["values"].as_array().unwrap().len(), 3);
    // Training went back to a checkpoint: other rows stand in the place of those that are known.
    let other = lines[..3].concat() + &lines[3].replace(',', ", ") + lines[4] + lines[5];
    fs::write(run.join("metrics.csv"), other).unwrap();
    let anew = wait(&server, &since, |value| points(value) == 5);
    assert_eq!(anew["curve"]["from"], json!(0));
    assert_ne!(anew["curve"]["epoch"], json!(epoch));
    fs::write(run.join("metrics.csv"), lines[..2].concat() + "x,y\n").unwrap();
    let broken = wait(&server, "/api/runs/0", |value| value["faults"] != json!([]));
    assert!(broken["faults"][0].as_str().unwrap().contains("line 3"), "{}", broken["faults"]);
    fs::write(run.join("metrics.csv"), &text).unwrap();
    let whole = wait(&server, "/api/runs/0", |value| points(value) == lines.len() - 1);
    assert_eq!(whole["faults"], json!([]));
}

#[test]
fn states_are_those_of_the_folder() {
    let folder = empty("states");
    let run = folder.join("run");
    let server = serve(&[run.clone(), folder.join("later")]);
    let list = get(&server, "/api/runs").json();
    assert_eq!((list["runs"].as_array().unwrap().len(), list["waiting"].as_array().unwrap().len()), (0, 2));
    let held = begin(&run, &experiment(), Keeping::default());
    let list = wait(&server, "/api/runs", |list| list["runs"] != json!([]));
    assert_eq!((&of(&list, 0)["state"], list["waiting"].as_array().unwrap().len()), (&json!("training"), 1));
    // Nobody holds it any more, and the last thing that was written is old.
    drop(held);
    let old = std::time::SystemTime::now() - Duration::from_mins(1);
    let file = fs::File::options().write(true).open(run.join("experiment.toml")).unwrap();
    file.set_modified(old).unwrap();
    wait(&server, "/api/runs", |list| of(list, 0)["state"] == json!("interrupted"));
    fs::remove_dir_all(&run).unwrap();
    wait(&server, "/api/runs", |list| of(list, 0)["state"] == json!("gone"));
    assert_eq!(get(&server, "/api/runs/0/episode").status, 409);
    // Another training takes its place.
    trained(&run);
    wait(&server, "/api/runs", |list| of(list, 0)["state"] == json!("finished"));
    assert_eq!(get(&server, "/api/runs/0/episode").status, 200);
}

#[test]
fn runs_that_are_damaged_are_told_and_the_rest_is_shown() {
    let folder = empty("damaged");
    let run = folder.join("run");
    trained(&run);
    fs::write(run.join("summary.json"), "{").unwrap();
    let text = fs::read_to_string(run.join("experiment.toml")).unwrap();
    fs::write(run.join("experiment.toml"), text.replace("problem = \"reach\"", "problem = \"of-others\"")).unwrap();
    let server = serve(std::slice::from_ref(&run));
    let detail = get(&server, "/api/runs/0").json();
    assert_eq!((&detail["problem"], &detail["simulates"]), (&json!("of-others"), &json!(false)));
    assert_eq!(detail["faults"].as_array().unwrap().len(), 2, "{}", detail["faults"]);
    assert!(detail["curve"]["env_steps"].as_array().unwrap().len() > 2);
    assert_eq!(get(&server, "/api/runs/0/episode").status, 409);
    fs::write(run.join("experiment.toml"), [0xff, 0x00]).unwrap();
    assert_eq!(get(&server, "/api/runs/0").status, 200);
    fs::write(run.join("experiment.toml"), &text).unwrap();
    fs::remove_file(run.join("summary.json")).unwrap();
    fs::write(run.join("policy.safetensors"), "no policy").unwrap();
    wait(&server, "/api/runs/0", |value| value["simulates"] == json!(true) && value["policy"] == json!("last"));
    std::thread::sleep(Duration::from_millis(250));
    let answer = get(&server, "/api/runs/0/episode");
    assert!(answer.status == 409 && answer.text().contains("policy"), "{}", answer.text());
}

#[test]
fn episodes_are_those_of_the_newest_controller() {
    let folder = empty("episodes");
    let run = folder.join("run");
    let experiment = experiment();
    let held = begin(&run, &experiment, Keeping::default());
    let server = serve(std::slice::from_ref(&run));
    let first = get(&server, "/api/runs/0/episode").json();
    assert_eq!((&first["policy"], &first["env_steps"]), (&json!("first"), &json!(0)));
    let assembly = Assembly::new(&experiment).unwrap();
    assert_eq!(first["design"], json!(assembly.policy.design(&assembly.init())));
    drop(held);
    fs::remove_dir_all(&run).unwrap();
    let params = trained(&run);
    let last = wait(&server, "/api/runs/0/episode", |episode| episode["policy"] == json!("last"));
    assert_eq!(last["design"], json!(assembly.policy.design(&params)));
    assert!(!last["scene"]["takes"].as_array().unwrap().is_empty());
}

/// Training goes on meanwhile, and replaces the checkpoint.
#[test]
fn the_cost_is_that_of_the_controller_that_was_shown() {
    let folder = empty("cost-of");
    let run = folder.join("run");
    drop(begin(&run, &experiment(), Keeping::default()));
    let server = serve(std::slice::from_ref(&run));
    let detail = get(&server, "/api/runs/0").json();
    let (name, low) = (&detail["design"][0]["parameters"][0], &detail["design"][0]["limits"][0]);
    let query = format!("{}={low}", name.as_str().unwrap());
    assert_eq!(get(&server, &format!("/api/runs/0/what-if?{query}")).json()["policy"], json!("first"));
    let elsewhere = folder.join("elsewhere");
    trained(&elsewhere);
    fs::rename(elsewhere.join("policy.safetensors"), run.join("policy.safetensors")).unwrap();
    wait(&server, "/api/runs/0", |value| value["policy"] == json!("last"));
    let (of_first, of_last) = (format!("/api/runs/0/cost/first?{query}"), format!("/api/runs/0/cost/last?{query}"));
    let (of_first, of_last) = (get(&server, &of_first).json(), get(&server, &of_last).json());
    assert_ne!(of_first["before"]["return"]["mean"], of_last["before"]["return"]["mean"]);
    let gone = get(&server, &format!("/api/runs/0/cost/checkpoint-3?{query}"));
    assert!(gone.status == 409 && gone.text().contains("the newest is last"), "{}", gone.text());
}

#[test]
fn another_design_is_simulated_and_what_it_costs_is_told() {
    let folder = empty("what-if");
    let run = folder.join("run");
    trained(&run);
    let server = serve(std::slice::from_ref(&run));
    let detail = get(&server, "/api/runs/0").json();
    let group = &detail["design"][0];
    let (name, low, high) = (
        group["parameters"][0].as_str().unwrap(),
        group["limits"][0].as_f64().unwrap(),
        group["limits"][1].as_f64().unwrap(),
    );
    let own = group["values"][0].as_f64().unwrap();
    let same = get(&server, &format!("/api/runs/0/what-if?{name}={own}")).json();
    assert_eq!(same["before"], same["after"]);
    let cost = get(&server, &format!("/api/runs/0/cost/last?{name}={own}")).json();
    assert_eq!(cost["change"]["return"]["mean"], json!(0.0));
    let other = get(&server, &format!("/api/runs/0/what-if?{name}={low}")).json();
    assert_eq!(other["after"]["design"][0], json!(low));
    assert_ne!(other["before"]["scene"], other["after"]["scene"]);
    let cost = get(&server, &format!("/api/runs/0/cost/last?{name}={low}")).json();
    let mean = |what: &str| cost[what]["return"]["mean"].as_f64().unwrap();
    let change = cost["change"]["return"]["mean"].as_f64().unwrap();
    assert!((mean("after") - mean("before") - change).abs() < 1e-9 * mean("before").abs() && change < 0.0, "{cost}");
    for (query, told) in [
        (format!("{name}={}", high + 1.0), "outside"),
        ("nothing=1".to_owned(), name),
        (format!("{name}=NaN"), "not a number"),
        (format!("{name}=1e999"), "not a number"),
        (format!("{name}={own}&{name}={own}"), "twice"),
        (name.to_owned(), "not a number"),
    ] {
        let answer = get(&server, &format!("/api/runs/0/what-if?{query}"));
        assert!(answer.status == 400 && answer.text().contains(told), "{query}: {}", answer.text());
    }
}
