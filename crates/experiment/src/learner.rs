//! The learners of an experiment: all of the catalogue with their settings, and the one that it asks for.

use std::fmt;
use std::sync::Arc;

use hwasp_algos::{BaselineSettings, Learner, LearnerKind, LearnerSetup};
use hwasp_settings::{AnySettings, Section, listed, read};

use crate::train::TrainSettings;

/// `[learner]`, and the table of every learner.
#[derive(Clone)]
pub struct LearnerSettings {
    kinds: Vec<Arc<dyn LearnerKind>>,
    /// One for each of them.
    pub(crate) settings: Vec<Box<dyn AnySettings>>,
    chosen: usize,
}

impl LearnerSettings {
    /// The defaults for iterations of these rows.
    pub(crate) fn new(kinds: &[Arc<dyn LearnerKind>], rows: usize) -> Self {
        let mut settings = Vec::with_capacity(kinds.len());
        for kind in kinds {
            settings.push(kind.defaults(rows, &settings));
        }
        Self { kinds: kinds.to_vec(), settings, chosen: 0 }
    }

    /// Reads the choice and, by their names, the tables. `sound`: whether the iterations are what the file asks for.
    pub(crate) fn read<'r>(
        &mut self,
        choice: &mut Section<'r>,
        mut table: impl FnMut(&str) -> Section<'r>,
        train: &TrainSettings,
        sound: bool,
    ) {
        let names: Vec<(&str, usize)> = self.kinds.iter().enumerate().map(|(i, kind)| (kind.name(), i)).collect();
        let chosen = choice.choice("algorithm", &names).unwrap_or(0);
        for (i, kind) in self.kinds.iter().enumerate() {
            let mut section = table(kind.name());
            let mut own = kind.defaults(train.rows(), &self.settings[..i]);
            read(&mut *own, &mut section);
            // What the others are told may wait until they are asked for.
            let asked = sound && i == chosen;
            if let Some(fault) = kind.fault(&*own, train.rows(), &train.portion()).filter(|_| asked) {
                section.clash(fault.key, fault.message, &fault.hint);
            }
            self.settings[i] = own;
            section.finish();
        }
        self.chosen = chosen;
    }

    /// Whether the chosen one learns from old experience.
    pub fn keeps_experience(&self) -> bool {
        self.kind().keeps_experience()
    }

    /// Whether the chosen one learns how widely commands spread.
    pub fn state_dependent_std(&self) -> bool {
        self.kind().state_dependent_std()
    }

    /// Whether what the chosen one keeps means the same later. `measured`: keys that change what is seen or earned, whether they are
    /// set, and the way out.
    pub(crate) fn check(&self, choice: &mut Section<'_>, measured: [(&str, bool, &str); 2]) {
        for (key, _, hint) in measured.into_iter().filter(|(_, set, _)| *set && self.keeps_experience()) {
            let name = self.algorithm();
            let message =
                format!("learner.algorithm = \"{name}\" keeps old experience, and {key} = true measures it ever anew");
            choice.clash("algorithm", message, hint);
        }
    }

    /// What improves the policy, by name.
    pub fn algorithm(&self) -> &str {
        self.kind().name()
    }

    /// What it is called in prose.
    pub fn title(&self) -> &str {
        self.kind().title()
    }

    /// The names of all that there are.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.kinds.iter().map(|kind| kind.name())
    }

    /// Which of them can be asked for, in words.
    pub(crate) fn listed(&self) -> String {
        listed(self.names())
    }

    fn kind(&self) -> &dyn LearnerKind {
        &*self.kinds[self.chosen]
    }

    /// The defaults of the value baseline beside the chosen one.
    pub(crate) fn baseline(&self, rows: usize) -> BaselineSettings {
        self.kind().baseline(&*self.settings[self.chosen], rows)
    }

    /// The discount that returns are told and candidates scored by.
    pub fn discount(&self) -> f64 {
        self.kind().discount(&*self.settings[self.chosen])
    }

    /// The setting of the chosen one that asks for a design that is drawn once an episode, by its whole key, where it is set.
    pub fn wants_draws(&self) -> Option<String> {
        let key = self.kind().wants_draws(&*self.settings[self.chosen])?;
        Some(format!("{}.{key}", self.algorithm()))
    }

    /// The settings of a learner, of a type that the caller knows.
    pub fn of<S: 'static>(&self) -> Option<&S> {
        self.settings.iter().find_map(|settings| settings.as_any().downcast_ref())
    }

    /// A learner of the chosen kind.
    pub fn learner(&self, setup: LearnerSetup) -> Box<dyn Learner> {
        self.kind().learner(&*self.settings[self.chosen], setup)
    }
}

impl PartialEq for LearnerSettings {
    fn eq(&self, other: &Self) -> bool {
        self.algorithm() == other.algorithm() && self.settings == other.settings
    }
}

impl fmt::Debug for LearnerSettings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LearnerSettings")
            .field("algorithm", &self.algorithm())
            .field("settings", &self.settings)
            .finish_non_exhaustive()
    }
}
