//! Problems that a program brings along: a law, a plant and a task of one's own, trained from experiment files like the
//! others.

use std::error::Error;
use std::fmt;
use std::ops::RangeInclusive;
use std::sync::{Mutex, PoisonError, RwLock};

use hwasp_core::{Dimension, EnvSpec};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use thiserror::Error;

use super::section::Section;
use super::task::{GroupSpec, MOST_STEPS, ProblemKind};
use super::values::with_unit;
use crate::worlds::Problems;

/// Whatever a problem of one's own finds wrong.
type AnyError = Box<dyn Error + Send + Sync>;
type Build = dyn Fn(&[f64]) -> Result<Problems, AnyError> + Send + Sync;

/// Keys of `[task]` that every problem has.
const COMMON: [&str; 2] = ["problem", "horizon"];

/// A quantity that experiments may set in `[task]`, in SI.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// Its key.
    pub name: &'static str,
    /// What it measures.
    pub dimension: Dimension,
    /// Its value where the experiment says nothing.
    pub default: f64,
    /// The values that it may have.
    pub limits: RangeInclusive<f64>,
}

/// A problem that a program brings along, for [`register`].
///
/// Experiment files name it in `task.problem` and set its [`Setting`]s below; checking, training, run folders, evaluation,
/// comparisons and drawings are those of every other problem. What experiments say of the design (names, units, limits)
/// and of the ports is read off the law and the environment that it builds.
pub struct OwnProblem {
    name: &'static str,
    settings: Vec<Setting>,
    build: Box<Build>,
}

/// Why a problem cannot be registered.
#[derive(Debug, Error)]
pub enum OwnError {
    /// A name that cannot be written into an experiment, or means something else there.
    #[error("problem `{name}`: {why}; name it in lower-case letters, digits and hyphens, as no other problem is")]
    Name {
        /// The name.
        name: String,
        /// What is wrong with it.
        why: &'static str,
    },
    /// A setting that no experiment could have.
    #[error("problem `{problem}`: the setting `{name}` {why}")]
    Setting {
        /// The problem.
        problem: &'static str,
        /// The setting.
        name: &'static str,
        /// What is wrong with it.
        why: String,
    },
    /// The problem with the defaults of its settings.
    #[error("problem `{problem}`: {source}")]
    Build {
        /// The problem.
        problem: &'static str,
        /// What is wrong.
        source: AnyError,
    },
}

/// The program's own problems. They belong to it as its code does, and stay for as long as it runs.
static OWN: RwLock<&[&OwnProblem]> = RwLock::new(&[]);

/// Says which problems this program brings along, beside those of this crate. To be called before experiments or run folders
/// are read; what was said before is replaced.
///
/// # Errors
/// Where names clash, or a problem cannot be built with the defaults of its settings; nothing is registered then.
pub fn register(problems: impl IntoIterator<Item = OwnProblem>) -> Result<(), OwnError> {
    let problems: Vec<OwnProblem> = problems.into_iter().collect();
    for (i, problem) in problems.iter().enumerate() {
        problem.check(&problems[..i])?;
    }
    // Specs refer to them, and there are as many as the program's source has.
    let kept = problems.into_iter().map(|problem| &*Box::leak(Box::new(problem))).collect::<Vec<_>>();
    *OWN.write().unwrap_or_else(PoisonError::into_inner) = Vec::leak(kept);
    Ok(())
}

/// The problems of [`register`].
pub fn registered() -> &'static [&'static OwnProblem] {
    *OWN.read().unwrap_or_else(PoisonError::into_inner)
}

impl OwnProblem {
    /// A problem of that name. `build` is given a value for each setting, in their order and within their limits (SI), and
    /// returns law and environments; both are to be the same whenever the settings are.
    ///
    /// ```
    /// use hwasp_core::Dimension;
    /// use hwasp_training::Problems;
    /// use hwasp_training::spec::{OwnProblem, Setting};
    /// use hwasp_tasks::reach::{Reach, ReachSettings};
    ///
    /// let goal = Setting { name: "goal", dimension: Dimension::Length, default: 0.25, limits: -1.0..=1.0 };
    /// let problem = OwnProblem::new("my-reach", [goal], |[goal]| {
    ///     let reach = Reach::new(ReachSettings { goal, ..ReachSettings::default() })?;
    ///     Ok(Problems::new(reach.law(), reach))
    /// });
    /// hwasp_training::spec::register([problem])?;
    /// # Ok::<(), hwasp_training::spec::OwnError>(())
    /// ```
    pub fn new<const N: usize>(
        name: &'static str,
        settings: [Setting; N],
        build: impl Fn([f64; N]) -> Result<Problems, AnyError> + Send + Sync + 'static,
    ) -> Self {
        let build = move |values: &[f64]| build(std::array::from_fn(|i| values[i]));
        Self { name, settings: settings.into(), build: Box::new(build) }
    }

    /// What experiments call it.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// What experiments may set of it.
    pub fn settings(&self) -> &[Setting] {
        &self.settings
    }

    /// The problem with the defaults of its settings, for tests of it.
    pub fn usual(&self) -> Result<Problems, AnyError> {
        let values: Vec<f64> = self.settings.iter().map(|setting| setting.default).collect();
        self.built(&values).map(|(problem, _)| problem)
    }

    fn check(&self, others: &[Self]) -> Result<(), OwnError> {
        let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
        let why = match self.name {
            "" => Some("the name is empty"),
            name if !name.chars().all(plain) => Some("the name has other characters"),
            name if ProblemKind::from_name(name).is_some() => Some("a problem that comes with hwasp has this name"),
            name if others.iter().any(|other| other.name == name) => Some("two problems have this name"),
            _ => None,
        };
        if let Some(why) = why {
            return Err(OwnError::Name { name: self.name.to_owned(), why });
        }
        for (i, Setting { name, dimension, default, limits }) in self.settings.iter().enumerate() {
            let (lo, hi) = (*limits.start(), *limits.end());
            let why = if COMMON.contains(name) {
                Some("has the name of a key that every problem has".to_owned())
            } else if self.settings[..i].iter().any(|other| other.name == *name) {
                Some("is there twice".to_owned())
            } else if !(lo.is_finite() && hi.is_finite() && limits.contains(default)) {
                let [default, lo, hi] = [*default, lo, hi].map(|value| with_unit(value, *dimension));
                Some(format!("is {default} by default, which is not inside [{lo}, {hi}]"))
            } else {
                None
            };
            if let Some(why) = why {
                return Err(OwnError::Setting { problem: self.name, name, why });
            }
        }
        self.usual().map(drop).map_err(|source| OwnError::Build { problem: self.name, source })
    }

    /// The problem for values of its settings, and what its environments are from outside.
    fn built(&self, values: &[f64]) -> Result<(Problems, EnvSpec), AnyError> {
        let problem = (self.build)(values)?;
        let env = problem.training.make.make(None).spec().clone();
        let groups = problem.training.law.design().groups();
        if groups.is_empty() {
            return Err("the law has no design parameter, so that there is nothing to design".into());
        }
        if problem.optimum.len() != groups.len() {
            let (given, needed) = (problem.optimum.len(), groups.len());
            return Err(format!("the optimum of {given} design groups is given, but there are {needed}").into());
        }
        if env.effort.iter().any(|port| port.dimension != env.effort[0].dimension) {
            return Err("its efforts measure different things; the exploration of efforts has one size for all".into());
        }
        if !(1..=MOST_STEPS).contains(&env.horizon) {
            return Err(format!("its horizon is {} steps, not between 1 and {MOST_STEPS}", env.horizon).into());
        }
        Ok((problem, env))
    }

    /// Reads the settings and the horizon and builds the problem. None where it cannot be built.
    pub(super) fn read(&'static self, s: &mut Section<'_>) -> Option<(usize, OwnTask)> {
        let values: Vec<f64> = self
            .settings
            .iter()
            .map(|Setting { name, dimension, default, limits }| s.quantity(name, *dimension, *default, limits))
            .collect();
        match self.built(&values) {
            Ok((built, env)) => {
                let horizon = s.count("horizon", env.horizon, 1..=MOST_STEPS);
                Some((horizon, OwnTask { problem: self, values, built, env }))
            }
            Err(error) => {
                let message = format!("the problem {} cannot be built: {error}", self.name);
                s.clash("problem", message, "see the settings in [task], and the program's source");
                None
            }
        }
    }
}

impl fmt::Debug for OwnProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("OwnProblem").field("name", &self.name).field("settings", &self.settings).finish_non_exhaustive()
    }
}

/// A problem that the program brings along, with its settings.
#[derive(Clone)]
pub struct OwnTask {
    problem: &'static OwnProblem,
    /// One for each setting, SI.
    values: Vec<f64>,
    built: Problems,
    /// Of `built`.
    env: EnvSpec,
}

impl OwnTask {
    /// What experiments call it.
    pub fn name(&self) -> &'static str {
        self.problem.name
    }

    /// Law and environments.
    pub(crate) fn built(&self) -> &Problems {
        &self.built
    }

    pub(super) fn env(&self) -> &EnvSpec {
        &self.env
    }

    pub(super) fn groups(&self) -> Vec<GroupSpec> {
        let mut first = 0;
        let groups = self.built.training.law.design().groups().iter().map(|group| {
            let spec = GroupSpec {
                name: interned(&group.name),
                first,
                dimension: group.dimension,
                count: group.count,
                lo: group.lo,
                hi: group.hi,
            };
            first += group.count;
            spec
        });
        groups.collect()
    }
}

/// A name for as long as the program runs. The names of design groups stand in its source, so that there are few.
fn interned(name: &str) -> &'static str {
    static NAMES: Mutex<Vec<&'static str>> = Mutex::new(Vec::new());
    let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = names.iter().find(|known| **known == name) {
        return known;
    }
    let name: &'static str = Box::leak(name.into());
    names.push(name);
    name
}

impl PartialEq for OwnTask {
    fn eq(&self, other: &Self) -> bool {
        self.problem.name == other.problem.name && self.values == other.values
    }
}

impl fmt::Debug for OwnTask {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("OwnTask").field("problem", &self.problem).field("values", &self.values).finish_non_exhaustive()
    }
}

impl Serialize for OwnTask {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(1 + self.values.len()))?;
        map.serialize_entry("problem", self.problem.name)?;
        for (Setting { name, dimension, .. }, value) in self.problem.settings.iter().zip(&self.values) {
            map.serialize_entry(name, &with_unit(*value, *dimension))?;
        }
        map.end()
    }
}
