//! What grasping environments are from outside.

use hwasp_core::{CommandPort, Dimension, EnvSpec, Port};

use super::{ShapeKind, TravelSensed};
use crate::hand::{HandDescription, PalmMotion, names};

/// Ports, horizon and time step of a hand whose palm moves by up to `palm_step`, m, in a step.
pub fn env_spec(
    hand: &HandDescription,
    palm: PalmMotion,
    travel: TravelSensed,
    palm_step: f64,
    horizon: usize,
) -> EnvSpec {
    let port = |name: &str, dimension| Port { name: name.to_owned(), dimension };
    let lengths = ["palm_x", "palm_y", "palm_z", "object_x", "object_y", "object_z", "size_x", "size_y", "size_z"];
    let mut observation: Vec<Port> = lengths.iter().map(|name| port(name, Dimension::Length)).collect();
    observation.push(port("motor_travel", Dimension::Length));
    observation.push(port("motor_torque", Dimension::Torque));
    if travel == TravelSensed::Both {
        observation.push(port("motor_travel_target", Dimension::Length));
    }
    let mut state = vec![port("motor_travel", Dimension::Length)];
    state.extend(names::JOINTS.iter().map(|joint| port(&format!("{joint}_angle"), Dimension::Angle)));
    let mut effort: Vec<Port> =
        names::JOINTS.iter().map(|joint| port(&format!("{joint}_torque"), Dimension::Torque)).collect();
    effort.push(port("motor_torque", Dimension::Torque));
    let motor = |name: &str, most: f64| CommandPort {
        name: name.to_owned(),
        dimension: Dimension::Length,
        lo: -most,
        hi: most,
        direct: true,
    };
    let mut command: Vec<CommandPort> = palm.commands().iter().map(|name| motor(name, palm_step)).collect();
    command.push(motor("motor", hand.transmission.step_limit));
    let mut context = vec![port("mass", Dimension::Mass), port("friction", Dimension::None)];
    context.extend(ShapeKind::EACH.iter().map(|kind| port(kind.name(), Dimension::None)));
    context.extend(["inertia_x", "inertia_y", "inertia_z"].iter().map(|name| port(name, Dimension::None)));
    EnvSpec {
        observation,
        state,
        context,
        effort,
        command,
        horizon,
        time_step: hand.step_time(),
        shaped_by: vec![],
        terms: vec![],
    }
}
