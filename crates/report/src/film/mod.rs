//! Held-out episodes, drawn as a film and as a row of stills, of whatever [shows itself](hwasp_core::Environment::look). The
//! drawings need no renderer: they are paths of an SVG.

mod eye;
mod order;
mod outline;
mod reel;
mod set;
mod sketch;

use hwasp_scene::{LOOKED_THROUGH, Moment, Studio, Take};
use hwasp_training::{Assembly, EvaluateError, World};
use maud::{Markup, PreEscaped, html};

use self::reel::{Frame, Reel};
pub(crate) use self::set::Set;
pub(crate) use self::sketch::sketch;
use crate::words::{decimal, decimals};

/// Stills of an episode.
const STILLS: usize = 6;

/// Which episodes are filmed, and where.
pub(crate) struct Request<'a> {
    pub(crate) assembly: &'a Assembly,
    pub(crate) params: &'a [f32],
    pub(crate) world: &'a World,
    /// The design that acts there, SI.
    pub(crate) design: &'a [f64],
    /// The root seed of the starts.
    pub(crate) seed: u64,
    /// The indices of the episodes; the film chooses where there are none.
    pub(crate) episodes: Vec<u64>,
}

/// Films the episodes; there are none where nothing is to be seen of the world.
///
/// # Errors
/// Where no episode can be run.
pub(crate) fn takes(request: &Request<'_>) -> Result<Vec<Take>, EvaluateError> {
    let Request { assembly, params, world, design, seed, .. } = *request;
    let studio = Studio::new((assembly, params), (world, design), seed);
    let chosen = match &request.episodes[..] {
        [] => studio.choice()?,
        episodes => episodes.iter().map(|&index| (index, String::new())).collect(),
    };
    let mut takes = Vec::new();
    for (index, name) in chosen {
        takes.extend(studio.take(index, name)?);
    }
    Ok(takes)
}

/// Episodes from starts of a seed, drawn in at most so many bytes; none where there are none.
pub(crate) fn film(takes: &[Take], seed: u64, most_bytes: usize) -> Option<Markup> {
    if takes.is_empty() {
        return None;
    }
    let set = Set::new(takes);
    Some(html! {
        p { (told_of_all(takes, seed)) @if !set.ground.is_empty() { " Lines on the ground are " (length(set.spacing)) " apart." } }
        div.film {
            (player(&set, takes, most_bytes / takes.len()))
            div { @for (number, take) in takes.iter().enumerate() { (stills(&set, (number, take))) } }
        }
    })
}

/// What is shown, in a sentence.
fn told_of_all(takes: &[Take], seed: u64) -> String {
    let which = match takes {
        [one] => format!("Held-out episode {}", one.index),
        [best, worst] if best.name == "best" && worst.name == "worst" => {
            format!("The best and the worst, by return, of the first {LOOKED_THROUGH} held-out episodes")
        }
        [first, ..] if !first.name.is_empty() => "The first held-out episode of each kind".to_owned(),
        _ => "Held-out episodes".to_owned(),
    };
    format!("{which} (seed {seed}), by the deterministic controller on the hardware as built, as they were simulated.")
}

fn length(metres: f64) -> String {
    if metres < 1.0 { format!("{} mm", decimal(1e3 * metres, 0)) } else { format!("{} m", decimal(metres, 0)) }
}

/// How it ended, for tasks that know success: a word and its class.
fn verdict(take: &Take) -> Option<&'static str> {
    take.success().map(|success| if success { "success" } else { "failure" })
}

/// What an episode is called.
fn title(take: &Take) -> String {
    if take.name.is_empty() { format!("episode {}", take.index) } else { take.name.clone() }
}

/// What it was about and came to, in a line.
fn told_of_take(take: &Take) -> String {
    let worth = take.result.undiscounted_return;
    let about = take.moments.first().map_or("", |moment| &moment.sight.about);
    let gap = if about.is_empty() { "" } else { ", " };
    format!(
        "episode {}: {about}{gap}return {}, {} steps",
        take.index,
        decimal(worth, decimals(worth)),
        take.result.steps
    )
}

/// What is to be known of a moment.
pub(crate) fn told_of_moment(moment: &Moment) -> String {
    if moment.sight.told.is_empty() {
        format!("return {}", decimal(moment.worth, decimals(moment.worth)))
    } else {
        moment.sight.told.clone()
    }
}

/// The film, which waits for the script, and for those who do not want things to move.
fn player(set: &Set, takes: &[Take], each: usize) -> Markup {
    let reels: Vec<Reel> = takes.iter().enumerate().map(|take| Reel::new(set, take, each)).collect();
    let data = serde_json::to_string(&reels).expect("texts and finite numbers can be written as JSON");
    let names = ["player", "Episodes, drawn as a film", "The moments beside it show the same as stills."];
    html! {
        figure.player hidden {
            div.takes role="group" aria-label="Which episode" {
                @for (i, take) in takes.iter().enumerate() {
                    button type="button" data-take=(i) aria-pressed=(i == 0) {
                        (title(take)) @if let Some(verdict) = verdict(take) { " " span class=(verdict) { (verdict) } }
                    }
                }
            }
            (drawing(set, (0, &takes[0], takes[0].moments.len() / 2), true, names))
            div.controls {
                button.play type="button" { "Play" }
                label { span.hidden { "Time" } input type="range" min="0" max="0" value="0" step="1"; }
                span.clock { "0.00 s" }
            }
            script type="application/json" { (PreEscaped(hwasp_scene::data(&data))) }
        }
    }
}

/// Some moments of an episode.
fn stills(set: &Set, (number, take): (usize, &Take)) -> Markup {
    let still = |(i, name): (usize, &str)| {
        let moment = &take.moments[i];
        let seconds = decimal(take.time_step * moment.step as f64, 2);
        let gap = if name.is_empty() { "" } else { ", " };
        let (id, title) = (format!("still-{number}-{i}"), format!("{}: {name}{gap}{seconds} s", title(take)));
        html! {
            li { (drawing(set, (number, take, i), false, [&id, &title, &told_of_moment(moment)])) span { (name) (gap) (seconds) " s" } }
        }
    };
    html! {
        figure.stills {
            figcaption {
                strong { (title(take)) }
                @if let Some(verdict) = verdict(take) { " " span class=(verdict) { (verdict) } }
                " " small { (told_of_take(take)) }
            }
            ol { @for chosen in chosen(take) { (still(chosen)) } }
        }
    }
}

/// Moments for stills, with what happens there: start, the first of everything of note, end; evenly spread ones where there are
/// fewer.
pub(crate) fn chosen(take: &Take) -> Vec<(usize, &str)> {
    let last = take.moments.len() - 1;
    let mut chosen = vec![(0, "start")];
    chosen.extend((last > 0).then_some((last, "end")));
    for (i, moment) in take.moments.iter().enumerate().take(last).skip(1) {
        for name in &moment.sight.moments {
            let new = chosen.iter().all(|&(at, known)| at != i && known != *name);
            if new && chosen.len() < STILLS {
                chosen.push((i, name));
            }
        }
    }
    chosen.sort_by_key(|chosen| chosen.0);
    while chosen.len() < STILLS.min(last + 1) {
        // Into the middle of the widest gap.
        let Some(widest) = (1..chosen.len()).max_by_key(|&i| (chosen[i].0 - chosen[i - 1].0, usize::MAX - i)) else {
            break;
        };
        let middle = usize::midpoint(chosen[widest - 1].0, chosen[widest].0);
        chosen.insert(widest, (middle, ""));
    }
    chosen.dedup_by_key(|chosen| chosen.0);
    chosen
}

/// A picture with its name; `id` is its own. That of a `film` has all its slots, numbered, for the paths to come.
fn drawing(set: &Set, take: (usize, &Take, usize), film: bool, [id, title, about]: [&str; 3]) -> Markup {
    let [width, height] = set.size;
    html! {
        svg.sketch viewBox={ "0 0 " (width) " " (height) } role="img" aria-labelledby={ (id) "-t " (id) "-d" } {
            title id={ (id) "-t" } { (title) }
            desc id={ (id) "-d" } { (about) }
            (shapes(set, take, film))
        }
    }
}

/// What is drawn of a moment of an episode.
fn shapes(set: &Set, (number, take, i): (usize, &Take, usize), film: bool) -> Markup {
    let sight = &take.moments[i].sight;
    let frame = Frame::new(set, (number, i), sight);
    let [left, top] = frame.corner.map(|at| -at);
    let solids = sight.solids.len();
    let colour = |[r, g, b]: [u8; 3]| format!("#{r:02x}{g:02x}{b:02x}");
    let slot = |slot: usize| {
        let (path, number) = (&frame.paths[slot], film.then_some(slot));
        if let Some(solid) = sight.solids.get(slot) {
            let opacity = (solid.opacity < 1.0).then(|| decimal(f64::from(solid.opacity), 2));
            html! { path data-slot=[number] fill=(colour(solid.colour)) fill-opacity=[opacity] d=(path) {} }
        } else {
            let cord = &sight.cords[slot - solids];
            html! { path.cord data-slot=[number] stroke=(colour(cord.colour)) d=(path) {} }
        }
    };
    html! {
        g.camera transform={ "translate(" (left) " " (top) ")" } {
            @for [outline, lines] in &set.ground {
                @if !outline.is_empty() { path.floor d=(outline) {} }
                path.grid d=(lines) {}
            }
            g.solids { @for &i in &frame.order { (slot(i)) } }
        }
    }
}

#[cfg(test)]
mod tests {
    use hwasp_core::{End, EpisodeResult, Form, Sight, Solid};

    use super::*;

    /// A ball that moves to the right by so much a moment, over a floor, beside a post.
    fn take(speed: f64, moments: usize, seen: fn(usize) -> Vec<&'static str>) -> Take {
        let solid = |form, at, fixed| Solid { fixed, ..Solid::new(form, at, [10, 200, 30]) };
        let moment = |i: usize| {
            let solids = vec![
                solid(Form::Plane([0.0; 2]), [0.0; 3], true),
                solid(Form::Ellipsoid([0.1; 3]), [speed * i as f64, 0.0, 0.1], false),
                solid(Form::Box([0.02, 0.02, 0.2]), [0.3, 0.0, 0.2], true),
            ];
            Moment { step: 5 * i, worth: i as f64, sight: Sight { solids, moments: seen(i), ..Sight::default() } }
        };
        let result = EpisodeResult {
            discounted_return: 1.0,
            undiscounted_return: 2.0,
            steps: 5 * moments,
            end: End::Truncated,
            ended_by: None,
            outcome: None,
            terms: vec![],
        };
        Take { index: 3, name: "best".into(), moments: (0..moments).map(moment).collect(), result, time_step: 0.01 }
    }

    #[test]
    fn the_camera_follows_what_goes_away_and_stands_still_otherwise() {
        let still = Set::new(&[take(0.002, 20, |_| vec![])]);
        assert!(still.corners[0].iter().all(|corner| *corner == still.corners[0][0]), "{:?}", still.corners);
        let set = Set::new(&[take(0.2, 100, |_| vec![])]);
        let [first, last] = [0, 99].map(|i| set.corners[0][i]);
        // From the side on which x is to the right; less than the whole way by what smoothing takes at both ends.
        let way = set.eye.flat([19.8, 0.0, 0.0]);
        let shares = [0, 1].map(|k| (last[k] - first[k]) / way[k]);
        assert!(way[0] > 0.0 && shares.iter().all(|share| (0.9..1.0).contains(share)), "{shares:?} of {way:?}");
        let [x, y] = set.eye.flat([0.0, 0.0, 0.1]);
        assert!((first[0]..first[0] + set.size[0]).contains(&x) && (first[1]..first[1] + set.size[1]).contains(&y));
        assert_eq!(set.ground.len(), 1);
    }

    #[test]
    fn a_film_has_what_changes_within_its_bytes() {
        let takes = [take(0.002, 100, |_| vec![])];
        let set = Set::new(&takes);
        let json = |most| serde_json::to_value(Reel::new(&set, (0, &takes[0]), most)).unwrap();
        let frames = |reel: &serde_json::Value| -> Vec<String> {
            reel["frames"].as_array().unwrap().iter().map(|frame| frame.as_str().unwrap().to_owned()).collect()
        };
        let whole = json(usize::MAX);
        let all = frames(&whole);
        assert_eq!(
            (all.len(), whole["times"][99].as_f64(), whole["told"][2].as_str()),
            (100, Some(4.95), Some("return 2.00"))
        );
        let parts: Vec<&str> = all[0].split('|').collect();
        // Corner, order without the floor, then floor, ball and post.
        assert!(
            parts.len() == 5 && parts[2] == "M0 0" && parts[3].contains('a') && parts[4].contains('l'),
            "{parts:?}"
        );
        assert!(all[1..].iter().all(|frame| frame.starts_with("||") && frame.ends_with('|')), "{:?}", all[1]);
        let short = frames(&json(1500));
        assert!(short.iter().map(String::len).sum::<usize>() <= 1500 && short.len() > 12, "{}", short.len());
        assert_eq!(frames(&json(1)).len(), 12);
    }

    #[test]
    fn stills_show_what_is_of_note() {
        let seen = |i| {
            if i >= 40 {
                vec!["contact", "lifted"]
            } else if i >= 7 {
                vec!["contact"]
            } else {
                vec![]
            }
        };
        let of = |moments| {
            chosen(&take(0.1, moments, seen)).into_iter().map(|(i, name)| format!("{i}{name}")).collect::<Vec<_>>()
        };
        assert_eq!(of(101), ["0start", "7contact", "23", "40lifted", "70", "100end"]);
        assert_eq!(of(3), ["0start", "1", "2end"]);
        assert_eq!(of(1), ["0start"]);
    }
}
