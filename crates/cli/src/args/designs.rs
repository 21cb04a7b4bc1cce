//! Arguments of the commands that make something of a trained design.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use hwasp_experiment::TrainSettings;
use hwasp_export::{Kind, MOST_SAMPLES};

use super::ServerArgs;
use super::parse::{LAST_SEED, MOST_EPISODES, MOST_STEPS, path, threads, whole};

#[derive(Debug, clap::Args)]
pub(crate) struct DesignArgs {
    /// A run folder, as `hwasp train` writes one; or an experiment, for what its design parameters change of the model
    #[arg(value_name = "RUN|EXPERIMENT", value_parser = path())]
    pub(crate) run: PathBuf,
    /// Another value of a parameter, such as `shank="0.6 m"`: what it changes of the model, as numbers; may be repeated
    /// [default for an experiment: from the lower to the upper limit of each parameter that shapes the model]
    #[arg(long = "at", value_name = "NAME=VALUE")]
    pub(crate) at: Vec<String>,
    /// Where a hand's closing chart is drawn, closing.svg and closing.png [default: the run folder]
    #[arg(long, value_name = "FOLDER", value_parser = path())]
    pub(crate) out: Option<PathBuf>,
    /// Print JSON, for scripts; the chart is then drawn only where --out says
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, clap::Args)]
pub(crate) struct ExportArgs {
    /// A run folder, as `hwasp train` writes one
    #[arg(value_parser = path())]
    pub(crate) run: PathBuf,
    /// The folder; files of an earlier export of the same run are replaced [default: export/ in the run folder]
    #[arg(long, value_name = "FOLDER", value_parser = path())]
    pub(crate) out: Option<PathBuf>,
    /// Also write random observations with this program's answers, to hold another runtime against: samples.safetensors
    #[arg(long, value_name = "COUNT", allow_negative_numbers = true, value_parser = whole(1..=MOST_SAMPLES))]
    pub(crate) samples: Option<u64>,
    #[command(flatten)]
    pub(crate) kinds: KindArgs,
}

/// What is exported.
#[derive(Debug, clap::Args)]
#[allow(clippy::struct_excessive_bools)] // a flag for each kind
#[command(next_help_heading = "Kinds [default: all that the run has]")]
pub(crate) struct KindArgs {
    /// controller.onnx, and policy.onnx: the controller with the law of the hardware as built
    #[arg(long)]
    onnx: bool,
    /// controller.safetensors: weights and scaling
    #[arg(long)]
    safetensors: bool,
    /// controller.json: the same as text
    #[arg(long)]
    json: bool,
    /// hand.xml: the hand with tendons and springs, and its task, for MuJoCo
    #[arg(long)]
    mjcf: bool,
    /// hand.urdf: the hand's links and joints, with the STL files as what is seen
    #[arg(long)]
    urdf: bool,
    /// palm.stl, each link and pulley and what is on the palm, to print, in mm
    #[arg(long)]
    stl: bool,
    /// hand.scad: the same for OpenSCAD, with the parameters at its top
    #[arg(long)]
    scad: bool,
    /// palm.step and each other part, for programs that want solids instead of triangles
    #[arg(long)]
    step: bool,
    /// package/: bill of materials, assembly in steps, a drawing of each part, a test coupon, and whether it can be built
    #[arg(long)]
    package: bool,
}

impl KindArgs {
    /// What is asked for.
    pub(crate) fn asked(&self) -> Vec<Kind> {
        let asked = |kind: &Kind| match kind {
            Kind::Onnx => self.onnx,
            Kind::Safetensors => self.safetensors,
            Kind::Json => self.json,
            Kind::Mjcf => self.mjcf,
            Kind::Urdf => self.urdf,
            Kind::Stl => self.stl,
            Kind::Scad => self.scad,
            Kind::Step => self.step,
            Kind::Package => self.package,
        };
        Kind::ALL.into_iter().filter(asked).collect()
    }
}

#[derive(Debug, clap::Args)]
pub(crate) struct PartsArgs {
    /// A run folder of a grasping problem, as `hwasp train` writes one
    #[arg(value_parser = path())]
    pub(crate) run: PathBuf,
    /// Springs to choose from, a CSV file with the columns of docs/parts.md [default: one that comes with the program, of
    /// standard sizes and nobody's stock]
    #[arg(long, value_name = "FILE", value_parser = path())]
    pub(crate) catalogue: Option<PathBuf>,
    /// Set what the workshop has, such as `axle="3 mm"` or `hole_pitch="10 deg"`; may be repeated
    #[arg(long = "bench", value_name = "KEY=VALUE")]
    pub(crate) bench: Vec<String>,
    /// Train the controller further on the parts, for so many simulator steps, such as 3e5 [default: not at all]
    #[arg(long, value_name = "STEPS", allow_negative_numbers = true, value_parser = whole(1..=MOST_STEPS))]
    pub(crate) fine_tune: Option<u64>,
    #[command(flatten)]
    pub(crate) held_out: HeldOutArgs,
    /// The folder of the list; its files are replaced [default: build/ in the run folder]
    #[arg(long, value_name = "FOLDER", value_parser = path())]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) server: ServerArgs,
}

#[derive(Debug, clap::Args)]
pub(crate) struct TolerancesArgs {
    /// A run folder, as `hwasp train` writes one
    #[arg(value_parser = path())]
    pub(crate) run: PathBuf,
    /// How far a parameter may be off, such as `radius="0.1 mm"`, `thumb_distal_stiffness="10 %"`; may be repeated [default: of a
    /// hand radius 0.1 mm, stiffness 5 %, preload 0.13 rad; otherwise 5 %]
    #[arg(long = "error", value_name = "NAME=SIZE")]
    pub(crate) error: Vec<String>,
    #[command(flatten)]
    pub(crate) held_out: HeldOutArgs,
    /// The folder of figures and pictures; files there are replaced [default: build/ in the run folder]
    #[arg(long, value_name = "FOLDER", value_parser = path())]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) server: ServerArgs,
}

/// Held-out episodes.
#[derive(Debug, clap::Args)]
pub(crate) struct HeldOutArgs {
    /// Episodes [default: what the experiment says]
    #[arg(long, allow_negative_numbers = true, value_parser = whole(1..=MOST_EPISODES))]
    episodes: Option<u64>,
    /// Root seed of their starts [default: what the experiment says]
    #[arg(long, allow_negative_numbers = true, value_parser = whole(0..=LAST_SEED))]
    seed: Option<u64>,
    /// Threads for episodes; they do not change the result
    #[arg(long, default_value = "1", allow_negative_numbers = true, value_parser = threads)]
    pub(crate) threads: NonZeroUsize,
}

impl HeldOutArgs {
    /// How many episodes, and the root seed of their starts.
    pub(crate) fn asked(&self, train: &TrainSettings) -> (u64, u64) {
        (self.episodes.unwrap_or(train.evaluation_episodes as u64), self.seed.unwrap_or(train.evaluation_seed))
    }
}
