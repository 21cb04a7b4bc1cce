//! The command line.

#[cfg(feature = "cluster")]
mod cluster;
mod deploy;
mod designs;
mod parse;
mod server;
mod studies;
mod watch;

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::time::Duration;

use clap::{Parser, Subcommand, ValueEnum};
use hwasp_experiment::Method;
use hwasp_plot::{Theme, XAxis};
use hwasp_report::play;

use crate::caller::Caller;

#[cfg(feature = "cluster")]
pub(crate) use cluster::{
    ClusterArgs, ClusterCommand, ConnectArgs, MeasureArgs, SlurmArgs, StatusArgs, UpArgs, WorkerArgs,
};
pub(crate) use deploy::{
    DeployArgs, DeployCalibrateArgs, DeployCheckArgs, DeployCommand, DeployInitArgs, DeployRunArgs, DeployTrialsArgs,
    RigArgs, ShapeArg,
};
#[cfg(feature = "mujoco")]
pub(crate) use deploy::{DeployIdentifyArgs, DeployRehearseArgs, DeployReplayArgs};
pub(crate) use designs::{DesignArgs, ExportArgs, HeldOutArgs, PartsArgs, TolerancesArgs};
use parse::{LAST_SEED, MOST_EPISODES, MOST_STEPS, path, seconds, side, threads, whole};
pub(crate) use server::ServerArgs;
pub(crate) use studies::{CompareArgs, ReproduceArgs};
pub(crate) use watch::{LOOPBACK, Place, WatchArgs};

/// What the program says where nothing is asked of it.
pub(crate) const GREETING: &str = "\
hwasp: hardware as policy. It designs a robot's body and its controller together.

  hwasp train mass-spring      ten springs and a motor, trained in seconds
  hwasp init robot.xml         begin with a robot of your own (MJCF or URDF)
  hwasp help                   all commands
";

const EXAMPLES: &str = "\
Examples:
  hwasp list                                  what can be trained
  hwasp train mass-spring                     train a design and its controller, into runs/
  hwasp eval runs/mass-spring-hwasp-seed0     evaluate the result on held-out starts
  hwasp watch runs                            follow all trainings in a browser
  hwasp plot runs/* --out curves.png          compare runs
  hwasp report runs/mass-spring-hwasp-seed0   all of it on one page for a browser

Exit status: 0 if all went well, 1 if something failed on the way, 2 if what was asked for is wrong, 130 if it was asked to
stop (Ctrl-C, SIGTERM).";

/// Design a robot's body and its controller together.
///
/// The law of a mechanism (springs, bars, tendons) is a differentiable part of the policy, and policy gradients train its
/// physical parameters with the controller (Chen, He and Ciocarlie, "Hardware as Policy", CoRL 2020).
#[derive(Debug, Parser)]
#[command(name = "hwasp", version, max_term_width = 100, after_help = EXAMPLES)]
pub(crate) struct Args {
    /// None greets.
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
    /// The form of remarks and errors, and of a run's train.log
    #[arg(long, global = true, value_enum, value_name = "FORMAT", default_value_t = LogFormat::Text)]
    pub(crate) log_format: LogFormat,
    /// The least of them that is shown; train.log has all
    #[arg(long, global = true, value_enum, value_name = "LEVEL", default_value_t = LogLevel::Info)]
    pub(crate) log_level: LogLevel,
}

/// The form of a log.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub(crate) enum LogFormat {
    Text,
    Json,
}

impl LogFormat {
    /// What a command line asks for that cannot be read.
    pub(crate) fn typed() -> Self {
        let words = &Caller::get().words;
        let apart = words.windows(2).any(|pair| pair[0] == "--log-format" && pair[1] == "json");
        if apart || words.iter().any(|word| word == "--log-format=json") { Self::Json } else { Self::Text }
    }
}

/// What a log has, at least.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum LogLevel {
    Error,
    Warn,
    Info,
    Debug,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Train an experiment and write a run folder
    Train(TrainArgs),
    /// Evaluate a run: the deterministic policy on held-out starts, on the hardware as built
    Eval(EvalArgs),
    /// Say of a run's design what can be said without simulating it; of a hand also what it pinches, lifts and how it closes; of
    /// a model what another design changes
    Design(DesignArgs),
    /// Write what a run comes to in files that other programs read: the controller as ONNX, safetensors and JSON; a hand
    /// as MJCF, URDF, STL and OpenSCAD
    Export(ExportArgs),
    /// Drive the built hand on an arm with a run's controller: check, calibrate, run, and learn from what was logged
    Deploy(DeployArgs),
    /// Choose pulleys and springs for a run's hand, simulate it with them, and train its controller further on them
    Parts(PartsArgs),
    /// Simulate a run's design with every parameter off by its manufacturing error: which part has to be precise
    Tolerances(TolerancesArgs),
    /// Repeat the iteration after a checkpoint, one that failed for instance, and say what happens
    Replay(ReplayArgs),
    /// Show held-out episodes of a run: a page in three dimensions for a browser, films (GIF, MP4, WebM) and a sheet of stills
    Play(PlayArgs),
    /// Follow trainings on a page for a browser: curves, design, log, the robot in three dimensions, and what another design would do
    Watch(WatchArgs),
    /// Draw learning curves; runs of one experiment and method are summarised together
    Plot(PlotArgs),
    /// Make the report of a run or a comparison: one HTML file for a browser or a printer, which loads nothing
    Report(ReportArgs),
    /// Train methods against each other, several seeds each under one budget, and say which is better
    Compare(CompareArgs),
    /// Repeat a toy figure or table of the paper with the authors' settings, their numbers beside ours
    Reproduce(ReproduceArgs),
    /// Do jobs of trainings on other machines, as long as it runs
    #[cfg(feature = "cluster")]
    Worker(WorkerArgs),
    /// Queue and workers for trainings on many machines: start them, look after them, write scripts for Slurm
    #[cfg(feature = "cluster")]
    Cluster(ClusterArgs),
    /// Check an experiment file and report all that is wrong with it at once
    Check(ExperimentArgs),
    /// Print the JSON Schema of experiment files, by which editors complete and check them
    Schema(SchemaArgs),
    /// List the experiments that come with the program
    List,
    /// Print the library of laws (gears, springs, tendons, linkages, motors) that formulas of experiments call by name
    Laws,
    /// Draw the law of an experiment as a computational graph
    Graph(GraphArgs),
    /// Begin with a robot of your own: an experiment for its model, or a project in Rust for a mechanism, ready to train
    Init(InitArgs),
}

impl Command {
    /// Whether nothing but errors is wanted.
    pub(crate) fn quiet(&self) -> bool {
        matches!(self, Self::Train(TrainArgs { quiet: true, .. }) | Self::Compare(CompareArgs { quiet: true, .. }))
    }
}

/// How learner, controller and hardware are composed.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum MethodArg {
    /// PPO with the law in the policy's graph, as in the paper's HWasP
    Hwasp,
    /// PPO with the design in the action, as in the paper's HWasP-Minimal
    Minimal,
    /// PPO with the design drawn once an episode and held
    Episode,
    /// PPO on hardware that stays as it begins; only the controller learns
    Fixed,
    /// CMA-ES over controller and design
    Cmaes,
    /// Augmented random search over controller and design
    Ars,
    /// CMA-ES over the design; every candidate trains a controller of its own with PPO
    CmaesRl,
    /// Augmented random search over the design; every candidate trains a controller of its own with PPO
    ArsRl,
    /// Bayesian optimisation of the design; every candidate trains a controller of its own with PPO
    BoRl,
    /// Random designs; every candidate trains a controller of its own with PPO
    RandomRl,
}

impl MethodArg {
    fn method(self) -> Method {
        match self {
            Self::Hwasp => Method::Hwasp,
            Self::Minimal => Method::Minimal,
            Self::Episode => Method::Episode,
            Self::Fixed => Method::Fixed,
            Self::Cmaes => Method::Cmaes,
            Self::Ars => Method::Ars,
            Self::CmaesRl => Method::CmaesRl,
            Self::ArsRl => Method::ArsRl,
            Self::BoRl => Method::BoRl,
            Self::RandomRl => Method::RandomRl,
        }
    }
}

/// What names an experiment.
#[derive(Debug, clap::Args)]
pub(crate) struct ExperimentArgs {
    /// A name from `hwasp list`, or the path of a TOML file
    pub(crate) experiment: String,
    #[command(flatten)]
    pub(crate) settings: SettingsArgs,
}

/// What is set anew in an experiment.
#[derive(Debug, clap::Args)]
pub(crate) struct SettingsArgs {
    /// How learner, controller and hardware are composed [default: what the experiment says]
    #[arg(long, value_enum)]
    method: Option<MethodArg>,
    /// Set one value of the experiment, such as `ppo.clip_ratio=0.1`; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
}

impl SettingsArgs {
    pub(crate) fn method(&self) -> Option<&'static str> {
        self.method.map(|method| method.method().name())
    }

    pub(crate) fn set(&self) -> &[String] {
        &self.set
    }
}

#[derive(Debug, clap::Args)]
#[command(override_usage = "hwasp train [OPTIONS] <EXPERIMENT>\n       hwasp train [OPTIONS] --resume <RUN>")]
pub(crate) struct TrainArgs {
    /// A name from `hwasp list`, or the path of a TOML file
    #[arg(required_unless_present = "resume")]
    pub(crate) experiment: Option<String>,
    #[command(flatten)]
    pub(crate) settings: SettingsArgs,
    /// Root of all random numbers of the run [default: what the experiment says]
    #[arg(long, allow_negative_numbers = true, value_parser = whole(0..=LAST_SEED))]
    pub(crate) seed: Option<u64>,
    /// Real simulator steps to train for, such as 4e6 [default: what the experiment says]
    #[arg(long, value_name = "STEPS", allow_negative_numbers = true, value_parser = whole(1..=MOST_STEPS))]
    pub(crate) env_steps: Option<u64>,
    /// Threads for episodes; they do not change the result
    #[arg(long, default_value = "1", allow_negative_numbers = true, value_parser = threads)]
    pub(crate) threads: NonZeroUsize,
    /// The run folder [default: a new one under runs/]
    #[arg(long, value_name = "FOLDER", value_parser = path())]
    pub(crate) out: Option<PathBuf>,
    /// Begin with what another run learned: weights by the names of what is seen and commanded, the design by the names of its
    /// parameters. Values and schedules are those of the experiment. May be repeated: networks then stand side by side, and each
    /// command comes from the first run that has it
    #[arg(long, value_name = "RUN", conflicts_with = "resume", value_parser = path())]
    pub(crate) from: Vec<PathBuf>,
    /// Go on with a training that was interrupted, from its newest checkpoint: the result has the same bits
    #[arg(long, value_name = "RUN", conflicts_with_all = ["experiment", "method", "set", "seed", "env_steps", "out"], value_parser = path())]
    pub(crate) resume: Option<PathBuf>,
    /// Time between two checkpoints, at least
    #[arg(long, value_name = "SECONDS", default_value = "30", allow_negative_numbers = true, value_parser = seconds)]
    pub(crate) checkpoint_every: Duration,
    /// Write the learning curve for TensorBoard as well, into tensorboard/ of the run folder
    #[arg(long)]
    pub(crate) tensorboard: bool,
    /// Follow the training on a page for a browser, as `hwasp watch` does. The page stays until Ctrl-C
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, require_equals = true, default_missing_value = LOOPBACK, value_parser = watch::place)]
    pub(crate) watch: Option<Place>,
    /// Print nothing but errors
    #[arg(long, short)]
    pub(crate) quiet: bool,
    #[command(flatten)]
    pub(crate) server: ServerArgs,
}

/// Worlds that are nearer to the built robot than the law, held for a step of the controller.
#[derive(Debug, clap::Args)]
pub(crate) struct NearerArgs {
    /// On the hand with the engine's own tendons and springs, at 1 kHz, instead of the law: as near to the built hand as
    /// simulation goes
    #[arg(long)]
    pub(crate) native_tendons: bool,
    /// How often the law of a robot from a model acts: with every step of the controller, and held in between, as in training, or with
    /// every step of the physics
    #[arg(long, value_name = "RATE", default_value = "step", conflicts_with = "native_tendons")]
    pub(crate) law_rate: LawRateArg,
}

/// How often a law acts. What the values mean stands at the option, for which clap keeps its short form.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum LawRateArg {
    Step,
    Physics,
}

#[derive(Debug, clap::Args)]
pub(crate) struct EvalArgs {
    /// A run folder, as `hwasp train` writes one
    #[arg(value_parser = path())]
    pub(crate) run: PathBuf,
    #[command(flatten)]
    pub(crate) held_out: HeldOutArgs,
    /// Evaluate under another value of the experiment, such as `task.disturbance_force="0.2 N"`; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
    #[command(flatten)]
    pub(crate) nearer: NearerArgs,
    /// Print the rate of success of every kind of episode too, of an object's shape for one
    #[arg(long)]
    pub(crate) per_shape: bool,
    /// Print JSON, for scripts
    #[arg(long)]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) server: ServerArgs,
}

#[derive(Debug, clap::Args)]
pub(crate) struct ReplayArgs {
    /// A file in `faults` or `checkpoints` of a run folder
    #[arg(value_parser = path())]
    pub(crate) file: PathBuf,
    /// Threads for episodes; they do not change the result
    #[arg(long, default_value = "1", allow_negative_numbers = true, value_parser = threads)]
    pub(crate) threads: NonZeroUsize,
}

#[derive(Debug, clap::Args)]
pub(crate) struct PlayArgs {
    /// A run folder, as `hwasp train` writes one
    #[arg(value_parser = path())]
    pub(crate) run: PathBuf,
    /// Episodes
    #[arg(long, default_value = "4", allow_negative_numbers = true, value_parser = whole(1..=play::MOST_EPISODES))]
    pub(crate) episodes: u64,
    /// The first of them, counted as `hwasp eval` runs them
    #[arg(long, value_name = "INDEX", default_value = "0", allow_negative_numbers = true, value_parser = whole(0..=MOST_EPISODES))]
    pub(crate) first: u64,
    /// Root seed of their starts [default: what the experiment says]
    #[arg(long, allow_negative_numbers = true, value_parser = whole(0..=LAST_SEED))]
    pub(crate) seed: Option<u64>,
    /// Play under another value of the experiment, such as `task.disturbance_force="0.2 N"`; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
    #[command(flatten)]
    pub(crate) nearer: NearerArgs,
    /// The folder of the pictures; those of the same name are replaced [default: play/ in the run folder]
    #[arg(long, value_name = "FOLDER", value_parser = path())]
    pub(crate) out: Option<PathBuf>,
    /// What films are written as; MP4 and WebM need the program `ffmpeg`
    #[arg(long, value_enum, value_name = "FORMAT", default_value_t = FilmArg::Gif)]
    pub(crate) format: FilmArg,
    /// Write the pages alone, and no films
    #[arg(long, conflicts_with = "format")]
    pub(crate) html: bool,
    /// Pixels across of a film
    #[arg(long, value_name = "PIXELS", default_value = "320", allow_negative_numbers = true, value_parser = side())]
    pub(crate) width: u64,
    /// Pixels down of a film
    #[arg(long, value_name = "PIXELS", default_value = "320", allow_negative_numbers = true, value_parser = side())]
    pub(crate) height: u64,
}

/// What a film is written as.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum FilmArg {
    Gif,
    Mp4,
    Webm,
}

impl From<FilmArg> for play::Format {
    fn from(format: FilmArg) -> Self {
        match format {
            FilmArg::Gif => Self::Gif,
            FilmArg::Mp4 => Self::Mp4,
            FilmArg::Webm => Self::Webm,
        }
    }
}

/// A horizontal axis.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum AxisArg {
    /// Real simulator steps
    Steps,
    /// Time since training began
    Wall,
    /// Steps as the paper's plots count them, where the experiment says how
    Nominal,
}

impl AxisArg {
    pub(crate) fn axis(self) -> XAxis {
        match self {
            Self::Steps => XAxis::EnvSteps,
            Self::Wall => XAxis::WallClock,
            Self::Nominal => XAxis::Nominal,
        }
    }
}

/// What a picture is to be looked at on.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum ThemeArg {
    /// A screen: panels of one size side by side
    Screen,
    /// A page: 170 mm wide, with texts of 7.5 points and more, and dashes for printers without colour
    Print,
}

impl ThemeArg {
    pub(crate) fn theme(self) -> Theme {
        match self {
            Self::Screen => Theme::Screen,
            Self::Print => Theme::Print,
        }
    }
}

#[derive(Debug, clap::Args)]
pub(crate) struct PlotArgs {
    /// Run folders, as `hwasp train` writes them
    #[arg(required = true, value_parser = path())]
    pub(crate) runs: Vec<PathBuf>,
    /// The picture, .svg or .png
    #[arg(long, value_name = "FILE", default_value = "curves.svg", value_parser = path())]
    pub(crate) out: PathBuf,
    /// What the curves are drawn against
    #[arg(long, value_enum, default_value_t = AxisArg::Steps)]
    pub(crate) axis: AxisArg,
    /// What it is to be looked at on; the colours of both are told apart by every common kind of colour vision
    #[arg(long, value_enum, default_value_t = ThemeArg::Screen)]
    pub(crate) theme: ThemeArg,
    /// A line above it [default: none]
    #[arg(long, default_value = "", hide_default_value = true)]
    pub(crate) title: String,
}

#[derive(Debug, clap::Args)]
pub(crate) struct ReportArgs {
    /// A run folder, as `hwasp train` writes one, or the folder of a comparison
    #[arg(value_parser = path())]
    pub(crate) folder: PathBuf,
    /// The report, .html [default: report.html in the folder]
    #[arg(long, value_name = "FILE", value_parser = path())]
    pub(crate) out: Option<PathBuf>,
}

/// The physics of a project.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum TemplateArg {
    /// Physics written in Rust; no engine is needed
    Plant,
    /// Physics in the MuJoCo engine, from an MJCF file
    Mjcf,
}

#[derive(Debug, clap::Args)]
pub(crate) struct InitArgs {
    /// A robot's model, .xml (MJCF) or .urdf, for an experiment with it; or the folder of a project in Rust, empty or new
    #[arg(value_name = "MODEL|FOLDER", value_parser = path())]
    pub(crate) what: PathBuf,
    /// The experiment of a model, .toml [default: called like the model, beside it]
    #[arg(long, value_name = "FILE", value_parser = path())]
    pub(crate) out: Option<PathBuf>,
    /// The name of the experiment, or of the project as a Rust package [default: the model's, the folder's]
    #[arg(long)]
    pub(crate) name: Option<String>,
    /// What the physics of a project are [default: plant]
    #[arg(long, value_enum)]
    pub(crate) template: Option<TemplateArg>,
    /// The checkout of hwasp that a project is built with [default: the one that this program was built in]
    #[arg(long, value_name = "CHECKOUT", value_parser = path())]
    pub(crate) path: Option<PathBuf>,
}

#[derive(Debug, clap::Args)]
pub(crate) struct SchemaArgs {
    /// The file, .json [default: standard output]
    #[arg(long, value_name = "FILE", value_parser = path())]
    pub(crate) out: Option<PathBuf>,
    /// The keys as Markdown instead: the reference in docs/experiments.md
    #[arg(long, hide = true)]
    pub(crate) reference: bool,
}

#[derive(Debug, clap::Args)]
pub(crate) struct GraphArgs {
    #[command(flatten)]
    pub(crate) experiment: ExperimentArgs,
    /// The drawing, .svg, or .dot or .gv for Graphviz [default: Graphviz DOT on standard output]
    #[arg(long, value_name = "FILE", value_parser = path())]
    pub(crate) out: Option<PathBuf>,
}
