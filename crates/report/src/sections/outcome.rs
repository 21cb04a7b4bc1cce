//! What the result is worth.

use hwasp_plot::{IntervalRow, intervals};
use hwasp_runs::text::grouped;
use hwasp_training::stats::Interval;
use hwasp_training::{Evaluation, MeanInterval, SuccessRate};
use maud::{Markup, html};

use crate::figure::{gallery, picture};
use crate::page::Section;
use crate::run::Run;
use crate::words::{decimal, mean_interval, percent, rate_interval};

pub(crate) fn section(run: &Run) -> Section {
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
    };
    Section { id: "outcome", title: "What it reaches", body }
}

/// The share of successes over all episodes and by kind, as a picture and as a table.
fn success(rates: &[SuccessRate]) -> Markup {
    let rows: Vec<IntervalRow<'_>> = rates.iter().map(|rate| rate_row(&rate.kind, rate)).collect();
    let svg = intervals(&rows, "success (%)", 100.0);
    let about = "Dots are shares of successful episodes, bars their 95 % intervals; the table below has the numbers.";
    html! {
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
