//! Held-out grasps, drawn as a film and as a row of stills. The drawings need no renderer: they are paths of an SVG.

mod pose;
mod shape;
mod sketch;
mod view;

use hwasp_training::Assembly;
use maud::{Markup, PreEscaped, html};
use serde::Serialize;

use self::pose::{Poses, poses};
use self::sketch::{Frame, Sketch};
use crate::play::{Moment, PlayError, PlayOptions, Take, check, film, moments};
use crate::words::decimal;

/// The most episodes that are looked through for one of each shape.
const MOST_EPISODES: u64 = 32;
/// Steps between pictures, and what a step lasts, s: 20 pictures a second.
const EVERY: usize = 5;
const STEP: f64 = 0.01;

/// What the script plays of an episode.
#[derive(Serialize)]
struct Reel {
    kind: &'static str,
    /// Height of the object above the floor, mm, per picture.
    height: Vec<i32>,
    /// The paths of each picture, slot by slot, parted by bars.
    frames: Vec<String>,
}

/// The first held-out episode of every shape.
pub(super) fn section(assembly: &Assembly, params: &[f32]) -> Result<Markup, PlayError> {
    let takes = takes(assembly, params)?;
    if takes.is_empty() {
        return Ok(html! { p { "None of the first " (MOST_EPISODES) " episodes came to its end." } });
    }
    let poses = takes.iter().map(|take| poses(assembly, take)).collect::<Result<Vec<_>, _>>()?;
    let sketch = Sketch::new(&poses);
    let seed = assembly.experiment().train.evaluation_seed;
    Ok(html! {
        p {
            "The first held-out episode of each shape (seed " (seed) "), by the deterministic controller on the hardware as built, \
             as the simulator moved it; none is chosen for its looks. The thumb is red, the fingers are blue; squares on the floor \
             are 50 mm."
        }
        div.grasps {
            (player(&sketch, &takes, &poses))
            div { @for (take, poses) in takes.iter().zip(&poses) { (stills(&sketch, take, poses)) } }
        }
    })
}

/// Episodes one after the other until every shape was there.
fn takes(assembly: &Assembly, params: &[f32]) -> Result<Vec<Take>, PlayError> {
    let shapes = check(assembly)?.shapes.len();
    let seed = assembly.experiment().train.evaluation_seed;
    let mut takes: Vec<Take> = Vec::new();
    for first in 0..MOST_EPISODES {
        if takes.len() == shapes {
            break;
        }
        let options = PlayOptions { first, episodes: 1, seed, native: false, size: [0, 0] };
        for take in film(assembly, params, &options)? {
            if takes.iter().all(|other| other.object.kind != take.object.kind) {
                takes.push(take);
            }
        }
    }
    Ok(takes)
}

fn verdict(take: &Take) -> &'static str {
    if take.success { "success" } else { "failure" }
}

/// What was grasped, in a line.
fn told(take: &Take) -> String {
    let [x, y, z] = take.object.size.map(|edge| decimal(1e3 * edge, 0));
    let (mass, friction) = (decimal(1e3 * take.object.mass, 0), decimal(take.object.friction, 2));
    format!("episode {}: {x} × {y} × {z} mm, {mass} g, friction {friction}", take.index)
}

/// The film, which waits for the script, and for those who do not want things to move.
fn player(sketch: &Sketch, takes: &[Take], poses: &[Poses]) -> Markup {
    let reel = |(take, poses): (&Take, &Poses)| {
        let last = poses.moments.len().saturating_sub(1);
        let steps = (0..last).step_by(EVERY).chain([last]);
        let frames: Vec<Frame> = steps.map(|step| sketch.frame(poses, step)).collect();
        Reel {
            kind: take.object.kind.name(),
            height: frames.iter().map(|frame| frame.height).collect(),
            frames: frames.into_iter().map(|frame| frame.slots.join("|")).collect(),
        }
    };
    let reels: Vec<Reel> = takes.iter().zip(poses).map(reel).collect();
    // The shapes' names are ours, so that nothing in it ends the script.
    let data = serde_json::to_string(&reels).expect("texts and whole numbers can be written as JSON");
    let first = poses.first().expect("there is a player only where there are takes");
    let start = sketch.frame(first, first.moments.len() / 2);
    html! {
        figure.player hidden data-step=(EVERY as f64 * STEP) {
            div.takes role="group" aria-label="Which grasp" {
                @for (i, take) in takes.iter().enumerate() {
                    button type="button" data-take=(i) aria-pressed=(i == 0) {
                        (take.object.kind.name()) " " span class=(verdict(take)) { (verdict(take)) }
                    }
                }
            }
            (sketch.svg(&start, true, ["player", "A grasp, drawn as a film", "The moments beside it show the same as stills."]))
            div.controls {
                button.play type="button" { "Play" }
                label { span.hidden { "Time" } input type="range" min="0" max="0" value="0" step="1"; }
                span.clock { "0.00 s" }
            }
            script type="application/json" { (PreEscaped(data)) }
        }
    }
}

/// Six moments of an episode.
fn stills(sketch: &Sketch, take: &Take, poses: &Poses) -> Markup {
    let kind = take.object.kind.name();
    let still = |(i, moment): (usize, Moment)| {
        let seconds = decimal(STEP * moment.step as f64, 2);
        let name = if moment.name.is_empty() { String::new() } else { format!("{}, ", moment.name) };
        let frame = sketch.frame(poses, moment.step);
        let about = format!("The object is {} mm above the floor.", frame.height);
        let title = format!("{kind}: {name}{seconds} s");
        html! {
            li { (sketch.svg(&frame, false, [&format!("still-{kind}-{i}"), &title, &about])) span { (name) (seconds) " s" } }
        }
    };
    html! {
        figure.stills {
            figcaption {
                strong { (kind) } " " span class=(verdict(take)) { (verdict(take)) } " " small { (told(take)) }
            }
            ol { @for (i, moment) in moments(&take.film.stills).into_iter().enumerate() { (still((i, moment))) } }
        }
    }
}
