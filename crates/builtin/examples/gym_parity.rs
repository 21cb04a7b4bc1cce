//! Repeats what Gymnasium's robots did, step by step, in the problems of `benches/gym`, and tells how far apart they are.
//!
//! `python benches/gym/parity.py` writes the steps and runs this: `gym_parity FOLDER`, a folder with `NAME.toml`, the model, and
//! the steps of `NAME.txt`.

#![allow(clippy::print_stdout)] // an example shows what it finds

use std::error::Error;
use std::fs;
use std::path::Path;

use hwasp_core::{End, Environment, Purpose, stream};
use hwasp_experiment::{Catalogue, Folder, Layers, resolve};

/// How far apart numbers may be.
const MOST: f64 = 1e-9;

fn main() -> Result<(), Box<dyn Error>> {
    let Some(folder) = std::env::args().nth(1) else {
        println!("gym_parity FOLDER: see benches/gym/parity.py, which writes the folder");
        return Ok(());
    };
    let catalogue = hwasp_builtin::catalogue();
    let mut robots: Vec<_> = fs::read_dir(&folder)?.collect::<Result<Vec<_>, _>>()?;
    robots.sort_by_key(std::fs::DirEntry::file_name);
    for file in robots.iter().map(std::fs::DirEntry::path).filter(|path| path.extension().is_some_and(|e| e == "toml"))
    {
        let worst = repeat(&file, &catalogue)?;
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        println!(
            "{name:<26} {} steps, observations within {:.1e}, rewards within {:.1e}",
            worst.steps, worst.observation, worst.reward
        );
        if worst.observation > MOST || worst.reward > MOST {
            return Err(format!("{name} is not within {MOST:e}").into());
        }
    }
    Ok(())
}

/// The largest differences.
#[derive(Default)]
struct Worst {
    steps: usize,
    observation: f64,
    reward: f64,
}

fn numbers(text: &str) -> Result<Vec<f64>, Box<dyn Error>> {
    text.split_whitespace().map(|number| Ok(number.parse()?)).collect()
}

/// An environment that starts in this state.
fn environment(file: &Path, start: &str, catalogue: &Catalogue) -> Result<Box<dyn Environment>, Box<dyn Error>> {
    let list = |numbers: &[f64]| format!("{numbers:?}");
    let (qpos, qvel) = start.split_once('|').ok_or("a start has positions and velocities")?;
    // The experiment with a start of its own, which is its last table.
    let text = fs::read_to_string(file)?;
    let (before, _) = text.split_once("[task.start]").ok_or("the experiment ends with [task.start]")?;
    let start = format!("qpos = \"{}\"\nqvel = \"{}\"\n", list(&numbers(qpos)?), list(&numbers(qvel)?));
    let folder = Folder::Disk(file.parent().unwrap_or(Path::new(".")).to_owned());
    let layers =
        Layers::from_text(&file.to_string_lossy(), &format!("{before}[task.start]\n{start}"))?.with_folder(folder);
    let experiment = resolve(layers, Some("fixed"), catalogue)?;
    let mut environment = experiment.task.built().deployment.make.make(None);
    environment.reset(&mut stream(0, Purpose::EvaluationReset, 0, 0));
    Ok(environment)
}

fn repeat(file: &Path, catalogue: &Catalogue) -> Result<Worst, Box<dyn Error>> {
    let steps = fs::read_to_string(file.with_extension("txt"))?;
    let mut worst = Worst::default();
    let mut robot: Option<Box<dyn Environment>> = None;
    for line in steps.lines() {
        if let Some(start) = line.strip_prefix("start ") {
            robot = Some(environment(file, start, catalogue)?);
            continue;
        }
        let parts = line.strip_prefix("step ").ok_or("a line begins with start or step")?.split('|');
        let parts = parts.map(numbers).collect::<Result<Vec<_>, _>>()?;
        let [action, observation, reward, terminated] = &parts[..] else { return Err("a step has four parts".into()) };
        let robot = robot.as_mut().ok_or("steps come after a start")?;
        let step = robot.step(&[], action);
        let mut seen = vec![0.0; robot.spec().observation.len()];
        robot.observe(&mut seen);
        let ended = step.end == Some(End::Terminated);
        if ended != (terminated[0] != 0.0) || seen.len() != observation.len() {
            return Err(format!("step {}: {:?} with {} observations", worst.steps, step.end, seen.len()).into());
        }
        let apart = |a: f64, b: f64| (a - b).abs();
        let furthest = seen.iter().zip(observation).map(|(&a, &b)| apart(a, b)).fold(0.0, f64::max);
        worst.observation = worst.observation.max(furthest);
        worst.reward = worst.reward.max(apart(step.reward, reward[0]));
        worst.steps += 1;
    }
    Ok(worst)
}
