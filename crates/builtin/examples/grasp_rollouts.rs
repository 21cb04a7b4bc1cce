//! Rollouts of z-grasp by its trained controller: how long they take, how long their physics alone, and, for the comparison
//! of `benches/peers`, all that others need to repeat those physics to the bit.
//!
//!     grasp_rollouts [EPISODES [THREADS [FOLDER]]]        default: 4 episodes of 500 steps, 1 thread
//!
//! Prints one line of JSON, in seconds. `FOLDER` gets the model, and of every episode the object, the controls and forces of
//! each step, and where everything was at the end.

#![allow(clippy::print_stdout)] // a program

use std::error::Error;
use std::fs;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use hwasp_core::{
    EnvSpec, Environment, EpisodeKind, Episodes, Executor, Robot, Sampler, Serial, Step, Stream, Threads,
};
use hwasp_grasp::{Grasp, GraspTask, Object, settings_of};
use hwasp_mujoco::engine::{BodyId, Simulation, Wrench};
use hwasp_runs::SavedRun;
use hwasp_tasks::hand::{MjcfOptions, SUBSTEPS, mjcf, names};
use serde_json::json;

/// What the physics were given in one step.
#[derive(Clone, Debug)]
struct Given {
    controls: Vec<f64>,
    /// On palm and object.
    wrenches: [Wrench; 2],
    reward: f64,
}

/// An episode, to be repeated.
#[derive(Clone, Debug)]
struct Recording {
    object: Object,
    /// Positions of all joints.
    start: Vec<f64>,
    end: Vec<f64>,
    steps: Vec<Given>,
}

/// An environment that writes down what it does to the simulation.
struct Recorder {
    robot: Robot<GraspTask>,
    bodies: [BodyId; 2],
    last: Arc<Mutex<Option<Recording>>>,
}

impl Environment for Recorder {
    fn spec(&self) -> &EnvSpec {
        self.robot.spec()
    }

    fn set_design(&mut self, design: &[f64]) {
        self.robot.set_design(design);
    }

    fn reset(&mut self, rng: &mut Stream) {
        self.robot.reset(rng);
        let plant = self.robot.plant();
        let start = plant.simulation().qpos().to_vec();
        let recording = Recording { object: plant.object().clone(), end: start.clone(), start, steps: Vec::new() };
        *self.last.lock().unwrap_or_else(PoisonError::into_inner) = Some(recording);
    }

    fn observe(&self, out: &mut [f64]) {
        self.robot.observe(out);
    }

    fn state(&self, out: &mut [f64]) {
        self.robot.state(out);
    }

    fn context(&self, out: &mut [f64]) {
        self.robot.context(out);
    }

    fn step(&mut self, effort: &[f64], command: &[f64]) -> Step {
        let step = self.robot.step(effort, command);
        let simulation = self.robot.plant().simulation();
        if let Some(recording) = &mut *self.last.lock().unwrap_or_else(PoisonError::into_inner) {
            recording.steps.push(Given {
                controls: simulation.ctrl().to_vec(),
                wrenches: self.bodies.map(|body| simulation.wrench(body)),
                reward: step.reward,
            });
            recording.end = simulation.qpos().to_vec();
        }
        step
    }
}

/// Repeats the physics of an episode, and nothing else.
fn repeat(simulation: &mut Simulation, recording: &Recording) -> Result<(), Box<dyn Error + Send + Sync>> {
    let (geom, floor) = (simulation.geom(names::OBJECT_GEOM)?, simulation.geom(names::FLOOR)?);
    let bodies = [simulation.body(names::PALM)?, simulation.body(names::OBJECT)?];
    recording.object.enter(simulation, bodies[1], geom, floor)?;
    simulation.qpos_mut().copy_from_slice(&recording.start);
    for given in &recording.steps {
        simulation.ctrl_mut().copy_from_slice(&given.controls);
        for (&body, &wrench) in bodies.iter().zip(&given.wrenches) {
            simulation.set_wrench(body, wrench);
        }
        simulation.step(SUBSTEPS)?;
    }
    Ok(())
}

/// Seconds that the recorded physics take on these threads, each with a simulation of its own.
fn physics(model: &Simulation, recordings: &[Recording], executor: &dyn Executor) -> Result<f64, Box<dyn Error>> {
    let idle = Mutex::new(vec![model.clone(); executor.workers()]);
    let began = Instant::now();
    let ends = executor.map(recordings.len(), |i| {
        let simulation = idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut simulation = simulation.unwrap_or_else(|| model.clone());
        repeat(&mut simulation, &recordings[i])?;
        let same = simulation.qpos() == recordings[i].end;
        idle.lock().unwrap_or_else(PoisonError::into_inner).push(simulation);
        Ok::<_, Box<dyn Error + Send + Sync>>(same)
    });
    let seconds = began.elapsed().as_secs_f64();
    for (i, same) in ends.into_iter().enumerate() {
        if !same.map_err(|error| error.to_string())? {
            return Err(format!("episode {i} ends elsewhere when it is repeated").into());
        }
    }
    Ok(seconds)
}

fn write(folder: &Path, grasp: &Grasp, recordings: &[Recording]) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(folder)?;
    fs::write(folder.join("model.xml"), mjcf(&grasp.settings().hand, &MjcfOptions::default())?)?;
    let about = |r: &Recording| {
        let Object { kind, size, mass, inertia, friction, .. } = r.object;
        json!({ "kind": kind.name(), "size": size, "mass": mass, "inertia": inertia, "friction": friction,
                "start": r.start, "end": r.end, "steps": r.steps.len() })
    };
    let names = json!({ "palm": names::PALM, "palm_joints": names::PALM_JOINTS, "object": names::OBJECT,
        "object_joint": names::OBJECT_JOINT, "object_geom": names::OBJECT_GEOM, "floor": names::FLOOR,
        "links": names::LINK_GEOMS, "joints": names::JOINTS });
    let episodes: Vec<_> = recordings.iter().map(about).collect();
    let all = json!({ "substeps": SUBSTEPS, "names": names, "episodes": episodes });
    fs::write(folder.join("episodes.json"), all.to_string())?;
    let save = |name: &str, numbers: &dyn Fn(&Given) -> Vec<f64>| {
        let bytes: Vec<u8> =
            recordings.iter().flat_map(|r| &r.steps).flat_map(numbers).flat_map(f64::to_le_bytes).collect();
        fs::write(folder.join(name), bytes)
    };
    save("controls.f64", &|given| given.controls.clone())?;
    save("wrenches.f64", &|given| given.wrenches.iter().flat_map(|w| [w.force, w.torque].concat()).collect())?;
    save("rewards.f64", &|given| vec![given.reward])?;
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let episodes = arguments.next().map_or(Ok(4), |count| count.parse::<u64>())?;
    let threads = arguments.next().map_or(Ok(1), |count| count.parse::<usize>())?;
    let run = SavedRun::open(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("../../results/z-grasp"),
        &hwasp_builtin::catalogue(),
    )?;
    let (assembly, params) = (run.assembly(), run.params()?);
    let task = assembly.experiment().task.settings().ok_or("z-grasp is a grasp")?;
    let grasp = Arc::new(Grasp::new(settings_of(task))?);
    let model = grasp.robot(None).plant().simulation().clone();
    let bodies = [model.body(names::PALM)?, model.body(names::OBJECT)?];
    let asked = |indices| Episodes { seed: 0, iteration: 0, indices, progress: 0.0, kind: EpisodeKind::Training };

    // One at a time; neighbours change nothing in an episode.
    let last = Arc::new(Mutex::new(None));
    let (recorded, shared) = (Arc::clone(&grasp), Arc::clone(&last));
    let recorder = move |horizon| {
        Box::new(Recorder { robot: recorded.robot(horizon), bodies, last: Arc::clone(&shared) }) as Box<dyn Environment>
    };
    let sampler = Sampler::new(Arc::clone(&assembly.policy), Arc::new(recorder), None);
    let mut recordings = Vec::new();
    for index in 0..episodes {
        sampler.collect(&Serial, &params, &asked(index..index + 1))?;
        recordings.extend(last.lock().unwrap_or_else(PoisonError::into_inner).take());
    }
    if let Some(folder) = arguments.next() {
        write(Path::new(&folder), &grasp, &recordings)?;
    }

    let executor = Threads::new(threads)?;
    let sampler = Sampler::new(Arc::clone(&assembly.policy), grasp, None);
    let began = Instant::now();
    let steps = sampler.collect(&executor, &params, &asked(0..episodes))?.rows();
    let rollout = began.elapsed().as_secs_f64();
    let physics = physics(&model, &recordings, &executor)?;
    println!("{}", json!({ "steps": steps, "rollout_s": rollout, "physics_s": physics }));
    Ok(())
}
