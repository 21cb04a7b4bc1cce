//! Steps per second of robots from files, and of the bare engine on the same model with the same commands. The last line says
//! it in JSON.
//!
//!     robot_throughput FOLDER [STEPS]         a folder with NAME.toml and models; default: 50,000 steps
//!
//! Both run on one thread, in turn, three times; the fastest of each counts. Then the environments run on all cores at once.
//! `python benches/gym/speed.py` adds Gymnasium.

#![allow(clippy::print_stdout)] // a program

use std::error::Error;
use std::fs;
use std::path::Path;
use std::thread;
use std::time::Instant;

use hwasp_core::{Purpose, Stream, stream};
use hwasp_experiment::{Catalogue, Experiment, load, resolve};
use hwasp_mujoco::engine::{Files, Simulation, Spec};
use rand::RngExt;
use serde_json::json;

/// How often each is measured.
const ROUNDS: usize = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let Some(folder) = arguments.next() else {
        println!("robot_throughput FOLDER [STEPS]: see benches/gym/speed.py, which writes the folder");
        return Ok(());
    };
    let steps: usize = arguments.next().map_or(Ok(50_000), |steps| steps.parse())?;
    let catalogue = hwasp_builtin::catalogue();
    let mut files: Vec<_> = fs::read_dir(&folder)?.collect::<Result<Vec<_>, _>>()?;
    files.sort_by_key(fs::DirEntry::file_name);
    let mut figures = Vec::new();
    for path in files.iter().map(fs::DirEntry::path).filter(|path| path.extension().is_some_and(|e| e == "toml")) {
        let experiment = read(&path, &catalogue)?;
        let (mut ours, mut bare) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..ROUNDS {
            ours = ours.min(environment(&experiment, steps));
            bare = bare.min(engine(&experiment, steps)?);
        }
        let cores = thread::available_parallelism()?.get();
        let all = (0..ROUNDS).map(|_| at_once(&experiment, steps, cores)).fold(f64::INFINITY, f64::min);
        let rate = |seconds: f64| steps as f64 / seconds;
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let (one, bare, all) = (rate(ours), rate(bare), cores as f64 * rate(all));
        println!(
            "{name:<26} {one:>9.0} steps/s, bare engine {bare:>9.0}: {:.3} of it; {cores} cores {all:>9.0}",
            one / bare
        );
        figures
            .push(json!({ "robot": name, "steps_per_s": one, "bare_steps_per_s": bare, "all_cores_steps_per_s": all }));
    }
    println!("{}", json!(figures));
    Ok(())
}

fn read(path: &Path, catalogue: &Catalogue) -> Result<Experiment, Box<dyn Error>> {
    Ok(resolve(load(&path.to_string_lossy(), catalogue)?, Some("fixed"), catalogue)?)
}

/// Commands within their limits, some thousand steps of them, over and over.
fn commands(experiment: &Experiment, chance: &mut Stream) -> Vec<Vec<f64>> {
    let ports = &experiment.task.built().deployment.env.command;
    let mut draw = || ports.iter().map(|port| port.lo + (port.hi - port.lo) * chance.random::<f64>()).collect();
    (0..4096).map(|_| draw()).collect()
}

/// Seconds for so many steps of the environment, resets included.
fn environment(experiment: &Experiment, steps: usize) -> f64 {
    let mut robot = experiment.task.built().deployment.make.make(None);
    let mut chance = stream(0, Purpose::Samples, 0, 0);
    let commands = commands(experiment, &mut chance);
    let mut seen = vec![0.0; robot.spec().observation.len()];
    robot.reset(&mut chance);
    let began = Instant::now();
    for i in 0..steps {
        let step = robot.step(&[], &commands[i % commands.len()]);
        robot.observe(&mut seen);
        if step.end.is_some() {
            robot.reset(&mut chance);
        }
    }
    began.elapsed().as_secs_f64()
}

/// Seconds until each of so many threads has taken so many steps.
fn at_once(experiment: &Experiment, steps: usize, threads: usize) -> f64 {
    let began = Instant::now();
    thread::scope(|scope| (0..threads).for_each(|_| drop(scope.spawn(|| environment(experiment, steps)))));
    began.elapsed().as_secs_f64()
}

/// Seconds for so many steps of the engine alone: as many simulation steps, with the same commands, back to the start where the
/// environment would be reset.
fn engine(experiment: &Experiment, steps: usize) -> Result<f64, Box<dyn Error>> {
    let built = experiment.task.built();
    let files = Files::new(built.files.iter().map(|(path, bytes)| (path.clone(), bytes.clone())))?;
    let main = built
        .files
        .keys()
        .find(|path| Path::new(path).extension().is_some_and(|ending| ending == "xml"))
        .ok_or("a robot has a model")?;
    let mut bare: Simulation = Spec::parse(main, &files)?.compile()?;
    let mut robot = built.deployment.make.make(None);
    let mut chance = stream(0, Purpose::Samples, 0, 0);
    let commands = commands(experiment, &mut chance);
    // Where the environment ends its episodes, so that both simulate the same.
    robot.reset(&mut chance);
    let mut ends = Vec::with_capacity(steps);
    for i in 0..steps {
        let ended = robot.step(&[], &commands[i % commands.len()]).end.is_some();
        ends.push(ended);
        if ended {
            robot.reset(&mut chance);
        }
    }
    let skip = (built.deployment.env.time_step / bare.timestep()).round() as usize;
    bare.reset();
    let began = Instant::now();
    for (i, &ended) in ends.iter().enumerate() {
        bare.ctrl_mut().copy_from_slice(&commands[i % commands.len()]);
        bare.step(skip)?;
        if ended {
            bare.reset();
        }
    }
    Ok(began.elapsed().as_secs_f64())
}
