//! The bill of materials: everything that a hand takes, printed and bought, each once.

use std::fmt::Write;

use hwasp_tasks::hand::HandDescription;
use hwasp_tasks::hand::names::{KINDS, LINK_PARTS, MOUNT_PARTS, PALM_PART, PULLEY_PARTS};

use crate::bodies::{LinkBody, pads};
use crate::bought::{MOTOR_MASS, axle, bar, clip_mass, pad_mass, spring_mass};
use crate::parts::{Part, TURN_PIN, dimensions};
use crate::verdict::FittedSpring;
use crate::workshop::Workshop;

/// How full parts are printed whose mass nothing depends on.
const FRAME_INFILL: f64 = 0.25;
/// What a printer lays down, m³/s: lines of 0.45 × 0.2 mm at 45 mm/s, moves and corners included.
const FLOW: f64 = 4e-9;
/// Of line for each digit, m: its way, what is knotted and what is held while it is tensioned.
const LINE: f64 = 0.5;

/// What a row of the bill is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// Printed.
    Printed,
    /// Bought.
    Bought,
}

/// How a part is printed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Printing {
    /// How full its core is, from 0 to 1.
    pub infill: f64,
    /// The axis of its frame that is upright.
    pub upright: &'static str,
    /// An estimate of how long one takes, s.
    pub time: f64,
}

/// A row of the bill.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// What it is called in the assembly; of printed parts the name of their file.
    pub name: String,
    /// How many of it.
    pub count: usize,
    /// What to ask for, or how to print it.
    pub what: String,
    /// Mass of one, kg, where it is known.
    pub mass: Option<f64>,
    /// Of printed parts.
    pub printing: Option<Printing>,
}

impl Item {
    /// Whether it is printed or bought.
    pub fn origin(&self) -> Origin {
        if self.printing.is_some() { Origin::Printed } else { Origin::Bought }
    }
}

/// Everything that goes into a hand.
#[derive(Clone, Debug, PartialEq)]
pub struct Bill {
    /// The rows.
    pub items: Vec<Item>,
}

impl Bill {
    /// The bill of a hand whose parts (with the [`coupon`](crate::coupon)) and link bodies these are.
    pub fn new(
        hand: &HandDescription,
        parts: &[Part],
        bodies: &[LinkBody],
        springs: &[FittedSpring; 4],
        workshop: &Workshop,
    ) -> Self {
        let mut items: Vec<Item> = parts.iter().map(|part| printed(part, bodies, workshop)).collect();
        items.extend(transmission(hand, springs, workshop));
        items.extend(fasteners(workshop));
        Self { items }
    }

    /// A row by its name.
    pub fn find(&self, name: &str) -> Option<&Item> {
        self.items.iter().find(|item| item.name == name)
    }

    /// As a table: a header, and a row for each item.
    pub fn csv(&self) -> String {
        let mut text = "item,count,made,what,mass_g_each,infill_percent,upright_axis,print_min_each\n".to_owned();
        for item in &self.items {
            let made = match item.origin() {
                Origin::Printed => "printed",
                Origin::Bought => "bought",
            };
            let mass = item.mass.map_or(String::new(), |mass| format!("{:.2}", 1e3 * mass));
            let (infill, upright, time) = item.printing.map_or_else(Default::default, |printing| {
                (format!("{:.0}", 100.0 * printing.infill), printing.upright, format!("{:.0}", printing.time / 60.0))
            });
            let fields = [quoted(&item.name), item.count.to_string(), made.to_owned(), quoted(&item.what)];
            let _ = writeln!(text, "{},{mass},{infill},{upright},{time}", fields.join(","));
        }
        text
    }
}

/// As spreadsheets read it. What begins like a formula is not one.
fn quoted(text: &str) -> String {
    let plain: String = text.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect();
    let plain = if plain.starts_with(['=', '+', '-', '@']) { format!("'{plain}") } else { plain };
    if plain.contains([',', '"']) { format!("\"{}\"", plain.replace('"', "\"\"")) } else { plain }
}

fn printed(part: &Part, bodies: &[LinkBody], workshop: &Workshop) -> Item {
    let body = bodies.iter().find(|body| LINK_PARTS[body.kind] == part.name);
    let frame = part.name == PALM_PART || MOUNT_PARTS.contains(&part.name);
    let infill = body.map_or(if frame { FRAME_INFILL } else { 1.0 }, |body| body.infill);
    let mass = part.filling(workshop.density, workshop.shell).filled(infill).mass;
    let what = format!(
        "{}.stl; shell of {:.1} mm all around, infill {:.0} %",
        part.name,
        1e3 * workshop.shell,
        100.0 * infill
    );
    let time = mass / workshop.density / FLOW;
    let printing = Some(Printing { infill, upright: part.axis.names()[0], time });
    Item { name: part.name.to_owned(), count: part.count, what, mass: Some(mass), printing }
}

fn bought(name: impl Into<String>, count: usize, what: impl Into<String>, mass: Option<f64>) -> Item {
    Item { name: name.into(), count, what: what.into(), mass, printing: None }
}

/// How many joints of a hand are of a kind.
fn joints(kind: usize) -> usize {
    if kind < 2 { 1 } else { 2 }
}

/// Springs, pads, axles, pins, line and the motor.
fn transmission(hand: &HandDescription, springs: &[FittedSpring; 4], workshop: &Workshop) -> Vec<Item> {
    let seated = springs.each_ref().map(|spring| spring.seated);
    let dims = dimensions(&seated, workshop);
    let mm = |length: f64| format!("{:.2}", 1e3 * length);
    let mut items = Vec::new();
    for (kind, spring) in springs.iter().enumerate() {
        let what = format!("torsion spring {}, half of them wound left and half right", spring.part);
        let count = joints(kind) * workshop.springs as usize;
        items.push(bought(format!("spring of {}", KINDS[kind]), count, what, Some(spring_mass(&spring.seated))));
        let pad = pads(hand, &seated, workshop, kind);
        let what = format!(
            "silicone sheet, 40 Shore A, {} mm thick, cut to {} x {} mm, self-adhesive",
            mm(workshop.pad),
            mm(pad.width),
            mm(pad.length)
        );
        let mass = Some(pad_mass(&pad, workshop.pad));
        items.push(bought(format!("pad of {}", LINK_PARTS[kind]), joints(kind) * pad.count, what, mass));
    }
    let shaft = axle(workshop, dims.half_width);
    let (held, groove) = match shaft.clip {
        Some(clip) => (
            bought("clip", 12, format!("retaining washer DIN 6799 - {}", mm(clip.groove)), Some(clip_mass(&clip))),
            format!(
                "two grooves {} mm in diameter and {} mm wide, {} mm between them",
                mm(clip.groove),
                mm(clip.thick + 0.05e-3),
                mm(shaft.between_grooves)
            ),
        ),
        None => (
            bought("clip", 12, format!("set collar for a shaft of {} mm, 3 mm wide", mm(workshop.axle)), None),
            format!("collars {} mm apart", mm(shaft.between_grooves)),
        ),
    };
    let what = format!("steel pin, ground, {} x {} mm; {groove}", mm(workshop.axle), mm(shaft.length));
    let mass = Some(bar(workshop.axle, shaft.length));
    for joint in ["distal", "proximal"] {
        items.push(bought(format!("axle, {joint}"), 3, what.clone(), mass));
        items.push(Item { name: format!("clip, {joint}"), count: 6, ..held.clone() });
    }
    let what = format!("steel pin, {} x {} mm", mm(workshop.pin), mm(dims.pin_length));
    items.push(bought("pulley pin", 6, what, Some(bar(workshop.pin, dims.pin_length))));
    let what = format!("braided polyethylene, {} mm, 50 lb (220 N), {LINE} m each", mm(workshop.line));
    items.push(bought("line", 3, what, None));
    let what = "serial adapter U2D2 or the like, 12 V supply of 5 A, cables to the motor";
    items.push(bought("bus and power", 1, what, None));
    items.push(bought("motor", 1, "Dynamixel XM430-W210-T or -R with its horn HN12-N101 and cable", Some(MOTOR_MASS)));
    items
}

/// What holds the rest together.
fn fasteners(workshop: &Workshop) -> Vec<Item> {
    let pin = bar(2.0 * TURN_PIN[0], 2.0 * TURN_PIN[1]);
    let glue = format!("cyanoacrylate: for {} pins of {:.2} mm, three of 3 mm and the ring", 6, 1e3 * workshop.pin);
    vec![
        bought("line pin", 3, "steel pin ISO 2338, 3 x 10 mm, polished", Some(pin)),
        bought("square nut M3, palm", 4, "square nut DIN 562 - M3", Some(0.000_3)),
        bought("screw M3 x 30", 4, "socket head screw ISO 4762 - M3 x 30", None),
        bought("square nut M3, flange plate", 4, "square nut DIN 562 - M3", Some(0.000_3)),
        bought("screw M3 x 8", 4, "socket head screw ISO 4762 - M3 x 8", None),
        bought("screw M2 x 5", 4, "socket head screw ISO 4762 - M2 x 5, for the horn", None),
        bought("screw M2.5 x 10", 4, "socket head screw ISO 4762 - M2.5 x 10", None),
        bought("washer M2.5", 4, "washer ISO 7089 - 2.5", None),
        bought("screw M6 x 10", 4, "socket head screw ISO 4762 - M6 x 10, for the robot's flange", None),
        bought("flange pin", 1, "steel pin ISO 2338, 6 m6 x 10 mm", Some(bar(0.006, 0.010))),
        bought("rubber sheet", 1, "EPDM, 1 mm, 25 x 40 mm, between motor and flange plate", None),
        bought("glue", 1, glue, None),
    ]
}

/// The printed parts of a digit whose kinds of joints begin with `first`.
pub(crate) fn of_digit(first: usize) -> [&'static str; 4] {
    [LINK_PARTS[first], LINK_PARTS[first + 1], PULLEY_PARTS[first], PULLEY_PARTS[first + 1]]
}
