//! Whether it works, can be built, and stands what is not as in the simulation: first of all.

use hwasp_training::{Evaluation, StandInKind};
use hwasp_workshop::design::Grade;
use hwasp_workshop::tolerances::{Sensitivities, Side};
use maud::html;

use super::provenance::command;
use crate::page::Section;
use crate::run::Run;
use crate::trials::{Tally, Trials};
use crate::words::{decimal, percent, rate_interval, sentence};

/// From this share of successes on it works, and half as it should.
const WORKS: (f64, f64) = (0.9, 0.5);
/// So much of the success, or of the return, may be lost without harm, and so much with some.
const LOST: (f64, f64) = (0.05, 0.2);

/// The answer to a question.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Answer {
    Yes,
    Partly,
    No,
    /// Nobody has tried.
    Untested,
    /// There is nothing that it could be judged by.
    Open,
}

impl Answer {
    fn word(self) -> &'static str {
        match self {
            Self::Yes => "yes",
            Self::Partly => "partly",
            Self::No => "no",
            Self::Untested => "not tested",
            Self::Open => "not judged",
        }
    }

    fn class(self) -> &'static str {
        match self {
            Self::Yes => "success",
            Self::Partly => "doubt",
            Self::No => "failure",
            Self::Untested | Self::Open => "open",
        }
    }

    /// Of a loss, as a share.
    fn of_loss(lost: f64) -> Self {
        match lost {
            lost if lost <= LOST.0 => Self::Yes,
            lost if lost <= LOST.1 => Self::Partly,
            _ => Self::No,
        }
    }
}

/// A question with its answer, why, and what would tell more.
struct Row {
    question: &'static str,
    answer: Answer,
    told: String,
    command: Option<String>,
}

pub(crate) fn section(run: &Run, trials: Option<&Trials>) -> Section {
    let rows: Vec<Row> = [Some(works(run)), Some(buildable(run)), Some(robust(run)), nearer(run, trials)]
        .into_iter()
        .flatten()
        .collect();
    let body = html! {
        dl.verdict {
            @for Row { question, answer, told, command: line } in &rows {
                div {
                    dt { (question) " " span class=(answer.class()) { (sentence(answer.word())) } }
                    dd { p { (told) } @if let Some(line) = line { (command(line)) } }
                }
            }
        }
    };
    Section { id: "verdict", title: "Verdict", body }
}

fn works(run: &Run) -> Row {
    let evaluation = &run.summary.evaluation;
    let (answer, told) = match evaluation.success.first() {
        Some(all) => {
            let answer = match all.low {
                low if low >= WORKS.0 => Answer::Yes,
                _ if all.rate() >= WORKS.1 => Answer::Partly,
                _ => Answer::No,
            };
            let told = format!(
                "{} of {} held-out episodes succeed ({}, 95 % interval {}). It counts as working where the interval begins at {} or above.",
                all.successes,
                all.episodes,
                percent(all.rate()),
                rate_interval(all),
                percent(WORKS.0)
            );
            (answer, told)
        }
        None => (Answer::Open, by_return(evaluation)),
    };
    Row { question: "Does it work?", answer, told, command: None }
}

/// What there is to be said of a task that knows no success.
fn by_return(evaluation: &Evaluation) -> String {
    let ends = evaluation.ends.as_ref().map_or(String::new(), |ends| format!(" Of its episodes, {ends}."));
    format!(
        "The task knows no success, so its return has to speak: {} in the mean of {} held-out episodes.{ends}",
        decimal(evaluation.undiscounted_return.mean, 2),
        evaluation.episodes
    )
}

fn buildable(run: &Run) -> Row {
    let question = "Can it be built?";
    let limits = run.design.judged.as_ref().filter(|judged| judged.grade != Grade::Good);
    let limits = limits.map_or(String::new(), |judged| format!(" Of its parameters, {}.", judged.told));
    let Some(verdict) = &run.verdict else {
        let told = format!("What can be made of this mechanism is known for the hand alone.{limits}");
        return Row { question, answer: Answer::Open, told, command: None };
    };
    let wrong: Vec<String> = (verdict.findings.iter().filter(|finding| !finding.good))
        .map(|finding| format!("{}: {}.", sentence(&finding.what), finding.told))
        .collect();
    let told = if verdict.buildable {
        let looked: Vec<&str> = verdict.findings.iter().map(|finding| finding.what.as_str()).collect();
        format!("{} are as they have to be.{limits}", sentence(&looked.join(", ")))
    } else {
        format!("{}{limits}", wrong.join(" "))
    };
    let answer = if verdict.buildable { Answer::Yes } else { Answer::No };
    let command = run.parts.is_none().then(|| format!("hwasp parts {}", run.typed_path()));
    Row { question, answer, told, command }
}

fn robust(run: &Run) -> Row {
    let question = "Does it stand errors of the workshop?";
    if run.design.groups.is_empty() {
        let told = "Nothing is designed, so no part of a design can be off.".to_owned();
        return Row { question, answer: Answer::Open, told, command: None };
    }
    let Some(list) = &run.tolerances else {
        let told = "Nobody has simulated parameters that are off. What does:".to_owned();
        let command = Some(format!("hwasp tolerances {}", run.typed_path()));
        return Row { question, answer: Answer::Untested, told, command };
    };
    let Some((lost, told)) = costliest(list) else {
        return Row { question, answer: Answer::Open, told: list.verdict(), command: None };
    };
    Row { question, answer: Answer::of_loss(lost), told: format!("{told} {}", list.verdict()), command: None }
}

/// What the worst of all errors takes, as a share and in words: of the success where the task knows it, else of the return.
fn costliest(list: &Sensitivities) -> Option<(f64, String)> {
    let known = !list.nominal.success.is_empty();
    let size = list.nominal.undiscounted_return.mean.abs();
    let lost = |side: &Side| match &side.change.success {
        Some(success) => -success.mean,
        None => -side.change.undiscounted_return.mean / size,
    };
    let sides = list.parameters.iter().flat_map(|p| [("smaller", &p.minus), ("larger", &p.plus)].map(|side| (p, side)));
    let (parameter, (way, side)) = sides.max_by(|a, b| lost(a.1.1).total_cmp(&lost(b.1.1)))?;
    let lost = lost(side);
    let what = if known { "success" } else { "return" };
    let told = if lost > 0.0 {
        let (name, error, unit) =
            (&parameter.name, parameter.off_by(), if known { "points of success" } else { "% of the return" });
        format!("The costliest error, {name} {way} by {error}, takes {} {unit}.", decimal(100.0 * lost, 1))
    } else {
        format!("No error takes {what} in {} episodes.", list.nominal.episodes)
    };
    lost.is_finite().then_some((lost.max(0.0), told))
}

fn nearer(run: &Run, trials: Option<&Trials>) -> Option<Row> {
    let question = "Does it hold in a world nearer to the robot?";
    let stand_in = run.spec.task.built().stand_in.as_ref()?.kind;
    let flag = match stand_in {
        StandInKind::NativeTendons => "--native-tendons",
        StandInKind::FastLaw => "--law-rate physics",
    };
    let command = || Some(format!("hwasp eval {} {flag}", run.typed_path()));
    let row = |answer, told, command| Some(Row { question, answer, told, command });
    match trials.and_then(|trials| Some((trials, trials.nearer.as_ref()?))) {
        Some((trials, (_, Ok(tally)))) => {
            let (here, there) = (trials.tally(), *tally);
            row(Answer::of_loss(lost_between(here, there)), compared(stand_in, here, there), command())
        }
        Some((_, (_, Err(error)))) => row(Answer::Untested, format!("It could not be tried: {error}."), command()),
        None => row(Answer::Untested, "No episode could be run.".to_owned(), command()),
    }
}

/// The share that is lost from one world to the other: of the success where the task knows it, else of the return.
fn lost_between(here: Tally, there: Tally) -> f64 {
    match (here.rate(), there.rate()) {
        (Some((here, _)), Some((there, _))) => here - there,
        _ => (here.mean_return - there.mean_return) / here.mean_return.abs(),
    }
}

fn compared(kind: StandInKind, here: Tally, there: Tally) -> String {
    let world = super::outcome::world(kind);
    match (here.successes, there.successes) {
        (Some(one), Some(other)) => format!(
            "With {world} {other} of the first {} held-out episodes succeed, and {one} of {} with the law as trained.",
            there.episodes, here.episodes
        ),
        _ => format!(
            "With {world} the return of the first {} held-out episodes is {}, and {} with the law as trained.",
            there.episodes,
            decimal(there.mean_return, 2),
            decimal(here.mean_return, 2)
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn losses_are_answered_by_their_size() {
        let tally = |successes: Option<u64>, mean_return: f64| Tally { episodes: 100, successes, mean_return };
        let answer = |one, other| Answer::of_loss(lost_between(one, other));
        assert_eq!(answer(tally(Some(97), 0.0), tally(Some(93), 0.0)), Answer::Yes);
        assert_eq!(answer(tally(Some(97), 0.0), tally(Some(80), 0.0)), Answer::Partly);
        assert_eq!(answer(tally(Some(97), 0.0), tally(Some(50), 0.0)), Answer::No);
        assert_eq!(answer(tally(None, -100.0), tally(None, -103.0)), Answer::Yes);
        assert_eq!(answer(tally(None, -100.0), tally(None, -150.0)), Answer::No);
        // More is no loss.
        assert_eq!(answer(tally(None, 100.0), tally(None, 150.0)), Answer::Yes);
        // A loss that is no number is none that was found.
        assert_eq!(Answer::of_loss(f64::NAN), Answer::No);
    }
}
