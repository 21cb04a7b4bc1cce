//! What another design changes of the model, as numbers: the fields that it sets, and what follows of them.

use hwasp_mujoco::engine::Inventory;
use hwasp_problem::{AnyError, Changed};

use crate::anatomy::Anatomy;
use crate::body::Body;
use crate::robot::Robot;

/// The smallest change that is told, as a share.
const LEAST: f64 = 1e-9;

/// Name, unit and value of a number of the model.
type Number = (String, &'static str, f64);

/// The numbers that differ between two designs: fields that are set, then what follows of them.
///
/// # Errors
/// Where the model cannot be made with one of them.
pub(crate) fn changes(robot: &Robot, before: &[f64], after: &[f64]) -> Result<Vec<Changed>, AnyError> {
    let (before, after) = (numbers(robot, before)?, numbers(robot, after)?);
    let mut changes = Vec::new();
    for (follows, (one, other)) in [(false, (before.0, after.0)), (true, (before.1, after.1))] {
        for ((name, unit, before), (_, _, after)) in one.into_iter().zip(other) {
            if (after - before).abs() > LEAST * before.abs().max(after.abs()) {
                changes.push(Changed { name, unit: unit.to_owned(), before, after, follows });
            }
        }
    }
    Ok(changes)
}

/// The fields that a design sets, and what follows: masses, distances between bodies, heights at the start. What is drawn is in
/// its middle.
fn numbers(robot: &Robot, design: &[f64]) -> Result<(Vec<Number>, Vec<Number>), AnyError> {
    let mut making = robot.additions.spec(&robot.main, &robot.files)?;
    let mut values = crate::corners::columns(robot, design, 0.0, 1.0);
    let mut set = Vec::new();
    if let Some(shaping) = &robot.shaping {
        for (field, value) in shaping.fields.iter().zip(shaping.formula.run(design, &values)) {
            making.set(field, value)?;
            set.push((field.to_string(), making.quantity(field)?.unit(), value));
        }
    }
    let simulation = making.compile()?;
    let (anatomy, has) = (Anatomy::of(&simulation), simulation.inventory());
    let mut body = Body::new(simulation, &robot.columns);
    crate::corners::start(robot, &mut body, design, &mut values)?;
    Ok((set, following(&body, &anatomy, &has)))
}

/// What follows of a model at its start.
fn following(body: &Body, anatomy: &Anatomy, has: &Inventory) -> Vec<Number> {
    let simulation = body.simulation();
    let named = |i: usize| {
        if anatomy.bodies[i].is_empty() { format!("body.#{i}") } else { format!("body.{}", anatomy.bodies[i]) }
    };
    let mut numbers = Vec::new();
    for (i, entry) in has.bodies.iter().enumerate().skip(1) {
        numbers.push((format!("mass of {}", named(i)), "kg", entry.mass));
        let at = simulation.body_position(entry.id);
        match entry.parent.filter(|parent| parent.index() > 0) {
            Some(parent) => {
                let from = simulation.body_position(parent);
                let distance = (0..3).map(|k| (at[k] - from[k]).powi(2)).sum::<f64>().sqrt();
                numbers.push((format!("{} from {}", named(i), named(parent.index())), "m", distance));
            }
            None => numbers.push((format!("height of {} at the start", named(i)), "m", at[2])),
        }
    }
    numbers.push(("mass of everything".to_owned(), "kg", has.bodies.iter().map(|body| body.mass).sum()));
    let centre = simulation.subtree_center(has.bodies[0].id);
    numbers.push(("height of the centre of mass at the start".to_owned(), "m", centre[2]));
    numbers
}
