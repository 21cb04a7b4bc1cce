//! `[task]`: the problem and its physics.

use std::fmt;
use std::sync::Arc;

use hwasp_core::Dimension;
use hwasp_problem::{AnyError, AnyProblem, Built};
use hwasp_settings::{AnySettings, Item, Keys, Section, described, listed, read, written};

use crate::catalogue::Catalogue;
use crate::design::Group;

/// The longest episode, steps.
pub const MOST_STEPS: usize = 100_000;
/// Keys of `[task]` that every problem has.
pub(crate) const COMMON_KEYS: [&str; 2] = ["problem", "horizon"];
/// Columns of a learning curve that are not a design group's.
const COLUMNS: [&str; 5] = ["iteration", "env_steps", "wall_s", "discounted_return", "return"];
/// The longest name of a design group, bytes.
const LONGEST_NAME: usize = 58;

/// `[task]`: a problem with its settings, built.
#[derive(Clone)]
pub struct Task {
    /// Steps of an evaluation episode, and the most of a training one.
    pub horizon: usize,
    problem: Arc<dyn AnyProblem>,
    settings: Box<dyn AnySettings>,
    built: Arc<Built>,
}

impl Task {
    /// What experiments call the problem.
    pub fn name(&self) -> &str {
        self.problem.name()
    }

    /// Its settings, of a type that the caller knows.
    pub fn settings<S: 'static>(&self) -> Option<&S> {
        self.settings.as_any().downcast_ref()
    }

    /// The problem with these settings.
    pub fn built(&self) -> &Built {
        &self.built
    }

    /// How many numbers the controller sees.
    pub fn observations(&self) -> usize {
        self.built.training.env.observation.len()
    }

    /// How many commands the controller gives.
    pub fn commands(&self) -> usize {
        self.built.training.env.command.len()
    }

    /// What the law hands to the plant.
    pub fn effort_dimension(&self) -> Dimension {
        self.built.training.env.effort.first().map_or(Dimension::None, |port| port.dimension)
    }

    /// The design parameters, named and limited as the problem's law has them.
    pub fn groups(&self) -> Vec<Group> {
        let mut first = 0;
        let groups = self.built.training.law.design().groups().iter().map(|group| {
            let &hwasp_core::DesignGroup { dimension, count, lo, hi, .. } = group;
            first += count;
            Group { name: group.name.clone(), first: first - count, dimension, count, lo, hi }
        });
        groups.collect()
    }

    /// The table as it is written.
    pub(crate) fn written(&self) -> Keys {
        let mut keys = Keys::default();
        keys.push("horizon", Item::Integer(self.horizon as u64));
        keys.push("problem", Item::from(self.name()));
        keys.0.extend(written(&mut *self.settings.clone()).0);
        keys
    }

    /// Reads the table; what is wrong in it becomes the default. None where the problem itself is not known, or cannot be.
    pub(crate) fn read(mut section: Section<'_>, catalogue: &Catalogue) -> Option<Self> {
        let choices: Vec<(&str, &Arc<dyn AnyProblem>)> =
            catalogue.problems().iter().map(|problem| (problem.name(), problem)).collect();
        if !section.has("problem") {
            let hint = format!("set `problem` in [task] to one of {}", listed(choices.iter().map(|(name, _)| *name)));
            section.clash("problem", "task.problem is missing".into(), &hint);
        }
        let problem = section.choice("problem", &choices)?;
        let mut settings = problem.defaults();
        read(&mut *settings, &mut section);
        refuse_foreign(&mut section, &**problem, catalogue);
        let read = match build(&**problem, &*settings) {
            Ok(built) => {
                let horizon = section.count("horizon", built.training.env.horizon, 1..=MOST_STEPS);
                Some(Self { horizon, problem: Arc::clone(problem), settings, built: Arc::new(built) })
            }
            Err(error) => {
                section.take("horizon");
                let message = format!("the problem {} cannot be built: {error}", problem.name());
                section.clash("problem", message, "see the settings in [task]");
                None
            }
        };
        section.finish();
        read
    }
}

/// Keys that some problem has, and this one has not.
fn refuse_foreign(section: &mut Section<'_>, problem: &dyn AnyProblem, catalogue: &Catalogue) {
    let keys = |problem: &dyn AnyProblem| {
        described(&mut *problem.defaults()).into_iter().map(|field| field.key).collect::<Vec<String>>()
    };
    let own = keys(problem);
    let mut foreign: Vec<(String, Vec<&str>)> = Vec::new();
    for other in catalogue.problems().iter().filter(|other| other.name() != problem.name()) {
        for key in keys(&**other) {
            if own.contains(&key) || COMMON_KEYS.contains(&key.as_str()) || !section.has(&key) {
                continue;
            }
            match foreign.iter_mut().find(|(known, _)| *known == key) {
                Some((_, owners)) => owners.push(other.name()),
                None => foreign.push((key, vec![other.name()])),
            }
        }
    }
    for (key, owners) in foreign {
        section.refuse(&key, &format!("it is for problem = {}, and this is {}", owners.join(" or "), problem.name()));
    }
}

/// Builds a problem and checks what experiments rely on.
pub(crate) fn build(problem: &dyn AnyProblem, settings: &dyn AnySettings) -> Result<Built, AnyError> {
    let built = problem.build(settings)?;
    let (env, groups) = (&built.training.env, built.training.law.design().groups());
    if groups.is_empty() {
        return Err("the law has no design parameter, so that there is nothing to design".into());
    }
    if built.optimum.len() != groups.len() {
        let (given, needed) = (built.optimum.len(), groups.len());
        return Err(format!("the optimum of {given} design groups is given, but there are {needed}").into());
    }
    if env.effort.iter().any(|port| port.dimension != env.effort[0].dimension) {
        return Err("its efforts measure different things; the exploration of efforts has one size for all".into());
    }
    if !(1..=MOST_STEPS).contains(&env.horizon) {
        return Err(format!("its horizon is {} steps, not between 1 and {MOST_STEPS}", env.horizon).into());
    }
    for group in groups {
        check_group(&group.name)?;
    }
    Ok(built)
}

/// Whether a design group can name a column of a learning curve.
fn check_group(name: &str) -> Result<(), AnyError> {
    let plain = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-');
    let why = if name.is_empty() || name.len() > LONGEST_NAME || !name.chars().all(plain) {
        format!("use 1 to {LONGEST_NAME} letters, digits, `_` and `-`")
    } else if COLUMNS.contains(&name) {
        format!("learning curves have a column of this name, as of {}", listed(COLUMNS))
    } else {
        return Ok(());
    };
    Err(format!("the design group `{}` cannot be called so: {why}", hwasp_settings::text::shorten(name, 60)).into())
}

impl PartialEq for Task {
    fn eq(&self, other: &Self) -> bool {
        (self.name(), self.horizon) == (other.name(), other.horizon) && self.settings.equals(&*other.settings)
    }
}

impl fmt::Debug for Task {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Task")
            .field("problem", &self.name())
            .field("horizon", &self.horizon)
            .field("settings", &self.settings)
            .finish_non_exhaustive()
    }
}
