//! Learners by name: what an experiment needs to know of one that it may ask for.

use std::sync::Arc;

use hwasp_core::HardwarePolicy;
use hwasp_settings::AnySettings;

use crate::baseline::BaselineConfig;
use crate::gae::AdvantageConfig;
use crate::learner::Learner;
use crate::ppo::{Ppo, PpoConfig, PpoSettings};
use crate::settings::BaselineSettings;
use crate::trpo::{Trpo, TrpoConfig, TrpoSettings};

/// What a learner is made of, beside its own settings.
#[derive(Clone, Debug)]
pub struct LearnerSetup {
    /// The policy.
    pub policy: Arc<HardwarePolicy>,
    /// Its parameters at the start.
    pub params: Vec<f32>,
    /// The root seed, which names random streams.
    pub seed: u64,
    /// The value baseline.
    pub baseline: BaselineConfig,
    /// Times the learning rate, for design parameters.
    pub design_lr_scale: f64,
    /// Times the learning rate, for log standard deviations.
    pub log_std_lr_scale: f64,
}

/// Settings that do not go together with the iterations of a training.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SettingFault {
    /// The key, in the learner's table.
    pub key: &'static str,
    /// What is wrong.
    pub message: String,
    /// The way out.
    pub hint: String,
}

/// A learner that experiments may name in `learner.algorithm`. Its settings are in the table of its name.
pub trait LearnerKind: Send + Sync {
    /// Its name.
    fn name(&self) -> &str;

    /// What it is called in prose.
    fn title(&self) -> &str;

    /// Its settings for iterations of so many rows, where an experiment says nothing. `earlier` are the settings of the learners
    /// that stand before it in the catalogue: some defaults are taken over from there.
    fn defaults(&self, rows: usize, earlier: &[Box<dyn AnySettings>]) -> Box<dyn AnySettings>;

    /// What of its settings does not go together with iterations of so many rows, which `portion` calls in words.
    fn fault(&self, _settings: &dyn AnySettings, _rows: usize, _portion: &str) -> Option<SettingFault> {
        None
    }

    /// Whether it learns from old experience, that of other parameters too. Batches may then be collected while it learns, with the
    /// parameters from before; and what it has kept has to mean the same later, so that observations and rewards are measured alike
    /// all the time.
    fn keeps_experience(&self) -> bool {
        false
    }

    /// Whether it learns how widely commands spread, state by state: the controller tells it then, and `noise.command` is where it
    /// begins.
    fn state_dependent_std(&self) -> bool {
        false
    }

    /// The key, in its table, of a setting that asks for a design that is drawn once an episode; none where it is not set.
    fn wants_draws(&self, _settings: &dyn AnySettings) -> Option<&'static str> {
        None
    }

    /// The defaults of the value baseline beside it.
    fn baseline(&self, _settings: &dyn AnySettings, rows: usize) -> BaselineSettings {
        let mut baseline = BaselineSettings::default();
        baseline.mlp.minibatch_rows = rows.min(baseline.mlp.minibatch_rows);
        baseline
    }

    /// The discount that returns are told and candidates scored by.
    fn discount(&self, settings: &dyn AnySettings) -> f64;

    /// A learner.
    fn learner(&self, settings: &dyn AnySettings, setup: LearnerSetup) -> Box<dyn Learner>;
}

/// The settings of a learner, of the type that it gave.
///
/// # Panics
/// If they are of another type.
pub fn own<S: 'static>(settings: &dyn AnySettings) -> &S {
    settings.as_any().downcast_ref().expect("settings are handed back to the learner that they came from")
}

/// Minibatches that an iteration does not fill.
pub(crate) fn minibatch_fault(table: &str, minibatch_rows: usize, rows: usize, portion: &str) -> Option<SettingFault> {
    (minibatch_rows > rows).then(|| SettingFault {
        key: "minibatch_rows",
        message: format!("{table}.minibatch_rows = {minibatch_rows} is more than the {portion}"),
        hint: "0 takes the whole batch at once".into(),
    })
}

impl BaselineSettings {
    /// What of them does not go together with iterations of so many rows.
    pub fn fault(&self, rows: usize, portion: &str) -> Option<SettingFault> {
        minibatch_fault("baseline", self.mlp.minibatch_rows, rows, portion)
    }
}

/// Proximal policy optimisation, `ppo`.
#[derive(Clone, Copy, Debug, Default)]
pub struct PpoKind;

impl LearnerKind for PpoKind {
    fn name(&self) -> &'static str {
        "ppo"
    }

    fn title(&self) -> &'static str {
        "PPO"
    }

    fn defaults(&self, rows: usize, _: &[Box<dyn AnySettings>]) -> Box<dyn AnySettings> {
        let usual = PpoConfig::default();
        Box::new(PpoConfig { minibatch_rows: rows.min(usual.minibatch_rows), ..usual })
    }

    fn fault(&self, settings: &dyn AnySettings, rows: usize, portion: &str) -> Option<SettingFault> {
        minibatch_fault("ppo", own::<PpoConfig>(settings).minibatch_rows, rows, portion)
    }

    /// It decays with the policy, and its gradients have the same limit.
    fn baseline(&self, settings: &dyn AnySettings, _: usize) -> BaselineSettings {
        let ppo: &PpoConfig = own(settings);
        let mut baseline = BaselineSettings::default();
        baseline.mlp.minibatch_rows = ppo.minibatch_rows;
        baseline.mlp.learning_rate_final = ppo.learning_rate_final;
        baseline.mlp.max_grad_norm = ppo.max_grad_norm;
        baseline
    }

    fn discount(&self, settings: &dyn AnySettings) -> f64 {
        own::<PpoConfig>(settings).discount
    }

    fn learner(&self, settings: &dyn AnySettings, setup: LearnerSetup) -> Box<dyn Learner> {
        let ppo = PpoConfig {
            design_lr_scale: setup.design_lr_scale,
            log_std_lr_scale: setup.log_std_lr_scale,
            ..own::<PpoConfig>(settings).clone()
        };
        let settings = PpoSettings { ppo, baseline: setup.baseline };
        Box::new(Ppo::new(&settings, setup.policy, setup.params, setup.seed))
    }
}

/// Trust region policy optimisation, `trpo`. It has no learning rate to scale.
#[derive(Clone, Copy, Debug, Default)]
pub struct TrpoKind;

impl LearnerKind for TrpoKind {
    fn name(&self) -> &'static str {
        "trpo"
    }

    fn title(&self) -> &'static str {
        "TRPO"
    }

    /// What it does not say of advantages is as PPO has it.
    fn defaults(&self, _: usize, earlier: &[Box<dyn AnySettings>]) -> Box<dyn AnySettings> {
        let mut usual = TrpoConfig::default();
        if let Some(ppo) = earlier.iter().find_map(|settings| settings.as_any().downcast_ref::<PpoConfig>()) {
            usual.advantages = AdvantageConfig {
                discount: ppo.discount,
                gae_lambda: ppo.gae_lambda,
                normalize: ppo.normalize_advantages,
                bootstrap_truncated: ppo.bootstrap_truncated,
            };
        }
        Box::new(usual)
    }

    fn discount(&self, settings: &dyn AnySettings) -> f64 {
        own::<TrpoConfig>(settings).advantages.discount
    }

    fn learner(&self, settings: &dyn AnySettings, setup: LearnerSetup) -> Box<dyn Learner> {
        let settings = TrpoSettings { trpo: own::<TrpoConfig>(settings).clone(), baseline: setup.baseline };
        Box::new(Trpo::new(&settings, setup.policy, setup.params, setup.seed))
    }
}
