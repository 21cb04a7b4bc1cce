//! Episodes of a run's controller, on its design and on others.

use std::io;
use std::path::{Path, PathBuf};

use hwasp_core::Serial;
use hwasp_experiment::Catalogue;
use hwasp_runs::{RunError, SavedRun};
use hwasp_scene::{Scene, Studio};
use hwasp_settings::text::show;
use hwasp_training::collect::EpisodeAnswer;
use hwasp_training::{Assembly, Change, EvaluateError, Evaluation, held_out, sampler};
use hyper::StatusCode;
use serde::Serialize;

use crate::answer::Answer;
use crate::follow::Policy;
use crate::stamp::Stamp;

/// Episodes by which a design is judged.
const JUDGED: u64 = 20;
/// Episodes that are shown of a training that goes on: its time is dear.
const WHILE_TRAINING: u64 = 2;
/// Controllers that are kept, at most.
const MOST_OPENED: usize = 4;
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
    /// What such a design is worth more, or less, on more episodes, by the controller of this name.
    Cost(String, Vec<(String, f64)>),
}

/// The controllers whose episodes are asked for, the latest first. Of a training they are kept although it goes on.
#[derive(Default)]
pub(crate) struct Stage {
    opened: Vec<Opened>,
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
    /// How its own design did in the episodes by which others are judged.
    trials: Vec<EpisodeAnswer>,
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
    before: Shown,
    after: Shown,
}

#[derive(Serialize)]
struct Shown {
    design: Vec<f64>,
    scene: Scene,
}

#[derive(Serialize)]
struct Cost {
    before: Evaluation,
    after: Evaluation,
    /// What it changes, episode by episode.
    change: Change,
}

impl Stage {
    /// The answer, and whether it is worth to be kept.
    pub(crate) fn answer(&mut self, asked: &Asked, catalogue: &Catalogue) -> (Answer, bool) {
        let place = self.opened.iter().position(|opened| opened.serves(asked));
        let opened = match place.map_or_else(|| open(asked, catalogue), |place| Ok(self.opened.remove(place))) {
            Ok(opened) => opened,
            Err(error) => return (Answer::fault(StatusCode::CONFLICT, &error), false),
        };
        self.opened.truncate(MOST_OPENED - 1);
        self.opened.insert(0, opened);
        let opened = &mut self.opened[0];
        let answer = match &asked.what {
            What::Episode => opened.episodes(),
            What::Changed(values) => opened.compared(values),
            What::Cost(policy, values) if *policy == opened.policy.name() => opened.cost(values),
            What::Cost(policy, _) => Err(Answer::fault(
                StatusCode::CONFLICT,
                &format!("the controller {policy} is no longer there; the newest is {}", opened.policy.name()),
            )),
        };
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
        choice: (0..WHILE_TRAINING).map(|index| (index, String::new())).collect(),
        trials: Vec::new(),
    };
    if matches!(asked.policy, Policy::Last(_)) {
        opened.choice = opened.studio(&opened.built()).choice().map_err(|error| error.to_string())?;
    }
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
                    Err(RunError::Io { source, .. }) if source.kind() == io::ErrorKind::NotFound => {
                        found = saved.found();
                    }
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
    /// Whether it is what is asked for.
    fn serves(&self, asked: &Asked) -> bool {
        let policy = match &asked.what {
            What::Cost(policy, _) => self.policy.name() == *policy,
            What::Episode | What::Changed(_) => self.policy == asked.policy,
        };
        policy && (&self.run, self.experiment) == (&asked.run, asked.experiment)
    }

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
        let first = &self.choice[..self.choice.len().min(1)];
        let shown = |design: Vec<f64>| -> Result<Shown, Answer> {
            let built = self.assembly().worlds.training.law.as_built(&design);
            Ok(Shown { scene: self.scene(&built, first).map_err(failed)?, design })
        };
        let changed = self.changed(values)?;
        Ok(Answer::json(&Comparison {
            policy: &self.policy.name(),
            env_steps: self.env_steps,
            seed: self.seed(),
            before: shown(self.assembly().policy.design(&self.params))?,
            after: shown(changed)?,
        }))
    }

    fn cost(&mut self, values: &[(String, f64)]) -> Result<Answer, Answer> {
        let changed = self.assembly().worlds.training.law.as_built(&self.changed(values)?);
        if self.trials.is_empty() {
            self.trials = self.tried(&self.built()).map_err(failed)?;
        }
        let trials = self.tried(&changed).map_err(failed)?;
        let (asked, env) = ((JUDGED, self.seed()), &self.assembly().worlds.deployment.env);
        let judged = |trials: &[EpisodeAnswer]| Evaluation::new(trials, env, asked);
        let cost = || {
            let change = Change::of(&self.trials, &trials, asked.1)?;
            Ok(Cost { before: judged(&self.trials)?, after: judged(&trials)?, change })
        };
        cost().map(|cost| Answer::json(&cost)).map_err(failed)
    }

    /// How the controller does on a design as built.
    fn tried(&self, built: &[f64]) -> Result<Vec<EpisodeAnswer>, EvaluateError> {
        let assembly = self.assembly();
        let sampler = sampler(assembly, &assembly.worlds.deployment, built)?;
        let controller = assembly.policy.controller_params(&self.params);
        let discount = assembly.experiment().discount();
        Ok(sampler.outcomes(&Serial, controller, &held_out(self.seed(), 0..JUDGED), discount)?)
    }

    /// The design with other values.
    fn changed(&self, values: &[(String, f64)]) -> Result<Vec<f64>, Answer> {
        let design = self.assembly().policy.design(&self.params);
        changed(self.assembly(), &design, values).map_err(|error| Answer::fault(StatusCode::BAD_REQUEST, &error))
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

#[expect(clippy::needless_pass_by_value, reason = "as `map_err` hands it over")]
fn failed(error: EvaluateError) -> Answer {
    Answer::fault(StatusCode::CONFLICT, &format!("no episode could be simulated: {error}"))
}

fn title(run: &Path) -> String {
    run.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}
