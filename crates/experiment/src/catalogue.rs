//! What experiments may name: problems and learners.

use std::sync::Arc;

use hwasp_algos::LearnerKind;
use hwasp_problem::{AnyError, AnyProblem, FaultsTold, Preset};
use hwasp_settings::described;
use thiserror::Error;

use crate::built::{COMMON_KEYS, build};

/// Problems and learners, by name. It is a value that the caller hands over: two can live in one process.
///
/// Those that come with the program and those that somebody brings along enter in the same way:
///
/// ```
/// use hwasp_algos::PpoKind;
/// use hwasp_experiment::{Catalogue, Layers, resolve};
/// # use hwasp_problem::{AnyError, Built, Problem};
/// # struct Lamp;
/// # impl Problem for Lamp {
/// #     type Settings = ();
/// #     fn name(&self) -> &str { "lamp" }
/// #     fn defaults(&self) {}
/// #     fn build(&self, (): &()) -> Result<Built, AnyError> { Err("not built in this example".into()) }
/// # }
///
/// let catalogue = Catalogue::default().with_learner(PpoKind)?;
/// assert_eq!(catalogue.with(Lamp).unwrap_err().to_string(), "problem `lamp`: not built in this example");
/// # Ok::<(), hwasp_experiment::CatalogueError>(())
/// ```
#[derive(Clone, Default)]
pub struct Catalogue {
    problems: Vec<Arc<dyn AnyProblem>>,
    learners: Vec<Arc<dyn LearnerKind>>,
}

/// Why a problem or a learner cannot be in a catalogue. Its `Debug` is its message, so that `main` may return it.
#[derive(Error)]
pub enum CatalogueError {
    /// A name that cannot be written into an experiment, or means something else there.
    #[error("{what} `{name}`: {why}; name it in lower-case letters, digits and hyphens, as no other is named")]
    Name {
        /// Problem or learner.
        what: &'static str,
        /// The name.
        name: String,
        /// What is wrong with it.
        why: &'static str,
    },
    /// A setting that no experiment could have.
    #[error("problem `{problem}`: the setting `{key}` {why}")]
    Setting {
        /// The problem.
        problem: String,
        /// The setting.
        key: String,
        /// What is wrong with it.
        why: &'static str,
    },
    /// The problem with the defaults of its settings.
    #[error("problem `{problem}`: {source}")]
    Build {
        /// The problem.
        problem: String,
        /// What is wrong.
        source: AnyError,
    },
}

impl std::fmt::Debug for CatalogueError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{self}")
    }
}

impl Catalogue {
    /// The same with one problem more.
    ///
    /// # Errors
    /// Where its name or a setting's cannot be, or is taken; where it cannot be built with the defaults of its settings.
    pub fn with(self, problem: impl AnyProblem + 'static) -> Result<Self, CatalogueError> {
        self.with_shared(Arc::new(problem))
    }

    /// The same of a problem that is shared already.
    pub fn with_shared(mut self, problem: Arc<dyn AnyProblem>) -> Result<Self, CatalogueError> {
        let name = problem.name().to_owned();
        check_name("problem", &name, self.problems.iter().any(|other| other.name() == name))?;
        let fields = described(&mut *problem.defaults());
        for (i, field) in fields.iter().enumerate() {
            let why = if COMMON_KEYS.contains(&field.key.as_str()) {
                "has the name of a key that every problem has"
            } else if fields[..i].iter().any(|other| other.key == field.key) {
                "is there twice"
            } else {
                continue;
            };
            return Err(CatalogueError::Setting { problem: name, key: field.key.clone(), why });
        }
        match build(&*problem, &*problem.defaults()) {
            // One that needs settings: a model, for one.
            Err(source) if !source.is::<FaultsTold>() => return Err(CatalogueError::Build { problem: name, source }),
            _ => {}
        }
        self.problems.push(problem);
        Ok(self)
    }

    /// The same without a problem; as it is where there is none of this name.
    #[must_use]
    pub fn without(&self, name: &str) -> Self {
        let problems = self.problems.iter().filter(|problem| problem.name() != name).cloned().collect();
        Self { problems, learners: self.learners.clone() }
    }

    /// The same with one learner more. The first one is what an experiment gets that does not choose.
    ///
    /// # Errors
    /// Where its name cannot be, or is taken.
    pub fn with_learner(mut self, learner: impl LearnerKind + 'static) -> Result<Self, CatalogueError> {
        let name = learner.name();
        check_name(
            "learner",
            name,
            SECTIONS.contains(&name) || self.learners.iter().any(|other| other.name() == name),
        )?;
        self.learners.push(Arc::new(learner));
        Ok(self)
    }

    /// The problems, in the order in which they came.
    pub fn problems(&self) -> &[Arc<dyn AnyProblem>] {
        &self.problems
    }

    /// The learners, in the order in which they came.
    pub fn learners(&self) -> &[Arc<dyn LearnerKind>] {
        &self.learners
    }

    /// The experiments that come with the problems.
    pub fn presets(&self) -> Vec<Preset> {
        let all = self.problems.iter().flat_map(|problem| problem.presets());
        // Those of the paper last.
        let (paper, own): (Vec<_>, Vec<_>) = all.partition(|preset| preset.name.contains('/'));
        own.into_iter().chain(paper).collect()
    }
}

/// Tables of an experiment that are not a learner's.
pub(crate) const SECTIONS: [&str; 14] = [
    "task",
    "controller",
    "design",
    "noise",
    "learner",
    "baseline",
    "search",
    "cmaes",
    "ars",
    "bo",
    "random",
    "train",
    "polish",
    "methods",
];

fn check_name(what: &'static str, name: &str, taken: bool) -> Result<(), CatalogueError> {
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    let why = if name.is_empty() {
        "the name is empty"
    } else if !name.chars().all(plain) {
        "the name has other characters"
    } else if taken {
        "the name is taken"
    } else {
        return Ok(());
    };
    Err(CatalogueError::Name { what, name: name.to_owned(), why })
}

impl std::fmt::Debug for Catalogue {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let problems: Vec<&str> = self.problems.iter().map(|problem| problem.name()).collect();
        let learners: Vec<&str> = self.learners.iter().map(|learner| learner.name()).collect();
        f.debug_struct("Catalogue").field("problems", &problems).field("learners", &learners).finish()
    }
}
