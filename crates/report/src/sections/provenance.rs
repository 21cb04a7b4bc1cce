//! Where it came from, and how to get it again.

use hwasp_experiment::EXPERIMENT;
use hwasp_runs::Provenance;
use hwasp_runs::checkpoint::experiment_hash;
use hwasp_runs::text::grouped;
use maud::{Markup, html};

use crate::page::{KeyFigure, Section};
use crate::run::Run;
use crate::words::{date, decimal, duration, quoted};

pub(crate) fn section(run: &Run) -> Section {
    let summary = &run.summary;
    let body = html! {
        div.part {
            p { "The training again, to the same numbers on any number of threads:" }
            (command(&format!("hwasp train {} --out again", quoted(&run.path.join(EXPERIMENT).to_string_lossy()))))
        }
        p {
            "Without the folder: save the text below as " code { (EXPERIMENT) }
            @if !run.spec.files().is_empty() {
                " with the files that it names beside it ("
                @for (i, path) in run.spec.files().keys().enumerate() { @if i > 0 { ", " } code { (path) } } ")"
            }
            " and train that."
        }
        details { summary { "The experiment, every setting resolved" } pre { code { (run.experiment) } } }
        table {
            caption { "The training" }
            tbody {
                tr { th scope="row" { "iterations" } td { (grouped(summary.iterations)) } }
                tr { th scope="row" { "simulator steps" } td { (grouped(summary.env_steps)) } }
                @if let Some(steps) = summary.polish_steps {
                    tr { th scope="row" { "of these, to polish the controller" } td { (grouped(steps)) } }
                }
                tr { th scope="row" { "time" } td { (duration(summary.wall_s)) ", " (grouped(summary.steps_per_s as u64)) " steps/s" } }
                @if let Some(figure) = summary.training_return {
                    tr { th scope="row" { "return at its end" } td { (decimal(figure, 2)) } }
                }
                @if let Some(figure) = summary.training_discounted_return {
                    tr { th scope="row" { "discounted return at its end" } td { (decimal(figure, 2)) } }
                }
                @if let Some(failed) = summary.failed_candidates {
                    tr { th scope="row" { "candidates that failed" } td { (grouped(failed)) } }
                }
                @if let Some(first) = &summary.first_failure {
                    tr { th scope="row" { "how the first of them failed" } td { (first) } }
                }
                tr { th scope="row" { "discarded episodes" } td { (grouped(summary.discarded_episodes)) } }
                tr { th scope="row" { "SHA-256 of the experiment" } td { code.hash { (experiment_hash(&run.experiment)) } } }
            }
        }
        @match &run.provenance {
            Some(provenance) => (origin(provenance)),
            None => p { "The folder has no " code { "provenance.json" } ", which says when, where and by what command it was made." },
        }
    };
    Section { id: "provenance", title: "Where it came from", body }
}

/// The day of the training, for those who have the page on paper.
pub(crate) fn begun(label: &str, provenance: &Provenance) -> KeyFigure {
    let when = date(provenance.started_unix_s);
    let (day, time) = when.split_once(' ').unwrap_or((&when, ""));
    KeyFigure { label: label.to_owned(), value: day.to_owned(), note: time.to_owned() }
}

/// A line to be typed.
pub(crate) fn command(line: &str) -> Markup {
    html! { pre.command { code { (line) } } }
}

/// What stands in the place of a file that a run folder has not yet.
pub(crate) fn not_yet(what: &str, line: &str, then: &str) -> Markup {
    html! {
        div.part {
            p { "This run has no " (what) " yet. What makes them:" }
            (command(line))
            p { "The report, made again, then shows " (then) "." }
        }
    }
}

/// What was typed, when and where.
pub(crate) fn origin(provenance: &Provenance) -> Markup {
    html! {
        table {
            caption { "The program that trained" }
            tbody {
                tr { th scope="row" { "command" } td { code { (typed(&provenance.command_line)) } } }
                tr { th scope="row" { "begun" } td { (date(provenance.started_unix_s)) } }
                tr { th scope="row" { "version" } td { "hwasp " (provenance.hwasp_version) } }
                tr { th scope="row" { "platform" } td { (provenance.platform) ", vectors " (provenance.vector_instructions) } }
                tr { th scope="row" { "threads" } td { (provenance.threads) } }
                tr { th scope="row" { "root seed" } td { (provenance.seed) } }
                @if !provenance.resumed.is_empty() {
                    tr { th scope="row" { "resumed" } td { (provenance.resumed.len()) " times" } }
                }
            }
        }
    }
}

/// A command line as a shell takes it; the program without its folder.
fn typed(words: &[String]) -> String {
    let name =
        |program: &String| std::path::Path::new(program).file_name().map(|name| name.to_string_lossy().into_owned());
    let program = words.first().and_then(name).unwrap_or_default();
    std::iter::once(program).chain(words.iter().skip(1).map(|word| quoted(word))).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_as_a_shell_takes_them() {
        let words = ["/home/me/target/release/hwasp", "train", "reach", "--set", "task.goal=30 cm", "--out", "it's"];
        let words: Vec<String> = words.map(str::to_owned).to_vec();
        assert_eq!(typed(&words), "hwasp train reach --set 'task.goal=30 cm' --out 'it'\\''s'");
        assert_eq!((typed(&[]), quoted("")), (String::new(), "''".to_owned()));
    }
}
