//! A moment as a picture by itself, for whoever makes pixels of it.

use hwasp_scene::Take;

use super::{Set, shapes};

/// The report's style by day.
const STYLE: &str = "svg { stroke-linecap: round; stroke-linejoin: round } \
    .floor { fill: #f5f6f8; stroke: #d9dde3; stroke-width: 6 } .grid { fill: none; stroke: #d9dde3; stroke-width: 4 } \
    .solids { stroke: #14181f; stroke-width: 6 } .cord { fill: none; stroke-width: 10 }";

/// Moment `i` of episode `number` of a set as an SVG of so many pixels across and down, with bands above and below that stay free.
pub(crate) fn sketch(set: &Set, (number, take, i): (usize, &Take, usize), size: [usize; 2], band: f64) -> String {
    let ([width, height], [wide, high]) = (size, set.size);
    let (inner, shapes) = (height as f64 - 2.0 * band, shapes(set, (number, take, i), false).into_string());
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\"><style>{STYLE}</style>\
         <svg y=\"{band}\" width=\"{width}\" height=\"{inner}\" viewBox=\"0 0 {wide} {high}\">{shapes}</svg></svg>"
    )
}
