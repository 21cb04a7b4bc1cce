//! An episode as text that the page's script plays: paths of every solid, and of moments only what has changed.

use std::fmt::Write;

use hwasp_core::{Cord, Sight};
use serde::Serialize;

use super::order::painted;
use super::outline::{outline, polyline};
use super::set::Set;
use hwasp_scene::Take;

/// What the script plays of an episode.
#[derive(Debug, Serialize)]
pub(super) struct Reel {
    /// The time of each picture, s.
    times: Vec<f64>,
    /// What is told of each.
    told: Vec<String>,
    /// Each picture: the corner, the order of the slots, and the path of each slot, parted by bars. What is as before is empty.
    frames: Vec<String>,
}

/// A picture.
#[derive(Clone, Debug, Default)]
pub(super) struct Frame {
    /// Its upper left corner.
    pub(super) corner: [f64; 2],
    /// Slots from the back to the front; ground has none.
    pub(super) order: Vec<usize>,
    /// The path of each solid, then of each cord.
    pub(super) paths: Vec<String>,
}

/// What is written where a path is empty: nothing at all is what was there before.
const NOTHING: &str = "M0 0";

impl Frame {
    /// Moment `i` of episode `take` of a set.
    pub(super) fn new(set: &Set, (take, i): (usize, usize), sight: &Sight) -> Self {
        let solids = sight.solids.len();
        let paths = sight.solids.iter().map(|solid| outline(&set.eye, solid));
        let cord = |cord: &Cord| -> String {
            let line = |part: &Vec<[f64; 3]>| polyline(&part.iter().map(|&at| set.eye.flat(at)).collect::<Vec<_>>());
            cord.parts.iter().map(line).collect()
        };
        Self {
            corner: set.corners[take][i],
            order: painted(&set.eye, &sight.solids).into_iter().chain(solids..solids + sight.cords.len()).collect(),
            paths: paths.chain(sight.cords.iter().map(cord)).collect(),
        }
    }

    /// As text, after another picture.
    fn after(&self, before: Option<&Self>) -> String {
        let mut text = String::new();
        let same = |of: fn(&Self) -> String| {
            Some(of(self)).filter(|now| before.map(of).as_ref() != Some(now)).unwrap_or_default()
        };
        text.push_str(&same(|frame| format!("{} {}", frame.corner[0], frame.corner[1])));
        text.push('|');
        text.push_str(&same(|frame| frame.order.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")));
        for (slot, path) in self.paths.iter().enumerate() {
            let known = before.and_then(|before| before.paths.get(slot));
            let path = if known == Some(path) {
                ""
            } else if path.is_empty() {
                NOTHING
            } else {
                path
            };
            let _ = write!(text, "|{path}");
        }
        text
    }
}

impl Reel {
    /// An episode of a set, in at most so many bytes: with fewer pictures where it has too many.
    pub(super) fn new(set: &Set, (number, take): (usize, &Take), most_bytes: usize) -> Self {
        let frame = |i: usize| Frame::new(set, (number, i), &take.moments[i].sight);
        let frames: Vec<Frame> = (0..take.moments.len()).map(frame).collect();
        let mut every = 1;
        loop {
            let last = frames.len().saturating_sub(1);
            let shown: Vec<usize> = (0..last).step_by(every).chain([last]).collect();
            let mut before = None;
            let mut text = |&i: &usize| frames[i].after(before.replace(&frames[i]));
            let texts: Vec<String> = shown.iter().map(&mut text).collect();
            let bytes: usize = texts.iter().map(String::len).sum();
            if bytes <= most_bytes || shown.len() <= 12 {
                let moment = |&i: &usize| &take.moments[i];
                return Self {
                    times: shown.iter().map(|i| (moment(i).step as f64 * take.time_step * 1e3).round() / 1e3).collect(),
                    told: shown.iter().map(|i| super::told_of_moment(moment(i))).collect(),
                    frames: texts,
                };
            }
            every += 1;
        }
    }
}
