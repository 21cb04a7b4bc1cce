//! The reference of names and functions, from what reads them.

use std::fmt::Write;

use hwasp_expr::{FUNCTIONS, Quantity, laws};
use hwasp_mujoco::engine::{Kind, settable_fields};

use crate::names::attributes;

/// Kinds of elements, with attributes each.
const KINDS: [&str; 6] = ["joint", "body", "geom", "site", "tendon", "actuator"];
/// Names without attributes of elements.
const OTHERS: [(&str, &str); 13] = [
    ("sensor.NAME", "values of a sensor of the model"),
    ("contact.A.B", "1 where two geoms touch, else 0"),
    ("contact.A.B.force", "force between them along the normal, N"),
    ("contact.A", "1 where a geom touches anything"),
    ("com.pos`, `com.vel", "centre of mass of everything that moves, m, and its velocity, m/s"),
    ("energy.kinetic`, `energy.potential", "energies, J"),
    ("qpos`, `qvel", "all positions and velocities, as the engine has them"),
    ("command`, `command.NAME", "what was commanded, within its limits"),
    ("effort`, `effort.TARGET", "what the law gave, `effort.joint.knee`"),
    ("time`, `dt", "time since the start of the episode, and of a step, s"),
    ("step", "steps since the start of the episode"),
    ("progress", "share of training done, 0 to 1; 1 in evaluations"),
    ("pi", "3.14159…"),
];

/// The one field that stays as the file of the model has it: the length of an environment's step follows from it.
pub(crate) const TIME_STEP: &str = "option.timestep";

/// The fields of the model that designs can set, as a table in Markdown.
pub fn settable() -> String {
    let mut text = "| field | numbers | measures |\n|---|---|---|\n".to_owned();
    // The time step is that of the model's file: the compiler refuses to set it.
    for field in settable_fields().into_iter().filter(|field| (field.kind, field.name) != (Kind::Options, "timestep")) {
        let element = if field.kind == Kind::Options { "" } else { ".NAME" };
        let numbers = match (field.len, field.letters.is_empty()) {
            (1, _) => "1".to_owned(),
            (len, true) => format!("{len}: `[0]` to `[{}]`", len - 1),
            (len, false) => {
                let letters: Vec<String> = field.letters.chars().map(|letter| format!("`.{letter}`")).collect();
                format!("{len}: {}", letters.join(", "))
            }
        };
        let path = format!("{}{element}.{}", field.kind, field.name);
        if path != TIME_STEP {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "| `{path}` | {numbers} | {} |", field.units);
        }
    }
    text
}

/// Tables in Markdown: names, functions, laws.
pub fn reference() -> String {
    let mut text = "| name | value |\n|---|---|\n".to_owned();
    // Writing to a string cannot fail.
    for kind in KINDS {
        for (attribute, _, about) in attributes(kind) {
            let _ = writeln!(text, "| `{kind}.NAME.{attribute}` | {about} |");
        }
    }
    for (name, about) in OTHERS {
        let _ = writeln!(text, "| `{name}` | {about} |");
    }
    text.push_str("| names of your own | of `[task.define]`, `[task.random]` and `[task.design]` |\n");
    text.push_str("\n| function | value |\n|---|---|\n");
    for function in FUNCTIONS {
        let _ = writeln!(text, "| `{}` | {} |", function.usage, function.about);
    }
    text.push_str("\n| law of the library | gives | what it is (source) |\n|---|---|---|\n");
    for law in laws() {
        let gives = match law.gives() {
            Ok(Quantity::Known(exponents)) => exponents.to_string(),
            Ok(Quantity::Number) => "a number or rad".to_owned(),
            _ => "as `value`".to_owned(),
        };
        let _ = writeln!(text, "| `{}` | {gives} | {} ({}) |", law.function.signature(), law.about, law.source);
    }
    text
}
