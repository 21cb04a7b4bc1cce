//! Run folders.

use std::fs;

use super::Given::{Made, Nothing};
use super::{Case, case};
use crate::sandbox::Sandbox;

/// Changes the finished run.
macro_rules! run {
    ($change:expr) => {
        Made(|s| {
            s.put_run();
            let change: fn(&Sandbox) = $change;
            change(s);
        })
    };
}

fn remove(sandbox: &Sandbox, name: &str) {
    fs::remove_file(sandbox.path(name)).unwrap();
}

/// What an export of another run says of itself.
const EXPORTED: &str = r#"{"format": "hwasp-export-1", "hwasp_version": "0.1.0", "experiment": "mass-spring",
"method": "hwasp", "seed": 3, "files": []}"#;

fn put_manifest(sandbox: &Sandbox, manifest: &str) {
    fs::create_dir(sandbox.path("robot")).unwrap();
    sandbox.write("robot/export.json", manifest);
}

pub(super) const CASES: &[Case] = &[
    case("A folder that does not exist", Nothing, "hwasp eval nowhere"),
    case("The same, plotted", Nothing, "hwasp plot nowhere"),
    case("A file", Made(Sandbox::put_run), "hwasp eval run/summary.json"),
    case("An empty folder", Made(|s| fs::create_dir(s.path("empty")).unwrap()), "hwasp eval empty"),
    case(
        "One good folder and an empty one",
        run!(|s| fs::create_dir(s.path("empty")).unwrap()),
        "hwasp plot run empty",
    ),
    case(
        "A folder for an experiment",
        run!(|s| {
            remove(s, "run/experiment.toml");
            fs::create_dir(s.path("run/experiment.toml")).unwrap();
        }),
        "hwasp plot run",
    ),
    case("An empty experiment", run!(|s| s.write("run/experiment.toml", "")), "hwasp plot run"),
    case(
        "An experiment of two megabytes",
        run!(|s| s.write("run/experiment.toml", "# \n".repeat(700_000))),
        "hwasp eval run",
    ),
    case(
        "An experiment that was changed",
        run!(|s| {
            s.replace("run/experiment.toml", "gae_lambda = 0.95", "gae_lambda = 7");
            s.replace("run/experiment.toml", "seed = 0", "seed = \"zero\"");
        }),
        "hwasp eval run",
    ),
    case(
        "An experiment that was changed after the training",
        run!(|s| s.replace("run/experiment.toml", "gae_lambda = 0.95", "gae_lambda = 0.9")),
        "hwasp eval run",
    ),
    case("To write into a run that is there", Made(Sandbox::put_run), "hwasp train reach --out run"),
    case("To write into a file", Made(|s| s.write("file", "precious")), "hwasp train reach --out file"),
    case("To write into a folder in a file", Made(|s| s.write("file", "")), "hwasp train reach --out file/run"),
    case("The same, deeper", Made(|s| s.write("file", "")), "hwasp train reach --out file/run/deep"),
    case("To resume a run that is finished", Made(Sandbox::put_run), "hwasp train --resume run"),
    case("To resume what does not exist", Nothing, "hwasp train --resume nowhere"),
    case(
        "To resume a run that is under way",
        Made(|s| {
            s.put_stopped_run();
            s.write("run/.lock", "4711\n");
            let lock = fs::File::open(s.path("run/.lock")).unwrap();
            lock.lock().unwrap();
            // Held as long as the tests run.
            std::mem::forget(lock);
        }),
        "hwasp train --resume run",
    ),
    case(
        "A folder for a lock",
        Made(|s| {
            s.put_stopped_run();
            remove(s, "run/.lock");
            fs::create_dir(s.path("run/.lock")).unwrap();
        }),
        "hwasp train --resume run",
    ),
    case(
        "The policy of a run that did not finish",
        Made(|s| {
            s.put_stopped_run();
            fs::remove_dir_all(s.path("run/checkpoints")).unwrap();
        }),
        "hwasp eval run",
    ),
    case("A finished run without its policy", run!(|s| remove(s, "run/policy.safetensors")), "hwasp eval run"),
    case("The design of a run that did not finish", Made(Sandbox::put_stopped_run), "hwasp design run"),
    case("A finished run without its design", run!(|s| remove(s, "run/design.toml")), "hwasp design run"),
    case("A design that is no TOML", run!(|s| s.write("run/design.toml", "gear: 1\n")), "hwasp design run"),
    case(
        "A design beyond its limits",
        run!(|s| {
            let design = String::from_utf8(s.read("run/design.toml")).unwrap();
            let values = design.lines().find(|line| line.starts_with("values")).unwrap();
            s.write("run/design.toml", design.replace(values, "values = [99.0]"));
        }),
        "hwasp design run",
    ),
    case("An export of what does not exist", Nothing, "hwasp export nowhere"),
    case(
        "An export over a file that no export wrote",
        run!(|s| {
            fs::create_dir(s.path("robot")).unwrap();
            s.write("robot/controller.json", "precious");
        }),
        "hwasp export run --out robot",
    ),
    case("An export beside that of another run", run!(|s| put_manifest(s, EXPORTED)), "hwasp export run --out robot"),
    case("An export beside a damaged one", run!(|s| put_manifest(s, "{}")), "hwasp export run --out robot"),
    case("An export into a file", run!(|s| s.write("file", "")), "hwasp export run --out file").late(),
    case("The report of an empty folder", Made(|s| fs::create_dir(s.path("empty")).unwrap()), "hwasp report empty"),
    case("The report of a run that did not finish", Made(Sandbox::put_stopped_run), "hwasp report run"),
    case(
        "The report of a run with the figures of another",
        run!(|s| s.replace("run/summary.json", "\"seed\": 0", "\"seed\": 7")),
        "hwasp report run",
    ),
    case(
        "The report of a run whose origin was damaged",
        run!(|s| s.write("run/provenance.json", "[]")),
        "hwasp report run",
    ),
    case(
        "The report of a run whose parts were damaged",
        run!(|s| {
            fs::create_dir(s.path("run/build")).unwrap();
            s.write("run/build/parts.json", "{\"experiment\": 1}");
        }),
        "hwasp report run",
    ),
    case("The report of a run without its policy", run!(|s| remove(s, "run/policy.safetensors")), "hwasp report run"),
    case("A report that is no page", Made(Sandbox::put_run), "hwasp report run --out report.pdf"),
    case("A comparison in a run folder", Made(Sandbox::put_run), "hwasp compare reach --out run"),
    case("A comparison in a file", Made(|s| s.write("file", "")), "hwasp compare reach --out file"),
    case(
        "A comparison of another experiment",
        Made(|s| {
            s.put_run();
            fs::create_dir_all(s.path("both/cells")).unwrap();
            fs::rename(s.path("run"), s.path("both/cells/hwasp-seed0")).unwrap();
        }),
        "hwasp compare reach --methods hwasp --seeds 1 --quiet --out both",
    ),
];
