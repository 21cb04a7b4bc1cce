//! A training from its beginning, or from where it was interrupted, to a finished run folder: what the command `train` and the
//! Python package do.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use hwasp_experiment::{Catalogue, Experiment, InitialDesign, Layers, resolve};
use hwasp_plot::curves_svg;
use hwasp_runs::{Found, Keeping, Provenance, Resumed, RunError, RunFolder, Summary, TensorBoard, saved_provenance};
use hwasp_training::collect::CollectError;
use hwasp_training::{
    Assembly, Checkpoint, EvaluateError, Learned, Observer, ObserverError, STILL, TrainError, Trained, beginning,
    moved, train_by, warm_start,
};

use crate::crew::{Crew, Elsewhere, place};
use crate::failure::Failure;
use crate::given::{run_folder, saved_run};
use crate::words::{beginning as beginning_line, shell};

/// A training that is asked for.
#[derive(Clone, Debug)]
pub struct Training {
    /// What is trained.
    pub what: What,
    /// Threads for episodes; they do not change the result.
    pub threads: NonZeroUsize,
    /// Workers that run the episodes instead; they do not change it either.
    pub elsewhere: Option<Elsewhere>,
    /// Time between two checkpoints, at least.
    pub checkpoint_every: Duration,
    /// Whether the learning curve is written for TensorBoard, too.
    pub tensorboard: bool,
    /// What was typed, for the run's provenance.
    pub command_line: Vec<String>,
}

/// What is trained.
#[derive(Clone, Debug)]
pub enum What {
    /// An experiment.
    Anew {
        /// Its settings.
        layers: Layers,
        /// The method, unless the experiment says it.
        method: Option<String>,
        /// The runs whose parameters it begins with.
        learned: Vec<PathBuf>,
        /// The run folder; a new one under `runs/` where none is named.
        out: Option<PathBuf>,
    },
    /// A run that was interrupted.
    Resume(PathBuf),
}

/// A training that can run: its folder is there, and nobody else's.
pub struct Session {
    assembly: Assembly,
    folder: RunFolder,
    found: Found,
    board: Option<TensorBoard>,
    crew: Crew,
    resumed: bool,
}

impl Session {
    /// Makes the run folder, or takes it up.
    ///
    /// # Errors
    /// Where something that was asked for is wrong, or the folder cannot be had; nothing has changed then.
    pub fn begin(training: Training, catalogue: &Catalogue) -> Result<Self, Failure> {
        let (threads, elsewhere) = (training.threads, training.elsewhere);
        let keeping = Keeping { checkpoint_every: training.checkpoint_every, ..Keeping::default() };
        let provenance = |seed| Provenance::new(training.command_line, threads.get(), seed);
        let resumed = matches!(training.what, What::Resume(_));
        let crew = |assembly: &Assembly, path: &Path, began: u64| {
            // What workers know a training by: its experiment, its folder, and when it began.
            let name = [assembly.experiment().to_toml()?, place(path)?, began.to_string()];
            Crew::new(threads, elsewhere.as_ref(), &name, catalogue)
        };
        let (assembly, crew, Resumed { folder, found }) = match training.what {
            What::Resume(run) => {
                let assembly = saved_run(run_folder(&run)?, &[], catalogue)?.assembly().clone();
                let began = saved_provenance(&run).map_err(Failure::input)?.map_or(0, |before| before.started_unix_s);
                let (crew, spec) = (crew(&assembly, &run, began)?, assembly.experiment());
                let folder = RunFolder::resume(&run, spec, provenance(spec.seed), keeping).map_err(Failure::input)?;
                (assembly, crew, folder)
            }
            What::Anew { layers, method, learned, out } => {
                let mut spec = resolve(layers, method.as_deref(), catalogue).map_err(Failure::input)?;
                let mut assembly = Assembly::new(&spec).map_err(Failure::input)?;
                let start = match &learned[..] {
                    [] => None,
                    runs => Some(learned_before(runs, &mut spec, &mut assembly, catalogue)?),
                };
                let path = out.unwrap_or_else(|| RunFolder::free_name(Path::new("runs"), &spec));
                let provenance = provenance(spec.seed);
                let crew = crew(&assembly, &path, provenance.started_unix_s)?;
                // A folder that cannot be had is known before the work begins.
                let folder = RunFolder::create(&path, &spec, &provenance, keeping);
                let mut folder = folder.map_err(Failure::input)?;
                if let Some(start) = &start {
                    // No experiment file says it: from the first moment on it is in the folder.
                    folder.keep(start)?;
                }
                (assembly, crew, Resumed { folder, found: Found { checkpoint: start, ..Found::default() } })
            }
        };
        let tensorboard = folder.path().join("tensorboard");
        let wanted = training.tensorboard || (resumed && tensorboard.is_dir());
        let board = wanted.then(|| TensorBoard::create(&tensorboard)).transpose()?;
        Ok(Self { assembly, folder, found, board, crew, resumed })
    }

    /// Its experiment, ready to run.
    pub fn assembly(&self) -> &Assembly {
        &self.assembly
    }

    /// Its run folder.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// A line that says what begins.
    pub fn opening(&self) -> String {
        beginning_line(self.assembly.experiment(), self.path(), self.resumed, self.found.checkpoint.as_ref())
    }

    /// Tells of checkpoints that are damaged, where it goes on from an older one.
    pub fn warn(&self) {
        self.found.warn();
    }

    /// Trains to the end, and finishes the folder. The run folder is the first of the observers.
    ///
    /// # Errors
    /// Where it was stopped or failed; the folder has what it takes to go on.
    pub fn run(mut self, watching: &mut dyn Observer, stop: &AtomicBool) -> Result<(Trained, Summary), Failure> {
        let mut observers: Vec<&mut dyn Observer> = Vec::new();
        observers.extend(self.board.as_mut().map(|board| board as &mut dyn Observer));
        observers.push(watching);
        into_folder(&self.assembly, &mut self.folder, self.found.checkpoint.as_ref(), &self.crew, &mut observers, stop)
    }
}

/// Trains into a folder while others watch, and finishes it.
pub fn into_folder(
    assembly: &Assembly,
    folder: &mut RunFolder,
    from: Option<&Checkpoint>,
    crew: &Crew,
    watching: &mut dyn Observer,
    stop: &AtomicBool,
) -> Result<(Trained, Summary), Failure> {
    let (collector, mut settling) = (crew.collector(assembly, Some(stop))?, crew);
    // What workers keep is not needed any more once the folder has it.
    let mut observers: Vec<&mut dyn Observer> = vec![folder, watching, &mut settling];
    let trained = train_by(&*collector, from, assembly, crew.executor(), &mut observers, stop);
    drop(observers);
    if trained.is_err() {
        crew.stop();
    }
    let trained = trained.map_err(|error| ended(error, folder, crew))?;
    if !moved(assembly, from, &trained.params) {
        tracing::warn!("the training changed nothing: {STILL}");
    }
    let resume = format!("`hwasp train --resume {}` goes on from the last checkpoint", shell(folder.path()));
    let finished = folder.finish(assembly, &trained, &curves_svg);
    let summary = finished.map_err(|error| Failure::from(error).hint(&format!("free the way; {resume}")))?;
    crew.finish();
    Ok((trained, summary))
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

/// What could not be written or read of the run folder, where a training ended for that.
fn unwritten(error: &TrainError) -> Option<&RunError> {
    if let TrainError::Observer(ObserverError(error)) = error { error.downcast_ref() } else { None }
}

/// What a training that did not come to its end leaves, and the way on.
fn ended(error: TrainError, folder: &mut RunFolder, crew: &Crew) -> Failure {
    let run = shell(folder.path());
    let with = if crew.is_elsewhere() { ", with the same --server," } else { "" };
    let resume = format!("`hwasp train --resume {run}`{with} goes on");
    if let Err(unsaved) = folder.settle() {
        let hint = format!("the last checkpoint is as it was; with the way free, {resume} from there");
        return Failure::from(unsaved).hint(&hint);
    }
    match &error {
        TrainError::Interrupted { .. } => Failure::interrupted(error).hint(&format!("{resume} from there")),
        TrainError::Collect(gone) | TrainError::Evaluate(EvaluateError::Collect(gone)) => {
            let how = if *gone == CollectError::Interrupted { Failure::interrupted } else { Failure::failed };
            how(error).hint(&format!("{resume} from the last checkpoint"))
        }
        _ => match (folder.fault(), unwritten(&error)) {
            (Some(fault), _) => Failure::from(error).hint(&format!("`hwasp replay {}` repeats it", shell(fault))),
            (None, Some(_)) => Failure::from(error).hint(&format!("with the way free, {resume}")),
            (None, None) => error.into(),
        },
    }
}
