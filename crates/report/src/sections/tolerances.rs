//! Which part has to be precise.

use hwasp_workshop::tolerances::{Sensitivities, Sensitivity, Side};
use maud::{Markup, html};

use super::provenance::not_yet;
use crate::figure::{picture, wide};
use crate::page::Section;
use crate::run::Run;
use crate::words::{change, mean_interval, percent};

pub(crate) fn section(run: &Run) -> Section {
    let (line, then) = (format!("hwasp tolerances {}", run.typed_path()), "what an error of each parameter costs");
    let body = run.tolerances.as_ref().map_or_else(|| not_yet("tolerances", &line, then), sensitivities);
    Section { id: "tolerances", title: "Which part has to be precise", body }
}

fn sensitivities(list: &Sensitivities) -> Markup {
    let about = "For each parameter two bars: the mean change where it is too small and where it is too large, with 95 % intervals. \
                 The table below has the numbers.";
    let chart = picture(&list.plot().svg, "tornado", "What errors of each parameter cost", about);
    html! {
        p {
            "Each parameter off by its manufacturing error, one at a time, on the same " (list.nominal.episodes)
            " held-out episodes. The one whose error costs most return is on top."
        }
        p { strong { (list.verdict()) } }
        (wide(&chart, "The chart; scroll to see all of it", "The changes are paired: each episode with itself."))
        table.cards {
            caption { "Change of return, with 95 % intervals, and success with each parameter off to either side" }
            thead {
                tr {
                    th scope="col" { "parameter" } th scope="col" { "error" } th.n scope="col" { "too small" }
                    th.n scope="col" { "too large" }
                }
            }
            tbody {
                @for parameter in &list.parameters {
                    tr {
                        th scope="row" { (parameter.name) }
                        td data-label="error" { "±" (parameter.error_text) }
                        td.n data-label="too small" { div { (side(&parameter.minus, parameter)) } }
                        td.n data-label="too large" { div { (side(&parameter.plus, parameter)) } }
                    }
                }
            }
        }
    }
}

fn side(side: &Side, of: &Sensitivity) -> Markup {
    let figure = &side.change.undiscounted_return;
    html! {
        (change(figure.mean, 1))
        br; small { (mean_interval(figure, 1)) }
        br; small { "at " (of.simulated(side)) }
        @if let Some(rate) = &side.success { br; small { "success " (percent(rate.rate())) } }
    }
}
