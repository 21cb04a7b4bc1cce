//! How the sensors read, and what becomes of the commands.

use hwasp_problem::{Motor, Sensor, Target};

use crate::grasp::rules::WORKSPACE;
use crate::grasp::{GraspTaskSettings, ObjectSensed, TravelSensed, Viewpoint};
use crate::hand::{HandDescription, PalmMotion};

/// The frames' names.
pub(super) const WORLD: &str = "world";
pub(super) const PALM: &str = "palm";
pub(super) const OBJECT: &str = "object";

const AXES: [&str; 3] = ["x", "y", "z"];

/// In the order of the observation.
pub(super) fn sensors(task: &GraspTaskSettings) -> Vec<Sensor> {
    let end = "at the end of the period before; first before the first command";
    let seen = match task.bench.object_sensed {
        ObjectSensed::Tracked => end,
        ObjectSensed::Carried => {
            "before the first command, and with the palm from when the grasp is felt (bench: `object_sensed`)"
        }
        ObjectSensed::Fixed => "once, before the first command",
    };
    let (place, read) = match task.viewpoint {
        Viewpoint::World => (WORLD, seen.to_owned()),
        Viewpoint::Palm => (PALM, format!("{seen}; in the world, and what the palm's sensors read is taken off")),
    };
    let three = |name: &str, frame: &str, sampled: &str, noise: f64| {
        AXES.map(|axis| Sensor {
            port: format!("{name}_{axis}"),
            frame: Some(frame.to_owned()),
            sampled: sampled.to_owned(),
            noise,
        })
    };
    let motor = |quantity: &str, sampled: &str, noise: f64| Sensor {
        port: format!("motor_{quantity}"),
        frame: None,
        sampled: sampled.to_owned(),
        noise,
    };
    let mut sensors = Vec::new();
    sensors.extend(three("palm", WORLD, end, task.position_noise));
    sensors.extend(three("object", place, &read, task.position_noise));
    sensors.extend(three("size", OBJECT, "once, before the start", 0.0));
    let sum = "after the commands of the period before were added up; 0 before the first one";
    let travel = match task.bench.travel_sensed {
        TravelSensed::Commanded => sum,
        TravelSensed::Encoder | TravelSensed::Both => end,
    };
    sensors.push(motor("travel", travel, task.travel_noise));
    let torque =
        "in the last simulation step of the period before (a motor: at the period's end); 0 before the first command";
    sensors.push(motor("torque", torque, 0.0));
    if task.bench.travel_sensed == TravelSensed::Both {
        sensors.push(motor("travel_target", sum, 0.0));
    }
    sensors
}

/// In the order of the command.
pub(super) fn motors(task: &GraspTaskSettings, hand: &HandDescription) -> Vec<Motor> {
    let first = match task.palm {
        PalmMotion::Vertical => 2,
        PalmMotion::Spatial => 0,
    };
    let palm = |axis: usize| Motor {
        port: format!("palm_{}", AXES[axis]),
        frame: Some(WORLD.to_owned()),
        hold: Some(0.0),
        becomes: "added to the palm's target, which is held for the period".to_owned(),
        target: Some(Target {
            name: format!("palm_{}_target", AXES[axis]),
            meaning:
                "where the palm shall be; it begins where the palm stands, and the palm's position control follows it"
                    .to_owned(),
            start: None,
            limits: WORKSPACE[axis],
            noise: task.position_noise,
        }),
    };
    let winding = Motor {
        port: "motor".to_owned(),
        frame: None,
        hold: Some(0.0),
        becomes: "added to the length of tendon to be on the spool; positive winds and closes, negative pays out"
            .to_owned(),
        target: Some(Target {
            name: "motor_travel_target".to_owned(),
            meaning: "tendon to be on the spool, from the open hand with its tendons just taut; angle of the \
                      spool times its radius. The spool gives way where the tendons would pull more than they may \
                      (transmission: `tension_limit`), and the sum stays as it is"
                .to_owned(),
            start: Some(0.0),
            limits: [0.0, hand.transmission.travel],
            noise: task.travel_noise,
        }),
    };
    (first..3).map(palm).chain([winding]).collect()
}
