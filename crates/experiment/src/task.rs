//! `[task]`: the problem and its physics.

use std::fmt;
use std::sync::Arc;

use hwasp_core::{Initial, Port};
use hwasp_problem::{AnyProblem, Built, FaultsTold};
use hwasp_settings::{AnySettings, Item, Keys, Section, described, either, listed, read, written};

use crate::built::{COMMON_KEYS, MOST_STEPS, build};
use crate::catalogue::Catalogue;
use crate::group::Group;

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
    pub fn efforts(&self) -> &[Port] {
        &self.built.training.env.effort
    }

    /// The design parameters, named and limited as the problem's law has them.
    pub fn groups(&self) -> Vec<Group> {
        let mut first = 0;
        let shaped_by = &self.built.training.env.shaped_by;
        let groups = self.built.training.law.design().groups().iter().map(|group| {
            let &hwasp_core::DesignGroup { dimension, count, lo, hi, initial, .. } = group;
            let initial = if let Initial::Value(value) = initial { Some(value) } else { None };
            first += count;
            let shapes_world = shaped_by.contains(&group.name);
            Group { name: group.name.clone(), first: first - count, dimension, count, lo, hi, initial, shapes_world }
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
            Err(error) if error.is::<FaultsTold>() => {
                section.take("horizon");
                None
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
        section.refuse(&key, &format!("it is for problem = {}, and this is {}", either(&owners), problem.name()));
    }
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
