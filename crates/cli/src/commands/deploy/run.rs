//! `hwasp deploy run`.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicU32;

use hwasp_deploy::calibrate::{Calibration, stands};
use hwasp_deploy::clock::SystemClock;
use hwasp_deploy::controller::{Controller, Spool, Training, hand};
use hwasp_deploy::drive::{Bench, Drive, Manner};
use hwasp_deploy::log::{About, LogWriter};
use hwasp_deploy::rig::Rig;
use hwasp_deploy::run::{Episode, Placed, Plan, Stage, run as run_episodes};
use hwasp_deploy::trials::{TRIALS, Trial, add};
use hwasp_deploy::{DeployError, date, devices};
use hwasp_experiment::Catalogue;
use hwasp_export::Deployed;

use super::answers::Answers;
use super::{deployed, interrupts, rig};
use crate::args::DeployRunArgs;
use crate::output;
use hwasp_session::Failure;

pub(crate) fn run(args: &DeployRunArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let deployed = deployed(&args.run, catalogue)?;
    let interrupts = interrupts()?;
    if args.dry_run {
        return dry(args, &deployed, &interrupts);
    }
    only_dry(args)?;
    let rig = rig(&args.rig)?;
    let hand = hand(deployed.spec()).map_err(Failure::input)?;
    stands(hand, deployed.design()).map_err(Failure::input)?;
    let calibration = Calibration::open(&args.calibration, &rig, deployed.design()).map_err(Failure::input)?;
    if !args.shadow && !std::io::stdin().is_terminal() {
        return Err(Failure::input("a person has to say that everybody is clear: standard input is no terminal"));
    }
    let answers = Answers::listen(Arc::clone(&interrupts));
    let mut stage = Person { placed: placed(args)?, asks: !args.shadow, answers };
    let what = if args.shadow { "shadow" } else { "run" };
    let job = Job { args, deployed: &deployed, rig: &rig, calibration: &calibration, interrupts: &interrupts, what };
    let (task, table) = (deployed.spec().task.name(), job.folder().join(TRIALS));
    let mut kept = Ok(());
    let episodes = job.run(&mut stage, &mut |episode| {
        // One by one: what was seen is kept whatever comes.
        if let (Ok(()), Some(trial)) = (&kept, trial(episode, task, &args.run)) {
            kept = add(&table, &[trial]).map(drop);
        }
    })?;
    kept?;
    ended(&episodes)
}

/// Everything for a run but who places objects.
struct Job<'a> {
    args: &'a DeployRunArgs,
    deployed: &'a Deployed,
    rig: &'a Rig,
    calibration: &'a Calibration,
    interrupts: &'a AtomicU32,
    what: &'static str,
}

impl Job<'_> {
    fn folder(&self) -> PathBuf {
        self.args.log.clone().unwrap_or_else(|| self.rig.log.folder.clone())
    }

    fn run(&self, stage: &mut dyn Stage, seen: &mut dyn FnMut(&Episode)) -> Result<Vec<Episode>, Failure> {
        let (args, deployed, rig) = (self.args, self.deployed, self.rig);
        let hand = hand(deployed.spec()).map_err(Failure::input)?;
        let training = Training::of(deployed.spec()).map_err(Failure::input)?;
        let mut controller = Controller::new(deployed, &training).map_err(Failure::input)?;
        let spool =
            Spool::new(&hand.transmission, rig.motor.winding, self.calibration.zero_rad, self.calibration.torque_gain);
        let mut manner = Manner::new(rig, spool, deployed.env().time_step, hand.transmission.step_limit);
        manner.shadow = args.shadow;
        manner.palm_speed = speed(args, rig, &training)?;
        let mut plan = Plan::new(args.episodes as u32, args.object.known(), deployed.env(), training);
        plan.first = args.first as u32;
        plan.tracker = rig.object.tracker_port as u16;
        plan.felt = rig.object.felt.unwrap_or(plan.felt);
        let name = format!("{}-{}", date::for_files(), self.what);
        let mut log = LogWriter::create(&self.folder(), &name, &self.about(&spool)).map_err(Failure::from)?;
        let mut arm = devices::arm(rig)?;
        if !args.shadow {
            devices::ready(&mut arm, rig)?;
        }
        let mut motor = devices::motor(rig)?;
        std::thread::sleep(std::time::Duration::from_millis(50));
        let bench = Bench {
            arm: &mut arm,
            motor: &mut motor,
            clock: &SystemClock,
            interrupts: self.interrupts,
            sink: &mut log,
        };
        let mut drive = Drive::new(bench, manner);
        let episodes = run_episodes(&mut drive, &mut controller, &plan, stage, &mut |episode| {
            output::remark(&told(episode));
            seen(episode);
        });
        let jitter = drive.jitter().to_string();
        drop(drive);
        let path = log.finish();
        let episodes = episodes?;
        let path = path?;
        output::print(&format!("  steps began late by {jitter}\n  {}\n", path.display()))?;
        Ok(episodes)
    }

    fn about(&self, spool: &Spool) -> About {
        let env = self.deployed.env();
        About {
            what: self.what.to_owned(),
            run: self.args.run.display().to_string(),
            experiment: self.deployed.spec().name.clone(),
            observation: env.observation.iter().map(|port| port.name.clone()).collect(),
            command: env.command.iter().map(|port| port.name.clone()).collect(),
            period: env.time_step,
            design: self.deployed.design().to_vec(),
            torque_per_current: spool.torque_per_current,
            spool_radius: spool.radius,
            winding_sign: spool.sign,
            object: self.args.object.known().name().to_owned(),
            motor: hwasp_deploy::calibrate::motor_hash(self.rig),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        }
    }
}

/// The most that the palm moves with, m/s.
fn speed(args: &DeployRunArgs, rig: &Rig, training: &Training) -> Result<f64, Failure> {
    let most = rig.limits.palm_speed;
    let speed = args.speed.unwrap_or_else(|| training.palm_speed.map_or(most, |trained| trained.min(most)));
    if (0.001..=most).contains(&speed) {
        return Ok(speed);
    }
    let limits = format!("0.001 to {most} m/s, the rig's limits.palm_speed");
    Err(Failure::input(DeployError::Value { name: "--speed", value: speed.to_string(), limits }))
}

/// What is for dry runs alone.
fn only_dry(args: &DeployRunArgs) -> Result<(), Failure> {
    let given = [
        ("--plant", !args.plant.is_empty()),
        ("--fault", args.fault.is_some()),
        ("--seed", args.seed.is_some()),
        ("--first", args.first != 0),
    ];
    match given.iter().find(|(_, given)| *given) {
        Some((name, _)) => Err(Failure::input(format!("{name} is for --dry-run alone"))),
        None => Ok(()),
    }
}

/// The object that was described.
fn placed(args: &DeployRunArgs) -> Result<Placed, Failure> {
    let wrong = |name, value: f64, limits: &str| {
        Err(Failure::input(DeployError::Value { name, value: format!("{value} mm"), limits: limits.to_owned() }))
    };
    let (size, place) = (args.size.unwrap_or_default(), args.at);
    if let Some(edge) = size.into_iter().find(|edge| !(10.0..=200.0).contains(edge)) {
        return wrong("--size", edge, "10 to 200 mm");
    }
    if let Some(at) = place.into_iter().find(|at| !(-150.0..=150.0).contains(at)) {
        return wrong("--at", at, "-150 to 150 mm");
    }
    let size = size.map(|edge| 1e-3 * edge);
    let place = [1e-3 * place[0], 1e-3 * place[1], 0.5 * size[2]];
    Ok(Placed { size, place, shape: args.shape.map(crate::args::ShapeArg::kind), start: None })
}

/// A person who puts the object there, and says whether it held.
struct Person {
    placed: Placed,
    asks: bool,
    answers: Answers,
}

impl Stage for Person {
    fn place(&mut self, episode: u32) -> Result<Placed, DeployError> {
        if self.asks {
            output::remark(&format!("put object {episode} there, keep clear, and press Enter"));
            if self.answers.next().is_none() {
                return Err(DeployError::Stopped {
                    cause: "nobody said that everybody is clear".to_owned(),
                    state: "nothing was grasped, and the motor is free".to_owned(),
                });
            }
        }
        Ok(self.placed)
    }

    fn held(&mut self, _: u32) -> Result<Option<bool>, DeployError> {
        if !self.asks {
            return Ok(None);
        }
        output::remark("does it hold? y or n; anything else counts as not looked at");
        Ok(match self.answers.next().as_deref() {
            Some("y" | "yes") => Some(true),
            Some("n" | "no") => Some(false),
            _ => None,
        })
    }
}

/// A line about an episode.
fn told(episode: &Episode) -> String {
    let [x, y, z] = episode.placed.size.map(|edge| 1e3 * edge);
    let shape = episode.placed.shape.map_or("object", hwasp_tasks::grasp::ShapeKind::name);
    let felt = if episode.felt { "felt" } else { "not felt" };
    let how = match (episode.ended, episode.held) {
        (Some(verdict), _) => {
            let cause = verdict.cause.map_or("", |cause| cause.name());
            format!("ended: {cause}; {}", verdict.response)
        }
        (None, Some(true)) => "held".to_owned(),
        (None, Some(false)) => "not held".to_owned(),
        (None, None) => "done".to_owned(),
    };
    format!("{:>5}  {shape:<9} {x:.0} × {y:.0} × {z:.0} mm  {felt}, {how}", episode.index)
}

fn trial(episode: &Episode, task: &str, run: &Path) -> Option<Trial> {
    let (date, run, note) = (date::now(), run.display().to_string(), String::new());
    let (shape, held, size) = (episode.placed.shape?, episode.held?, episode.placed.size);
    Some(Trial { date, task: task.to_owned(), run, shape, size, held, note })
}

/// A run that a rule ended is no success.
fn ended(episodes: &[Episode]) -> Result<(), Failure> {
    use hwasp_deploy::safety::{Cause, Response};
    let Some(verdict) = episodes.last().and_then(|episode| episode.ended) else { return Ok(()) };
    let cause = verdict.cause.map_or_else(String::new, |cause| cause.name().to_owned());
    let state = match verdict.response {
        Response::SetDown => "the object is on the table and the motor is free",
        Response::StopArm => "the arm stands, the motor held and is free by now; look at them before you go on",
        _ => "the arm stands and the motor is free; look at them before you go on",
    };
    let error = DeployError::Stopped { cause, state: state.to_owned() };
    let asked = matches!(verdict.cause, Some(Cause::Interrupt | Cause::InterruptTwice));
    Err(if asked { Failure::interrupted(error) } else { Failure::from(error) })
}

/// When a fault is ordered: while the hand closes on the first object, or lifts it.
#[cfg(feature = "mujoco")]
const FAULT_AFTER: std::time::Duration = std::time::Duration::from_secs(3);

#[cfg(not(feature = "mujoco"))]
fn dry(_: &DeployRunArgs, _: &Deployed, _: &AtomicU32) -> Result<(), Failure> {
    Err(super::no_engine())
}

/// The rates of a dry run.
#[cfg(feature = "mujoco")]
fn dry(args: &DeployRunArgs, deployed: &Deployed, interrupts: &AtomicU32) -> Result<(), Failure> {
    use hwasp_deploy::dry::{DryStage, HeldOut};
    use hwasp_deploy::trials::rates;
    use hwasp_emulators::bench::check_fault;
    use hwasp_training::stats::wilson;

    if let Some(fault) = &args.fault {
        check_fault(fault).map_err(|error| Failure::input(format!("--fault: {error}")))?;
    }
    let rig = if args.rig.rig.exists() { rig(&args.rig)? } else { Rig::default() };
    let held_out = HeldOut::new(deployed, args.seed).map_err(Failure::input)?;
    let (bench, mut rig) = super::bench::start(deployed, &rig, &args.plant)?;
    // Nobody stands before an emulated hand: it is freed at once.
    rig.limits.hold = rig.limits.hold.min(1.0);
    let calibration = Calibration::ideal(&rig, deployed.design());
    let job = Job { args, deployed, rig: &rig, calibration: &calibration, interrupts, what: "dry-run" };
    let mut stage = DryStage::new(bench, held_out);
    if let Some(fault) = &args.fault {
        stage = stage.with_fault(FAULT_AFTER, fault);
    }
    let episodes = job.run(&mut stage, &mut |_| {})?;
    let task = deployed.spec().task.name();
    // What a rule ended was not held.
    let counted = |episode: &Episode| Episode { held: episode.held.or(episode.ended.map(|_| false)), ..*episode };
    let trials: Vec<_> = episodes.iter().map(counted).filter_map(|episode| trial(&episode, task, &args.run)).collect();
    let held = trials.iter().filter(|trial| trial.held).count() as u64;
    let (count, interval) = (trials.len() as u64, wilson(held, trials.len() as u64));
    let share = 100.0 * held as f64 / count.max(1) as f64;
    let (low, high) = (100.0 * interval.low, 100.0 * interval.high);
    output::print(&format!(
        "\n{}\n  {held} of {count} held: {share:.1} % [{low:.1}, {high:.1}] (Wilson, 95 %)\n",
        super::trials::table(&rates(&trials))
    ))?;
    ended(&episodes)
}
