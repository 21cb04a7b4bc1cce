//! Experiment files.

use std::fs;

use super::Given::{File, Made, Nothing};
use super::{Case, case, file};

/// The reach problem, and what is wrong with it.
macro_rules! reach {
    ($rest:literal) => {
        concat!("name = \"mine\"\n[task]\nproblem = \"reach\"\n", $rest)
    };
}

pub(super) const CASES: &[Case] = &[
    case("A misspelt name of an experiment", Nothing, "hwasp train reahc"),
    case("A name of nothing", Nothing, "hwasp check ''"),
    case("A file that does not exist", Nothing, "hwasp check nowhere.toml"),
    case("An experiment of the program, as if it were a file", Nothing, "hwasp check reach.toml"),
    case("A file without its ending", File(reach!("")), "hwasp train mine"),
    case("A folder", Made(|s| fs::create_dir(s.path("mine.toml")).unwrap()), "hwasp check mine.toml"),
    case("A run folder", Made(super::Sandbox::put_run), "hwasp train run"),
    file("An empty file", ""),
    case(
        "Bytes",
        Made(|s| s.write("mine.toml", [0x7f, b'E', b'L', b'F', 2, 1, 0, 0xff, 0xfe])),
        "hwasp check mine.toml",
    ),
    case(
        "A text in Latin-1",
        Made(|s| s.write("mine.toml", b"name = \"x\"\ndescription = \"f\xfcr\"\n")),
        "hwasp train mine.toml",
    ),
    case("A text in UTF-16", Made(|s| s.write("mine.toml", b"\xff\xfen\0a\0m\0e\0")), "hwasp check mine.toml"),
    file("A zero byte", "name = \"x\0\"\n"),
    case("A file of two megabytes", Made(|s| s.write("mine.toml", "# \n".repeat(700_000))), "hwasp check mine.toml"),
    case("Another kind of file", Made(super::Sandbox::put_run), "hwasp train run/summary.json"),
    case("A file without an end", Nothing, "hwasp check /dev/zero"),
    case(
        "A link that leads to itself",
        Made(|s| std::os::unix::fs::symlink("mine.toml", s.path("mine.toml")).unwrap()),
        "hwasp check mine.toml",
    ),
    case(
        "Brackets in brackets in brackets",
        Made(|s| s.write("mine.toml", format!("x = {}", "[".repeat(3000)))),
        "hwasp check mine.toml",
    ),
    file("Broken TOML", "name = \"x\"\n[task\nproblem = \"reach\"\n"),
    file("A decimal comma", reach!("[ppo]\nclip_ratio = 0,2\n")),
    file("A text without quotes", "name = \"mine\"\n[task]\nproblem = reach\n"),
    file("A key twice", "name = \"mine\"\nseed = 1\nseed = 2\n[task]\nproblem = \"reach\"\n"),
    file("A table twice", reach!("[ppo]\nepochs = 5\n[ppo]\nclip_ratio = 0.1\n")),
    file("No name", "[task]\nproblem = \"reach\"\n"),
    file("An empty name", "name = \"\"\n[task]\nproblem = \"reach\"\n"),
    file("A name that would move the cursor", "name = \"a\\u001b[2J\"\n[task]\nproblem = \"reach\"\n"),
    file("A name that is a number", "name = 3\n[task]\nproblem = \"reach\"\n"),
    file("No problem", "name = \"mine\"\n"),
    file("A misspelt problem", "name = \"mine\"\n[task]\nproblem = \"raech\"\n"),
    file("A text where a table belongs", "name = \"mine\"\ntask = \"reach\"\n"),
    file("Double brackets", reach!("[[ppo]]\nclip_ratio = 0.1\n")),
    file("A misspelt key", reach!("[ppo]\nclip_ration = 0.1\n")),
    file("A key of another table", reach!("[train]\nclip_ratio = 0.1\n")),
    file("A misspelt table", reach!("[contoller]\nhidden = [8]\n")),
    file("A key of another problem", reach!("segments = 10\n")),
    file("Zero where one is the least", "name = \"mine\"\n[task]\nproblem = \"stiffness\"\nsegments = 0\n"),
    file("A negative number of steps", reach!("[train]\nenv_steps = -1\n")),
    file("A number that no one can wait for", reach!("[train]\nenv_steps = 1e99\n")),
    file("A seed of more than 64 bits", "name = \"mine\"\nseed = 99999999999999999999\n[task]\nproblem = \"reach\"\n"),
    file("A fraction where a whole number belongs", reach!("[ppo]\nepochs = 2.5\n")),
    file("NaN", reach!("[ppo]\nclip_ratio = nan\n")),
    file("Infinity", reach!("[ppo]\ndiscount = inf\n")),
    file("NaN where a whole number belongs", reach!("horizon = nan\n")),
    file("A text where a number belongs", reach!("[ppo]\nclip_ratio = \"small\"\n")),
    file("A date", reach!("horizon = 2026-11-22\n")),
    file("A number where a choice belongs", reach!("[controller]\nactivation = 3\n")),
    file("A misspelt choice", reach!("[controller]\nactivation = \"tahn\"\n")),
    file("A misspelt method", "name = \"mine\"\nmethod = \"hwsap\"\n[task]\nproblem = \"reach\"\n"),
    file("A layer of no neurons", reach!("[controller]\nhidden = [16, 0]\n")),
    file("A list of the wrong length", reach!("[controller]\nobservation_scale = [1.0, 1.0, 1.0]\n")),
    file("A scale of zero", reach!("[controller]\nobservation_scale = [0.0]\n")),
    file(
        "Observations scaled by hand and by statistics",
        reach!("[controller]\nnormalize_observations = true\nobservation_scale = [0.5]\n"),
    ),
    file("Fewer steps than lanes", reach!("[train]\nsteps_per_iteration = 10\n")),
    file("No unit", reach!("[noise]\neffort = 0.1\n")),
    file("A unit that is not known", reach!("[noise]\neffort = \"3 furlongs\"\n")),
    file("A unit of something else", reach!("[noise]\neffort = \"3 mm\"\n")),
    file("A comma in a quantity", reach!("[noise]\neffort = \"0,1 m/s\"\n")),
    file("A quantity without its number", reach!("[noise]\neffort = \"m/s\"\n")),
    file("NaN as a quantity", reach!("[noise]\neffort = \"nan m/s\"\n")),
    file("A quantity out of its range", reach!("[noise]\neffort = \"-1 m/s\"\n")),
    file("A design that begins outside of its limits", reach!("[design]\ninitial = \"4\"\n")),
    file("A design that begins nowhere", reach!("[design]\ninitial = \"inf\"\n")),
    file(
        "Two placements that contradict each other",
        reach!("[design]\nplacements = { \"gear\" = \"action\", \"gear[0]\" = \"fixed\" }\n"),
    ),
    file("A placement of what there is not", reach!("[design]\nplacements = { \"gear[3]\" = \"action\" }\n")),
    file("A placement of no range", reach!("[design]\nplacements = { \"gear[1..0]\" = \"action\" }\n")),
    file("Too many placements", reach!("[design]\nplacements = [\"graph\", \"fixed\"]\n")),
    file("Settings for a method that does not exist", reach!("[methods.minimla.ppo]\nclip_ratio = 0.1\n")),
    file("A fault in the settings of another method", reach!("[methods.minimal.ppo]\nclip_ratio = 9\n")),
    file("Fewer steps than an iteration", reach!("[train]\nenv_steps = 100\n")),
    file("Episodes longer than the horizon", reach!("horizon = 10\n[train]\nepisode_steps = 30\n")),
    case(
        "Several faults at once",
        File(
            "name = \"x\"\nsed = 3\n[task]\nproblem = \"stiffness\"\nsegments = 0\n[ppo]\nclip_ratio = 7\n\
             [noise]\neffort = \"3 mm\"\n[methods.other]\nx = 1\n",
        ),
        "hwasp check mine.toml --set seed=-1",
    ),
];
