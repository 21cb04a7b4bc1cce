//! What the result is worth.

use hwasp_core::EpisodeResult;
use hwasp_plot::{IntervalRow, intervals};
use hwasp_runs::text::grouped;
use hwasp_training::stats::Interval;
use hwasp_training::{Evaluation, MeanInterval, StandInKind, SuccessRate};
use maud::{Markup, html};

use crate::figure::{gallery, picture};
use crate::page::Section;
use crate::run::Run;
use crate::trials::{Tally, Trials};
use crate::words::{decimal, mean_interval, percent, rate_interval};

/// Failures that are listed.
const LISTED: usize = 8;

pub(crate) fn section(run: &Run, trials: Option<&Trials>) -> Section {
    let evaluation = &run.summary.evaluation;
    let body = html! {
        p {
            "The deterministic controller on the hardware as built, on " (grouped(evaluation.episodes))
            " starts that training never saw (seed " (evaluation.seed) ")."
            @if evaluation.discarded_episodes > 0 {
                " " (grouped(evaluation.discarded_episodes)) " episodes in which the physics failed are in none of the figures."
            }
        }
        @if !evaluation.success.is_empty() { (success(&evaluation.success)) }
        (returns(run, evaluation))
        @if let Some(ends) = &evaluation.ends {
            p {
                "An episode took " (decimal(ends.mean_steps, 1)) " steps (" (decimal(ends.mean_s, 2)) " s) in the mean: "
                (ends.to_string()) "."
            }
        }
        @if let Some(trials) = trials {
            @if trials.tally().successes.is_some() { (failures(trials)) }
            @if let Some((kind, Ok(there))) = &trials.nearer { (beside(*kind, trials.tally(), *there)) }
        }
    };
    Section { id: "outcome", title: "What it reaches", body }
}

/// The share of successes over all episodes and by kind, as a picture and as a table.
fn success(rates: &[SuccessRate]) -> Markup {
    let rows: Vec<IntervalRow<'_>> = rates.iter().map(|rate| rate_row(&rate.kind, rate)).collect();
    let svg = intervals(&rows, "success (%)", 100.0);
    let about = "Dots are shares of successful episodes, bars their 95 % intervals; the table below has the numbers.";
    html! {
        div.part.whole {
        h3 { "Success by kind of episode" }
        div.beside {
            (gallery(&[picture(&svg, "success", "Success by kind of episode", about)], ""))
            table {
                caption { "Successful episodes, with Wilson’s 95 % intervals" }
                thead {
                    tr { th scope="col" { "kind" } th.n scope="col" { "successes" } th.n scope="col" { "share" }
                        th.n scope="col" { "interval" } }
                }
                tbody {
                    @for rate in rates {
                        tr {
                            th scope="row" { (rate.kind) }
                            td.n { (rate.successes) " of " (rate.episodes) }
                            td.n { (percent(rate.rate())) }
                            td.n { (rate_interval(rate)) }
                        }
                    }
                }
            }
        }
        }
    }
}

/// A share of successes in a picture of shares.
pub(crate) fn rate_row<'a>(label: &'a str, rate: &SuccessRate) -> IntervalRow<'a> {
    let [value, low, high] = [rate.rate(), rate.low, rate.high].map(|share| 100.0 * share);
    IntervalRow { label, value, text: percent(rate.rate()), interval: Some(Interval { low, high }), points: &[] }
}

fn returns(run: &Run, evaluation: &Evaluation) -> Markup {
    let row = |name: &str, figure: &MeanInterval| {
        html! { tr { th scope="row" { (name) } td.n { (decimal(figure.mean, 2)) } td.n { (mean_interval(figure, 2)) } } }
    };
    html! {
        div.part {
        h3 { "Return" }
        table {
            caption { "Returns, with 95 % bootstrap intervals over episodes; the discount is " (run.spec.discount()) }
            thead {
                tr { th scope="col" { "return" } th.n scope="col" { "mean" } th.n scope="col" { "interval" } }
            }
            tbody {
                (row("return", &evaluation.undiscounted_return))
                @for (term, mean) in &evaluation.terms {
                    tr { th scope="row" { "return, of " (term) } td.n { (decimal(*mean, 2)) } td.n { "–" } }
                }
                (row("discounted return", &evaluation.discounted_return))
                tr {
                    th scope="row" { "discounted return, median" }
                    td.n { (decimal(evaluation.median_discounted_return, 2)) } td.n { "–" }
                }
                tr {
                    th scope="row" { "discounted return, worst episode" }
                    td.n { (decimal(evaluation.worst_discounted_return, 2)) } td.n { "–" }
                }
            }
        }
        }
    }
}

/// What the world that is nearest to the built robot is called.
pub(crate) fn world(kind: StandInKind) -> &'static str {
    match kind {
        StandInKind::NativeTendons => "native tendons",
        StandInKind::FastLaw => "the law at the rate of the physics",
    }
}

/// The first episodes that fail.
fn failures(trials: &Trials) -> Markup {
    let (tally, count) = (trials.tally(), trials.failures().count());
    let row = |(index, result): (u64, &EpisodeResult)| {
        let kind = result.outcome.as_ref().map_or("", |outcome| &*outcome.kind);
        html! {
            tr {
                th scope="row" { (index) }
                td { (kind) }
                td { (result.ended_by.as_deref().unwrap_or("its time")) }
                td.n { (grouped(result.steps as u64)) }
                td.n { (decimal(result.undiscounted_return, 1)) }
            }
        }
    };
    html! {
        div.part {
        h3 { "Where it fails" }
        @if count == 0 {
            p { "None of the first " (tally.episodes) " held-out episodes fails." }
        } @else {
            p { (count) " of the first " (tally.episodes) " held-out episodes fail. Their starts can be played: " code { "hwasp play" } ", with " code { "--first" } " and the number." }
            table {
                caption { "The first failures among the held-out episodes" }
                thead {
                    tr {
                        th scope="col" { "episode" } th scope="col" { "kind" } th scope="col" { "ended by" }
                        th.n scope="col" { "steps" } th.n scope="col" { "return" }
                    }
                }
                tbody { @for failure in trials.failures().take(LISTED) { (row(failure)) } }
            }
        }
        }
    }
}

/// The same starts in the world as trained and in the one that is nearer to the robot.
fn beside(kind: StandInKind, here: Tally, there: Tally) -> Markup {
    let row = |name: &str, tally: Tally| {
        html! {
            tr {
                th scope="row" { (name) }
                td.n data-label="episodes" { (tally.episodes) }
                @match tally.rate() {
                    Some((rate, Interval { low, high })) => {
                        td.n data-label="success" { (percent(rate)) }
                        td.n data-label="95 % interval" { (percent(low)) " to " (percent(high)) }
                    }
                    None => { td.n data-label="success" { "–" } td.n data-label="95 % interval" { "–" } }
                }
                td.n data-label="mean return" { (decimal(tally.mean_return, 1)) }
            }
        }
    };
    let about = match kind {
        StandInKind::NativeTendons => "tendons and springs are the engine’s own, and the law has no say",
        StandInKind::FastLaw => "the law acts at the rate of the physics instead of once a step",
    };
    html! {
        div.part {
        h3 { "In a world nearer to the robot" }
        p { "The same first held-out starts, run for this page: where it was judged, and where " (about) "." }
        table.cards {
            caption { "What the world changes" }
            thead {
                tr {
                    th scope="col" { "world" } th.n scope="col" { "episodes" } th.n scope="col" { "success" }
                    th.n scope="col" { "95 % interval" } th.n scope="col" { "mean return" }
                }
            }
            tbody { (row("hardware as built, the law as trained", here)) (row(world(kind), there)) }
        }
        }
    }
}
