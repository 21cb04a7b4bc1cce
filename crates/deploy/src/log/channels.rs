//! The channels of a log: names, and what a message has.

use hwasp_core::Dimension;

use super::About;

/// What the controller saw; keys are the names of its ports.
pub(super) const OBSERVATION: &str = "/observation";
/// What it commanded.
pub(super) const COMMAND: &str = "/command";
/// Where the palm is and is sent.
pub(super) const ARM: &str = "/arm";
/// What the motor is and does.
pub(super) const MOTOR: &str = "/motor";
/// Which step it is, and what was decided.
pub(super) const LOOP: &str = "/loop";
/// What happened once.
pub(super) const EVENTS: &str = "/events";

/// The channels with their schemas, JSON Schema, in order.
pub(super) fn schemas(about: &About) -> [(&'static str, String); 6] {
    let numbers = |names: &[String]| {
        let fields: Vec<_> = names.iter().map(|name| (name.as_str(), "number", String::new())).collect();
        fields.into_iter().map(|(name, kind, about)| (name.to_owned(), kind, about)).collect::<Vec<_>>()
    };
    let listed = |fields: &[(&str, &'static str, &str)]| {
        fields.iter().map(|(name, kind, about)| ((*name).to_owned(), *kind, (*about).to_owned())).collect::<Vec<_>>()
    };
    let (m, s, a) = (Dimension::Length.si(), Dimension::Time.si(), Dimension::Current.si());
    let arm = [
        ("palm", "vector", "where the palm is in the task's world, m"),
        ("palm_target", "vector", "where it is sent, m"),
        ("tool_speed", "vector", "speed of the tool in the arm's base, m/s"),
        ("clock", "number", "the arm's own clock, s"),
        ("age", "number", "age of its data, s"),
        ("mode", "string", "running, idle or off"),
        ("safety", "string", "what its own safety says"),
    ];
    let motor = [
        ("wound", "number", m),
        ("goal", "number", "where it is sent, as tendon, m"),
        ("travel", "number", "sum of commands, m"),
        ("velocity", "number", "rad/s"),
        ("current", "number", a),
        ("torque", "number", "N·m"),
        ("voltage", "number", "V"),
        ("temperature", "number", "°C"),
        ("age", "number", s),
    ];
    let looped = [
        ("episode", "integer", ""),
        ("phase", "string", ""),
        ("step", "integer", ""),
        ("late", "number", "how late the step began, s"),
        ("response", "string", "what the rules decided"),
    ];
    let events = [
        ("episode", "integer", ""),
        ("event", "string", ""),
        ("detail", "string", ""),
        ("size", "vector", "of the object, m"),
        ("place", "vector", "of the object, m"),
    ];
    [
        (OBSERVATION, schema(OBSERVATION, &numbers(&about.observation))),
        (COMMAND, schema(COMMAND, &numbers(&about.command))),
        (ARM, schema(ARM, &listed(&arm))),
        (MOTOR, schema(MOTOR, &listed(&motor))),
        (LOOP, schema(LOOP, &listed(&looped))),
        (EVENTS, schema(EVENTS, &listed(&events))),
    ]
}

fn schema(topic: &str, fields: &[(String, &str, String)]) -> String {
    let properties: serde_json::Map<_, _> = fields
        .iter()
        .map(|(name, kind, about)| {
            let mut field = match *kind {
                "vector" => serde_json::json!({ "type": "array", "items": { "type": "number" } }),
                // What a sensor did not say is null.
                "number" => serde_json::json!({ "type": ["number", "null"] }),
                kind => serde_json::json!({ "type": kind }),
            };
            if !about.is_empty() {
                field["description"] = about.clone().into();
            }
            (name.clone(), field)
        })
        .collect();
    serde_json::json!({ "title": &topic[1..], "type": "object", "properties": properties }).to_string()
}
