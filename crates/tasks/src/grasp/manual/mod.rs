//! What somebody has to know who lets a trained hand grasp: on a bench, or in another simulation of it.

mod bench;
mod hand;
mod ports;
mod scene;

use hwasp_problem::Manual;

use super::GraspTaskSettings;

/// All of it, for the hand and the objects of these settings.
pub(super) fn manual(task: &GraspTaskSettings) -> Manual {
    let hand = task.hand();
    Manual {
        frames: hand::frames(&hand),
        sensors: ports::sensors(task),
        motors: ports::motors(task, &hand),
        topics: vec![
            hand::period(&hand),
            bench::topic(&task.bench),
            hand::transmission(&hand.transmission),
            hand::palm(&hand.palm),
            scene::start(task),
            scene::objects(task),
            scene::disturbance(task),
            scene::success(),
            hand::model(),
        ],
    }
}

#[cfg(test)]
mod tests {
    use hwasp_problem::Told;

    use super::*;
    use crate::grasp::{ObjectSensed, TravelSensed, env_spec};
    use crate::hand::PalmMotion;

    #[test]
    fn every_port_is_told_and_every_frame_is_there() {
        for (palm, travel) in
            [(PalmMotion::Vertical, TravelSensed::Both), (PalmMotion::Spatial, TravelSensed::Commanded)]
        {
            let mut task = GraspTaskSettings::new(palm);
            task.bench.travel_sensed = travel;
            let (manual, env) = (manual(&task), env_spec(&task.hand(), palm, travel, 0.002, 500));
            let sensors: Vec<&str> = manual.sensors.iter().map(|sensor| &*sensor.port).collect();
            let motors: Vec<&str> = manual.motors.iter().map(|motor| &*motor.port).collect();
            assert_eq!(sensors, env.observation.iter().map(|port| &*port.name).collect::<Vec<_>>());
            assert_eq!(motors, env.command.iter().map(|port| &*port.name).collect::<Vec<_>>());
            let frames = manual.sensors.iter().map(|s| &s.frame).chain(manual.motors.iter().map(|m| &m.frame));
            assert!(frames.flatten().all(|frame| manual.frames.iter().any(|known| known.name == *frame)));
        }
    }

    #[test]
    fn the_settings_are_told() {
        let mut task = GraspTaskSettings::new(PalmMotion::Spatial);
        (task.mass, task.offset, task.position_noise, task.tension_limit) = ([0.2, 0.3], 0.07, 0.0, 60.0);
        (task.bench.object_sensed, task.bench.palm_speed) = (ObjectSensed::Carried, Some(0.1));
        let manual = manual(&task);
        let told = |topic: &str, fact: &str| {
            let topic = manual.topics.iter().find(|known| known.name == topic).unwrap();
            topic.facts.iter().find(|known| known.name == fact).unwrap().told.clone()
        };
        assert_eq!(told("bench", "object_sensed"), Told::Text("carried".to_owned()));
        assert_eq!((told("bench", "grasp_felt"), told("bench", "palm_speed")), (Told::Value(0.3), Told::Value(0.1)));
        assert_eq!(told("objects", "mass"), Told::Range([0.2, 0.3]));
        assert_eq!(told("start", "object_x"), Told::Range([-0.07, 0.07]));
        assert_eq!(told("transmission", "tension_limit"), Told::Value(60.0));
        assert_eq!(told("transmission", "torque_limit"), Told::Value(0.48));
        assert!(manual.sensors.iter().filter(|sensor| sensor.port != "motor_travel").all(|sensor| sensor.noise == 0.0));
    }
}
