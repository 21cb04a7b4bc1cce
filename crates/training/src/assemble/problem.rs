//! A problem's settings as its plant and law take them.

use std::sync::Arc;

use hwasp_core::{Initial, Law};
use hwasp_tasks::hand::{PalmMotion, TendonHand, TendonHandSettings};
use hwasp_tasks::mass_spring::{Interface, MassSpring, MassSpringSettings};
use hwasp_tasks::pendulum::{Pendulum, PendulumSettings};
use hwasp_tasks::reach::{Reach, ReachSettings};

use super::{AssembleError, Assembly};
use crate::spec::{GraspProblem, GroupSpec, InitialSpec, InterfaceKind, MassSpringSpec, Problem, RewardKind, Spec};
#[cfg(feature = "mujoco")]
use crate::spec::{ObjectKind, ViewpointKind};
use crate::worlds::{Problems, World};

pub(super) fn problem(spec: &Spec) -> Result<Problems, AssembleError> {
    // Problems with one group of parameters; the hand has more.
    let initial = initial(spec)[0];
    match &spec.task.problem {
        Problem::Stiffness(p) => {
            let settings = MassSpringSettings {
                max_total_stiffness: p.stiffness_total_max,
                bar_length: p.bar,
                ..mass_spring(&p.base, spec.task.horizon, initial)
            };
            let deployment = MassSpring::stiffness(MassSpringSettings { effort_limit: None, ..settings.clone() })?;
            Ok(mass_spring_problem(&MassSpring::stiffness(settings)?, &deployment))
        }
        Problem::BarLength(p) => {
            let settings = MassSpringSettings {
                max_total_length: p.length_total_max,
                spring_stiffness: p.spring,
                interface_stiffness: p.interface_stiffness,
                interface_damping: p.interface_damping,
                ..mass_spring(&p.base, spec.task.horizon, initial)
            };
            let interface = match p.interface {
                InterfaceKind::Soft => Interface::Soft,
                InterfaceKind::Rigid => Interface::Rigid,
            };
            // The bar that is built is rigid and nothing clips its forces.
            let deployment = MassSpringSettings { effort_limit: None, ..settings.clone() };
            let deployment = MassSpring::bar(deployment, Interface::Rigid)?;
            Ok(mass_spring_problem(&MassSpring::bar(settings, interface)?, &deployment))
        }
        Problem::Reach(p) => {
            let settings =
                ReachSettings { goal: p.goal, horizon: spec.task.horizon, initial, ..ReachSettings::default() };
            let reach = Reach::new(settings)?;
            let world = World { law: reach.law(), make: Arc::new(reach.clone()) };
            Ok(Problems { training: world.clone(), deployment: world, optimum: vec![Some(reach.optimum())] })
        }
        Problem::Pendulum => {
            let pendulum = Pendulum::new(&PendulumSettings { horizon: spec.task.horizon, initial })?;
            let world = World { law: pendulum.law(), make: Arc::new(pendulum) };
            Ok(Problems { training: world.clone(), deployment: world, optimum: vec![None] })
        }
        Problem::ZGrasp(p) | Problem::SpatialGrasp(p) => grasp(p, spec),
        Problem::Own(own) => own_problem(own.built(), spec),
    }
}

/// The law of the world in which one trains. That of the hand is there without the engine, too.
pub fn law(spec: &Spec) -> Result<Law, AssembleError> {
    let (Problem::ZGrasp(p) | Problem::SpatialGrasp(p)) = &spec.task.problem else {
        return Ok(problem(spec)?.training.law);
    };
    let palm = palm(spec);
    let settings = TendonHandSettings { palm, range: p.range.into(), ..TendonHandSettings::default() };
    Ok(Law::new(TendonHand::new(&p.hand().transmission, &settings)?))
}

fn palm(spec: &Spec) -> PalmMotion {
    match spec.task.problem {
        Problem::SpatialGrasp(_) => PalmMotion::Spatial,
        _ => PalmMotion::Vertical,
    }
}

/// A problem that the program brings along, with the horizon and the start that the experiment asks for.
fn own_problem(built: &Problems, spec: &Spec) -> Result<Problems, AssembleError> {
    let (horizon, initial) = (spec.task.horizon, initial(spec));
    let world = |world: &World| -> Result<World, AssembleError> {
        let make = Arc::clone(&world.make);
        let law = match spec.design.initial {
            InitialSpec::Law => world.law.clone(),
            _ => world.law.clone().beginning(&initial)?,
        };
        let make = move |shorter: Option<usize>| make.make(Some(shorter.unwrap_or(horizon)));
        Ok(World { law, make: Arc::new(make) })
    };
    Ok(Problems {
        training: world(&built.training)?,
        deployment: world(&built.deployment)?,
        optimum: built.optimum.clone(),
    })
}

#[cfg(not(feature = "mujoco"))]
fn grasp(_: &GraspProblem, spec: &Spec) -> Result<Problems, AssembleError> {
    Err(AssembleError::NoEngine { problem: spec.task.name() })
}

#[cfg(feature = "mujoco")]
fn grasp(p: &GraspProblem, spec: &Spec) -> Result<Problems, AssembleError> {
    let make = hwasp_mujoco::grasp::Grasp::new;
    let deployment = grasp_settings(p, spec);
    // What lifts more than it has to is safe where it has to.
    let load = hwasp_mujoco::grasp::Ramp { first: 1.0, last: p.safety_factor, progress: p.safety_growth };
    let mut training = hwasp_mujoco::grasp::GraspSettings { load_ramp: Some(load), ..deployment.clone() };
    training.reward.approach = p.approach_reward;
    let optimum = vec![None; hwasp_tasks::hand::DESIGN_LEN];
    Ok(Problems { training: world(make(training)?), deployment: world(make(deployment)?), optimum })
}

impl Assembly {
    /// The world in which the hand of this `design` (SI) moves by the engine's own tendons and springs, at the rate of the
    /// simulation, and the law has no say.
    pub fn native(&self, design: &[f64]) -> Result<World, AssembleError> {
        let problem = self.spec().task.name();
        self.grasp_problem().map_err(|_| AssembleError::NoNative { problem })?;
        native(self, design)
    }

    /// The same of a model that was written to a file before, `mjcf`.
    #[cfg(feature = "mujoco")]
    pub fn native_from(&self, mjcf: &str) -> Result<World, AssembleError> {
        let settings = grasp_settings(self.grasp_problem()?, self.spec());
        Ok(world(hwasp_mujoco::grasp::Grasp::native_from(settings, mjcf)?))
    }

    /// What the experiment says of its grasps, if it is about any.
    pub fn grasp_problem(&self) -> Result<&GraspProblem, AssembleError> {
        match &self.spec().task.problem {
            Problem::ZGrasp(settings) | Problem::SpatialGrasp(settings) => Ok(settings),
            _ => Err(AssembleError::NoGrasp { problem: self.spec().task.name() }),
        }
    }

    /// The grasping task by itself, whose episodes can be looked at: that of evaluation, or with a `native`
    /// design (SI) that of [`Self::native`].
    #[cfg(feature = "mujoco")]
    pub fn grasp(&self, native: Option<&[f64]>) -> Result<hwasp_mujoco::grasp::Grasp, AssembleError> {
        let settings = grasp_settings(self.grasp_problem()?, self.spec());
        Ok(match native {
            None => hwasp_mujoco::grasp::Grasp::new(settings)?,
            Some(design) => hwasp_mujoco::grasp::Grasp::native(settings, &std::array::from_fn(|i| design[i]))?,
        })
    }
}

#[cfg(not(feature = "mujoco"))]
fn native(assembly: &Assembly, _: &[f64]) -> Result<World, AssembleError> {
    Err(AssembleError::NoEngine { problem: assembly.spec().task.name() })
}

#[cfg(feature = "mujoco")]
fn native(assembly: &Assembly, design: &[f64]) -> Result<World, AssembleError> {
    Ok(world(assembly.grasp(Some(design))?))
}

#[cfg(feature = "mujoco")]
fn world(grasp: hwasp_mujoco::grasp::Grasp) -> World {
    World { law: grasp.law(), make: grasp.shared() }
}

#[cfg(feature = "mujoco")]
fn grasp_settings(p: &GraspProblem, spec: &Spec) -> hwasp_mujoco::grasp::GraspSettings {
    use hwasp_mujoco::grasp::{GraspReward, GraspSettings, Inertia, Ramp, ShapeKind, Viewpoint};

    let starts = initial(spec);
    GraspSettings {
        palm: palm(spec),
        hand: p.hand(),
        range: p.range.into(),
        initial: std::array::from_fn(|i| starts[i]),
        shapes: p
            .shapes
            .iter()
            .map(|shape| match shape {
                ObjectKind::Sphere => ShapeKind::Sphere,
                ObjectKind::Box => ShapeKind::Box,
                ObjectKind::Cylinder => ShapeKind::Cylinder,
                ObjectKind::Ellipsoid => ShapeKind::Ellipsoid,
            })
            .collect(),
        size: p.size.ends(),
        mass: p.mass.ends(),
        friction: p.friction.ends(),
        inertia: p.inertia.map_or(Inertia::Physical, |span| Inertia::Independent(span.ends())),
        height: p.height.ends(),
        offset: p.offset,
        offset_ramp: p.offset_initial.map(|first| Ramp { first, last: p.offset, progress: p.offset_growth }),
        yaw: p.yaw,
        lying: p.lying,
        viewpoint: match p.viewpoint {
            ViewpointKind::World => Viewpoint::World,
            ViewpointKind::Palm => Viewpoint::Palm,
        },
        sensor_noise: [p.position_noise, p.travel_noise],
        actuation_noise: [p.position_noise, p.travel_noise],
        disturbance: [p.disturbance_force, p.disturbance_torque],
        reward: GraspReward { distance: -p.distance_penalty, contact: p.contact_reward, ..GraspReward::default() },
        horizon: spec.task.horizon,
        ..GraspSettings::default()
    }
}

fn mass_spring_problem(training: &MassSpring, deployment: &MassSpring) -> Problems {
    let world = |m: &MassSpring| World { law: m.law(), make: Arc::new(m.clone()) };
    Problems { training: world(training), deployment: world(deployment), optimum: vec![Some(deployment.optimum())] }
}

fn mass_spring(base: &MassSpringSpec, horizon: usize, initial: Initial) -> MassSpringSettings {
    let paper = MassSpringSettings::default();
    // The experiment names the force; the motor's constants stay and its current gives it.
    let max_current = base.motor_limit * paper.shaft_radius / paper.torque_constant;
    let settings = MassSpringSettings {
        count: base.segments,
        upper_mass: base.mass_1,
        lower_mass: base.mass_2,
        goal: base.goal,
        max_current,
        effort_limit: base.effort_clip,
        horizon,
        initial,
        ..paper
    };
    match base.reward {
        RewardKind::Soft => settings,
        RewardKind::Hard => settings.with_hard_reward(),
    }
}

/// Where the parameters of each group begin.
pub(super) fn initial(spec: &Spec) -> Vec<Initial> {
    let start = |group: GroupSpec| {
        let middle = Initial::Value(0.5 * (group.lo + group.hi));
        match &spec.design.initial {
            InitialSpec::Logit => Initial::Logit { half_width: spec.design.logit_half_width },
            // Where the law says, nobody asks.
            InitialSpec::Middle | InitialSpec::Law => middle,
            InitialSpec::Values(values) => {
                values.iter().find(|v| v.group == group.name).map_or(middle, |v| Initial::Value(v.value))
            }
        }
    };
    spec.task.groups().into_iter().map(start).collect()
}
