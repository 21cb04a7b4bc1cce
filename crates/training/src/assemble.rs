//! From a checked experiment to things that run: one match per axis (problem, placement, learner), none per combination.

mod budget;
mod learner;
mod problem;

use std::sync::Arc;

use hwasp_algos::{Learner, Ppo, Trpo};
use hwasp_core::{
    Anneal, DesignError, HardwarePolicy, Initial, Law, Noise, Placement, PlacementError, Policy, PolicySpec, Purpose,
    Spread, stream,
};
use hwasp_diff::Activation;
use hwasp_tasks::hand::HandError;
use hwasp_tasks::mass_spring::MassSpringError;
use hwasp_tasks::pendulum::PendulumError;
use hwasp_tasks::reach::ReachError;
use thiserror::Error;

pub(crate) use self::budget::{FINAL_EPISODES, popsize};
pub use self::learner::LearnerSettings;
pub use self::problem::law;
use self::problem::problem;
use crate::spec::{ActivationKind, Method, Place, Spec};
use crate::worlds::{Problems, World};

/// The most parameters of a full covariance: its matrices take 1 GB then, and each decomposition seconds.
const MOST_CORRELATED: usize = 5000;

/// Why a checked experiment cannot be put together.
#[derive(Debug, Error)]
pub enum AssembleError {
    /// The mass-spring problem's settings.
    #[error(transparent)]
    MassSpring(#[from] MassSpringError),
    /// The reach problem's settings.
    #[error(transparent)]
    Reach(#[from] ReachError),
    /// The pendulum's settings.
    #[error(transparent)]
    Pendulum(#[from] PendulumError),
    /// The grasping task's settings.
    #[cfg(feature = "mujoco")]
    #[error(transparent)]
    Grasp(#[from] hwasp_mujoco::grasp::GraspError),
    /// The hand's mechanism.
    #[error(transparent)]
    Hand(#[from] HandError),
    /// A problem whose physics are not in this program.
    #[error(
        "{problem} needs the MuJoCo engine, and this program was built without it: build it with the feature \"mujoco\""
    )]
    NoEngine {
        /// The problem.
        problem: &'static str,
    },
    /// Where the design begins.
    #[error(transparent)]
    Design(#[from] DesignError),
    /// The placement of the design.
    #[error(transparent)]
    Placement(#[from] PlacementError),
    /// A problem whose mechanism the engine cannot express by itself.
    #[error("{problem} has no mechanism of the engine's own; z-grasp and 3d-grasp have")]
    NoNative {
        /// The problem.
        problem: &'static str,
    },
    /// A problem in which nothing is grasped.
    #[error("{problem} has no grasps to look at; z-grasp and 3d-grasp have")]
    NoGrasp {
        /// The problem.
        problem: &'static str,
    },
    /// A search whose budget does not hold one generation.
    #[error(
        "train.env_steps = {given} is less than one generation takes: {needed} steps, for {popsize} candidates of {each} \
         steps; train for longer, or with fewer candidates or shorter ones"
    )]
    Budget {
        /// Steps given.
        given: u64,
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
    /// A search over a design that is all fixed.
    #[error("method {method} searches the design, but all of it is fixed; let design.placement be \"action\"")]
    NothingToSearch {
        /// The method.
        method: &'static str,
    },
}

/// An experiment, ready to run.
#[derive(Clone)]
pub struct Assembly {
    /// The problem.
    pub problem: Problems,
    /// Controller and hardware composed.
    pub policy: Arc<HardwarePolicy>,
    /// Settings of the learner.
    pub learner: LearnerSettings,
    spec: Spec,
}

impl Assembly {
    /// Puts an experiment together.
    pub fn new(spec: &Spec) -> Result<Self, AssembleError> {
        let problem = problem(spec)?;
        let policy =
            HardwarePolicy::new(policy_spec(spec, &problem.training.law), problem.training.make.make(None).spec())?;
        let assembly =
            Self { problem, policy: Arc::new(policy), learner: LearnerSettings::new(spec), spec: spec.clone() };
        let parameters = assembly.policy.param_count();
        if spec.method == Method::Cmaes && !spec.cmaes.separable && parameters > MOST_CORRELATED {
            return Err(AssembleError::Covariance { parameters });
        }
        assembly.check_budget()?;
        Ok(assembly)
    }

    /// The same experiment with the design fixed and only a controller to train, by its gradient.
    pub(crate) fn frozen(&self, design: &[f64], seed: u64, env_steps: u64) -> Result<Self, AssembleError> {
        let mut spec = self.spec.clone();
        (spec.method, spec.seed, spec.train.env_steps) = (Method::Fixed, seed, env_steps);
        let policy = self.fixed_in(&self.problem.training, design, spec.noise.train)?;
        Ok(Self { policy: Arc::new(policy), spec, ..self.clone() })
    }

    /// The experiment it was made of.
    pub fn spec(&self) -> &Spec {
        &self.spec
    }

    /// The design in `params` as it is to be built, SI.
    pub fn built(&self, params: &[f32]) -> Vec<f64> {
        self.problem.training.law.as_built(&self.policy.design(params))
    }

    /// What the totals of the design groups are called in tables and plots: `stiffness_total`, or `gear` for a group of
    /// one.
    pub fn total_names(&self) -> Vec<String> {
        let groups = self.policy.space().groups().iter();
        groups.map(|g| total_name(&g.name, g.count)).collect()
    }

    /// Fresh parameters.
    pub fn init(&self) -> Vec<f32> {
        self.policy.init(self.spec.seed, self.spec.controller.output_gain)
    }

    /// A learner that starts from `params`.
    pub fn learner(&self, params: Vec<f32>) -> Box<dyn Learner> {
        let (policy, seed) = (Arc::clone(&self.policy), self.spec.seed);
        match &self.learner {
            LearnerSettings::Ppo(settings) => Box::new(Ppo::new(settings, policy, params, seed)),
            LearnerSettings::Trpo(settings) => Box::new(Trpo::new(settings, policy, params, seed)),
        }
    }

    /// The trained controller on the built hardware: every design parameter fixed to `built`, in the world it is for.
    pub fn deployed(&self, built: &[f64]) -> Result<HardwarePolicy, AssembleError> {
        self.fixed_in(&self.problem.deployment, built, false)
    }

    /// The trained controller on hardware fixed to `design`, in any world of this problem. `train_noise`: whether its
    /// parameters hold standard deviations.
    pub fn fixed_in(&self, world: &World, design: &[f64], train_noise: bool) -> Result<HardwarePolicy, AssembleError> {
        let mut spec = self.policy.spec().clone();
        spec.law = world.law.clone();
        spec.placements = design.iter().map(|&value| Placement::Fixed(value)).collect();
        spec.noise.train = train_noise;
        Ok(HardwarePolicy::new(spec, world.make.make(None).spec())?)
    }
}

/// The column of a group's total; a group of one is its own.
pub fn total_name(group: &str, count: usize) -> String {
    if count == 1 { group.to_owned() } else { format!("{group}_total") }
}

fn policy_spec(spec: &Spec, law: &Law) -> PolicySpec {
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
        Place::Fixed => Placement::Fixed(value),
    });
    let noise = &spec.noise;
    let [from, to] = noise.anneal;
    let spread = |first: f64, last: Option<f64>| Spread {
        std: first,
        anneal: last.map(|last| Anneal { ratio: last / first, from, to }),
    };
    let finals = noise.command_final.as_ref();
    let commands = noise.command.0.iter().enumerate();
    PolicySpec {
        hidden: spec.controller.hidden.clone(),
        activation: match spec.controller.activation {
            ActivationKind::Tanh => Activation::Tanh,
            ActivationKind::Relu => Activation::Relu,
        },
        squash: spec.controller.squash,
        observation_center: spec.controller.observation_center.clone(),
        observation_scale: spec.controller.observation_scale.clone(),
        law: law.clone(),
        placements: placements.collect(),
        noise: Noise {
            command: commands.map(|(i, &first)| spread(first, finals.map(|last| last.0[i]))).collect(),
            effort: spread(
                noise.effort.map_or(1.0, |effort| effort.value),
                noise.effort_final.map(|effort| effort.value),
            ),
            design: spread(noise.design, noise.design_final),
            // A search without noise has nothing to spread, and one with a training inside leaves that to the training.
            train: noise.train && (!spec.method.searches() || (spec.search.noise && !spec.method.trains_inside())),
        },
    }
}
