//! How time and memory grow with the size of a problem: `cargo bench -p hwasp-training --bench growth` prints the tables of
//! docs/performance.md, `-- springs` those whose name begins so. Every point is a process of its own, for its memory.

#![allow(clippy::print_stdout, reason = "a program")]

use std::error::Error;
use std::process::Command;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use hwasp_algos::{Cmaes, CmaesConfig, Search};
use hwasp_core::Threads;
use hwasp_training::{Assembly, train};

/// What is made larger.
struct Axis {
    name: &'static str,
    /// What one unit of time is.
    of: &'static str,
    /// The exponent that the arithmetic asks for: of time and of memory, at the upper end.
    expected: &'static str,
    values: &'static [u64],
    run: fn(u64) -> Result<f64, Box<dyn Error>>,
}

const AXES: &[Axis] = &[
    Axis {
        name: "springs in the graph",
        of: "an iteration of 4,000 steps",
        expected: "time 1, memory 1",
        values: &[10, 100, 1000, 10_000],
        run: |n| iteration(10, 4000, 1, &[("task.segments", &n.to_string())]),
    },
    Axis {
        name: "springs in the action",
        of: "an iteration of 4,000 steps",
        expected: "time 1, memory 1",
        values: &[10, 100, 1000, 10_000],
        run: |n| iteration(4, 4000, 1, &[("method", "minimal"), ("task.segments", &n.to_string())]),
    },
    Axis {
        name: "width of both hidden layers",
        of: "an iteration of 4,000 steps",
        expected: "time 2, memory 2",
        values: &[32, 64, 128, 256, 512, 1024],
        run: |n| iteration(4, 4000, 1, &[("controller.hidden", &format!("[{n}, {n}]"))]),
    },
    Axis {
        name: "episodes of an iteration (PPO)",
        of: "an iteration of as many episodes of 200 steps",
        expected: "time 1, memory 1",
        values: &[1, 4, 16, 64, 256, 1024, 4096],
        run: |n| {
            let episodes = ("train.episodes_per_iteration", &*n.to_string());
            iteration(512_u64.div_ceil(n).max(2), 200 * n, 1, &[episodes, ("ppo.minibatch_rows", "200")])
        },
    },
    Axis {
        name: "rows of a batch (TRPO)",
        of: "an iteration of as many steps",
        expected: "time 1, memory 1",
        values: &[1000, 10_000, 100_000, 1_000_000],
        run: |n| {
            let episodes = ("train.episodes_per_iteration", &*(n / 200).to_string());
            let trpo = ("learner.algorithm", "trpo");
            iteration(20_000_u64.div_ceil(n).max(2), n, 1, &[episodes, trpo, ("baseline.kind", "linear")])
        },
    },
    Axis {
        name: "threads (TRPO, 128 wide)",
        of: "an iteration of 20,000 steps",
        expected: "time -1",
        values: &[1, 2],
        run: |n| {
            let (trpo, hidden) = (("learner.algorithm", "trpo"), ("controller.hidden", "[128, 128]"));
            let episodes = ("train.episodes_per_iteration", "100");
            iteration(5, 20_000, n as usize, &[episodes, trpo, hidden, ("baseline.kind", "linear")])
        },
    },
    Axis {
        name: "dimensions of CMA-ES, separable",
        of: "a generation",
        expected: "time 1 (and the logarithm of the population), memory 1",
        values: &[100, 1000, 10_000, 100_000, 1_000_000],
        run: |n| generation(n as usize, true, 100_000_u64.div_ceil(n).max(3)),
    },
    Axis {
        name: "dimensions of CMA-ES, full",
        of: "a generation, decompositions among them",
        expected: "time 2 (and the logarithm of the population), memory 2",
        values: &[25, 50, 100, 200, 400, 800, 1600],
        run: |n| generation(n as usize, false, 2 * n + 20),
    },
];

/// Seconds of an iteration of mass-spring with these settings, the first ones among them.
fn iteration(count: u64, rows: u64, threads: usize, settings: &[(&str, &str)]) -> Result<f64, Box<dyn Error>> {
    let steps = (count * rows).to_string();
    let settings =
        [("train.env_steps", &*steps), ("train.evaluation_episodes", "1")].into_iter().chain(settings.to_vec());
    let layers =
        settings.fold(hwasp_testing::layers("mass-spring"), |layers, (key, value)| layers.with_override(key, value));
    let assembly = Assembly::new(&hwasp_testing::resolve(layers, None)?)?;
    let trained = train(&assembly, &Threads::new(threads)?, &mut (), &AtomicBool::new(false))?;
    Ok(trained.wall_s / trained.iterations as f64)
}

/// Seconds of a generation on the sphere, asked and told.
fn generation(dimensions: usize, separable: bool, count: u64) -> Result<f64, Box<dyn Error>> {
    let mut search = Cmaes::new(CmaesConfig { separable, ..CmaesConfig::default() }, &vec![1.0; dimensions], 1)?;
    let began = Instant::now();
    for _ in 0..count {
        let scores: Vec<f64> = search.ask().iter().map(|x| -x.iter().map(|x| x * x).sum::<f64>()).collect();
        search.tell(&scores)?;
    }
    Ok(began.elapsed().as_secs_f64() / count as f64)
}

/// The most memory that this process has had, MB; zero where the system does not tell.
fn memory() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB")?.parse().ok());
    peak.unwrap_or(0.0) / 1024.0
}

fn table(axis: &Axis) -> Result<(), Box<dyn Error>> {
    println!("\n### {}\n\nTime of {}. Expected exponents: {}.\n", axis.name, axis.of, axis.expected);
    println!("| {} | ms | exponent | memory, MB | exponent |\n|---|---|---|---|---|", axis.name);
    let mut before: Option<(f64, f64, f64)> = None;
    for &value in axis.values {
        let child = Command::new(std::env::current_exe()?).args(["point", axis.name, &value.to_string()]).output()?;
        let text = String::from_utf8(child.stdout)?;
        let point: Vec<f64> = text.split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
        let [time, memory] = point[..] else { return Err(String::from_utf8_lossy(&child.stderr).into()) };
        let size = value as f64;
        let exponent = |now: f64, then: f64, from: f64| format!("{:.2}", (now / then).ln() / (size / from).ln());
        let [of_time, of_memory] =
            before.map_or_else(Default::default, |(from, t, m)| [exponent(time, t, from), exponent(memory, m, from)]);
        println!("| {value} | {:.3} | {of_time} | {memory:.0} | {of_memory} |", 1e3 * time);
        before = Some((size, time, memory));
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    // Cargo adds --bench.
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    if let [command, name, value] = &arguments[..]
        && command == "point"
        && let Some(axis) = AXES.iter().find(|axis| axis.name == name)
    {
        let time = (axis.run)(value.parse()?)?;
        println!("{time} {}", memory());
        return Ok(());
    }
    let asked = arguments.first().map_or("", String::as_str);
    AXES.iter().filter(|axis| axis.name.starts_with(asked)).try_for_each(table)
}
