//! A training that polishes, as two: its main stage, and the training of the controller alone that follows.

use hwasp_algos::{Archive, Exchange, Persist, StateError};
use hwasp_core::{HardwarePolicy, Policy};
use hwasp_experiment::{Method, PolishWorld};
use hwasp_problem::World;

use super::{AssembleError, Assembly};
use crate::collect::Stage;

/// What checkpoints of a polish have beside the state of its training.
const PART: &str = "polish";

/// Where a main stage ended.
#[derive(Clone, Default)]
pub(crate) struct MainStage {
    /// The policy's parameters.
    pub(crate) params: Vec<f32>,
    /// Real simulator steps so far.
    pub(crate) env_steps: u64,
}

impl Persist for MainStage {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        with.vector("params", &mut self.params)?;
        with.number("env_steps", &mut self.env_steps)
    }
}

/// What the assembly of a polish knows of the whole training.
#[derive(Clone)]
pub(super) struct Polish {
    main: MainStage,
    stage: Stage,
    /// Parameters of the fixed policy that it begins with.
    pub(super) start: Vec<f32>,
    /// The totals of the design, as the main stage told them.
    totals: Vec<f64>,
}

impl Assembly {
    /// Whether a polish follows the main stage.
    pub fn polishes(&self) -> bool {
        self.experiment.polish.share > 0.0
    }

    /// Steps of the budget that polish; those that the main stage leaves come on top.
    pub fn polish_steps(&self) -> u64 {
        self.experiment.polish.steps(self.experiment.train.env_steps)
    }

    /// The training before the polish.
    #[must_use]
    pub fn main_stage(&self) -> Self {
        let mut main = self.clone();
        main.experiment.train.env_steps -= self.polish_steps();
        main.experiment.polish.share = 0.0;
        main
    }

    /// The training that polishes what the main stage came to: of the controller alone, on the design as built, in the world
    /// that the experiment says, with all steps that are left.
    pub(crate) fn polish(&self, main: MainStage) -> Result<Self, AssembleError> {
        let design = self.policy.design(&main.params);
        let totals = self.policy.space().totals(&design);
        let design = match self.experiment.polish.world {
            PolishWorld::Deployment => self.built(&main.params),
            PolishWorld::Native => design,
        };
        let (world, policy) = self.polished_in(&design)?;
        let start = self.start_of(&policy, &main.params);
        let mut polish = self.clone();
        let experiment = &mut polish.experiment;
        experiment.train = experiment.train.after(main.env_steps, experiment.polish.progress_start);
        experiment.method = Method::Fixed;
        polish.policy = policy.into();
        polish.worlds.training = world;
        polish.polish = Some(Polish { main, stage: Stage::Polish(design), start, totals }.into());
        Ok(polish)
    }

    /// The main stage that a checkpoint of a polish has; none of one that is of the main stage itself.
    pub(crate) fn main_at(&self, archive: &Archive) -> Result<Option<MainStage>, StateError> {
        if !self.polishes() || !archive.contains_key(&format!("{PART}.params")) {
            return Ok(None);
        }
        let mut main = MainStage { params: vec![0.0; self.policy.param_count()], env_steps: 0 };
        Exchange::loading(archive).part(PART, &mut main)?;
        Ok(Some(main))
    }

    /// Where a controller is polished on hardware of this design, SI, and the policy that learns there.
    pub(crate) fn polished_in(&self, design: &[f64]) -> Result<(World, HardwarePolicy), AssembleError> {
        let world = match self.experiment.polish.world {
            PolishWorld::Deployment => self.worlds.deployment.clone(),
            PolishWorld::Native => self.native(design)?,
        };
        let policy = self.fixed_in(&world, design, self.experiment.noise.train)?;
        Ok((world, policy))
    }

    /// What a fixed policy begins with: the trained controller, and the noise of its commands as far as that was trained.
    fn start_of(&self, fixed: &HardwarePolicy, params: &[f32]) -> Vec<f32> {
        let mut start = fixed.init(self.experiment.seed, self.experiment.controller.output_gain);
        let controller = self.policy.controller_params(params);
        start[..controller.len()].copy_from_slice(controller);
        if let (Some(from), Some(to)) = (self.policy.log_std_params(), fixed.log_std_params()) {
            for command in 0..self.worlds.training.env.command.len() {
                let places = self.policy.action_of_command(command).zip(fixed.action_of_command(command));
                if let Some((i, j)) = places {
                    start[to.start + j] = params[from.start + i];
                }
            }
        }
        start
    }

    /// The parameters of the whole policy where its training came to `params`: those of the main stage with the polished
    /// controller where it polishes, and else the same.
    pub(crate) fn whole(&self, params: Vec<f32>) -> Vec<f32> {
        let Some(polish) = &self.polish else { return params };
        let (mut whole, controller) = (polish.main.params.clone(), self.policy.controller_params(&params));
        whole[..controller.len()].copy_from_slice(controller);
        whole
    }

    /// Steps before the polish; none where it is no polish.
    pub(crate) fn main_steps(&self) -> u64 {
        self.polish.as_ref().map_or(0, |polish| polish.main.env_steps)
    }

    /// Where its episodes run, for requests.
    pub(crate) fn stage(&self) -> Stage {
        self.polish.as_ref().map_or(Stage::Training, |polish| polish.stage.clone())
    }

    /// The totals of the design groups, as rows tell them.
    pub(crate) fn totals(&self, params: &[f32]) -> Vec<f64> {
        let of = || self.policy.space().totals(&self.policy.design(params));
        self.polish.as_ref().map_or_else(of, |polish| polish.totals.clone())
    }

    /// What checkpoints have of the main stage.
    pub(crate) fn exchange_main(&self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        self.polish.as_ref().map_or(Ok(()), |polish| with.part(PART, &mut polish.main.clone()))
    }
}
