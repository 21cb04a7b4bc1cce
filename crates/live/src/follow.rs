//! One run, followed by what lies in its folder. Whoever writes it is never in the way, and need not be asked.

use std::fs::{self, File};
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use hwasp_experiment::{Catalogue, EXPERIMENT};
use hwasp_problem::Role;
use hwasp_runs::{
    CHECKPOINTS, LOG, METRICS, POLICY, PROVENANCE, Provenance, SUMMARY, Summary, Writers, saved_provenance,
    saved_summary,
};
use hwasp_settings::text::printable_lines;
use serde::Serialize;

use crate::about::{About, DesignGroup};
use crate::curve::Curve;
use crate::stamp::Stamp;

/// A run that nobody holds counts as interrupted when nothing was written for so long, s: not every system tells who holds it.
const PATIENCE: f64 = 10.0;
/// Bytes of a log from which the last lines are taken.
const LOG_BYTES: u64 = 16 << 10;
/// Lines of a log.
const LOG_LINES: usize = 60;

/// Where a training stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum State {
    Training,
    Finished,
    Interrupted,
    /// Its folder is no longer there.
    Gone,
}

/// The parameters that there are of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Policy {
    /// Those it began with.
    First,
    /// Those of a checkpoint, after so many iterations.
    Checkpoint(u64, Stamp),
    /// Those it came to.
    Last(Stamp),
}

impl Policy {
    /// What tells it from the others of a run.
    pub(crate) fn name(self) -> String {
        match self {
            Self::First => "first".to_owned(),
            Self::Checkpoint(iteration, _) => format!("checkpoint-{iteration}"),
            Self::Last(_) => "last".to_owned(),
        }
    }
}

/// What was found of a file: its stamp at that time, and what was in it.
type Found<T> = (Option<Stamp>, T);

/// A run that is followed.
pub(crate) struct Follower {
    pub(crate) path: PathBuf,
    /// What it is called in the list.
    pub(crate) label: String,
    about: Found<About>,
    provenance: Found<Option<Provenance>>,
    table: Found<Curve>,
    summary: Found<Result<Option<Summary>, String>>,
    log: Found<Vec<String>>,
    pub(crate) state: State,
    pub(crate) policy: Policy,
    /// How often its curve began anew.
    epoch: u64,
    /// How often something was new.
    pub(crate) version: u64,
}

/// A row of the list of runs.
#[derive(Debug, Serialize)]
pub(crate) struct Overview<'a> {
    index: usize,
    label: &'a str,
    state: State,
    experiment: Option<&'a str>,
    problem: Option<&'a str>,
    method: Option<&'a str>,
    seed: Option<u64>,
    started_unix_s: Option<u64>,
    env_steps: u64,
    budget: Option<u64>,
    wall_s: f64,
    steps_per_s: Option<f64>,
    left_s: Option<f64>,
    #[serde(rename = "return")]
    undiscounted_return: Option<f64>,
    version: u64,
}

/// What a browser has of a curve already.
#[derive(Debug, Default)]
pub(crate) struct Since {
    pub(crate) epoch: String,
    pub(crate) width: u64,
    pub(crate) points: usize,
}

/// Everything about a run but its episodes.
#[derive(Debug, Serialize)]
pub(crate) struct Detail<'a> {
    #[serde(flatten)]
    overview: Overview<'a>,
    about: &'a str,
    faults: Vec<String>,
    curve: Points<'a>,
    design: Vec<Group<'a>>,
    summary: Option<&'a Summary>,
    policy: String,
    /// Whether episodes can be simulated here.
    simulates: bool,
    log: &'a [String],
}

/// The points of a curve from `from` on; those before are with the browser.
#[derive(Debug, Serialize)]
struct Points<'a> {
    epoch: String,
    width: u64,
    from: usize,
    env_steps: Vec<u64>,
    wall_s: Vec<f64>,
    columns: Vec<Column<'a>>,
}

#[derive(Debug, Serialize)]
struct Column<'a> {
    name: &'a str,
    /// `return`, `learner`, `reward` or `design`.
    kind: &'static str,
    meaning: &'a str,
    unit: &'a str,
    to_si: f64,
    /// Its value in the last row, of which the points may have only a mean.
    last: Option<f64>,
    values: Vec<Option<f32>>,
}

#[derive(Debug, Serialize)]
struct Group<'a> {
    #[serde(flatten)]
    about: &'a DesignGroup,
    /// The newest total, SI.
    total: Option<f64>,
    /// Single values, SI, where they are known.
    values: Option<&'a [f64]>,
}

impl Follower {
    pub(crate) fn new(path: PathBuf, label: String) -> Self {
        Self {
            path,
            label,
            about: (None, About::default()),
            provenance: (None, None),
            table: (None, Curve::default()),
            summary: (None, Ok(None)),
            log: (None, Vec::new()),
            state: State::Training,
            policy: Policy::First,
            epoch: 0,
            version: 0,
        }
    }

    /// Looks at the folder again.
    pub(crate) fn refresh(&mut self, writers: &Writers, catalogue: &Catalogue) {
        let mut new = false;
        let run = self.path.clone();
        let mut due = |file: &str, before: &mut Option<Stamp>| {
            let stamp = Stamp::of(&run.join(file));
            let due = *before != stamp;
            *before = stamp;
            new |= due;
            due
        };
        if due(EXPERIMENT, &mut self.about.0) {
            // Another experiment is another run, of which nothing is known yet.
            self.about.1 = if self.about.0.is_some() { About::read(&run, catalogue) } else { About::default() };
            self.table = (None, Curve::default());
            self.epoch += 1;
        }
        if due(PROVENANCE, &mut self.provenance.0) {
            self.provenance.1 = self.provenance.0.and_then(|_| saved_provenance(&run).ok().flatten());
        }
        if due(METRICS, &mut self.table.0) {
            let anew = if self.table.0.is_some() {
                self.table.1.update(&run, &run.join(METRICS))
            } else {
                self.table.1 = Curve::default();
                true
            };
            self.epoch += u64::from(anew);
        }
        if due(SUMMARY, &mut self.summary.0) {
            let read = self.summary.0.map(|_| saved_summary(&run).map_err(|error| error.to_string()));
            self.summary.1 = read.transpose();
        }
        if due(LOG, &mut self.log.0) {
            self.log.1 = if self.log.0.is_some() { last_lines(&run.join(LOG)).unwrap_or_default() } else { Vec::new() };
        }
        let now = (self.standing(writers), self.newest());
        new |= now != (self.state, self.policy);
        (self.state, self.policy) = now;
        self.version += u64::from(new);
    }

    fn standing(&self, writers: &Writers) -> State {
        let written = [self.table.0, self.about.0].into_iter().flatten().filter_map(Stamp::unix_s).fold(0.0, f64::max);
        let age = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |now| now.as_secs_f64()) - written;
        if self.about.0.is_none() {
            State::Gone
        } else if self.summary.0.is_some() {
            State::Finished
        } else if writers.write_to(&self.path) || age < PATIENCE {
            State::Training
        } else {
            State::Interrupted
        }
    }

    fn newest(&self) -> Policy {
        if let Some(stamp) = Stamp::of(&self.path.join(POLICY)) {
            return Policy::Last(stamp);
        }
        let number = |name: &str| name.strip_prefix("iteration-")?.strip_suffix(".safetensors")?.parse::<u64>().ok();
        let entries = fs::read_dir(self.path.join(CHECKPOINTS)).into_iter().flatten().flatten();
        let newest = entries.filter_map(|entry| Some((number(entry.file_name().to_str()?)?, entry.path()))).max();
        newest.and_then(|(n, path)| Some(Policy::Checkpoint(n, Stamp::of(&path)?))).unwrap_or(Policy::First)
    }

    /// What tells this experiment from another one in the same folder.
    pub(crate) fn experiment(&self) -> Option<Stamp> {
        self.about.0
    }

    /// Why nothing of it can be simulated, where that is so.
    pub(crate) fn unsimulated(&self) -> Option<&str> {
        if self.state == State::Gone {
            Some("the run folder is no longer there")
        } else {
            self.about.1.fault.as_deref()
        }
    }

    pub(crate) fn overview(&self, index: usize) -> Overview<'_> {
        let (head, curve) = (&self.about.1.head, &self.table.1);
        let summary = self.summary.1.as_ref().ok().and_then(Option::as_ref);
        let last = curve.last.as_ref();
        let env_steps = last.map_or(0, |row| row.env_steps);
        let steps_per_s = summary.map(|s| s.steps_per_s).or_else(|| curve.steps_per_s());
        let budget = head.train.env_steps;
        let left = budget.zip(steps_per_s).map(|(budget, rate)| budget.saturating_sub(env_steps) as f64 / rate);
        Overview {
            index,
            label: &self.label,
            state: self.state,
            experiment: head.name.as_deref(),
            problem: head.task.problem.as_deref(),
            method: head.method.as_deref(),
            seed: head.seed,
            started_unix_s: self.provenance.1.as_ref().map(|provenance| provenance.started_unix_s),
            env_steps,
            budget,
            wall_s: last.map_or(0.0, |row| row.wall_s),
            steps_per_s,
            left_s: left.filter(|left| self.state == State::Training && left.is_finite()),
            undiscounted_return: last.map(|row| row.undiscounted_return).filter(|value| value.is_finite()),
            version: self.version,
        }
    }

    /// Everything, with the points of the curve that a browser does not have. `server`: what tells this server from another.
    pub(crate) fn detail(&self, index: usize, server: &str, since: &Since) -> Detail<'_> {
        let (about, curve) = (&self.about.1, &self.table.1);
        let epoch = format!("{server}-{}", self.epoch);
        let known = since.epoch == epoch && since.width == curve.width && since.points <= curve.points.len();
        // The last of those that it has may have grown.
        let from = if known { since.points.saturating_sub(1) } else { 0 };
        let points = &curve.points[from..];
        let summary = self.summary.1.as_ref().ok().and_then(Option::as_ref);
        let design = about.design.iter().enumerate().map(|(i, group)| {
            let built = summary.and_then(|summary| summary.design.get(&group.name));
            let total = curve.last.as_ref().and_then(|row| row.design_totals.get(i).copied());
            Group {
                about: group,
                total: built.map(|built| built.total).or(total),
                values: built.map(|built| &built.values[..]),
            }
        });
        let faults = [about.fault.as_ref(), curve.fault.as_ref(), self.summary.1.as_ref().err()];
        Detail {
            overview: self.overview(index),
            about: &about.told,
            faults: faults.into_iter().flatten().cloned().collect(),
            design: design.collect(),
            summary,
            policy: self.policy.name(),
            simulates: self.unsimulated().is_none(),
            log: &self.log.1,
            curve: Points {
                epoch,
                width: curve.width,
                from,
                env_steps: points.iter().map(|point| point.env_steps).collect(),
                wall_s: points.iter().map(|point| point.wall_s).collect(),
                columns: self.columns(from),
            },
        }
    }

    fn columns(&self, from: usize) -> Vec<Column<'_>> {
        let (about, curve) = (&self.about.1, &self.table.1);
        let names = &curve.names;
        let fixed = [
            ("return", "the mean over the training episodes of an iteration, which have noise; undiscounted"),
            ("discounted_return", "the mean over the training episodes of an iteration, which have noise"),
        ];
        let fixed = fixed.map(|(name, meaning)| (name, "return", meaning, ("", 1.0)));
        let learner = names.learner.iter().map(|name| (name.as_str(), "learner", "", ("", 1.0)));
        let meaning = |name| about.words.meaning(Role::Reward, name).unwrap_or_default();
        let terms = names.terms.iter().map(|name| (name.as_str(), "reward", meaning(name), ("", 1.0)));
        let totals = names.design_totals.iter().enumerate().map(|(i, name)| {
            let group = about.design.get(i);
            let unit = group.map_or(("", 1.0), |group| (group.unit, group.to_si));
            (name.as_str(), "design", group.map_or("", |group| &group.meaning), unit)
        });
        let last: Vec<f64> = curve.last.iter().flat_map(crate::curve::columns).collect();
        let others = crate::curve::LAST.map(|(name, meaning)| (name, "learner", meaning, ("", 1.0)));
        let all = fixed.into_iter().chain(learner).chain(terms).chain(totals).chain(others);
        let column = |(i, (name, kind, meaning, (unit, to_si)))| {
            let value = |value: f64| value.is_finite().then_some(value);
            let values = curve.points[from..].iter().map(|point| value(point.mean(i)).map(|mean| mean as f32));
            let last = last.get(i).copied().and_then(value);
            Column { name, kind, meaning, unit, to_si, last, values: values.collect() }
        };
        // A table without a header has no columns.
        let count = if curve.width == 0 { 0 } else { usize::MAX };
        all.enumerate().take(count).map(column).collect()
    }
}

/// The last lines of a log, fit to be shown.
fn last_lines(path: &Path) -> std::io::Result<Vec<String>> {
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    let start = length.saturating_sub(LOG_BYTES);
    file.seek(SeekFrom::Start(start))?;
    let mut bytes = Vec::new();
    file.take(LOG_BYTES).read_to_end(&mut bytes)?;
    let text = printable_lines(&String::from_utf8_lossy(&bytes));
    // The first line may have lost its beginning.
    let lines: Vec<&str> = text.lines().skip(usize::from(start > 0)).collect();
    Ok(lines[lines.len().saturating_sub(LOG_LINES)..].iter().map(|line| (*line).to_owned()).collect())
}
