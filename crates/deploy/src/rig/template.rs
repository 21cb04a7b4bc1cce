//! The file to begin with.

use std::fmt::Write;

use hwasp_settings::{Item, described, written};

use super::{Rig, SECTIONS};

/// A `rig.toml` with every key, its default, its limits and what it means.
pub fn template() -> String {
    let about = "# The bench for `hwasp deploy`. Every key has its default; quantities name their units.\n\
                 # What to measure and to wire stands in docs/deploy.md.\n";
    text_of(&Rig::default(), about)
}

/// A rig as such a file, beginning with these lines.
pub fn text_of(rig: &Rig, about: &str) -> String {
    let (mut rig, mut text) = (rig.clone(), about.to_owned());
    for ((name, settings), (_, about)) in rig.sections().into_iter().zip(SECTIONS) {
        let _ = write!(text, "\n# {}.\n[{name}]\n", capital(about));
        let fields = described(settings);
        for (field, (key, item)) in fields.iter().zip(written(settings).0) {
            let limits = if field.limits.is_empty() { String::new() } else { format!(" ({})", field.limits) };
            let _ = writeln!(text, "# {}{limits}\n{key} = {}", capital(&field.meaning), toml_of(&item));
        }
    }
    text
}

fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

fn toml_of(item: &Item) -> String {
    match item {
        Item::Text(text) => format!("{text:?}"),
        Item::Integer(value) => value.to_string(),
        Item::Float(value) => format!("{value:?}"),
        Item::Flag(value) => value.to_string(),
        Item::List(items) => format!("[{}]", items.iter().map(toml_of).collect::<Vec<_>>().join(", ")),
        Item::Keys(keys) => {
            let keys: Vec<_> = keys.0.iter().map(|(key, item)| format!("{key} = {}", toml_of(item))).collect();
            format!("{{ {} }}", keys.join(", "))
        }
    }
}
