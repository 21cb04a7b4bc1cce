//! `hwasp train`.

use std::path::Path;

use hwasp_lab::{Observer, Provenance, RunFolder, TensorBoard, train};

use super::{executor, experiment, stop_on_signal, typed};
use crate::args::TrainArgs;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::{output, report};

pub(crate) fn run(args: &TrainArgs) -> Result<(), Failure> {
    let mut further = Vec::new();
    further.extend(args.seed.map(|seed| ("seed", seed.to_string())));
    further.extend(args.env_steps.map(|steps| ("env-steps", steps.to_string())));
    let (spec, assembly) = experiment(&args.experiment, &further)?;
    let executor = executor(args.threads)?;
    let path = args.out.clone().unwrap_or_else(|| RunFolder::free_name(Path::new("runs"), &spec));
    let provenance = Provenance::new(typed(), args.threads.get(), spec.seed);
    // A folder that cannot be had is known before the work begins.
    let mut folder = RunFolder::create(&path, &spec, &provenance).map_err(Failure::input)?;
    let mut board = args.tensorboard.then(|| TensorBoard::create(&path.join("tensorboard"))).transpose()?;

    let stop = stop_on_signal()?;

    let mut progress = Progress::new(&assembly);
    let mut observers: Vec<&mut dyn Observer> = vec![&mut folder];
    observers.extend(board.as_mut().map(|board| board as &mut dyn Observer));
    if !args.quiet {
        output::remark(&report::beginning(&spec, &path));
        observers.push(&mut progress);
    }
    let trained = train(&assembly, &*executor, &mut observers, &stop);
    drop(observers);
    progress.finish();
    let summary = folder.finish(&assembly, &trained?)?;
    if !args.quiet {
        output::print(&report::training(&summary, &path))?;
    }
    Ok(())
}
