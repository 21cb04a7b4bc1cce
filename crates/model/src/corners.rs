//! Designs at the corners of their limits, compiled before anything is trained.

use hwasp_core::Stream;
use hwasp_expr::Distribution;
use rand::{RngExt, SeedableRng};

use crate::columns::Column;
use crate::robot::Robot;

/// Parameters of which every corner is tried; of more, as many corners by chance.
const MOST: usize = 6;
/// Designs inside of the limits that are tried, too.
const INSIDE: usize = 8;
/// What is drawn: few, the middle, much.
const LUCK: [f64; 3] = [-1.0, 0.0, 1.0];
/// Standard deviations from the middle that much of a normal draw is: it has no most.
const WIDE: f64 = 3.0;

/// Compiles the model for designs at the corners and inside of the limits.
///
/// # Errors
/// The first design that the engine does not take, with what it says.
pub(crate) fn check_corners(robot: &Robot) -> Result<(), String> {
    let Some(shaping) = &robot.shaping else { return Ok(()) };
    let space = robot.law.design();
    let mut making = robot.making().map_err(|error| error.to_string())?;
    let mut chance = Stream::seed_from_u64(0);
    let count = shaping.parameters.len();
    let corners = 1_usize << count.min(MOST);
    let names = space.names();
    // Where anything follows training, as it begins, too.
    let stages: &[f64] = if robot.columns.contains(&Column::Progress) { &[0.0, 1.0] } else { &[1.0] };
    let mut tape = shaping.formula.program.tape::<f64>(1);
    let mut out = vec![0.0; shaping.fields.len()];
    for number in 0..corners + INSIDE {
        let mut design = space.middle();
        for (k, &i) in shaping.parameters.iter().enumerate() {
            let (low, high) = space.bounds(i);
            design[i] = if number >= corners {
                low + (high - low) * chance.random::<f64>()
            } else if k < MOST {
                if number >> k & 1 == 1 { high } else { low }
            } else if chance.random::<bool>() {
                high
            } else {
                low
            };
        }
        shaping.formula.program.bind(&design, &mut tape);
        let at = || {
            let told = shaping.parameters.iter().map(|&i| format!("{} = {:.4}", names[i], design[i]));
            told.collect::<Vec<_>>().join(", ")
        };
        let refused = |what: &dyn std::fmt::Display| {
            if count == 0 {
                format!("the model cannot be made: {what}")
            } else {
                format!("the model cannot be made with {}: {what}", at())
            }
        };
        for &progress in stages {
            let columns = columns(robot, &design, LUCK[number % LUCK.len()], progress);
            shaping.formula.program.forward(&columns, 1, 1, &mut tape, &mut out, 1);
            for (field, &value) in shaping.fields.iter().zip(&out) {
                making.set(field, value).map_err(|error| refused(&error))?;
            }
            making.compile().map_err(|error| refused(&error))?;
        }
    }
    Ok(())
}

/// The columns that a model is made from at some progress of training, with everything drawn in its middle for a `luck` of 0, and at
/// its ends for -1 and 1.
pub(crate) fn columns(robot: &Robot, design: &[f64], luck: f64, progress: f64) -> Vec<f64> {
    let mut values = vec![0.0; robot.columns.len()];
    let random = robot.random.iter().flat_map(|(formula, _)| &formula.draws);
    let start = robot.start.iter().flat_map(|(formula, _)| &formula.draws);
    for &(from, column) in random.chain(robot.shaping.iter().flat_map(|shaping| &shaping.formula.draws)).chain(start) {
        values[column] = match from {
            Distribution::Uniform => (0.5 + 0.5 * luck).min(1.0 - f64::EPSILON),
            Distribution::Normal => WIDE * luck,
        };
    }
    if let Some(at) = robot.columns.iter().position(|column| *column == Column::Progress) {
        values[at] = progress;
    }
    if let Some((formula, columns)) = &robot.random {
        let mut tape = formula.program.tape::<f64>(1);
        let mut out = vec![0.0; columns.len()];
        formula.program.bind(design, &mut tape);
        formula.program.forward(&values, 1, 1, &mut tape, &mut out, 1);
        for (&column, &value) in columns.iter().zip(&out) {
            values[column] = value;
        }
    }
    values
}
