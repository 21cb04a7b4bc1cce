//! What statics say of a hand.

use hwasp_plot::closing_panels;
use hwasp_workshop::design::{DigitPair, HandReport, PinchBand, PinchReport, PinchTension};
use maud::{Markup, html};

use super::curves::panels;
use crate::page::Section;
use crate::words::{decimal, spaced};

pub(crate) fn section(hand: &HandReport) -> Section {
    // A third of the chart's points is one for each pixel of a small picture.
    let points: Vec<_> = hand.chart().iter().copied().step_by(3).collect();
    let plots = closing_panels(&points, hand.tension_limit);
    let end = decimal(1e3 * hand.closing_end, 1);
    let limit = decimal(hand.tension_limit, 0);
    let body = html! {
        h3 { "Free closing" }
        p {
            @if hand.spends_its_tension {
                "With nothing in the hand the motor is at its limit of " (limit) " N when it has wound " (end) " mm."
            } @else {
                "With nothing in the hand all is wound at " (end) " mm, and the motor is not yet at its limit of " (limit) " N."
            }
        }
        (panels(&plots, "closing", "against motor travel"))
        h3 { "Open, palm down" }
        (open(hand))
        h3 { "Pinches" }
        (pinches(hand))
    };
    Section { id: "mechanism", title: "What the mechanism does", body }
}

/// Whether springs hold the digits against their weight.
fn open(hand: &HandReport) -> Markup {
    let fate = |open: bool| if open { "stays open" } else { "droops shut" };
    let DigitPair { thumb, finger } = hand.stays_open;
    html! {
        p { "Against its own weight the thumb " (fate(thumb)) ", and each finger " (fate(finger)) "." }
        table {
            caption { "Torques at the joints of the open hand, N·mm" }
            thead {
                tr {
                    th scope="col" { "joint" } th.n scope="col" { "spring opens" } th.n scope="col" { "weight closes" }
                    th.n scope="col" { "margin" }
                }
            }
            tbody {
                @for joint in &hand.joints {
                    tr {
                        th scope="row" { (spaced(joint.joint)) }
                        td.n { (decimal(1e3 * joint.spring, 2)) }
                        td.n { (decimal(1e3 * joint.weight, 2)) }
                        td.n { (decimal(1e3 * joint.margin, 2)) }
                    }
                }
            }
        }
    }
}

fn pinches(hand: &HandReport) -> Markup {
    let limit = decimal(hand.tension_limit, 0);
    html! {
        p {
            "Objects held by the tips alone, 30 mm below the distal joints, with friction 0.5 and 1.5 times the weight. A pinch \
             holds where the ratio of proximal to distal torque lies in the band; below it the distal links curl in and embrace \
             the object, which takes less than half of the tension."
        }
        table.cards {
            caption { "Pinches from small to large, and the torque ratios of this design" }
            thead {
                tr {
                    th scope="col" { "width" } th.n scope="col" { "band that holds" } th.n scope="col" { "thumb" }
                    th.n scope="col" { "finger" } th.n scope="col" { "lifts at " (limit) " N" } th.n scope="col" { "500 g takes" }
                }
            }
            tbody { @for pinch in &hand.pinches { (row(pinch, &limit)) } }
        }
    }
}

fn row(pinch: &PinchReport, limit: &str) -> Markup {
    let ratio = |ratio: Option<f64>| ratio.map_or("none".to_owned(), |ratio| decimal(ratio, 2));
    let band = |band: PinchBand| format!("{} to {}", decimal(band.lo, 2), decimal(band.hi, 2));
    let takes = |needs: PinchTension| format!("{} N ({} N·m)", decimal(needs.total, 0), decimal(needs.motor_torque, 2));
    html! {
        tr {
            th scope="row" { (decimal(1e3 * pinch.width, 0)) " mm" }
            td.n data-label="band that holds" { (pinch.band.map_or("out of reach".to_owned(), band)) }
            td.n data-label="thumb" { (ratio(pinch.torque_ratio.thumb)) }
            td.n data-label="finger" { (ratio(pinch.torque_ratio.finger)) }
            td.n data-label={ "lifts at " (limit) " N" } {
                (pinch.capacity.map_or("–".to_owned(), |mass| format!("{} g", decimal(1e3 * mass, 0))))
            }
            td.n data-label="500 g takes" { (pinch.heaviest.map_or("–".to_owned(), takes)) }
        }
    }
}
