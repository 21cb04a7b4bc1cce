//! Training without the program around it.

#![allow(clippy::unwrap_used)]
// Every test file is a program of its own and uses some of this.
#![allow(dead_code)]

use std::sync::Arc;

use hwasp_algos::{BaselineConfig, Learner, MlpBaselineConfig, Ppo, PpoConfig, PpoSettings, Trpo, TrpoSettings};
use hwasp_core::{
    Environment, EpisodeKind, Episodes, Executor, HardwarePolicy, MakeEnvironment, Noise, Placement, PolicySpec,
    Sampler, Serial,
};
use hwasp_diff::Activation;
use hwasp_tasks::mass_spring::{MassSpring, MassSpringSettings};
use hwasp_tasks::reach::{Reach, ReachSettings};

/// A problem with a policy for it and the settings that it is learned with.
pub(crate) struct Case {
    pub(crate) sampler: Sampler,
    pub(crate) evaluation: Sampler,
    pub(crate) settings: PpoSettings,
    pub(crate) episodes: u64,
    pub(crate) output_gain: f64,
}

fn noise(command: f64, effort: f64, design: f64) -> Noise {
    Noise { command: vec![command.into()], effort: vec![effort.into()], design: design.into(), train: true }
}

impl Case {
    fn new(
        spec: PolicySpec,
        robot: &dyn Environment,
        make: Arc<dyn MakeEnvironment>,
        horizon: Option<usize>,
        settings: PpoSettings,
        episodes: u64,
        output_gain: f64,
    ) -> Self {
        let policy = Arc::new(HardwarePolicy::new(spec, robot.spec()).unwrap());
        let sampler = Sampler::new(Arc::clone(&policy), Arc::clone(&make), horizon);
        Self { sampler, evaluation: Sampler::new(policy, make, None), settings, episodes, output_gain }
    }

    /// The reach task.
    pub(crate) fn reach(place: Placement) -> Self {
        let problem = Reach::new(ReachSettings::default()).unwrap();
        let spec = PolicySpec {
            hidden: vec![16],
            activation: Activation::Tanh,
            squash: true,
            state_dependent_std: false,
            observation_center: vec![0.0],
            observation_scale: vec![0.5],
            sees_design: false,
            normalize: None,
            law: problem.law(),
            placements: vec![place],
            noise: noise(0.2, 0.2, 0.1),
        };
        let ppo = PpoConfig {
            discount: 0.95,
            clip_ratio: 0.3,
            epochs: 8,
            minibatch_rows: 150,
            learning_rate: 3e-3,
            design_lr_scale: 5.0,
            ..PpoConfig::default()
        };
        let settings =
            PpoSettings { ppo, baseline: BaselineConfig::Linear { ridge: 1e-5, privileged: false, context: false } };
        let robot = problem.robot(None);
        Self::new(spec, &robot, Arc::new(problem), None, settings, 20, 1.0)
    }

    /// Ten springs; training episodes of 200 steps.
    pub(crate) fn mass_spring(place: Placement) -> Self {
        let problem = MassSpring::stiffness(MassSpringSettings::default()).unwrap();
        let spec = PolicySpec {
            hidden: vec![32, 32],
            activation: Activation::Tanh,
            squash: true,
            state_dependent_std: false,
            observation_center: vec![0.1, 0.0],
            observation_scale: vec![0.1, 0.5],
            sees_design: false,
            normalize: None,
            law: problem.law(),
            placements: vec![place; problem.settings().count],
            noise: noise(0.3, 3.0, 0.3),
        };
        let ppo = PpoConfig {
            gae_lambda: 0.98,
            clip_ratio: 0.3,
            design_lr_scale: 10.0,
            log_std_lr_scale: 0.5,
            entropy_coef: 3e-3,
            ..PpoConfig::default()
        };
        let settings = PpoSettings { ppo, baseline: BaselineConfig::Mlp(MlpBaselineConfig::default()) };
        let robot = problem.robot(None);
        Self::new(spec, &robot, Arc::new(problem), Some(200), settings, 20, 0.1)
    }

    /// The parameters after so many iterations.
    pub(crate) fn train(&self, executor: &dyn Executor, seed: u64, iterations: u64) -> Vec<f32> {
        let policy = self.sampler.policy();
        let params = policy.init(seed, self.output_gain);
        let ppo = Ppo::new(&self.settings, Arc::clone(policy), params, seed);
        self.run(executor, seed, iterations, ppo)
    }

    /// The same with TRPO in the stead of PPO.
    pub(crate) fn train_trpo(
        &self,
        executor: &dyn Executor,
        seed: u64,
        iterations: u64,
        settings: &TrpoSettings,
    ) -> Vec<f32> {
        let policy = self.sampler.policy();
        let params = policy.init(seed, self.output_gain);
        self.run(executor, seed, iterations, Trpo::new(settings, Arc::clone(policy), params, seed))
    }

    fn run(&self, executor: &dyn Executor, seed: u64, iterations: u64, mut learner: impl Learner) -> Vec<f32> {
        for iteration in 0..iterations {
            let progress = iteration as f64 / iterations as f64;
            let indices = 0..self.episodes;
            let training = Episodes { seed, iteration, indices, progress, kind: EpisodeKind::Training };
            let batch = self.sampler.collect(executor, learner.params(), &training).unwrap();
            learner.update(executor, &batch, progress, iteration).unwrap();
        }
        learner.params().to_vec()
    }

    /// Mean discounted return of the deterministic policy over whole episodes from held-out starts.
    pub(crate) fn evaluate(&self, params: &[f32], episodes: u64) -> f64 {
        let held_out =
            Episodes { seed: 0, iteration: 0, indices: 0..episodes, progress: 1.0, kind: EpisodeKind::Evaluation };
        let returns = self.evaluation.collect(&Serial, params, &held_out).unwrap().returns(self.settings.ppo.discount);
        returns.iter().sum::<f64>() / returns.len() as f64
    }

    /// Evaluation and the total of the design, before and after training.
    pub(crate) fn learn(&self, seed: u64, iterations: u64) -> [(f64, f64); 2] {
        let before = self.judge(&self.sampler.policy().init(seed, self.output_gain));
        [before, self.judge(&self.train(&Serial, seed, iterations))]
    }

    /// Evaluation and the total of the design.
    pub(crate) fn judge(&self, params: &[f32]) -> (f64, f64) {
        let policy = self.sampler.policy();
        (self.evaluate(params, 40), policy.space().totals(&policy.design(params))[0])
    }
}
