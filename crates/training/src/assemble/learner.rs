//! Settings of the gradient learners.

use hwasp_algos::{
    AdvantageConfig, BaselineConfig, FisherRows, MlpBaselineConfig, PpoConfig, PpoSettings, TrpoConfig, TrpoSettings,
};

use crate::spec::{Algorithm, BaselineKind, Spec, TrpoSpec};

/// Settings of a gradient learner.
#[derive(Clone, Debug, PartialEq)]
pub enum LearnerSettings {
    /// Proximal policy optimisation.
    Ppo(PpoSettings),
    /// Trust region policy optimisation.
    Trpo(TrpoSettings),
}

impl LearnerSettings {
    /// As an experiment has them.
    pub(super) fn new(spec: &Spec) -> Self {
        let baseline = baseline(spec);
        match spec.learner.algorithm {
            Algorithm::Ppo => Self::Ppo(PpoSettings { ppo: ppo(spec), baseline }),
            Algorithm::Trpo => Self::Trpo(TrpoSettings { trpo: trpo(&spec.trpo), baseline }),
        }
    }
}

/// Limits of which 0 means none.
fn positive(x: f64) -> Option<f64> {
    (x > 0.0).then_some(x)
}

fn ppo(spec: &Spec) -> PpoConfig {
    let ppo = &spec.ppo;
    PpoConfig {
        discount: ppo.discount,
        gae_lambda: ppo.gae_lambda,
        clip_ratio: ppo.clip_ratio,
        epochs: ppo.epochs,
        minibatch_rows: ppo.minibatch_rows,
        learning_rate: ppo.learning_rate,
        learning_rate_final: ppo.learning_rate_final,
        design_lr_scale: spec.design.learning_rate_scale,
        log_std_lr_scale: spec.noise.learning_rate_scale,
        adam_epsilon: ppo.adam_epsilon,
        entropy_coef: ppo.entropy_coef,
        max_grad_norm: positive(ppo.max_grad_norm),
        target_kl: positive(ppo.target_kl),
        normalize_advantages: ppo.normalize_advantages,
        bootstrap_truncated: ppo.bootstrap_truncated,
    }
}

fn trpo(trpo: &TrpoSpec) -> TrpoConfig {
    let rows = trpo.fisher_rows;
    TrpoConfig {
        advantages: AdvantageConfig {
            discount: trpo.discount,
            gae_lambda: trpo.gae_lambda,
            normalize: trpo.normalize_advantages,
            bootstrap_truncated: trpo.bootstrap_truncated,
        },
        max_kl: trpo.max_kl,
        max_kl_final: trpo.max_kl_final,
        cg_iterations: trpo.cg_iterations,
        cg_tolerance: trpo.cg_tolerance,
        damping: trpo.damping,
        design_scale: trpo.design_scale,
        fisher_rows: if rows > 1.0 { FisherRows::Count(rows as usize) } else { FisherRows::Fraction(rows) },
        backtrack_ratio: trpo.backtrack_ratio,
        backtracks: trpo.backtracks,
    }
}

fn baseline(spec: &Spec) -> BaselineConfig {
    let (ppo, baseline) = (&spec.ppo, &spec.baseline);
    match baseline.kind {
        BaselineKind::Linear => {
            BaselineConfig::Linear { ridge: baseline.ridge, privileged: baseline.privileged, context: baseline.context }
        }
        BaselineKind::Mlp => BaselineConfig::Mlp(MlpBaselineConfig {
            hidden: baseline.hidden.clone(),
            learning_rate: baseline.learning_rate,
            learning_rate_final: ppo.learning_rate_final,
            epochs: baseline.epochs,
            minibatch_rows: baseline.minibatch_rows,
            max_grad_norm: positive(ppo.max_grad_norm),
            privileged: baseline.privileged,
            context: baseline.context,
        }),
    }
}
