//! What statics say of a hand.

use hwasp_core::Batch;
use hwasp_plot::{PanelPlot, closing_panels, traces, transmission};
use hwasp_tasks::hand::{DESIGN_LEN, HandDescription};
use hwasp_workshop::design::hand_of;
use hwasp_workshop::design::{DigitPair, HandReport, PinchBand, PinchReport, PinchTension};
use maud::{Markup, html};

use super::curves::panels;
use super::design::judged;
use crate::episode::{efforts, first_episode};
use crate::figure::{gallery, picture, wide};
use crate::page::Section;
use crate::run::Run;
use crate::trials::Played;
use crate::words::{decimal, sentence, spaced};

/// Efforts of the law that are drawn over time, with their names.
const TORQUES: [(&str, &str); 4] = [
    ("thumb_proximal_torque", "thumb, proximal"),
    ("thumb_distal_torque", "thumb, distal"),
    ("finger1_proximal_torque", "finger, proximal"),
    ("finger1_distal_torque", "finger, distal"),
];

pub(crate) fn section(run: &Run, hand: &HandReport, played: Option<&Played>) -> Section {
    // A third of the chart's points is one for each pixel of a small picture.
    let points: Vec<_> = hand.chart().iter().copied().step_by(3).collect();
    let plots = closing_panels(&points, hand.tension_limit);
    let end = decimal(1e3 * hand.closing_end, 1);
    let limit = decimal(hand.tension_limit, 0);
    let body = html! {
        @if let Some(description) = hand_of(&run.spec) { (drawing(run, description)) }
        @if let Some(played) = played { (over_time(run, played)) }
        div.part.whole {
        h3 { "Free closing" }
        p {
            @if hand.spends_its_tension {
                "With nothing in the hand the motor is at its limit of " (limit) " N when it has wound " (end) " mm."
            } @else {
                "With nothing in the hand all is wound at " (end) " mm, and the motor is not yet at its limit of " (limit) " N."
            }
        }
        (panels(&plots, "closing", "against motor travel"))
        (judged(&hand.judged.closing))
        }
        div.part { h3 { "Open, palm down" } (open(hand)) (judged(&hand.judged.open)) }
        div.part { h3 { "Pinches" } (pinches(hand)) (judged(&hand.judged.pinch)) }
    };
    Section { id: "mechanism", title: "What the mechanism does", body }
}

/// The transmission to scale, with the design as it is to be built.
fn drawing(run: &Run, hand: &HandDescription) -> Markup {
    let built: Vec<f64> = run.design.groups.iter().flat_map(|group| group.group.as_built.iter().copied()).collect();
    let Some(design) = built.first_chunk::<DESIGN_LEN>() else { return html! {} };
    let about = "The palm with its spool, thumb and finger open, a pulley at each joint, and the tendon of each digit from the spool round \
                 both pulleys to the fingertip.";
    let svg = picture(&transmission(hand, design), "transmission", "The transmission from the side, to scale", about);
    let caption = "One motor winds three tendons, each over two pulleys to its fingertip; a spring at each joint opens. The second finger is \
                   behind the first. Pulleys are as large as they are designed.";
    html! { div.part.whole { h3 { "The transmission" } (wide(&svg, "The drawing; scroll to see all of it", caption)) } }
}

/// What the motor winds and what the joints feel in an episode.
fn over_time(run: &Run, Played { saved, params, .. }: &Played) -> Markup {
    let assembly = saved.assembly();
    let seed = run.summary.evaluation.seed;
    let Ok(batch) = first_episode(assembly, params, seed) else { return html! {} };
    let env = &assembly.worlds.deployment.env;
    let travel = env.state.iter().position(|port| port.name == "motor_travel");
    let travel = travel.map(|i| column(&batch, env.state.len(), i));
    let efforts = efforts(assembly, params, &batch);
    let named = |(port, name): (&str, &'static str)| {
        efforts.iter().find(|(known, _)| known.name == port).map(|(_, values)| (name, values.clone()))
    };
    let torques: Vec<(&str, Vec<f64>)> = TORQUES.into_iter().filter_map(named).collect();
    let motor: Vec<(&str, Vec<f64>)> = named(("motor_torque", "motor")).into_iter().collect();
    let plots: Vec<PanelPlot> = [
        travel.and_then(|values| traces("motor travel", "mm", env.time_step, &[("motor", values)])),
        traces("torque at the spool", "N·m", env.time_step, &motor),
        traces("torque at the joints, closing", "N·m", env.time_step, &torques),
    ]
    .into_iter()
    .flatten()
    .collect();
    let about = "One line for each over the time of the episode.";
    let pictures: Vec<Markup> = (plots.iter().enumerate())
        .map(|(i, plot)| {
            picture(&plot.svg, &format!("over-time-{i}"), &format!("{} in one episode", sentence(&plot.label)), about)
        })
        .collect();
    html! {
        div.part.whole {
        h3 { "Travel and torque in an episode" }
        p { "The first held-out episode: what the motor has wound, what that takes, and what the law gives the joints of thumb and first finger." }
        (gallery(&pictures, ""))
        }
    }
}

/// A column of the states of a batch.
fn column(batch: &Batch, width: usize, i: usize) -> Vec<f64> {
    batch.state.iter().skip(i).step_by(width.max(1)).map(|&value| f64::from(value)).collect()
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
