//! Metrics, policies and summaries.

use std::fs;

use super::Given::Made;
use super::{Case, case, change};
use crate::sandbox::Sandbox;

const HEADER: &str = "iteration,env_steps,wall_s,discounted_return,return,learner.kl,gear\n";

/// A case of a finished run with another `metrics.csv`.
macro_rules! metrics {
    ($what:literal, $text:expr) => {
        case(
            $what,
            Made(|s| {
                s.put_run();
                s.write("run/metrics.csv", $text);
            }),
            "hwasp plot run",
        )
    };
}

/// A case of a finished run with another `policy.safetensors`.
macro_rules! policy {
    ($what:literal, $change:expr) => {
        case(
            $what,
            Made(|s| {
                s.put_run();
                change(s, "run/policy.safetensors", $change);
            }),
            "hwasp eval run",
        )
    };
}

/// A comparison of one cell, which is finished, with another summary.
fn comparison(sandbox: &Sandbox, summary: &str) {
    let line = "compare reach --methods hwasp --seeds 1 --env-steps 2400 --quiet --out both";
    assert!(sandbox.run(line).status.success());
    sandbox.write("both/cells/hwasp-seed0/summary.json", summary);
}

pub(super) const CASES: &[Case] = &[
    metrics!("An empty table", ""),
    metrics!("Another table", "a,b\n1,2\n"),
    metrics!("A header with a column missing", HEADER.replace(",wall_s", "")),
    metrics!("A row of two fields", format!("{HEADER}0,1200\n")),
    metrics!("A word for a number", format!("{HEADER}0,many,0,0,0,0,0\n")),
    metrics!("Negative steps", format!("{HEADER}0,-1200,0,0,0,0,0\n")),
    metrics!("Steps that go backwards", format!("{HEADER}0,2400,0,0,0,0,0\n0,1200,0,0,0,0,0\n")),
    metrics!("A line without an end", "x".repeat(1 << 20)),
    metrics!("Bytes", b"\xff\xfe\0\x01\n"),
    case(
        "No table",
        Made(|s| {
            s.put_run();
            fs::remove_file(s.path("run/metrics.csv")).unwrap();
        }),
        "hwasp plot run",
    ),
    case(
        "A folder for a table",
        Made(|s| {
            s.put_run();
            fs::remove_file(s.path("run/metrics.csv")).unwrap();
            fs::create_dir(s.path("run/metrics.csv")).unwrap();
        }),
        "hwasp plot run",
    ),
    policy!("An empty policy", Vec::clear),
    policy!("A policy cut in its header", |b| b.truncate(100)),
    policy!("A policy cut in its data", |b| b.truncate(b.len() - 4)),
    policy!("A policy with a header of 2^64 bytes", |b| b[..8].fill(0xff)),
    policy!("A policy with NaN", |b| {
        let last = b.len() - 4;
        b[last..].copy_from_slice(&f32::NAN.to_le_bytes());
    }),
    policy!("A policy that is a text", |b| *b = b"these are no weights".to_vec()),
    case(
        "A policy of another shape",
        Made(|s| {
            s.put_run();
            s.forget_experiment();
            s.replace("run/experiment.toml", "[controller]\nhidden = [16]", "[controller]\nhidden = [8]");
        }),
        "hwasp eval run",
    ),
    case(
        "A summary that is no JSON",
        Made(|s| comparison(s, "{")),
        "hwasp compare reach --methods hwasp --seeds 1 --env-steps 2400 --quiet --out both",
    )
    .late(),
    case(
        "A summary of something else",
        Made(|s| comparison(s, "{}")),
        "hwasp compare reach --methods hwasp --seeds 1 --env-steps 2400 --quiet --out both",
    )
    .late(),
];
