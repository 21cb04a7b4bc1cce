//! Arguments of `hwasp deploy`.

use std::path::PathBuf;

use clap::{Subcommand, ValueEnum};
use hwasp_deploy::object::ObjectKnown;
use hwasp_tasks::grasp::ShapeKind;

use super::parse::{LAST_SEED, MOST_EPISODES, finite, numbers, path, whole};

const SAFETY: &str = "\
Software is no safety function: keep the arm's own safety settings and the stop button within reach.
Ctrl-C sets the object down and frees the motor; once more stops the arm and frees the motor at once.";

#[derive(Debug, clap::Args)]
#[command(after_help = SAFETY)]
pub(crate) struct DeployArgs {
    #[command(subcommand)]
    pub(crate) command: DeployCommand,
}

#[derive(Debug, Subcommand)]
pub(crate) enum DeployCommand {
    /// Write a rig.toml with every key, its default and what it means
    Init(DeployInitArgs),
    /// Look at arm and motor; nothing moves
    Check(DeployCheckArgs),
    /// Measure the hand: where its tendons begin to pull, friction, and with a weight the motor's torque
    Calibrate(DeployCalibrateArgs),
    /// Run a run's controller on arm and hand, or with --dry-run on the emulated bench
    Run(DeployRunArgs),
    /// Start the emulated bench, for the commands above to be tried on: it has a rig.toml of its own
    Rehearse(DeployRehearseArgs),
    /// Hold a log against the simulation, step by step
    Replay(DeployReplayArgs),
    /// Fit friction, tendons, torque and delay to logs, and write the experiment with which to train on
    Identify(DeployIdentifyArgs),
    /// Count real grasps: add them to a table, and print the share that held beside the paper's
    Trials(DeployTrialsArgs),
    /// The emulated bench of a dry run
    #[command(hide = true)]
    Bench {
        /// Its settings, JSON
        #[arg(value_parser = path())]
        settings: PathBuf,
    },
}

#[derive(Debug, clap::Args)]
pub(crate) struct DeployInitArgs {
    /// The file
    #[arg(long, value_name = "FILE", default_value = "rig.toml", value_parser = path())]
    pub(crate) out: PathBuf,
}

/// The bench.
#[derive(Debug, clap::Args)]
pub(crate) struct RigArgs {
    /// What describes the bench; `hwasp deploy init` writes one
    #[arg(long, value_name = "FILE", default_value = "rig.toml", value_parser = path())]
    pub(crate) rig: PathBuf,
}

#[derive(Debug, clap::Args)]
pub(crate) struct DeployCheckArgs {
    #[command(flatten)]
    pub(crate) rig: RigArgs,
}

#[derive(Debug, clap::Args)]
pub(crate) struct DeployCalibrateArgs {
    /// The run folder of the hand that was built
    #[arg(value_parser = path())]
    pub(crate) run: PathBuf,
    #[command(flatten)]
    pub(crate) rig: RigArgs,
    /// A mass that hangs on one line from the spool, kg, tendons off: measures the motor's torque [default: the data sheet's]
    #[arg(long, value_name = "KG", allow_negative_numbers = true, value_parser = finite)]
    pub(crate) weight: Option<f64>,
    /// The file
    #[arg(long, value_name = "FILE", default_value = "calibration.toml", value_parser = path())]
    pub(crate) out: PathBuf,
}

/// How it is known where the object is. What the values mean stands at the option, for which clap keeps its short form.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ObjectArg {
    Fixed,
    Carried,
    Tracker,
}

impl ObjectArg {
    pub(crate) fn known(self) -> ObjectKnown {
        match self {
            Self::Fixed => ObjectKnown::Fixed,
            Self::Carried => ObjectKnown::Carried,
            Self::Tracker => ObjectKnown::Tracker,
        }
    }
}

/// A shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ShapeArg {
    Sphere,
    Box,
    Cylinder,
    Ellipsoid,
}

impl ShapeArg {
    pub(crate) fn kind(self) -> ShapeKind {
        match self {
            Self::Sphere => ShapeKind::Sphere,
            Self::Box => ShapeKind::Box,
            Self::Cylinder => ShapeKind::Cylinder,
            Self::Ellipsoid => ShapeKind::Ellipsoid,
        }
    }
}

#[derive(Debug, clap::Args)]
#[command(after_help = SAFETY)]
pub(crate) struct DeployRunArgs {
    /// The run folder
    #[arg(value_parser = path())]
    pub(crate) run: PathBuf,
    #[command(flatten)]
    pub(crate) rig: RigArgs,
    /// What `hwasp deploy calibrate` measured
    #[arg(long, value_name = "FILE", default_value = "calibration.toml", value_parser = path())]
    pub(crate) calibration: PathBuf,
    /// How it is known where the object is: `fixed`, told at the start; `carried`, told at the start and with the palm once the
    /// grasp is felt; `tracker`, told all the time over UDP
    #[arg(long, default_value = "carried")]
    pub(crate) object: ObjectArg,
    /// The most that the palm moves with, m/s, up to the rig's limit [default: as in training, within the rig's limit]
    #[arg(long, value_name = "M/S", allow_negative_numbers = true, value_parser = finite)]
    pub(crate) speed: Option<f64>,
    /// Grasps, one after the other
    #[arg(long, default_value = "1", allow_negative_numbers = true, value_parser = whole(1..=MOST_EPISODES))]
    pub(crate) episodes: u64,
    /// Edges of the object's bounding box along x, y and z, mm
    #[arg(long, value_name = "X,Y,Z", required_unless_present = "dry_run", value_parser = numbers::<3>)]
    pub(crate) size: Option<[f64; 3]>,
    /// Its shape, for the table of trials
    #[arg(long)]
    pub(crate) shape: Option<ShapeArg>,
    /// Where it stands in the task's world, mm
    #[arg(long, value_name = "X,Y", default_value = "0,0", allow_hyphen_values = true, value_parser = numbers::<2>)]
    pub(crate) at: [f64; 2],
    /// The same program against the emulated bench, a process of its own with the hand's physics behind it, and the objects of
    /// held-out episodes; no rig is needed
    #[arg(long, conflicts_with_all = ["size", "shape", "shadow"])]
    pub(crate) dry_run: bool,
    /// Root seed of the objects of a dry run [default: what the experiment says]
    #[arg(long, allow_negative_numbers = true, value_parser = whole(0..=LAST_SEED))]
    pub(crate) seed: Option<u64>,
    /// The first object of a dry run, counted as `hwasp eval` runs them
    #[arg(long, value_name = "INDEX", default_value = "0", allow_negative_numbers = true, value_parser = whole(0..=MOST_EPISODES))]
    pub(crate) first: u64,
    /// Make the emulated hand of a dry run differ from its description: `torque_gain`, `tendon_stiffness` (N/m), `friction` (N·m), `slack`
    /// (m), `delay` (s) or `zero` (rad); may be repeated
    #[arg(long = "plant", value_name = "NAME=NUMBER")]
    pub(crate) plant: Vec<String>,
    /// Order a fault of the emulated arm or motor, 3 s after the first object is there: `motor heat 80`, `arm protective-stop`;
    /// `docs/deploy_arm.md` and `docs/deploy_motor.md` have them all
    #[arg(long, value_name = "FAULT")]
    pub(crate) fault: Option<String>,
    /// Move nothing: what the controller says is only logged
    #[arg(long)]
    pub(crate) shadow: bool,
    /// The folder of logs [default: the rig's]
    #[arg(long, value_name = "FOLDER", value_parser = path())]
    pub(crate) log: Option<PathBuf>,
}

const ORDERS: &str = "\
It runs until its input ends or Ctrl-C. What it takes, a line each:
  object INDEX        put this held-out object there, as `hwasp eval` counts them; tells the command that grasps it
  state               tell where everything is, JSON: `success` of the hand says whether the object holds
  fault arm TEXT, fault motor TEXT
                      let something go wrong: `fault motor heat 80`, `fault arm protective-stop`
  quit";

#[derive(Debug, clap::Args)]
#[command(after_help = ORDERS)]
pub(crate) struct DeployRehearseArgs {
    /// The run folder of the hand
    #[arg(value_parser = path())]
    pub(crate) run: PathBuf,
    /// The bench that is emulated: place, limits and speeds of this file [default: as `hwasp deploy init` writes it]
    #[arg(long, value_name = "FILE", value_parser = path())]
    pub(crate) rig: Option<PathBuf>,
    /// The rig that reaches the emulated bench; removed at the end
    #[arg(long, value_name = "FILE", default_value = "rehearsal.toml", value_parser = path())]
    pub(crate) out: PathBuf,
    /// Make the hand differ from its description: `torque_gain`, `tendon_stiffness` (N/m), `friction` (N·m), `slack` (m), `delay` (s) or
    /// `zero` (rad); may be repeated
    #[arg(long = "plant", value_name = "NAME=NUMBER")]
    pub(crate) plant: Vec<String>,
}

#[derive(Debug, clap::Args)]
pub(crate) struct DeployReplayArgs {
    /// An .mcap file that `hwasp deploy run` wrote
    #[arg(value_parser = path())]
    pub(crate) log: PathBuf,
    /// The run folder [default: the one that the log names]
    #[arg(long, value_parser = path())]
    pub(crate) run: Option<PathBuf>,
    /// A table of every step, .csv [default: none]
    #[arg(long, value_name = "FILE", value_parser = path())]
    pub(crate) out: Option<PathBuf>,
}

#[derive(Debug, clap::Args)]
pub(crate) struct DeployIdentifyArgs {
    /// .mcap files that `hwasp deploy run` wrote
    #[arg(required = true, value_parser = path())]
    pub(crate) logs: Vec<PathBuf>,
    /// The run folder [default: the one that the first log names]
    #[arg(long, value_parser = path())]
    pub(crate) run: Option<PathBuf>,
    /// The experiment to train on with
    #[arg(long, value_name = "FILE", default_value = "identified.toml", value_parser = path())]
    pub(crate) out: PathBuf,
}

#[derive(Debug, clap::Args)]
pub(crate) struct DeployTrialsArgs {
    /// The table
    #[arg(long, value_name = "FILE", default_value = "deploy-logs/trials.csv", value_parser = path())]
    pub(crate) table: PathBuf,
    /// Add a grasp of this shape
    #[arg(long, requires_all = ["held", "run"])]
    pub(crate) shape: Option<ShapeArg>,
    /// Whether it held
    #[arg(long, requires = "shape")]
    pub(crate) held: Option<bool>,
    /// The run folder of the controller
    #[arg(long, requires = "shape", value_parser = path())]
    pub(crate) run: Option<PathBuf>,
    /// Edges of the object's bounding box, mm
    #[arg(long, value_name = "X,Y,Z", requires = "shape", value_parser = numbers::<3>)]
    pub(crate) size: Option<[f64; 3]>,
    /// What else there is to say
    #[arg(long, requires = "shape", default_value = "", hide_default_value = true)]
    pub(crate) note: String,
}
