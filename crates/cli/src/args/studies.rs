//! Arguments of the commands that train many times.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use super::ServerArgs;
use super::parse::{LAST_SEED, MOST_SEEDS, MOST_STEPS, finite, path, threads, whole};

#[derive(Debug, clap::Args)]
pub(crate) struct CompareArgs {
    /// A name from `hwasp list`, or the path of a TOML file
    pub(crate) experiment: String,
    /// Methods, separated by commas; fixed:middle, fixed:random, fixed:"2 N/m" and fixed:'{gear = 70, shank = "0.5 m"}' say where
    /// hardware stays that is fixed; parameters that are not named stay where they begin
    /// [default: hwasp,minimal,cmaes,ars,cmaes-rl,ars-rl,bo-rl,random-rl,fixed; fixed,cmaes,ars where nothing is designed]
    #[arg(long)]
    pub(crate) methods: Vec<String>,
    /// Seeds of each method, one after the other
    #[arg(long, default_value = "5", allow_negative_numbers = true, value_parser = whole(1..=MOST_SEEDS))]
    pub(crate) seeds: u64,
    /// The first of them
    #[arg(long, value_name = "SEED", default_value = "0", allow_negative_numbers = true, value_parser = whole(0..=LAST_SEED - MOST_SEEDS))]
    pub(crate) first_seed: u64,
    /// Real simulator steps of each training [default: what the experiment says]
    #[arg(long, value_name = "STEPS", allow_negative_numbers = true, value_parser = whole(1..=MOST_STEPS))]
    pub(crate) env_steps: Option<u64>,
    /// Set one value of the experiment, such as `ppo.clip_ratio=0.1`; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
    /// The training return whose steps are counted [default: nine tenths of the way from the worst to the best]
    #[arg(long, allow_negative_numbers = true, value_parser = finite)]
    pub(crate) threshold: Option<f64>,
    /// Cells trained at once on this machine; they do not change the result [default: the processors there are]
    #[arg(long, allow_negative_numbers = true, value_parser = threads)]
    pub(crate) threads: Option<NonZeroUsize>,
    /// The folder; where it holds a part of this comparison, that is continued [default: runs/compare-EXPERIMENT]
    #[arg(long, value_name = "FOLDER", value_parser = path())]
    pub(crate) out: Option<PathBuf>,
    /// Print nothing but errors
    #[arg(long, short)]
    pub(crate) quiet: bool,
    #[command(flatten)]
    pub(crate) server: ServerArgs,
}

#[derive(Debug, clap::Args)]
pub(crate) struct ReproduceArgs {
    /// fig3-10, fig3-50, figs-bar-10, figs-bar-50 or table1
    pub(crate) figure: String,
    /// Two seeds at a fifth of the steps: a minute or two, and the same shape
    #[arg(long)]
    pub(crate) quick: bool,
    /// Cells trained at once on this machine; they do not change the result [default: the processors there are]
    #[arg(long, allow_negative_numbers = true, value_parser = threads)]
    pub(crate) threads: Option<NonZeroUsize>,
    /// The folder; a part that is there is continued [default: runs/reproduce-FIGURE]
    #[arg(long, value_name = "FOLDER", value_parser = path())]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) server: ServerArgs,
}
