//! Off-policy learners by their names.

use hwasp_algos::{Learner, LearnerKind, LearnerSetup, SettingFault, own};
use hwasp_core::Reparameterised;
use hwasp_settings::AnySettings;

use crate::config::ReplayConfig;
use crate::sac::{Sac, SacConfig, SacRule};
use crate::td3::{Td3, Td3Config};

/// Twin delayed deep deterministic policy gradients, `td3`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Td3Kind;

/// Soft actor-critic, `sac`.
#[derive(Clone, Copy, Debug, Default)]
pub struct SacKind;

/// The fewest episodes whose returns may move a design.
const FEWEST_RETURNS: usize = 10;

/// What of the settings does not go together with iterations of so many rows.
fn fault(table: &str, settings: &ReplayConfig, rows: usize, portion: &str) -> Option<SettingFault> {
    let frames = settings.replay_frames;
    if frames < settings.warmup_steps {
        return Some(SettingFault {
            key: "replay_frames",
            message: format!(
                "{table}.replay_frames = {frames} is less than {table}.warmup_steps = {}",
                settings.warmup_steps
            ),
            hint: "learning would never begin: hold more, or begin earlier".into(),
        });
    }
    // An episode ends with a moment of its own.
    if frames < 2 * rows {
        return Some(SettingFault {
            key: "replay_frames",
            message: format!("{table}.replay_frames = {frames} is less than twice the {portion}"),
            hint: "hold at least two iterations; old experience is what the learner lives on".into(),
        });
    }
    let (window, search) = (settings.design_returns, settings.design_search);
    let (message, hint) = if window > 0 && search > 0 {
        (format!("and {table}.design_search = {search} both move the design"), "leave one of them out")
    } else if (1..FEWEST_RETURNS).contains(&window) {
        let needed = format!("is less than the {FEWEST_RETURNS} episodes that it takes to tell merit from chance");
        (needed, "60 are a good beginning; 0 leaves the design to the critics")
    } else if window > frames / 2 {
        (format!("episodes do not fit into {table}.replay_frames = {frames}"), "60 are a good beginning")
    } else {
        return None;
    };
    let message = format!("{table}.design_returns = {window} {message}");
    Some(SettingFault { key: "design_returns", message, hint: hint.into() })
}

/// The settings of a kind, with a replay that holds iterations of so many rows.
fn holding(mut replay: ReplayConfig, rows: usize) -> ReplayConfig {
    replay.replay_frames = replay.replay_frames.max(2 * rows);
    replay
}

/// The setting that asks for a design that is drawn once an episode.
fn wants_draws(settings: &ReplayConfig) -> Option<&'static str> {
    (settings.design_returns > 0).then_some("design_returns")
}

impl LearnerKind for Td3Kind {
    fn name(&self) -> &'static str {
        "td3"
    }

    fn title(&self) -> &'static str {
        "TD3"
    }

    fn defaults(&self, rows: usize, _: &[Box<dyn AnySettings>]) -> Box<dyn AnySettings> {
        let usual = Td3Config::default();
        Box::new(Td3Config { replay: holding(usual.replay, rows), ..usual })
    }

    fn fault(&self, settings: &dyn AnySettings, rows: usize, portion: &str) -> Option<SettingFault> {
        fault(self.name(), &own::<Td3Config>(settings).replay, rows, portion)
    }

    fn keeps_experience(&self) -> bool {
        true
    }

    fn wants_draws(&self, settings: &dyn AnySettings) -> Option<&'static str> {
        wants_draws(&own::<Td3Config>(settings).replay)
    }

    fn discount(&self, settings: &dyn AnySettings) -> f64 {
        own::<Td3Config>(settings).replay.discount
    }

    fn learner(&self, settings: &dyn AnySettings, setup: LearnerSetup) -> Box<dyn Learner> {
        let config = own::<Td3Config>(settings).clone();
        Box::new(Td3::new(config, setup.policy, setup.params, setup.seed, setup.design_lr_scale))
    }
}

impl LearnerKind for SacKind {
    fn name(&self) -> &'static str {
        "sac"
    }

    fn title(&self) -> &'static str {
        "SAC"
    }

    fn defaults(&self, rows: usize, _: &[Box<dyn AnySettings>]) -> Box<dyn AnySettings> {
        let usual = SacConfig::default();
        Box::new(SacConfig { replay: holding(usual.replay, rows), ..usual })
    }

    fn fault(&self, settings: &dyn AnySettings, rows: usize, portion: &str) -> Option<SettingFault> {
        fault(self.name(), &own::<SacConfig>(settings).replay, rows, portion)
    }

    fn keeps_experience(&self) -> bool {
        true
    }

    fn state_dependent_std(&self) -> bool {
        true
    }

    fn wants_draws(&self, settings: &dyn AnySettings) -> Option<&'static str> {
        wants_draws(&own::<SacConfig>(settings).replay)
    }

    fn discount(&self, settings: &dyn AnySettings) -> f64 {
        own::<SacConfig>(settings).replay.discount
    }

    fn learner(&self, settings: &dyn AnySettings, setup: LearnerSetup) -> Box<dyn Learner> {
        let rule = SacRule::new(own::<SacConfig>(settings).clone(), setup.policy.drawn_commands());
        Box::new(Sac::new(rule, setup.policy, setup.params, setup.seed, setup.design_lr_scale))
    }
}
