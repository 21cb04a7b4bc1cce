//! From a checked experiment to things that run: one match per axis (problem, placement, learner), none per combination.

mod budget;
mod polish;

use std::sync::Arc;

use hwasp_algos::{Learner, LearnerSetup};
use hwasp_core::{
    Anneal, HardwarePolicy, Initial, Law, Noise, Placement, PlacementError, Policy, PolicySpec, Purpose, Spread, stream,
};
use hwasp_diff::Activation;
use hwasp_experiment::{ActivationKind, Experiment, MOST_CORRELATED, MOST_MODELLED, Method, Place, total_name};
use hwasp_problem::{AnyError, World};
use thiserror::Error;

pub use self::budget::Piece;
pub(crate) use self::budget::{FINAL_EPISODES, Portion};
pub(crate) use self::polish::MainStage;
use self::polish::Polish;

/// Why a checked experiment cannot be put together.
#[derive(Debug, Error)]
pub enum AssembleError {
    /// Physics that cannot be set up: an engine that is missing, a model that it refuses.
    #[error("{0}")]
    Physics(String),
    /// Where the design begins.
    #[error(transparent)]
    Design(AnyError),
    /// The placement of the design.
    #[error(transparent)]
    Placement(#[from] PlacementError),
    /// A problem without a world that stands in for the built robot.
    #[error(
        "{problem} has no world that is nearer to the built robot; z-grasp and 3d-grasp have one, and model where it has a law"
    )]
    NoNative {
        /// The problem.
        problem: String,
    },
    /// The same elsewhere, in its own words.
    #[error("{0}")]
    Elsewhere(String),
    /// A setting for a design that is drawn once an episode, where none is.
    #[error(
        "{key} is for a design that is drawn once an episode, and none is; set design.placement = \"episode\", or leave it out"
    )]
    NoDraws {
        /// The setting.
        key: String,
    },
    /// A search whose budget does not hold one generation.
    #[error(
        "train.env_steps = {given}{} is less than one generation takes: {needed} steps, for {popsize} candidate{} of {each} \
         steps; train for longer, or with fewer candidates or shorter ones",
        if *.polish == 0 { String::new() } else { format!(", less {} to polish,", .polish) },
        if *.popsize == 1 { "" } else { "s" }
    )]
    Budget {
        /// Steps given.
        given: u64,
        /// Those of them that polish.
        polish: u64,
        /// Steps needed.
        needed: u64,
        /// Candidates of a generation.
        popsize: usize,
        /// Steps of a candidate.
        each: u64,
    },
    /// A covariance that would not fit.
    #[error(
        "method cmaes with a full covariance over {parameters} parameters is too large, {MOST_CORRELATED} are possible; set \
         cmaes.separable = true, or take a smaller controller"
    )]
    Covariance {
        /// Parameters of the policy.
        parameters: usize,
    },
    /// More candidates than a model of their scores bears.
    #[error(
        "method bo-rl would train {candidates} candidates, and its model bears {MOST_MODELLED}; train each for longer \
         (search.inner_env_steps), or take cmaes-rl"
    )]
    Model {
        /// Candidates that the budget holds.
        candidates: u64,
    },
    /// A search over a design that is all fixed, or over none.
    #[error("method {method} searches the design, {}", if *.parameters == 0 {
        "and nothing is designed; take the method fixed, which trains a controller alone, or cmaes or ars, which search one"
    } else {
        "but all of it is fixed; let design.placement be \"action\""
    })]
    NothingToSearch {
        /// The method.
        method: &'static str,
        /// Design parameters that there are.
        parameters: usize,
    },
}

/// Where one trains and where the result has to work, and what is known of the best design.
#[derive(Clone, Debug)]
pub struct Worlds {
    /// Where one trains.
    pub training: World,
    /// Where the result has to work: the mechanism as built, without aids to training.
    pub deployment: World,
    /// The total of each design group that is best as built, where it is known, SI.
    pub optimum: Vec<Option<f64>>,
}

impl Worlds {
    /// Those of an experiment, with its horizon and its start, and their physics set up.
    fn new(experiment: &Experiment) -> Result<Self, AssembleError> {
        let (task, built) = (&experiment.task, experiment.task.built());
        let starts = experiment.design.initial.starts(&task.groups(), experiment.design.logit_half_width);
        let world = |world: &World| -> Result<World, AssembleError> {
            world.ready().map_err(AssembleError::Physics)?;
            let world = world.clone().with_horizon(task.horizon);
            match &starts {
                Some(starts) => world.beginning(starts).map_err(AssembleError::Design),
                None => Ok(world),
            }
        };
        let (training, deployment) = (world(&built.training)?, world(&built.deployment)?);
        Ok(Self { training, deployment, optimum: built.optimum.clone() })
    }
}

/// An experiment, ready to run.
#[derive(Clone)]
pub struct Assembly {
    /// The problem's worlds.
    pub worlds: Worlds,
    /// Controller and hardware composed.
    pub policy: Arc<HardwarePolicy>,
    experiment: Experiment,
    /// Of the training that polishes what another one came to.
    polish: Option<Arc<Polish>>,
}

impl Assembly {
    /// Puts an experiment together.
    pub fn new(experiment: &Experiment) -> Result<Self, AssembleError> {
        let worlds = Worlds::new(experiment)?;
        let policy = HardwarePolicy::new(policy_spec(experiment, &worlds.training.law), &worlds.training.env)?;
        let assembly = Self { worlds, policy: Arc::new(policy), experiment: experiment.clone(), polish: None };
        let parameters = assembly.policy.param_count();
        if experiment.method == Method::Cmaes && !experiment.cmaes.separable && parameters > MOST_CORRELATED {
            return Err(AssembleError::Covariance { parameters });
        }
        let designs = !experiment.method.searches() && !assembly.policy.free_design().is_empty();
        if let Some(key) = experiment.learner.wants_draws()
            && designs
            && assembly.policy.drawn_actions() == 0
        {
            return Err(AssembleError::NoDraws { key });
        }
        assembly.check_budget()?;
        Ok(assembly)
    }

    /// The same experiment with the design fixed and only a controller to train, by its gradient.
    pub(crate) fn frozen(&self, design: &[f64], seed: u64, env_steps: u64) -> Result<Self, AssembleError> {
        let mut experiment = self.experiment.clone();
        (experiment.method, experiment.seed, experiment.train.env_steps) = (Method::Fixed, seed, env_steps);
        let policy = self.fixed_in(&self.worlds.training, design, experiment.noise.train)?;
        Ok(Self { policy: Arc::new(policy), experiment, ..self.clone() })
    }

    /// The experiment it was made of.
    pub fn experiment(&self) -> &Experiment {
        &self.experiment
    }

    /// The design in `params` as it is to be built, SI.
    pub fn built(&self, params: &[f32]) -> Vec<f64> {
        self.worlds.training.law.as_built(&self.policy.design(params))
    }

    /// What the totals of the design groups are called in tables and plots: `stiffness_total`, or `gear` for a group of
    /// one.
    pub fn total_names(&self) -> Vec<String> {
        let groups = self.policy.space().groups().iter();
        groups.map(|g| total_name(&g.name, g.count)).collect()
    }

    /// Fresh parameters; those of the main stage where it polishes.
    pub fn init(&self) -> Vec<f32> {
        let fresh = || self.policy.init(self.experiment.seed, self.experiment.controller.output_gain);
        self.polish.as_ref().map_or_else(fresh, |polish| polish.start.clone())
    }

    /// The names of what its learner tells of an update.
    pub(crate) fn metric_names(&self) -> &'static [&'static str] {
        self.learner(self.init()).metric_names()
    }

    /// A learner that starts from `params`.
    pub fn learner(&self, params: Vec<f32>) -> Box<dyn Learner> {
        let experiment = &self.experiment;
        experiment.learner.learner(LearnerSetup {
            policy: Arc::clone(&self.policy),
            params,
            seed: experiment.seed,
            baseline: experiment.baseline.config(),
            design_lr_scale: experiment.design.learning_rate_scale,
            log_std_lr_scale: experiment.noise.learning_rate_scale,
        })
    }

    /// The trained controller on the built hardware: every design parameter fixed to `built`, in the world it is for.
    pub fn deployed(&self, built: &[f64]) -> Result<HardwarePolicy, AssembleError> {
        self.fixed_in(&self.worlds.deployment, built, false)
    }

    /// The trained controller on hardware that was built to `design`, in any world of this problem. Errors of the workshop may
    /// have put it outside of the limits. `train_noise`: whether its
    /// parameters hold standard deviations.
    pub fn fixed_in(&self, world: &World, design: &[f64], train_noise: bool) -> Result<HardwarePolicy, AssembleError> {
        let mut spec = self.policy.spec().clone();
        spec.law = world.law.clone();
        spec.placements = design.iter().map(|&value| Placement::Built(value)).collect();
        spec.noise.train = train_noise;
        Ok(HardwarePolicy::new(spec, &world.env)?)
    }

    /// The world that stands in for the robot built to this `design` (SI), as its [kind](hwasp_problem::StandInKind) says: the hand with
    /// the engine's own tendons and springs, a robot from a model with the law at the rate of the physics.
    pub fn native(&self, design: &[f64]) -> Result<World, AssembleError> {
        let (given, needed) = (design.len(), self.policy.space().len());
        if given != needed {
            return Err(PlacementError::Count { given, needed }.into());
        }
        let task = &self.experiment.task;
        let none = || AssembleError::NoNative { problem: task.name().to_owned() };
        let stand_in = task.built().stand_in.as_ref().ok_or_else(none)?;
        let world = (stand_in.make)(design).map_err(|error| AssembleError::Physics(error.to_string()))?;
        world.ready().map_err(AssembleError::Physics)?;
        Ok(world.with_horizon(task.horizon))
    }
}

fn policy_spec(spec: &Experiment, law: &Law) -> PolicySpec {
    // A fixed parameter keeps the value that a free one would have begun with; a given one to the last bit, which the
    // way through the squash and back would not.
    let space = law.design();
    let mut first = space.values(&space.sample_initial(&mut stream(spec.seed, Purpose::Design, 0, 0)));
    let starts = space.groups().iter().flat_map(|g| vec![g.initial; g.count]);
    for (first, initial) in first.iter_mut().zip(starts) {
        if let Initial::Value(value) = initial {
            *first = value;
        }
    }
    let placements = first.iter().enumerate().map(|(i, &value)| match spec.design.place_of(i) {
        Place::Graph => Placement::Graph,
        Place::Action => Placement::Action,
        Place::Episode => Placement::Episode,
        Place::Fixed => Placement::Fixed(value),
    });
    let noise = &spec.noise;
    let [from, to] = noise.anneal;
    let spread = |first: f64, last: Option<f64>| Spread {
        std: first,
        anneal: last.map(|last| Anneal { ratio: last / first, from, to }),
    };
    let finals = noise.command_final.as_ref();
    let commands = noise.command.iter().enumerate();
    let efforts = noise.effort.iter().flatten().enumerate();
    PolicySpec {
        hidden: spec.controller.hidden.clone(),
        activation: match spec.controller.activation {
            ActivationKind::Tanh => Activation::Tanh,
            ActivationKind::Relu => Activation::Relu,
        },
        squash: spec.controller.squash,
        // A search of all parameters has no use for it, but a learner that polishes what it found has.
        state_dependent_std: spec.learner.state_dependent_std()
            && (!spec.method.searches() || spec.method.trains_inside() || spec.polish.share > 0.0),
        observation_center: spec.controller.observation_center.clone(),
        observation_scale: spec.controller.observation_scale.clone(),
        sees_design: spec.controller.sees_design,
        normalize: spec.controller.normalize_observations.then_some(spec.controller.observation_clip),
        law: law.clone(),
        placements: placements.collect(),
        noise: Noise {
            command: commands.map(|(i, &first)| spread(first, finals.map(|last| last[i]))).collect(),
            effort: efforts.map(|(i, &first)| spread(first, noise.effort_final.get(i).copied().flatten())).collect(),
            design: spread(noise.design, noise.design_final),
            // A search without noise has nothing to spread, and one with a training inside leaves that to the training.
            train: noise.train && (!spec.method.searches() || (spec.search.noise && !spec.method.trains_inside())),
        },
    }
}
