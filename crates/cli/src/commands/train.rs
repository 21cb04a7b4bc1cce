//! `hwasp train`.

use hwasp_experiment::{Catalogue, Experiment, InitialDesign};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use hwasp_core::Executor;
use hwasp_plot::curves_svg;
use hwasp_runs::{Found, Keeping, Provenance, Resumed, RunError, RunFolder, Summary, TensorBoard};
use hwasp_training::{
    Assembly, Checkpoint, Learned, Observer, ObserverError, STILL, TrainError, Trained, beginning, moved, train_from,
    warm_start,
};

use super::{executor, experiment, run_folder, saved_run, stop_on_signal, typed};
use crate::args::TrainArgs;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::{log, output, report};

pub(crate) fn run(args: &TrainArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let executor = executor(args.threads)?;
    let (assembly, Resumed { mut folder, found }) = match &args.resume {
        Some(run) => taken_up(run, args, catalogue)?,
        None => begun(args, catalogue)?,
    };
    let path = folder.path().to_owned();
    log::to_file(&path.join("train.log"));
    found.warn();
    let from = found.checkpoint.as_ref();
    let tensorboard = path.join("tensorboard");
    let wanted = args.tensorboard || (args.resume.is_some() && tensorboard.is_dir());
    let mut board = wanted.then(|| TensorBoard::create(&tensorboard)).transpose()?;

    let stop = stop_on_signal()?;

    output::remark(&report::beginning(assembly.experiment(), &path, args.resume.is_some(), from));
    let (_, summary) = into_folder(&assembly, &mut folder, from, &*executor, (board.as_mut(), args.quiet), &stop)?;
    if !args.quiet {
        output::print(&report::training(&summary, &path))?;
    }
    Ok(())
}

/// Trains into a folder, for TensorBoard too where that is wanted, with a bar unless all is to be quiet; and finishes it.
pub(super) fn into_folder(
    assembly: &Assembly,
    folder: &mut RunFolder,
    from: Option<&Checkpoint>,
    executor: &dyn Executor,
    (board, quiet): (Option<&mut TensorBoard>, bool),
    stop: &AtomicBool,
) -> Result<(Trained, Summary), Failure> {
    let mut progress = Progress::new(assembly);
    let mut observers: Vec<&mut dyn Observer> = vec![folder];
    observers.extend(board.map(|board| board as &mut dyn Observer));
    if !quiet {
        observers.push(&mut progress);
    }
    let trained = train_from(from, assembly, executor, &mut observers, stop);
    drop(observers);
    progress.finish();
    let trained = trained.map_err(|error| ended(error, folder))?;
    if !moved(assembly, from, &trained.params) {
        tracing::warn!("the training changed nothing: {STILL}");
    }
    let resume = format!("`hwasp train --resume {}` goes on from the last checkpoint", output::shell(folder.path()));
    let finished = folder.finish(assembly, &trained, &curves_svg);
    let summary = finished.map_err(|error| Failure::from(error).hint(&format!("free the way; {resume}")))?;
    Ok((trained, summary))
}

fn keeping(args: &TrainArgs) -> Keeping {
    Keeping { checkpoint_every: args.checkpoint_every, ..Keeping::default() }
}

/// A new run.
fn begun(args: &TrainArgs, catalogue: &Catalogue) -> Result<(Assembly, Resumed), Failure> {
    let mut further = Vec::new();
    further.extend(args.seed.map(|seed| ("seed", seed.to_string())));
    further.extend(args.env_steps.map(|steps| ("env-steps", steps.to_string())));
    let name = args.experiment.as_deref().unwrap_or_default();
    let (mut spec, mut assembly) = experiment(name, &args.settings, &further, catalogue)?;
    let start = match &args.from[..] {
        [] => None,
        runs => Some(learned_before(runs, &mut spec, &mut assembly, catalogue)?),
    };
    let path = args.out.clone().unwrap_or_else(|| RunFolder::free_name(Path::new("runs"), &spec));
    let provenance = Provenance::new(typed(), args.threads.get(), spec.seed);
    // A folder that cannot be had is known before the work begins.
    let mut folder = RunFolder::create(&path, &spec, &provenance, keeping(args)).map_err(Failure::input)?;
    if let Some(start) = &start {
        // No experiment file says it: from the first moment on it is in the folder.
        folder.keep(start)?;
    }
    Ok((assembly, Resumed { folder, found: Found { checkpoint: start, ..Found::default() } }))
}

/// The beginning of a training that other runs learned before. A design that no training moves is set to that of the first.
fn learned_before(
    runs: &[PathBuf],
    spec: &mut Experiment,
    assembly: &mut Assembly,
    catalogue: &Catalogue,
) -> Result<Checkpoint, Failure> {
    let method = assembly.experiment().method;
    if method.searches() {
        let name = method.name();
        return Err(Failure::input(format!(
            "--from: {name} begins its search anew; hwasp, minimal, episode and fixed can go on"
        )));
    }
    let mut saved = Vec::with_capacity(runs.len());
    for run in runs {
        let run = saved_run(run_folder(run)?, &[], catalogue)?;
        let params = run.params().map_err(Failure::input)?;
        saved.push((run, params));
    }
    let learned: Vec<_> = saved.iter().map(|(run, params)| Learned { assembly: run.assembly(), params }).collect();
    let Learned { assembly: first, params } = learned[0];
    let alike = first.policy.space().names() == assembly.policy.space().names();
    if alike && assembly.policy.free_design().is_empty() {
        spec.design.initial = InitialDesign::at(&spec.task.groups(), &first.built(params));
        *assembly = Assembly::new(spec).map_err(Failure::input)?;
    }
    let main = assembly.main_stage();
    let params = warm_start(&main, &learned).map_err(Failure::input)?;
    Ok(beginning(&main, params, first.experiment().train.env_steps)?)
}

/// A run that was interrupted.
fn taken_up(run: &Path, args: &TrainArgs, catalogue: &Catalogue) -> Result<(Assembly, Resumed), Failure> {
    let assembly = saved_run(run_folder(run)?, &[], catalogue)?.assembly().clone();
    let provenance = Provenance::new(typed(), args.threads.get(), assembly.experiment().seed);
    let resumed = RunFolder::resume(run, assembly.experiment(), provenance, keeping(args)).map_err(Failure::input)?;
    Ok((assembly, resumed))
}

/// What could not be written or read of the run folder, where a training ended for that.
fn unwritten(error: &TrainError) -> Option<&RunError> {
    if let TrainError::Observer(ObserverError(error)) = error { error.downcast_ref() } else { None }
}

/// What a training that did not come to its end leaves, and the way on.
fn ended(error: TrainError, folder: &mut RunFolder) -> Failure {
    let run = output::shell(folder.path());
    let resume = format!("`hwasp train --resume {run}` goes on");
    if let Err(unsaved) = folder.settle() {
        let hint = format!("the last checkpoint is as it was; with the way free, {resume} from there");
        return Failure::from(unsaved).hint(&hint);
    }
    match &error {
        TrainError::Interrupted { .. } => Failure::interrupted(error).hint(&format!("{resume} from there")),
        _ => match (folder.fault(), unwritten(&error)) {
            (Some(fault), _) => {
                Failure::from(error).hint(&format!("`hwasp replay {}` repeats it", output::shell(fault)))
            }
            (None, Some(_)) => Failure::from(error).hint(&format!("with the way free, {resume}")),
            (None, None) => error.into(),
        },
    }
}
