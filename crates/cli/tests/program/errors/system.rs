//! What the system refuses.

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};

use super::Given::{Made, Nothing};
use super::{Case, When, case};
use crate::sandbox::Sandbox;

const LONG: &str = "hwasp train reach --env-steps 1e9 --quiet --out run";

/// Lets every try to write a file of the folder `run` end at a full disk: files are written beside their place first.
fn full(sandbox: &Sandbox, name: &str) {
    fs::create_dir_all(sandbox.path("run")).unwrap();
    symlink("/dev/full", sandbox.path(&format!("run/.{name}.partial"))).unwrap();
}

pub(super) const CASES: &[Case] = &[
    case("A full disk where the output goes", Nothing, "hwasp list > /dev/full").late(),
    case(
        "A full disk before a training",
        Made(|s| full(s, "experiment.toml")),
        "hwasp train reach --env-steps 2400 --quiet --out run",
    ),
    case(
        "A full disk as a training begins",
        Made(|s| full(s, "metrics.csv")),
        "hwasp train reach --env-steps 2400 --quiet --out run",
    )
    .late(),
    case(
        "A full disk as a training ends",
        Made(|s| full(s, "policy.safetensors")),
        "hwasp train reach --env-steps 2400 --quiet --out run",
    )
    .late(),
    case(
        "A full disk as a training is taken up",
        Made(|s| {
            s.put_stopped_run();
            full(s, "provenance.json");
        }),
        "hwasp train --resume run --quiet",
    ),
    case(
        "A full disk where a plot goes",
        Made(|s| {
            s.put_run();
            symlink("/dev/full", s.path("curves.svg")).unwrap();
        }),
        "hwasp plot run",
    )
    .late(),
    case("A plot in a folder that is not there", Made(Sandbox::put_run), "hwasp plot run --out nowhere/curves.svg")
        .late(),
    case(
        "A plot in the place of a folder",
        Made(|s| {
            s.put_run();
            fs::create_dir(s.path("curves.svg")).unwrap();
        }),
        "hwasp plot run",
    )
    .late(),
    case("A drawing in a folder that is not there", Nothing, "hwasp graph reach --out nowhere/law.svg").late(),
    case(
        "A folder that may not be written",
        Made(|s| {
            fs::create_dir(s.path("locked")).unwrap();
            fs::set_permissions(s.path("locked"), fs::Permissions::from_mode(0o555)).unwrap();
        }),
        "hwasp train reach --out locked/run",
    )
    .when(When::Bound(
        "error: cannot create locked/run: Permission denied (os error 13)\n  = hint: name another folder with --out\n",
    )),
    case("A place where nothing can be created", Nothing, "hwasp train reach --out /proc/run"),
    case(
        "A summary that cannot be written, for a folder is there",
        Made(|s| {
            fs::create_dir_all(s.path("run/.summary.json.partial")).unwrap();
        }),
        "hwasp train reach --env-steps 2400 --quiet --out run",
    )
    .late(),
    case(
        "A table of a comparison that cannot be written",
        Made(|s| {
            fs::create_dir_all(s.path("both/cells")).unwrap();
            fs::create_dir(s.path("both/table.md")).unwrap();
        }),
        "hwasp compare reach --methods hwasp --seeds 1 --env-steps 2400 --log-level error --out both",
    )
    .late()
    .printing(),
    Case { code: 130, ..case("Ctrl-C", Nothing, LONG).when(When::UnderWay(|_| {})) },
    case("A folder that is moved away under a training, a file in its place, and Ctrl-C", Nothing, LONG).late().when(
        When::UnderWay(|s| {
            fs::rename(s.path("run"), s.path("gone")).unwrap();
            s.write("run", "");
        }),
    ),
];
