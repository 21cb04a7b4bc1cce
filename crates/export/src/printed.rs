//! The parts of a hand to print, made for the parts that were chosen.
//!
//! Of a finished run `experiment.toml` and `design.toml` are enough; neither the engine nor the policy is asked. What a model
//! simulates is the design as it was trained; what is printed is the design that its parts make.

use hwasp_fabrication::{PackageFile, Part, PartError, package, parts, scad, step_files};
use hwasp_tasks::hand::HandDescription;
use hwasp_workshop::parts::ChosenParts;

use crate::file::ExportFile;

/// As meshes.
pub(super) fn stl(hand: &HandDescription, chosen: &ChosenParts) -> Result<Vec<ExportFile>, PartError> {
    let parts = parts(hand, &chosen.design(), &chosen.springs(), &chosen.workshop)?;
    let file = |part: Part| ExportFile { name: format!("{}.stl", part.name), contents: part.mesh.stl(part.name) };
    Ok(parts.into_iter().map(file).collect())
}

/// As one file with its parameters.
pub(super) fn scad_file(hand: &HandDescription, chosen: &ChosenParts) -> Result<Vec<ExportFile>, PartError> {
    let contents = scad(hand, &chosen.design(), &chosen.springs(), &chosen.workshop)?.into_bytes();
    Ok(vec![ExportFile { name: "hand.scad".to_owned(), contents }])
}

/// As STEP files, with the test coupon.
pub(super) fn step(hand: &HandDescription, chosen: &ChosenParts) -> Result<Vec<ExportFile>, PartError> {
    let files = step_files(hand, &chosen.design(), &chosen.fitted(), &chosen.workshop)?;
    Ok(files.into_iter().map(|PackageFile { name, contents }| ExportFile { name, contents }).collect())
}

/// Bill, assembly, drawings, test coupon and verdict, in a folder of their own.
pub(super) fn whole_package(hand: &HandDescription, chosen: &ChosenParts) -> Result<Vec<ExportFile>, PartError> {
    let files = package(hand, &chosen.design(), &chosen.fitted(), &chosen.workshop, &chosen.leg_holes())?;
    let placed = |PackageFile { name, contents }| ExportFile { name: format!("{PACKAGE}/{name}"), contents };
    Ok(files.into_iter().map(placed).collect())
}

/// The folder of the package.
const PACKAGE: &str = "package";
