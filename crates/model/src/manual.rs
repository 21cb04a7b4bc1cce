//! What somebody has to know who puts the controller of a robot from a file to work: what the experiment says, in its own
//! formulas.

use hwasp_problem::{Manual, Motor, Topic};

use crate::robot::Robot;
use crate::settings::{ModelSettings, Readings};
use crate::texts::Named;

/// Whatever of it the experiment says; what it leaves out is left out here.
pub(crate) fn manual(settings: &ModelSettings, robot: &Robot) -> Manual {
    let topics = [
        Some(model(settings, robot)),
        names("observation", "formulas of what is seen after a period, in order", &settings.observe),
        formulas("definitions", "names that stand for formulas in others", &settings.define),
        formulas("random", "quantities that are drawn when an episode starts", &settings.random),
        formulas(
            "start",
            "where joints are and how fast they move when an episode starts; others as the model says",
            &settings.start,
        ),
        names("set", "fields of the model that formulas set", &settings.set),
        formulas("forces", "forces on bodies in training", &settings.forces),
        formulas("law", "efforts on joints, tendons and actuators; it is in policy.onnx", &settings.law),
        delays(settings),
        formulas("ends", "an episode ends before its time, in failure, once this holds", &settings.ends),
        success(settings),
    ];
    Manual { motors: motors(robot), topics: topics.into_iter().flatten().collect(), ..Manual::default() }
}

/// The file and how it is stepped.
fn model(settings: &ModelSettings, robot: &Robot) -> Topic {
    let steps = settings.frame_skip as f64;
    let readings = match settings.readings {
        Readings::Fresh => "fresh: after every period all of what is read is that of the new state",
        Readings::AsLeft => {
            "as left: positions of bodies and contacts are those at the start of the last simulation step"
        }
    };
    let topic = Topic::new("model", "the robot's model, exported as `robot.xml`")
        .with("file", &*settings.model, "", "its file in the experiment's folder")
        .with("simulation_step", robot.env.time_step / steps, "s", "a step of the physics")
        .with("simulation_steps", steps, "", "steps of the physics in a period")
        .with("readings", readings, "", "the moment that sensors tell of");
    match &*settings.keyframe {
        "" => topic,
        keyframe => topic.with("keyframe", keyframe, "", "where an episode starts, before `start`"),
    }
}

/// Where commands go.
fn motors(robot: &Robot) -> Vec<Motor> {
    let goes = |name: &str, direct: bool| {
        if direct {
            format!("the control of actuator `{name}` of the model, held for the period")
        } else {
            "read by the law, held for the period".to_owned()
        }
    };
    let motor = |(name, actuator): (&String, &Option<usize>)| Motor {
        port: name.clone(),
        frame: None,
        hold: None,
        becomes: goes(name, actuator.is_some()),
        target: None,
    };
    robot.env.command.iter().map(|port| &port.name).zip(&robot.direct).map(motor).collect()
}

fn delays(settings: &ModelSettings) -> Option<Topic> {
    let both = [
        ("observation", &settings.observation_delay, "from what is to what is seen"),
        ("command", &settings.command_delay, "from a decision to when it acts"),
    ];
    let topic = both
        .into_iter()
        .filter(|(_, delay, _)| !delay.is_empty())
        .fold(Topic::new("delays", "times that training has"), |topic, (name, delay, about)| {
            topic.with(name, &**delay, "s", about)
        });
    Some(topic).filter(|topic| !topic.facts.is_empty())
}

fn success(settings: &ModelSettings) -> Option<Topic> {
    let topic = Topic::new("success", "seen at the end of an episode");
    (!settings.success.is_empty())
        .then(|| topic.with("success", &*settings.success, "", "an episode is one where this holds"))
}

fn names(name: &str, about: &str, all: &[String]) -> Option<Topic> {
    let all: Vec<&str> = all.iter().map(String::as_str).collect();
    (!all.is_empty()).then(|| Topic::new(name, about).with("formulas", &all[..], "", "as the experiment has them"))
}

fn formulas(name: &str, about: &str, all: &Named) -> Option<Topic> {
    let one = |topic: Topic, (key, text): &(String, String)| {
        let key = if key.is_empty() { name } else { key };
        topic.with(key, &**text, "", "")
    };
    (!all.is_empty()).then(|| all.iter().fold(Topic::new(name, about), one))
}
