//! What the quantities of each problem mean, in a few words for the contract. Units and limits stand beside them there.

use hwasp_training::spec::{GraspProblem, Problem, ViewpointKind};

/// On which side of controller and law a quantity is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// What the controller sees.
    Observation,
    /// What only the law reads.
    State,
    /// What the controller asks of the motors.
    Command,
    /// What the mechanism does to the world.
    Effort,
}

/// What a quantity means, where it is known.
pub(super) fn meaning(problem: &Problem, role: Role, name: &str) -> Option<&'static str> {
    match problem {
        Problem::Stiffness(_) | Problem::BarLength(_) => mass_spring(name),
        Problem::Reach(_) => reach(name),
        Problem::Pendulum => pendulum(name),
        Problem::ZGrasp(grasp) | Problem::SpatialGrasp(grasp) => hand(grasp, role, name),
        // Its author's names have to do.
        Problem::Own(_) => None,
    }
}

fn mass_spring(name: &str) -> Option<&'static str> {
    Some(match name {
        "y1" => "the upper mass below the ceiling",
        "v1" => "speed of the upper mass, downwards",
        "y2" => "the lower mass below the ceiling",
        "v2" => "speed of the lower mass, downwards",
        "motor" => "pull of the motor's string, downwards",
        "effort" => "springs and motor together on both masses, downwards",
        "length" => "length of the bar between the masses",
        "interface1" => "the bar's pull on the upper mass, downwards",
        "interface2" => "the same on the lower mass",
        _ => return None,
    })
}

fn reach(name: &str) -> Option<&'static str> {
    Some(match name {
        "x" => "place on the rail",
        "speed" => "speed of the motor, as a fraction of its highest",
        "velocity" => "speed of the point",
        _ => return None,
    })
}

fn pendulum(name: &str) -> Option<&'static str> {
    Some(match name {
        "cos" => "cosine of the angle from upright",
        "sin" => "sine of the angle from upright",
        "angle" => "angle from upright, counter-clockwise, not wrapped",
        "speed" => "angular speed, counter-clockwise",
        "motor" => "torque of the motor, before the gear",
        "torque" => "torque on the rod, behind the gear",
        _ => return None,
    })
}

fn hand(grasp: &GraspProblem, role: Role, name: &str) -> Option<&'static str> {
    let of_palm = grasp.viewpoint == ViewpointKind::Palm;
    Some(match (role, name) {
        (Role::Observation, "palm_x" | "palm_y" | "palm_z") => "the palm in the world, z upwards from the floor",
        (Role::Observation, "object_x" | "object_y" | "object_z") if of_palm => "the object's centre from the palm",
        (Role::Observation, "object_x" | "object_y" | "object_z") => "the object's centre in the world",
        (Role::Observation, "size_x" | "size_y" | "size_z") => "the object's bounding box as it lies at the start",
        (Role::Observation | Role::State, "motor_travel") => "tendon wound so far",
        (Role::Observation, "motor_torque") => "torque of the motor in the last period",
        (Role::State, _) if name.ends_with("_angle") => "angle of the joint, 0 open, closing",
        (Role::Command, "palm_x" | "palm_y" | "palm_z") => "motion of the palm's target in this period",
        (Role::Command, "motor") => "tendon to wind in this period",
        (Role::Effort, "motor_torque") => "torque of the motor",
        (Role::Effort, _) if name.ends_with("_torque") => "torque about the joint, closing",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use hwasp_training::{Assembly, spec};

    /// Every port of every problem, in training and in deployment.
    #[test]
    fn nothing_is_without_a_meaning() {
        let hands: &[&str] = if cfg!(feature = "mujoco") { &["z-grasp", "3d-grasp"] } else { &[] };
        for experiment in ["mass-spring", "bar-length", "reach", "pendulum"].iter().chain(hands) {
            let spec = spec::resolve(spec::load(experiment).unwrap(), None).unwrap();
            let problem = Assembly::new(&spec).unwrap().problem;
            for world in [problem.training, problem.deployment] {
                let env = world.make.make(None).spec().clone();
                let ports =
                    [(Role::Observation, env.observation), (Role::State, env.state), (Role::Effort, env.effort)];
                let ports = ports.into_iter().flat_map(|(role, ports)| ports.into_iter().map(move |p| (role, p.name)));
                let commands = env.command.into_iter().map(|port| (Role::Command, port.name));
                for (role, name) in ports.chain(commands) {
                    assert!(meaning(&spec.task.problem, role, &name).is_some(), "{experiment}: {role:?} {name}");
                }
            }
        }
    }
}
