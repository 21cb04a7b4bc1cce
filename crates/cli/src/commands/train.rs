//! `hwasp train`.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use hwasp_lab::{Assembly, Observer, Provenance, RunFolder, train};

use super::{executor, experiment};
use crate::Failure;
use crate::args::TrainArgs;
use crate::progress::Progress;
use crate::report;

pub(crate) fn run(args: &TrainArgs) -> Result<(), Failure> {
    let mut further = Vec::new();
    further.extend(args.seed.map(|seed| ("seed", seed.to_string())));
    further.extend(args.env_steps.map(|steps| ("env-steps", steps.to_string())));
    let spec = experiment(&args.experiment, &further)?;
    let assembly = Assembly::new(&spec)?;
    let executor = executor(args.threads)?;
    let path = args.out.clone().unwrap_or_else(|| RunFolder::free_name(Path::new("runs"), &spec));
    let provenance = Provenance::new(std::env::args().collect(), args.threads.get(), spec.seed);
    let mut folder = RunFolder::create(&path, &spec, &provenance)?;

    let stop = Arc::new(AtomicBool::new(false));
    let signal = Arc::clone(&stop);
    ctrlc::set_handler(move || {
        // The second time there is nobody to wait for.
        if signal.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    })?;

    let mut progress = Progress::new(&assembly);
    let mut observers: Vec<&mut dyn Observer> = vec![&mut folder];
    if !args.quiet {
        eprintln!("{}", report::beginning(&spec, &path));
        observers.push(&mut progress);
    }
    let trained = train(&assembly, &*executor, &mut observers, &stop);
    drop(observers);
    progress.finish();
    let summary = folder.finish(&assembly, &trained?)?;
    if !args.quiet {
        print!("{}", report::training(&summary, &path));
    }
    Ok(())
}
