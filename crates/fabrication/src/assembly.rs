//! How a hand is put together, step by step. Every row of the bill is in exactly one step.

use std::fmt::Write;

use hwasp_tasks::hand::names::{KINDS, LINK_PARTS};

use crate::bill::{Bill, of_digit};
use crate::bought::PAD_FRICTION;
use crate::workshop::Workshop;

/// A step of the assembly.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// What is done.
    pub title: &'static str,
    /// Names of the rows of the bill that it takes.
    pub takes: Vec<String>,
    /// How.
    pub how: String,
    /// Parts that its picture shows, as the assembly has them: links and pulleys are those of the thumb.
    pub shows: Vec<&'static str>,
}

/// Holes of the springs' fixed legs at each kind of joint, from 0.
pub type LegHoles = [u32; 4];

/// The steps, in order.
pub fn steps(workshop: &Workshop, holes: &LegHoles) -> Vec<Step> {
    [coupon_step(workshop)].into_iter().chain(of_digits(workshop, holes)).chain(of_mount()).collect()
}

fn names(names: &[&str]) -> Vec<String> {
    names.iter().map(|&name| name.to_owned()).collect()
}

fn each(what: &str, of: &[&str]) -> Vec<String> {
    of.iter().map(|name| format!("{what} {name}")).collect()
}

fn coupon_step(workshop: &Workshop) -> Step {
    Step {
        title: "Print and try the coupon",
        takes: names(&["test_coupon"]),
        how: format!(
            "Every part lies in its file with the axis upright that the bill names. Print the coupon as the parts will be. An \
             axle turns freely in the second bore of the row of five and in no narrower one; springs' legs, pins and nuts go into \
             their holes by hand; the four holes of the circle lie on the horn's threads; the two ribs on the right, {:.2} mm apart, \
             are not joined. Otherwise set axle, pin, print_clearance or the slicer's hole compensation, and export anew.",
            1e3 * workshop.print_clearance
        ),
        shows: vec!["test_coupon"],
    }
}

/// Links, pulleys, springs and pads, and the palm.
fn of_digits(workshop: &Workshop, holes: &LegHoles) -> Vec<Step> {
    let [thumb, finger] = [of_digit(0), of_digit(2)];
    let legs = |kinds: [usize; 2]| {
        let told = kinds.map(|kind| format!("no. {} at {}", holes[kind], KINDS[kind]));
        format!("{} of {}", told.join(" and "), workshop.holes())
    };
    vec![
        Step {
            title: "Pin the distal pulleys to their links, with the line",
            takes: names(&[thumb[1], thumb[3], finger[1], finger[3], "pulley pin", "line", "glue"]),
            how: "Knot a line, and lead it through the recess and the hole of the prong and that of the pulley's flange, out of the \
                  groove. Put the pulley between the prongs with the pinned flange towards the line's hole; press both pins through the \
                  flange into the prong, with a drop of glue. Wind the line three quarters of a turn around the groove."
                .to_owned(),
            shows: vec![thumb[1], thumb[3]],
        },
        Step {
            title: "Join the links",
            takes: [
                names(&[thumb[0], finger[0], "axle, distal", "clip, distal"]),
                each("spring of", &[KINDS[1], KINDS[3]]),
            ]
            .concat(),
            how: format!(
                "Lay the springs into the pockets of the distal prongs, the one wound right on the side of the knot, a leg in the \
                 prong's hole. Bring the prongs between the cheeks of the proximal link, the other legs in the holes {}, counted as the \
                 sheet of parts says. Push the axle through and clip it on both sides. The joint opens by itself until the link leans \
                 on both cheeks. Lead the line along its way on the closing side.",
                legs([1, 3])
            ),
            shows: vec![thumb[0], thumb[1], thumb[3]],
        },
        Step {
            title: "Join the digits to the palm",
            takes: [
                names(&["palm", thumb[2], finger[2], "axle, proximal", "clip, proximal"]),
                each("spring of", &[KINDS[0], KINDS[2]]),
            ]
            .concat(),
            how: format!(
                "Put the proximal pulley between the prongs, loose. The line goes once all around it and then up. Springs as before, the \
                 fixed legs in the holes {} of the palm's lugs. Axles go in from the open sides: those of the fingers from the palm's \
                 sides, that of the thumb along the trough beside its lugs; clip them from below. Pull each line up through its shaft.",
                legs([0, 2])
            ),
            shows: vec!["palm", thumb[0], thumb[1], thumb[2]],
        },
        Step {
            title: "Stick the pads on",
            takes: each("pad of", &LINK_PARTS),
            how: format!(
                "Clean the recesses on the closing side with alcohol, and stick the pads in: two strips on a proximal link, with the \
                 line's way between them free; one on a distal link, bent around the tip. They are then flush with the round ends. Try \
                 them: an object of yours has to rest on a pad that is tilted by {:.0} degrees, for training assumes a friction of \
                 {PAD_FRICTION} in the middle of its range.",
                PAD_FRICTION.atan().to_degrees()
            ),
            shows: vec![thumb[0], thumb[1]],
        },
    ]
}

/// Everything on the palm, up to the robot.
fn of_mount() -> Vec<Step> {
    vec![
        Step {
            title: "Put the guide on the palm",
            takes: names(&["line_guide", "line pin", "square nut M3, palm"]),
            how: "Push the square nuts into the slots in the palm's sides until the screw holes are free. Lay the guide on the palm with \
                  the three lines through its holes. Lay a pin into each seat beside a hole, behind the line as seen from the spool: the \
                  line comes up, bends over the pin and runs in its channel to the middle. The lines pull the pins into their seats."
                .to_owned(),
            shows: vec!["palm", "line_guide"],
        },
        Step {
            title: "Screw the spool on the motor",
            takes: names(&["motor", "bus and power", "spool_hub", "screw M2 x 5", "spool_drum"]),
            how: "Turn the motor to its middle. Screw the hub on the horn, heads sunk; set the drum on the hub with its three slots \
                  outwards of the robot, their holes open downwards."
                .to_owned(),
            shows: vec!["spool_hub", "spool_drum"],
        },
        Step {
            title: "Set the motor into the cage, and the cage on the guide",
            takes: names(&["motor_cage", "screw M3 x 30"]),
            how: "Lower the motor into the cage, horn through the hole in its floor, cables out of the window in the back. Lay each line \
                  around the drum, that of the thumb in the lowest groove and those of the first and second finger above, all the same way \
                  round, through the slot and down through its hole. Set the cage on the guide, and screw it through the guide into the \
                  nuts of the palm."
                .to_owned(),
            shows: vec!["line_guide", "spool_drum", "spool_hub", "motor_cage"],
        },
        Step {
            title: "Tension the lines, and clamp them",
            takes: names(&["screw M2.5 x 10", "washer M2.5"]),
            how: "Turn the hand upside down. The well in the palm shows the drum from below. Set the four screws loosely, which hold the \
                  drum to the hub. Hang 200 g on the end of a line, with all digits open: it is taut. Lay it once around the next screw \
                  under the washer and tighten this. So the three are equally taut with the motor at its zero. Cut the ends off."
                .to_owned(),
            shows: vec!["palm", "spool_drum"],
        },
        Step {
            title: "Mount the hand on the robot",
            takes: names(&[
                "flange_plate",
                "centring_ring",
                "flange pin",
                "screw M6 x 10",
                "rubber sheet",
                "square nut M3, flange plate",
                "screw M3 x 8",
            ]),
            how: "Glue the ring into the plate's recess and press the pin in. Push the square nuts into the slots of the tongue. Screw the \
                  plate to the robot's flange (ISO 9409-1-50-4-M6) with the M6 screws, from below. Lay the rubber on the motor's back, push \
                  the cage over the tongue until it meets the plate, and screw it from both sides."
                .to_owned(),
            shows: vec!["motor_cage", "flange_plate", "centring_ring"],
        },
    ]
}

/// The assembly as a sheet: numbered steps with the rows that each takes as boxes to tick, and its picture.
pub fn assembly_sheet(steps: &[Step], bill: &Bill) -> String {
    let mut text =
        "# Assembly\n\nTick what a step takes before you begin it. `bill.csv` says what everything is.\n".to_owned();
    for (index, step) in steps.iter().enumerate() {
        let number = index + 1;
        let _ = write!(text, "\n## {number}. {}\n\n![step {number}]({})\n\n", step.title, picture_name(number));
        for name in &step.takes {
            let count = bill.find(name).map_or(0, |item| item.count);
            let _ = writeln!(text, "- [ ] {count} x {name}");
        }
        let _ = writeln!(text, "\n{}", step.how);
    }
    text
}

/// The file of a step's picture.
pub(crate) fn picture_name(number: usize) -> String {
    format!("step_{number:02}.svg")
}

/// What is wrong between the steps and the bill: rows that are in no step, or in more than one, and what no row is.
pub fn unmatched(steps: &[Step], bill: &Bill) -> Vec<String> {
    let taken = |name: &str| steps.iter().flat_map(|step| &step.takes).filter(|taken| *taken == name).count();
    let rows = bill.items.iter().map(|item| (item.name.as_str(), taken(&item.name)));
    let wrong = rows.filter(|(_, count)| *count != 1).map(|(name, count)| format!("{name} is in {count} steps"));
    let unknown = steps.iter().flat_map(|step| &step.takes).filter(|name| bill.find(name).is_none());
    wrong.chain(unknown.map(|name| format!("{name} is not on the bill"))).collect()
}
