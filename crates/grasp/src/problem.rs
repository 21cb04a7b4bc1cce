//! The engine behind the grasping problems of experiment files.

use std::sync::Arc;

use hwasp_core::MakeEnvironment;
use hwasp_problem::AnyError;
use hwasp_tasks::grasp::{GraspTaskSettings, Scene};

use crate::grasp::Grasp;
use crate::settings::{GraspReward, GraspSettings, Ramp};

/// Makes the environments of a scene: for [`GraspProblem`](hwasp_tasks::grasp::GraspProblem).
///
/// # Errors
/// Of a hand that cannot be, or of a model that the engine refuses.
pub fn engine(task: &GraspTaskSettings, scene: Scene) -> Result<Arc<dyn MakeEnvironment>, AnyError> {
    let settings = settings_of(task);
    let grasp = match scene {
        Scene::Training => {
            // What lifts more than it has to is safe where it has to.
            let load = Ramp { first: 1.0, last: task.safety_factor, progress: task.safety_growth };
            let mut training = GraspSettings { load_ramp: Some(load), ..settings };
            training.reward.approach = task.approach_reward;
            Grasp::new(training)?
        }
        Scene::Deployment => Grasp::new(settings)?,
        Scene::Native(design) => Grasp::native(settings, &design)?,
    };
    Ok(grasp.shared())
}

/// What an experiment says of its grasps, without the aids to training.
pub fn settings_of(task: &GraspTaskSettings) -> GraspSettings {
    let offset_ramp = task.offset_initial.map(|first| Ramp { first, last: task.offset, progress: task.offset_growth });
    GraspSettings {
        palm: task.palm,
        hand: task.hand(),
        range: task.range.into(),
        opening: task.law().opening,
        shapes: task.shapes.clone(),
        size: task.size,
        mass: task.mass,
        friction: task.friction,
        inertia: task.inertia,
        height: task.height,
        offset: task.offset,
        offset_ramp,
        yaw: task.yaw,
        lying: task.lying,
        viewpoint: task.viewpoint,
        bench: task.bench.clone(),
        sensor_noise: [task.position_noise, task.travel_noise],
        actuation_noise: [task.position_noise, task.travel_noise],
        disturbance: [task.disturbance_force, task.disturbance_torque],
        reward: GraspReward {
            distance: -task.distance_penalty,
            contact: task.contact_reward,
            sideways: -task.sideways_penalty,
            ..GraspReward::default()
        },
        ..GraspSettings::default()
    }
}
