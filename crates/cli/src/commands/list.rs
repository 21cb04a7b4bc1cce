//! `hwasp list`.

use std::fmt::Write;
use std::io::IsTerminal;

use hwasp_experiment::{Catalogue, load, resolve};

use crate::output;
use hwasp_session::Failure;

/// The least room for a description beside its name: below, it stands under it.
const NARROWEST: usize = 24;
/// How far it is indented there.
const INDENT: usize = 4;

pub(crate) fn run(catalogue: &Catalogue) -> Result<(), Failure> {
    let presets = catalogue.presets();
    let width = presets.iter().map(|preset| preset.name.len()).max().unwrap_or(0);
    // Scripts get a line for each.
    let terminal = std::io::stdout().is_terminal().then(terminal_size::terminal_size).flatten();
    let columns = terminal.map_or(usize::MAX, |(columns, _)| usize::from(columns.0));
    let mut text = String::new();
    let mut entry = |name: &str, about: &str| {
        let _ = writeln!(text, "{}", told(name, about, width, columns));
    };
    for preset in &presets {
        let experiment = resolve(load(preset.name, catalogue)?, None, catalogue)?;
        entry(preset.name, &experiment.description);
    }
    for problem in catalogue.problems().iter().filter(|problem| problem.presets().is_empty()) {
        let name = problem.name();
        entry(name, &format!("a problem of this program: task.problem = \"{name}\" in an experiment file"));
    }
    Ok(output::print(&text)?)
}

/// A name, and what it is about: beside it where names have this `width` and there are `columns` enough, else under it.
fn told(name: &str, about: &str, width: usize, columns: usize) -> String {
    let room = columns.saturating_sub(width + 2);
    if room < NARROWEST {
        let lines = wrapped(about, columns.saturating_sub(INDENT));
        return format!("{name}\n{:INDENT$}{}", "", lines.join(&format!("\n{:INDENT$}", "")));
    }
    format!("{name:width$}  {}", wrapped(about, room).join(&format!("\n{:width$}  ", "")))
}

/// The words of a text in lines of at most so many characters; a longer word has a line of its own.
fn wrapped(text: &str, room: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let line = lines.last_mut().expect("there is a first line");
        if line.is_empty() {
            line.push_str(word);
        } else if line.chars().count() + 1 + word.chars().count() <= room {
            line.push(' ');
            line.push_str(word);
        } else {
            lines.push(word.to_owned());
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At 120 columns the terminal broke the descriptions in the middle of words.
    #[test]
    fn lines_end_between_words() {
        let text = "Ten parallel springs under 0.3 kg, with the paper's settings";
        assert_eq!(wrapped(text, 30), ["Ten parallel springs under 0.3", "kg, with the paper's settings"]);
        assert_eq!(wrapped(text, usize::MAX), [text]);
        assert_eq!(
            told("lamp", text, 6, 38),
            "lamp    Ten parallel springs under 0.3\n        kg, with the paper's settings"
        );
        // In 28 columns there is no room beside a name of 6, and the terminal broke the words.
        assert_eq!(
            told("lamp", text, 6, 28),
            "lamp\n    Ten parallel springs\n    under 0.3 kg, with the\n    paper's settings"
        );
        assert_eq!(
            wrapped("a-word-that-is-longer-than-its-line and", 24),
            ["a-word-that-is-longer-than-its-line", "and"]
        );
    }
}
