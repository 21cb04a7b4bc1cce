//! Checkpoints.

use std::fs;

use super::Given::Made;
use super::{Case, case, change};
use crate::sandbox::Sandbox;

const NAMES: [&str; 3] = ["iteration-00000001", "iteration-00000002", "best"];

/// Changes all checkpoints of the run that was stopped.
fn all(sandbox: &Sandbox, how: fn(&mut Vec<u8>)) {
    sandbox.put_stopped_run();
    for name in NAMES {
        change(sandbox, &format!("run/checkpoints/{name}.safetensors"), how);
    }
}

fn cut(bytes: &mut Vec<u8>) {
    bytes.truncate(bytes.len() / 2);
}

fn flip(bytes: &mut [u8]) {
    *bytes.last_mut().unwrap() ^= 1;
}

/// The same length, so that nothing but the version is wrong.
fn of_the_future(bytes: &mut [u8]) {
    let (version, newer) = (br#"{\"version\":1,"#, br#"{\"version\":9,"#);
    let at = bytes.windows(version.len()).position(|part| part == version).unwrap();
    bytes[at..at + newer.len()].copy_from_slice(newer);
}

fn of_another_experiment(sandbox: &Sandbox) {
    sandbox.put_stopped_run();
    sandbox.replace("run/experiment.toml", "clip_ratio = 0.2", "clip_ratio = 0.3");
}

pub(super) const CASES: &[Case] = &[
    case("All cut in half", Made(|s| all(s, cut)), "hwasp train --resume run"),
    case("All with a flipped bit", Made(|s| all(s, |bytes| flip(bytes))), "hwasp train --resume run"),
    case("All damaged, and an evaluation", Made(|s| all(s, |bytes| flip(bytes))), "hwasp eval run"),
    case("All empty", Made(|s| all(s, Vec::clear)), "hwasp train --resume run"),
    case("Of a newer version", Made(|s| all(s, |bytes| of_the_future(bytes))), "hwasp train --resume run"),
    case("Of another experiment", Made(of_another_experiment), "hwasp train --resume run"),
    case("Of another experiment, and an evaluation", Made(of_another_experiment), "hwasp eval run"),
    case(
        "A folder in the place of a checkpoint",
        Made(|s| {
            s.put_stopped_run();
            fs::create_dir(s.path("run/checkpoints/iteration-00000003.safetensors")).unwrap();
        }),
        "hwasp train --resume run",
    ),
    case(
        "A file in the place of the folder",
        Made(|s| {
            s.put_stopped_run();
            fs::remove_dir_all(s.path("run/checkpoints")).unwrap();
            s.write("run/checkpoints", "");
        }),
        "hwasp train --resume run",
    ),
    case("Replayed, cut in half", Made(|s| all(s, cut)), "hwasp replay run/checkpoints/best.safetensors"),
    case(
        "Replayed, with a flipped bit",
        Made(|s| all(s, |bytes| flip(bytes))),
        "hwasp replay run/checkpoints/best.safetensors",
    ),
    case(
        "Replayed, of a newer version",
        Made(|s| all(s, |bytes| of_the_future(bytes))),
        "hwasp replay run/checkpoints/iteration-00000001.safetensors",
    ),
    case(
        "Replayed, of another experiment",
        Made(of_another_experiment),
        "hwasp replay run/checkpoints/best.safetensors",
    ),
    case(
        "Replayed, a policy among the checkpoints",
        Made(|s| {
            s.put_run();
            fs::create_dir(s.path("run/checkpoints")).unwrap();
            fs::copy(s.path("run/policy.safetensors"), s.path("run/checkpoints/policy.safetensors")).unwrap();
        }),
        "hwasp replay run/checkpoints/policy.safetensors",
    ),
    case(
        "Replayed, of a search",
        Made(|s| {
            let line = "train reach --method cmaes --env-steps 2400 --set search.episodes=1 --quiet --out run \
                        --set train.evaluation_episodes=2";
            assert!(s.run(line).status.success());
            let mut files = fs::read_dir(s.path("run/checkpoints")).unwrap().map(|file| file.unwrap().path());
            let any = files.next().unwrap();
            fs::rename(any, s.path("run/checkpoints/any.safetensors")).unwrap();
        }),
        "hwasp replay run/checkpoints/any.safetensors",
    ),
    case("Replayed, a policy", Made(Sandbox::put_run), "hwasp replay run/policy.safetensors"),
    case("Replayed, another file of a run", Made(Sandbox::put_run), "hwasp replay run/summary.json"),
    case("Replayed, a run", Made(Sandbox::put_run), "hwasp replay run"),
    case("Replayed, nothing", Made(|_| {}), "hwasp replay nowhere.safetensors"),
];
