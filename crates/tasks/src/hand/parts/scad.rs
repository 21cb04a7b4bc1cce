//! The same parts as an OpenSCAD file, for whoever wants them otherwise: every number that can be chosen is at its top.

use std::fmt::Write;

use super::super::description::HandDescription;
use super::super::error::HandError;
use super::super::names::KINDS;
use super::super::solid::SEGMENTS;
use super::super::space::DESIGN_LEN;
use super::{LINK_PARTS, PALM_PART, PULLEY_PARTS, Stock, stock};

/// What follows from the parameters: `link.rs`, `pulley.rs`, `palm.rs` and `stock.rs` in OpenSCAD's language.
const MODULES: &str = include_str!("hand.scad");

/// The parts in OpenSCAD's language: parameters in mm, N·mm/rad and rad, then modules that make [`parts`](super::parts) of them.
pub fn scad(hand: &HandDescription, design: &[f64; DESIGN_LEN], stock: &Stock) -> Result<String, HandError> {
    stock.check(hand, design)?;
    let mut text = String::from("// An underactuated hand. Lengths in mm, angles in rad.\n\n");
    let names = [PALM_PART].into_iter().chain(LINK_PARTS).chain(PULLEY_PARTS).collect::<Vec<_>>().join(", ");
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "// What to show: \"hand\", all of it with the digits open, or one of\n// {names}.\npart = \"hand\";\n"
    );
    let _ = writeln!(text, "// The design, in the order {}.", KINDS.join(", "));
    let quantities = [
        ("radius", 1e3, "from the centre of the line to that of the shaft"),
        ("stiffness", 1e3, "of the spring, N·mm/rad: to buy by; no shape follows from it"),
        ("preload", 1.0, "of the spring with the hand open, rad"),
    ];
    for ((name, unit, meaning), values) in quantities.into_iter().zip(design.chunks(4)) {
        let _ = writeln!(text, "{name} = {}; // {meaning}", list(values, unit));
    }
    text.push_str("\n// The hand.\n");
    let digits = hand.digits();
    let (lengths, radii): (Vec<f64>, Vec<f64>) = [digits[0], digits[1]]
        .iter()
        .flat_map(|digit| [&digit.proximal, &digit.distal])
        .map(|link| (link.length, link.radius))
        .unzip();
    let bases = digits.map(|digit| list(&digit.base[..2], 1e3));
    for (name, value, meaning) in [
        ("link_length", list(&lengths, 1e3), "joint to joint, joint to centre of the tip; in the order of the design"),
        ("link_radius", list(&radii, 1e3), "of the capsules"),
        ("palm_half_size", list(&hand.palm.half_size, 1e3), "in x, y, z; the proximal joints lie in its lower face"),
        ("base", format!("[{}]", bases.join(", ")), "x and y of the proximal joints: thumb, finger1, finger2"),
        ("rest_angle", number(hand.joint.rest_angle), "of the open links from straight down"),
        ("closed_angle", number(hand.joint.range[1]), "how far each joint closes"),
    ] {
        let _ = writeln!(text, "{name} = {value}; // {meaning}");
    }
    text.push_str("\n// What is bought, and what the printer can do.\n");
    for (name, value, meaning) in [
        ("line_diameter", stock.line_diameter, "the tendon"),
        ("shaft_diameter", stock.shaft_diameter, "of the joints"),
        ("leg_diameter", stock.leg_diameter, "the wire of the springs' legs; pins of the distal pulleys"),
        ("spring_diameter", stock.spring_diameter, "of the coils, outside"),
        ("spring_length", stock.spring_length, "of the coils, along the shaft"),
        ("clearance", stock.clearance, "between parts that move on each other"),
        ("wall", stock.wall, "the thinnest wall"),
        ("flange", stock::FLANGE, "of a pulley, each"),
        ("prong", stock::PRONG, "beside a spring"),
        ("cheek", stock::CHEEK, "of a link's fork and of the palm's lugs"),
        ("frame", stock::FRAME, "around a link's window"),
    ] {
        let _ = writeln!(text, "{name} = {}; // {meaning}", number(1e3 * value));
    }
    let _ = write!(text, "\n$fn = {SEGMENTS}; // segments of a circle\n\n{MODULES}");
    Ok(text)
}

fn list(values: &[f64], unit: f64) -> String {
    let numbers: Vec<String> = values.iter().map(|value| number(unit * value)).collect();
    format!("[{}]", numbers.join(", "))
}

/// To a millionth of a millimetre or radian, without what multiplication leaves behind.
fn number(value: f64) -> String {
    ((1e6 * value).round() / 1e6).to_string()
}

#[cfg(test)]
mod tests {
    use super::super::super::space::SEARCHED;
    use super::*;

    #[test]
    fn parameters_are_at_the_top_and_every_part_can_be_shown() {
        let text = scad(&HandDescription::default(), &SEARCHED, &Stock::default()).unwrap();
        let (top, rest) = text.split_once("$fn = 96;").unwrap();
        for line in [
            "radius = [10.9, 9.7, 7.7, 5.3]; ",
            "stiffness = [5.7, 6, 9, 6]; ",
            "preload = [2, 0.36, 2.06, 0.63]; ",
            "link_length = [50, 40, 50, 40]; ",
            "base = [[0, -35], [25, 35], [-25, 35]]; ",
            "line_diameter = 0.6; ",
        ] {
            assert!(top.lines().any(|found| found.starts_with(line)), "{line}:\n{top}");
        }
        for part in LINK_PARTS.iter().chain(&PULLEY_PARTS).chain(&[PALM_PART]) {
            assert!(rest.contains(&format!("if (part == \"{part}\")")), "{part}");
        }
        let balanced = |open: char, close: char| text.matches(open).count() == text.matches(close).count();
        assert!(balanced('(', ')') && balanced('{', '}') && balanced('[', ']'));
    }
}
