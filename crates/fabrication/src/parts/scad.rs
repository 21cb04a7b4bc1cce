//! The same parts as an OpenSCAD file, for whoever wants them otherwise: every number that can be chosen is at its top.

use std::fmt::Write;

use super::layout::{FRAME, Layout, PIN_CIRCLE};
use super::palm::hollows;
use super::parts;
use crate::error::PartError;
use crate::solid::{HOLE_SEGMENTS, Outline, SEGMENTS};
use crate::workshop::{SeatedSpring, Workshop};
use hwasp_tasks::hand::DESIGN_LEN;
use hwasp_tasks::hand::HandDescription;
use hwasp_tasks::hand::names::{KINDS, LINK_PARTS, MOUNT_PARTS, PALM_PART, PULLEY_PARTS};

/// What follows from the parameters: `link.rs`, `pulley.rs`, `palm.rs` and `layout.rs` in OpenSCAD's language.
const MODULES: &str = include_str!("hand.scad");

/// The parts in OpenSCAD's language: parameters in mm, N·mm/rad and rad, then modules that make [`parts`](super::parts) of them.
pub fn scad(
    hand: &HandDescription,
    design: &[f64; DESIGN_LEN],
    springs: &[SeatedSpring; 4],
    workshop: &Workshop,
) -> Result<String, PartError> {
    let layout = Layout { workshop, springs };
    layout.check(hand, design)?;
    let mut text = String::from("// An underactuated hand. Lengths in mm, angles in rad.\n\n");
    let names =
        [PALM_PART].into_iter().chain(LINK_PARTS).chain(PULLEY_PARTS).chain(MOUNT_PARTS).collect::<Vec<_>>().join(", ");
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "// What to show: \"hand\", all of it with the digits open, or one of\n// {names}.\npart = \"hand\";\n"
    );
    let _ = writeln!(text, "// The design, in the order {}.", KINDS.join(", "));
    let quantities = [
        ("radius", 1e3, "from the centre of the line to that of the axle"),
        ("stiffness", 1e3, "of a joint's springs together, N·mm/rad: to buy by; no shape follows from it"),
        (
            "preload",
            1.0,
            "of the springs with the hand open, rad: the hole of the fixed legs gives it; no shape follows from it",
        ),
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
    text.push_str("\n// The springs of each joint, in the order of the design.\n");
    for (name, values, meaning) in [
        ("spring_wire", springs.map(|spring| spring.wire), "diameter of wire and legs"),
        ("spring_outer", springs.map(|spring| spring.outer), "of the free coils, outside"),
        ("spring_length", springs.map(|spring| spring.length), "of the coils with the joint closed, along the axle"),
    ] {
        let _ = writeln!(text, "{name} = {}; // {meaning}", list(&values, 1e3));
    }
    text.push_str(
        "\n// The workshop: what is bought, and what the printer can do. Names are those of `hwasp parts --bench`.\n",
    );
    let degrees = workshop.hole_pitch.to_degrees();
    for (name, value, meaning) in [
        ("line", 1e3 * workshop.line, "diameter of the tendon"),
        ("axle", 1e3 * workshop.axle, "of the joints, diameter"),
        ("pin", 1e3 * workshop.pin, "diameter of the pins of the distal pulleys"),
        ("springs", f64::from(workshop.springs), "of a joint, on both sides of its pulley in turn"),
        ("spring_room", 1e3 * workshop.spring_room, "for each of them, along the axle"),
        ("hole_pitch", degrees, "between the holes for the fixed legs, degrees"),
        ("print_clearance", 1e3 * workshop.print_clearance, "between parts that move on each other"),
        ("wall", 1e3 * workshop.wall, "the thinnest"),
        ("pad", 1e3 * workshop.pad, "on the closing side of links"),
        ("flange", 1e3 * layout.flange(), "of a pulley, each"),
        ("plate", 1e3 * layout.plate(), "of a prong beside the longest springs"),
        ("cheek", 1e3 * layout.cheek_width(), "of a link's fork and of the palm's lugs"),
        ("frame", 1e3 * FRAME, "around a link's window"),
        ("pin_from", 1e3 * PIN_CIRCLE, "from the axle to the pins, if there is room for them"),
    ] {
        let _ = writeln!(text, "{name} = {}; // {meaning}", number(value));
    }
    let _ = writeln!(
        text,
        "\n// Segments of a circle, and of a hole for a leg; fewer where the whole hand is shown.\n\
         $fn = part == \"hand\" ? 24 : {SEGMENTS};\nhole_fn = part == \"hand\" ? 6 : {HOLE_SEGMENTS};\n"
    );
    text.push_str(
        "// What the palm is hollowed by on both sides of its middle: from and to in x, y and z.\nhollows = [\n",
    );
    for hollow in hollows(hand, &layout) {
        let spans = [hollow.x, hollow.y, hollow.z].map(|span| list(&span, 1e3));
        let _ = writeln!(text, "    [{}],", spans.join(", "));
    }
    text.push_str("];\n\n");
    text.push_str(MODULES);
    mount(hand, design, springs, workshop, &mut text)?;
    Ok(text)
}

/// What is on the palm: as it was made for this design, layer by layer.
fn mount(
    hand: &HandDescription,
    design: &[f64; DESIGN_LEN],
    springs: &[SeatedSpring; 4],
    workshop: &Workshop,
    text: &mut String,
) -> Result<(), PartError> {
    let made = parts(hand, design, springs, workshop)?;
    text.push_str("\n// What is on the palm follows from the design, too, but not from the parameters above: export anew for others.\n");
    for part in made.iter().filter(|part| MOUNT_PARTS.contains(&part.name)) {
        let _ = writeln!(text, "module {}() {{", part.name);
        for layer in &part.layers {
            let [low, high] = layer.heights.map(|height| number(1e3 * height));
            let _ = writeln!(text, "    level({low}, {high}) difference() {{\n        union() {{");
            layer.add.iter().for_each(|outline| shape(outline, text));
            text.push_str("        }\n        union() {\n");
            layer.cut.iter().for_each(|outline| shape(outline, text));
            text.push_str("        }\n    }\n");
        }
        text.push_str("}\n");
    }
    for part in MOUNT_PARTS {
        let _ = writeln!(text, "if (part == \"{part}\" || part == \"hand\") {part}();");
    }
    Ok(())
}

/// An outline: a disc where it is one.
fn shape(outline: &Outline, text: &mut String) {
    let corners = outline.len() as f64;
    let middle = [0, 1].map(|i| outline.iter().map(|corner| corner[i]).sum::<f64>() / corners);
    let away = |corner: &[f64; 2]| (corner[0] - middle[0]).hypot(corner[1] - middle[1]);
    let radius = outline.first().map_or(0.0, away);
    let round = outline.len() == SEGMENTS && outline.iter().all(|corner| (away(corner) - radius).abs() < 1e-9);
    let _ = if round {
        writeln!(text, "            disc({}, {});", number(1e3 * radius), list(&middle, 1e3))
    } else {
        let points: Vec<String> = outline.iter().map(|corner| list(corner, 1e3)).collect();
        writeln!(text, "            polygon([{}]);", points.join(", "))
    };
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
    use super::*;
    use hwasp_tasks::hand::SEARCHED;

    #[test]
    fn parameters_are_at_the_top_and_every_part_can_be_shown() {
        let springs = [SeatedSpring { wire: 0.38e-3, outer: 5.26e-3, length: 2.6e-3 }; 4];
        let text = scad(&HandDescription::default(), &SEARCHED, &springs, &Workshop::default()).unwrap();
        let (top, rest) = text.split_once("// Segments of a circle").unwrap();
        for line in [
            "radius = [10.9, 9.7, 7.7, 5.3]; ",
            "stiffness = [5.7, 6, 9, 6]; ",
            "preload = [2, 0.36, 2.06, 0.63]; ",
            "link_length = [50, 40, 50, 40]; ",
            "base = [[0, -35], [25, 35], [-25, 35]]; ",
            "spring_outer = [5.26, 5.26, 5.26, 5.26]; ",
            "line = 0.4; ",
            "hole_pitch = 15; ",
        ] {
            assert!(top.lines().any(|found| found.starts_with(line)), "{line}:\n{top}");
        }
        for part in LINK_PARTS.iter().chain(&PULLEY_PARTS).chain(&[PALM_PART]).chain(&MOUNT_PARTS) {
            assert!(rest.contains(&format!("if (part == \"{part}\"")), "{part}");
        }
        let balanced = |open: char, close: char| text.matches(open).count() == text.matches(close).count();
        assert!(balanced('(', ')') && balanced('{', '}') && balanced('[', ']'));
    }
}
