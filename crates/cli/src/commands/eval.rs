//! `hwasp eval`.

use hwasp_lab::{SavedRun, evaluate};

use super::executor;
use crate::Failure;
use crate::args::EvalArgs;
use crate::report;

pub(crate) fn run(args: &EvalArgs) -> Result<(), Failure> {
    let saved = SavedRun::open(&args.run)?;
    let params = saved.params()?;
    let settings = &saved.assembly().spec().train;
    let episodes = args.episodes.map_or(settings.evaluation_episodes as u64, std::num::NonZeroU64::get);
    let seed = args.seed.unwrap_or(settings.evaluation_seed);
    let executor = executor(args.threads)?;
    let evaluation = evaluate(saved.assembly(), &params, (episodes, seed), &*executor)?;
    if args.json {
        println!("{}", serde_json::to_string_pretty(&evaluation)?);
    } else {
        print!("{}", report::evaluation(&evaluation));
    }
    Ok(())
}
