//! Episodes of a run's controller, on its design and on others.

use std::io;
use std::path::{Path, PathBuf};

use hwasp_core::Serial;
use hwasp_experiment::Catalogue;
use hwasp_runs::{RunError, SavedRun};
use hwasp_scene::{Scene, Studio};
use hwasp_settings::text::show;
use hwasp_training::{Assembly, Change, EvaluateError, Evaluation, Reference};
use hyper::StatusCode;
use serde::Serialize;

use crate::answer::Answer;
use crate::follow::Policy;
use crate::stamp::Stamp;

/// Episodes by which a design is judged.
const JUDGED: u64 = 20;
/// How often a checkpoint is looked for that a training has just replaced.
const TRIES: usize = 3;

/// A simulation that is asked for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Asked {
    pub(crate) run: PathBuf,
    /// The experiment that is in the run's folder.
    pub(crate) experiment: Option<Stamp>,
    pub(crate) policy: Policy,
    pub(crate) what: What,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum What {
    /// Episodes on its design.
    Episode,
    /// An episode on both its design and one with these values, SI.
    Changed(Vec<(String, f64)>),
}

/// A run whose episodes are asked for, one after the other.
#[derive(Default)]
pub(crate) struct Stage {
    opened: Option<Opened>,
}

struct Opened {
    run: PathBuf,
    experiment: Option<Stamp>,
    policy: Policy,
    saved: SavedRun,
    params: Vec<f32>,
    /// Simulator steps of the training until then; none where it has come to its end.
    env_steps: Option<u64>,
    /// Which episodes are shown, and why.
    choice: Vec<(u64, String)>,
}

#[derive(Serialize)]
struct Episodes<'a> {
    policy: &'a str,
    env_steps: Option<u64>,
    /// Every design parameter, SI.
    design: Vec<f64>,
    seed: u64,
    scene: Scene,
}

#[derive(Serialize)]
struct Comparison<'a> {
    policy: &'a str,
    env_steps: Option<u64>,
    seed: u64,
    before: Judged,
    after: Judged,
    /// What it changes, episode by episode.
    change: Change,
}

#[derive(Serialize)]
struct Judged {
    design: Vec<f64>,
    scene: Scene,
    evaluation: Evaluation,
}

impl Stage {
    /// The answer, and whether it is worth to be kept.
    pub(crate) fn answer(&mut self, asked: &Asked, catalogue: &Catalogue) -> (Answer, bool) {
        let known = |opened: &Opened| {
            (&opened.run, opened.experiment, opened.policy) == (&asked.run, asked.experiment, asked.policy)
        };
        let opened = match self.opened.take().filter(known).map_or_else(|| open(asked, catalogue), Ok) {
            Ok(opened) => opened,
            Err(error) => return (Answer::fault(StatusCode::CONFLICT, &error), false),
        };
        let answer = match &asked.what {
            What::Episode => opened.episodes(),
            What::Changed(values) => opened.compared(values),
        };
        self.opened = Some(opened);
        match answer {
            Ok(answer) => (answer, true),
            Err(answer) => (answer, false),
        }
    }
}

fn open(asked: &Asked, catalogue: &Catalogue) -> Result<Opened, String> {
    let told = |error: RunError| error.to_string();
    let saved = SavedRun::open(&asked.run, catalogue).map_err(told)?;
    let (params, env_steps) = params(&saved, asked.policy).map_err(told)?;
    let mut opened = Opened {
        run: asked.run.clone(),
        experiment: asked.experiment,
        policy: asked.policy,
        saved,
        params,
        env_steps,
        choice: Vec::new(),
    };
    opened.choice = opened.studio(&opened.built()).choice().map_err(|error| error.to_string())?;
    Ok(opened)
}

/// The newest parameters, and the steps that they took.
fn params(saved: &SavedRun, policy: Policy) -> Result<(Vec<f32>, Option<u64>), RunError> {
    match policy {
        Policy::First => Ok((saved.assembly().init(), Some(0))),
        Policy::Last(_) => Ok((saved.params()?, None)),
        Policy::Checkpoint(..) => {
            let mut found = saved.found();
            for _ in 1..TRIES {
                match found {
                    Err(RunError::Io { source, .. }) if source.kind() == io::ErrorKind::NotFound => found = saved.found(),
                    _ => break,
                }
            }
            match found?.checkpoint {
                Some(checkpoint) => Ok((saved.params_at(&checkpoint)?, Some(checkpoint.env_steps))),
                // It came to its end just now.
                None => Ok((saved.params()?, None)),
            }
        }
    }
}

impl Opened {
    fn assembly(&self) -> &Assembly {
        self.saved.assembly()
    }

    fn seed(&self) -> u64 {
        self.assembly().experiment().train.evaluation_seed
    }

    fn built(&self) -> Vec<f64> {
        self.assembly().built(&self.params)
    }

    fn studio<'a>(&'a self, built: &'a [f64]) -> Studio<'a> {
        let world = &self.assembly().worlds.deployment;
        Studio::new((self.assembly(), &self.params), (world, built), self.seed())
    }

    /// Episodes on film.
    fn scene(&self, built: &[f64], chosen: &[(u64, String)]) -> Result<Scene, EvaluateError> {
        let studio = self.studio(built);
        let mut takes = Vec::new();
        for (index, name) in chosen {
            takes.extend(studio.take(*index, name.clone())?);
        }
        Ok(Scene::new(title(&self.run), &takes))
    }

    fn episodes(&self) -> Result<Answer, Answer> {
        Ok(Answer::json(&Episodes {
            policy: &self.policy.name(),
            env_steps: self.env_steps,
            design: self.assembly().policy.design(&self.params),
            seed: self.seed(),
            scene: self.scene(&self.built(), &self.choice).map_err(failed)?,
        }))
    }

    fn compared(&self, values: &[(String, f64)]) -> Result<Answer, Answer> {
        let assembly = self.assembly();
        let design = assembly.policy.design(&self.params);
        let changed = changed(assembly, &design, values).map_err(|e| Answer::fault(StatusCode::BAD_REQUEST, &e))?;
        let (before, after) = (self.built(), assembly.worlds.training.law.as_built(&changed));
        let reference = Reference::new(assembly, &before, &self.params, (JUDGED, self.seed()), &Serial).map_err(failed)?;
        let (evaluation, change) = reference.against(&after, &self.params).map_err(failed)?;
        let first = &self.choice[..self.choice.len().min(1)];
        let judged = |design, built: &[f64], evaluation| -> Result<Judged, Answer> {
            Ok(Judged { design, scene: self.scene(built, first).map_err(failed)?, evaluation })
        };
        Ok(Answer::json(&Comparison {
            policy: &self.policy.name(),
            env_steps: self.env_steps,
            seed: self.seed(),
            before: judged(design, &before, reference.evaluation.clone())?,
            after: judged(changed, &after, evaluation)?,
            change,
        }))
    }
}

/// A design with other values.
fn changed(assembly: &Assembly, design: &[f64], values: &[(String, f64)]) -> Result<Vec<f64>, String> {
    let space = assembly.policy.space();
    let (names, mut changed) = (space.names(), design.to_vec());
    for (name, value) in values {
        let place = names.iter().position(|known| known == name);
        let place = place.ok_or_else(|| format!("{name} is no design parameter; they are {}", names.join(", ")))?;
        let (low, high) = space.bounds(place);
        if !(low..=high).contains(value) {
            let unit = space.group_of(place).dimension.si();
            return Err(format!("{name} = {} {unit} is outside [{}, {}]", show(*value), show(low), show(high)));
        }
        changed[place] = *value;
    }
    Ok(changed)
}

fn failed(error: EvaluateError) -> Answer {
    Answer::fault(StatusCode::CONFLICT, &format!("no episode could be simulated: {error}"))
}

fn title(run: &Path) -> String {
    run.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}
