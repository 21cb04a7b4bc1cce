//! `hwasp train`.

use hwasp_experiment::Catalogue;
use hwasp_training::Observer;

use super::{layers, stop_on_signal, typed, watch};
use crate::args::TrainArgs;
use crate::progress::Progress;
use crate::{log, output, report};
use hwasp_session::Failure;
use hwasp_session::{Session, Training, What};

pub(crate) fn run(args: &TrainArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    // Where no page can be had, nothing is begun.
    let listener = args.watch.map(watch::listener).transpose()?;
    let session = Session::begin(asked(args, catalogue)?, catalogue)?;
    let path = session.path().to_owned();
    log::to_file(&path.join("train.log"));
    session.warn();
    let stop = stop_on_signal()?;
    output::remark(&session.opening());
    let serve = |listener| watch::serve(listener, vec![path.clone()], Vec::new(), catalogue);
    let page = listener.map(serve).transpose()?;
    if let Some(page) = &page {
        if args.quiet {
            // Without it nobody finds the page, and where it needs a token nobody gets in.
            output::print(&format!("{}\n", page.url()))?;
        } else {
            output::remark(&format!("watch it at {}", page.url()));
        }
    }
    let mut progress = Progress::new(session.assembly());
    let mut silence = ();
    let watching: &mut dyn Observer = if args.quiet { &mut silence } else { &mut progress };
    let ended = session.run(watching, &stop);
    progress.finish();
    let (_, summary) = ended?;
    if !args.quiet {
        output::print(&report::training(&summary, &path))?;
    }
    if let Some(page) = page.as_ref().filter(|_| !args.quiet) {
        output::remark(&format!("the page stays at {} until Ctrl-C", page.url()));
        watch::wait(&stop);
    }
    Ok(())
}

fn asked(args: &TrainArgs, catalogue: &Catalogue) -> Result<Training, Failure> {
    let what = if let Some(run) = &args.resume {
        What::Resume(run.clone())
    } else {
        let mut further = Vec::new();
        further.extend(args.seed.map(|seed| ("seed", seed.to_string())));
        further.extend(args.env_steps.map(|steps| ("env-steps", steps.to_string())));
        let name = args.experiment.as_deref().unwrap_or_default();
        What::Anew {
            layers: layers(name, args.settings.set(), &further, catalogue)?,
            method: args.settings.method().map(str::to_owned),
            learned: args.from.clone(),
            out: args.out.clone(),
        }
    };
    Ok(Training {
        what,
        threads: args.threads,
        elsewhere: args.server.elsewhere(),
        checkpoint_every: args.checkpoint_every,
        tensorboard: args.tensorboard,
        command_line: typed(),
    })
}
