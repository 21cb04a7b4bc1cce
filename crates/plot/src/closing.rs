//! The closing chart of a hand: angles and tensions against what the motor has wound.

use hwasp_tasks::hand::{ClosingPoint, FreeClosing};

use crate::draw::{Entry, Page, one_by_one, picture};
use crate::options::{PanelText, Theme};
use crate::panel::{Panel, SECOND_ROUND};
use crate::picture::{PanelPlots, Plot};
use crate::series::{Line, Shape};

/// Places of the legend, which are colours: the distal joints have those of their digits in the second, broken round.
const THUMB: usize = 0;
const FINGER: usize = 1;
const ALL: usize = 6;

/// What the dashes are.
const LIMIT: &str = "the motor's limit";
const EXPLANATION: &str = "without gravity and object; 0 is open";

/// Draws free closing up to the last of the `points`, with the most that the tendons pull together, N.
pub fn closing_plot(points: &[ClosingPoint], tension_limit: f64, title: &str) -> Plot {
    let page = Page {
        title,
        untitled: "free closing",
        reference: LIMIT,
        explanation: EXPLANATION.to_owned(),
        ..Page::default()
    };
    Plot { svg: picture(&panels(points, tension_limit), &BOTH, &page), theme: Theme::Screen, notes: Vec::new() }
}

/// The same as two small pictures, and what their lines mean.
pub fn closing_panels(points: &[ClosingPoint], tension_limit: f64) -> PanelPlots {
    let legend = |panel: usize| if panel == 0 { &ANGLES[..] } else { &TENSIONS[..] };
    let panels = one_by_one(panels(points, tension_limit).into(), legend, LIMIT);
    PanelPlots { panels, explanation: EXPLANATION.to_owned(), notes: Vec::new() }
}

const fn entry(place: usize, label: &str) -> Entry<'_> {
    Entry { place, label, runs: 1, asked: 1 }
}

/// The legends of both pictures in one, of the angles, and of the tensions.
const BOTH: [Entry<'_>; 5] = [
    entry(THUMB, "thumb: angle of the proximal joint, tension"),
    entry(SECOND_ROUND + THUMB, "thumb: angle of the distal joint"),
    entry(FINGER, "each finger: angle of the proximal joint, tension"),
    entry(SECOND_ROUND + FINGER, "each finger: angle of the distal joint"),
    entry(ALL, "the three tendons together"),
];
const ANGLES: [Entry<'_>; 4] = [
    entry(THUMB, "thumb, proximal"),
    entry(SECOND_ROUND + THUMB, "thumb, distal"),
    entry(FINGER, "finger, proximal"),
    entry(SECOND_ROUND + FINGER, "finger, distal"),
];
const TENSIONS: [Entry<'_>; 3] =
    [entry(THUMB, "thumb"), entry(FINGER, "each finger"), entry(ALL, "the three tendons together")];

fn panels(points: &[ClosingPoint], tension_limit: f64) -> [Panel; 2] {
    let line = |value: &dyn Fn(&ClosingPoint) -> f64| {
        let smooth = points.iter().map(|p| (1e3 * p.travel, value(p))).collect();
        Some(Shape::Single(Line { raw: Vec::new(), smooth }))
    };
    let digit = |finger: bool, p: &ClosingPoint| -> FreeClosing { if finger { p.finger } else { p.thumb } };
    let angle = |finger: bool, joint: usize| line(&move |p| digit(finger, p).angles[joint]);
    let shapes = |lines: Vec<(usize, Option<Shape>)>| {
        let mut shapes: Vec<Option<Shape>> = Vec::new();
        shapes.resize_with(SECOND_ROUND + FINGER + 1, || None);
        for (place, line) in lines {
            shapes[place] = line;
        }
        shapes
    };
    let angles = shapes(vec![
        (THUMB, angle(false, 0)),
        (SECOND_ROUND + THUMB, angle(false, 1)),
        (FINGER, angle(true, 0)),
        (SECOND_ROUND + FINGER, angle(true, 1)),
    ]);
    let tensions = shapes(vec![
        (THUMB, line(&|p| p.thumb.tension)),
        (FINGER, line(&|p| p.finger.tension)),
        (ALL, line(&|p| p.total_tension)),
    ]);
    let text = |label: &str, unit: &str, optimum| PanelText {
        column: String::new(),
        label: label.to_owned(),
        unit: unit.to_owned(),
        optimum,
    };
    let wound = "motor travel (mm)";
    [
        Panel::new(text("joint angle", "deg", None), wound, angles),
        Panel::new(text("tension", "N", Some(tension_limit)), wound, tensions),
    ]
}
