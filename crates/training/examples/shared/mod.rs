//! What the examples have in common: a training loop, written out.

use std::error::Error;
use std::sync::Arc;

use hwasp_algos::{BaselineConfig, Learner, MlpBaselineConfig, Ppo, PpoConfig, PpoSettings};
use hwasp_core::{
    EpisodeKind, Episodes, HardwarePolicy, Law, MakeEnvironment, Noise, Placement, PolicySpec, Sampler, Serial,
};
use hwasp_diff::Activation;

/// Iterations of a training.
const ITERATIONS: u64 = 150;
/// Episodes of an iteration.
const EPISODES: u64 = 20;
/// Discount of returns and advantages.
const DISCOUNT: f64 = 0.99;

/// A design and what its controller reaches with it.
pub(crate) struct Learned {
    /// The design that training began with, SI.
    pub(crate) first: Vec<f64>,
    /// The design that it ended with, SI.
    pub(crate) design: Vec<f64>,
    /// Mean discounted return of the deterministic policy over 100 held-out starts.
    pub(crate) discounted_return: f64,
}

/// Trains a controller, and the design with it where `placement` lets it move. The controller sees
/// (observation - centre)/scale; `effort_noise` is the standard deviation of the efforts at the start. All SI.
pub(crate) fn train(
    law: &Law,
    make: &Arc<dyn MakeEnvironment>,
    placement: Placement,
    (center, scale): (&[f64], &[f64]),
    effort_noise: f64,
) -> Result<Learned, Box<dyn Error>> {
    let noise = Noise {
        command: vec![0.3.into()], // of the motor's range
        effort: vec![effort_noise.into(); law.ports().effort.len()],
        design: 0.1.into(), // of the parameter's range, where it sits in the action
        train: true,
    };
    let spec = PolicySpec {
        hidden: vec![32, 32],
        activation: Activation::Tanh,
        squash: true,
        state_dependent_std: false,
        observation_center: center.to_vec(),
        observation_scale: scale.to_vec(),
        sees_design: false,
        normalize: None,
        law: law.clone(),
        placements: vec![placement; law.design().len()],
        noise,
    };
    let seed = 0;
    let policy = Arc::new(HardwarePolicy::new(spec, make.make(None).spec())?);
    let first = policy.init(seed, 0.1);
    let settings = PpoSettings {
        ppo: PpoConfig {
            discount: DISCOUNT,
            learning_rate: 3e-3,
            learning_rate_final: 0.1,
            design_lr_scale: 10.0,
            ..PpoConfig::default()
        },
        baseline: BaselineConfig::Mlp(MlpBaselineConfig { learning_rate: 3e-3, ..MlpBaselineConfig::default() }),
    };
    let mut learner = Ppo::new(&settings, Arc::clone(&policy), first.clone(), seed);
    let sampler = Sampler::new(Arc::clone(&policy), Arc::clone(make), None);
    for iteration in 0..ITERATIONS {
        let progress = iteration as f64 / ITERATIONS as f64;
        let asked = Episodes { seed, iteration, indices: 0..EPISODES, progress, kind: EpisodeKind::Training };
        let batch = sampler.collect(&Serial, learner.params(), &asked)?;
        learner.update(&Serial, &batch, progress, iteration)?;
    }
    let held_out = Episodes { seed, iteration: 0, indices: 0..100, progress: 1.0, kind: EpisodeKind::Evaluation };
    let returns = sampler.collect(&Serial, learner.params(), &held_out)?.returns(DISCOUNT);
    Ok(Learned {
        first: policy.design(&first),
        design: policy.design(learner.params()),
        discounted_return: returns.iter().sum::<f64>() / returns.len() as f64,
    })
}
