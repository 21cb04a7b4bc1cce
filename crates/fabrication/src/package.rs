//! The package: everything that a workshop gets beside the parts to print.

use hwasp_tasks::hand::{DESIGN_LEN, HandDescription};

use crate::assembly::{LegHoles, assembly_sheet, picture_name, steps};
use crate::bill::Bill;
use crate::bodies::link_bodies;
use crate::drawing::{Placed, part_drawing, picture};
use crate::error::PartError;
use crate::parts::{Part, coupon, parts};
use crate::step::step;
use crate::verdict::{FittedSpring, verdict};
use crate::workshop::Workshop;

/// A file of the package.
#[derive(Clone, Debug, PartialEq)]
pub struct PackageFile {
    /// Its name.
    pub name: String,
    /// What is in it.
    pub contents: Vec<u8>,
}

fn file(name: impl Into<String>, contents: impl Into<Vec<u8>>) -> PackageFile {
    PackageFile { name: name.into(), contents: contents.into() }
}

/// All parts of a hand with the test coupon.
fn made(
    hand: &HandDescription,
    design: &[f64; DESIGN_LEN],
    springs: &[FittedSpring; 4],
    workshop: &Workshop,
) -> Result<Vec<Part>, PartError> {
    let seated = springs.each_ref().map(|spring| spring.seated);
    let mut made = parts(hand, design, &seated, workshop)?;
    made.push(coupon(&seated, workshop)?);
    Ok(made)
}

/// The bill of a hand with this design (SI, as its parts make it) and these springs.
pub fn bill(
    hand: &HandDescription,
    design: &[f64; DESIGN_LEN],
    springs: &[FittedSpring; 4],
    workshop: &Workshop,
) -> Result<Bill, PartError> {
    let made = made(hand, design, springs, workshop)?;
    let seated = springs.each_ref().map(|spring| spring.seated);
    let bodies = link_bodies(hand, &made, &seated, workshop);
    Ok(Bill::new(hand, &made, &bodies, springs, workshop))
}

/// Bill (`bill.csv`), assembly (`assembly.md` with a picture of each step), a drawing of each part, the test coupon as STL, and the verdict
/// (`verdict.txt`). `holes`: those of the springs' fixed legs.
pub fn package(
    hand: &HandDescription,
    design: &[f64; DESIGN_LEN],
    springs: &[FittedSpring; 4],
    workshop: &Workshop,
    holes: &LegHoles,
) -> Result<Vec<PackageFile>, PartError> {
    let made = made(hand, design, springs, workshop)?;
    let seated = springs.each_ref().map(|spring| spring.seated);
    let bodies = link_bodies(hand, &made, &seated, workshop);
    let bill = Bill::new(hand, &made, &bodies, springs, workshop);
    let steps = steps(workshop, holes);
    let mut files = vec![
        file("bill.csv", bill.csv()),
        file("assembly.md", assembly_sheet(&steps, &bill)),
        file("verdict.txt", format!("{}\n", verdict(hand, design, springs, workshop))),
    ];
    for (index, step) in steps.iter().enumerate() {
        let number = index + 1;
        let placed: Vec<Placed<'_>> = (step.shows.iter().enumerate())
            .filter_map(|(order, name)| placed(hand, &made, name, order, step.shows.contains(&"palm")))
            .collect();
        files.push(file(picture_name(number), picture(&placed, &format!("{number}. {}", step.title))));
    }
    for part in &made {
        if let Some(item) = bill.find(part.name) {
            files.push(file(format!("{}.svg", part.name), part_drawing(part, item)));
        }
        if part.name == "test_coupon" {
            files.push(file(format!("{}.stl", part.name), part.mesh.stl(part.name)));
        }
    }
    Ok(files)
}

/// All parts of a hand as STEP, with the test coupon.
pub fn step_files(
    hand: &HandDescription,
    design: &[f64; DESIGN_LEN],
    springs: &[FittedSpring; 4],
    workshop: &Workshop,
) -> Result<Vec<PackageFile>, PartError> {
    let made = made(hand, design, springs, workshop)?;
    Ok(made.iter().map(|part| file(format!("{}.step", part.name), step(part))).collect())
}

/// How far parts are pulled apart in pictures, m for each that was put on before.
const APART: f64 = 0.012;

/// A part where the assembly has it, pulled away along the way that it is put on. Those of the thumb stand alone, or hang at the palm.
fn placed<'a>(hand: &HandDescription, made: &'a [Part], name: &str, order: usize, on_palm: bool) -> Option<Placed<'a>> {
    let part = made.iter().find(|part| part.name == name)?;
    let apart = APART * order as f64;
    let thumb = &hand.thumb;
    if !name.starts_with("thumb") {
        return Some(Placed { part, angle: 0.0, at: [0.0, 0.0, apart] });
    }
    // In the frame of the proximal joint: along the link, and pulleys out of it along the axle.
    let along = if name.contains("distal") { thumb.proximal.length } else { 0.0 } + apart;
    let aside = if name.contains("pulley") { -2.0 * APART } else { 0.0 };
    let angle = if on_palm { std::f64::consts::PI - hand.joint.rest_angle } else { 0.0 };
    let (sin, cos) = angle.sin_cos();
    let base = if on_palm { thumb.base } else { [0.0; 3] };
    Some(Placed { part, angle, at: [base[0] + aside, base[1] - sin * along, base[2] + cos * along] })
}
