//! The command line.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Parser, Subcommand, ValueEnum};

/// Design a robot's body and its controller together.
///
/// The law of a mechanism (springs, bars, tendons) is a differentiable part of the policy, and policy gradients train its
/// physical parameters with the controller (Chen, He and Ciocarlie, "Hardware as Policy", `CoRL` 2020).
#[derive(Debug, Parser)]
#[command(name = "hwasp", version, arg_required_else_help = true, max_term_width = 100)]
pub(crate) struct Args {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Train an experiment and write a run folder
    Train(TrainArgs),
    /// Evaluate a run: the deterministic policy on held-out starts, on the hardware as built
    Eval(EvalArgs),
    /// Draw learning curves; runs of one experiment and method are summarised together
    Plot(PlotArgs),
    /// Check an experiment file and report all that is wrong with it at once
    Check(ExperimentArgs),
    /// List the experiments that come with the program
    List,
    /// Draw the law of an experiment as a computational graph
    Graph(GraphArgs),
}

/// How the design is placed.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum MethodArg {
    /// The law in the policy's graph, as in the paper's `HWasP`
    Hwasp,
    /// The design in the action, as in the paper's HWasP-Minimal
    Minimal,
    /// The hardware stays as it begins; only the controller learns
    Fixed,
}

impl MethodArg {
    fn name(self) -> &'static str {
        match self {
            Self::Hwasp => "hwasp",
            Self::Minimal => "minimal",
            Self::Fixed => "fixed",
        }
    }
}

/// What names an experiment.
#[derive(Debug, clap::Args)]
pub(crate) struct ExperimentArgs {
    /// A name from `hwasp list`, or the path of a TOML file
    pub(crate) experiment: String,
    /// How the design is placed [default: what the experiment says]
    #[arg(long, value_enum)]
    method: Option<MethodArg>,
    /// Set one value of the experiment, such as `ppo.clip_ratio=0.1`; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
}

impl ExperimentArgs {
    pub(crate) fn method(&self) -> Option<&'static str> {
        self.method.map(MethodArg::name)
    }

    pub(crate) fn set(&self) -> &[String] {
        &self.set
    }
}

#[derive(Debug, clap::Args)]
pub(crate) struct TrainArgs {
    #[command(flatten)]
    pub(crate) experiment: ExperimentArgs,
    /// Root of all random numbers of the run
    #[arg(long)]
    pub(crate) seed: Option<u64>,
    /// Real simulator steps to train for
    #[arg(long, value_name = "STEPS")]
    pub(crate) env_steps: Option<u64>,
    /// Threads for episodes; they do not change the result
    #[arg(long, default_value = "1")]
    pub(crate) threads: NonZeroUsize,
    /// The run folder [default: a new one under runs/]
    #[arg(long, value_name = "FOLDER")]
    pub(crate) out: Option<PathBuf>,
    /// Print nothing but errors
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

#[derive(Debug, clap::Args)]
pub(crate) struct EvalArgs {
    /// A run folder
    pub(crate) run: PathBuf,
    /// Episodes [default: what the experiment says]
    #[arg(long)]
    pub(crate) episodes: Option<std::num::NonZeroU64>,
    /// Root seed of their starts [default: what the experiment says]
    #[arg(long)]
    pub(crate) seed: Option<u64>,
    /// Threads for episodes; they do not change the result
    #[arg(long, default_value = "1")]
    pub(crate) threads: NonZeroUsize,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, clap::Args)]
pub(crate) struct PlotArgs {
    /// Run folders
    #[arg(required = true)]
    pub(crate) runs: Vec<PathBuf>,
    /// The picture, .svg or .png
    #[arg(long, value_name = "FILE", default_value = "curves.svg")]
    pub(crate) out: PathBuf,
    /// A line above it
    #[arg(long, default_value = "")]
    pub(crate) title: String,
}

#[derive(Debug, clap::Args)]
pub(crate) struct GraphArgs {
    #[command(flatten)]
    pub(crate) experiment: ExperimentArgs,
    /// The drawing, .svg or .dot [default: Graphviz DOT on standard output]
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
}
