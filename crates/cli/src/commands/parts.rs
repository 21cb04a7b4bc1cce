//! `hwasp parts`.

use hwasp_experiment::Catalogue;
use std::path::Path;

use hwasp_runs::{Provenance, RunError};
use hwasp_workshop::parts::{
    BUILD, Judge, PARTS, PartsError, PartsWorth, SHEET, SpringCatalogue, TUNED, Tuning, TuningFolder, Workshop, snap,
};
use hwasp_workshop::writable;

use super::{saved_run, stop_on_signal, typed};
use crate::args::PartsArgs;
use crate::progress::Progress;
use crate::{log, output, report};
use hwasp_session::Crew;
use hwasp_session::Failure;
use hwasp_session::into_folder;

pub(crate) fn run(args: &PartsArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let springs = args.catalogue.as_deref().map_or_else(SpringCatalogue::built_in, SpringCatalogue::open);
    let springs = springs.map_err(Failure::input)?;
    let workshop = Workshop::with(&args.bench).map_err(Failure::input)?;
    let saved = saved_run(&args.run, &[], catalogue)?;
    let (assembly, params) = (saved.assembly(), saved.params().map_err(Failure::input)?);
    let asked = args.held_out.asked(&assembly.experiment().train);
    let snapped = snap(assembly, &params, &springs, &workshop).map_err(failure)?;
    let folder = args.out.clone().unwrap_or_else(|| args.run.join(BUILD));

    // What cannot be begun or written is known before the work begins.
    let tuning = args.fine_tune.map(|steps| Tuning::new(assembly, &params, &snapped.built, steps, asked));
    let tuning = tuning.transpose().map_err(failure)?;
    writable(&folder)?;
    if let Some(remark) = springs.remark() {
        output::remark(&remark);
    }
    let path = folder.join(TUNED);
    let provenance = Provenance::new(typed(), args.held_out.threads.get(), assembly.experiment().seed);
    let tuning = tuning.map(|tuning| Ok((tuning.folder(&path, provenance)?, tuning))).transpose();
    let tuning = tuning.map_err(|error: RunError| Failure::input(error))?;

    let crew = Crew::new(args.held_out.threads, args.server.elsewhere().as_ref(), &[], catalogue)?;
    let collector = crew.collector(assembly, None)?;
    output::remark(&format!("simulating the hand as trained and on its parts, {} episodes each", asked.0));
    let judge = snapped.judge(assembly, &params, asked, &*collector).map_err(failure)?;
    let worth = match tuning {
        None => judge.worth().clone(),
        Some((there, tuning)) => tuned(judge, there, &tuning, &path, &crew)?,
    };
    crew.finish();
    let list = snapped.list(assembly, worth);
    // What was found is told even if a disk is full by now.
    output::print(&report::parts::parts(&list))?;
    list.write(&folder)?;
    let further = if list.worth.tuned.is_some() { ", tuned/" } else { "" };
    Ok(output::print(&format!("\n  {}: {PARTS}, {SHEET}{further}\n", folder.display()))?)
}

/// Trains the controller further, unless that is done already, and simulates it.
fn tuned(
    judge: Judge<'_>,
    there: TuningFolder,
    tuning: &Tuning,
    path: &Path,
    crew: &Crew,
) -> Result<PartsWorth, Failure> {
    let spec = tuning.assembly.experiment();
    let params = match there {
        TuningFolder::Finished(params) => {
            output::remark(&format!("{} holds this training already", path.display()));
            params
        }
        TuningFolder::Open(mut folder, from) => {
            log::to_file(&path.join("train.log"));
            output::remark(&hwasp_session::beginning(spec, path, false, None));
            let stop = stop_on_signal()?;
            let mut progress = Progress::new(&tuning.assembly);
            let ended = into_folder(&tuning.assembly, &mut folder, Some(&from), crew, &mut progress, &stop);
            progress.finish();
            let (trained, _) = ended?;
            folder.remove_checkpoints()?;
            trained.params
        }
    };
    judge.tuned(&params, TUNED, spec.train.env_steps).map_err(failure)
}

fn failure(error: PartsError) -> Failure {
    match error {
        PartsError::Evaluate(_) | PartsError::Tuning(_) => error.into(),
        _ => Failure::input(error),
    }
}
