//! A start where the loops of a model are closed.

use hwasp_mujoco::engine::{FieldPath, Simulation, Spec};

use crate::corners::is_open;

/// The most steps in which loops close.
const MOST_STEPS: usize = 20_000;
/// What is let open, m and rad.
const CLOSED: f64 = 1e-6;
/// Coordinates that move less stay where they are, m and rad.
const STILL: f64 = 1e-7;

/// Closes loops that are open at the start: constraints move the bars, without gravity, and nothing swings. The coordinates that
/// moved; none where nothing was open, or the loops do not close.
pub(super) fn close(spec: &mut Spec, simulation: &mut Simulation) -> Vec<usize> {
    if !simulation.gaps().iter().any(is_open) {
        return Vec::new();
    }
    let Some(closed) = without_gravity(spec).and_then(|still| closed(still, simulation.qpos())) else {
        return Vec::new();
    };
    let moved = |&at: &usize| (closed[at] - simulation.qpos()[at]).abs() > STILL;
    let moved = (0..closed.len()).filter(moved).collect();
    simulation.qpos_mut().copy_from_slice(&closed);
    moved
}

/// The model where nothing falls; the text stays as it is.
fn without_gravity(spec: &mut Spec) -> Option<Simulation> {
    let fields = ["x", "y", "z"].map(|axis| format!("option.gravity.{axis}").parse::<FieldPath>());
    let fields: Vec<FieldPath> = fields.into_iter().collect::<Result<_, _>>().ok()?;
    let before: Vec<f64> = fields.iter().map(|field| spec.field(field)).collect::<Result<_, _>>().ok()?;
    fields.iter().try_for_each(|field| spec.set(field, 0.0)).ok()?;
    let still = spec.compile().ok();
    fields.iter().zip(&before).try_for_each(|(field, &value)| spec.set(field, value)).ok()?;
    still
}

/// Positions near these where every loop is closed.
fn closed(mut still: Simulation, from: &[f64]) -> Option<Vec<f64>> {
    still.qpos_mut().copy_from_slice(from);
    for _ in 0..MOST_STEPS {
        still.qvel_mut().fill(0.0);
        still.step(1).ok()?;
        still.forward().ok()?;
        if still.gaps().iter().all(|gap| gap.distance < CLOSED && gap.angle < CLOSED) {
            break;
        }
    }
    (!still.gaps().iter().any(is_open)).then(|| still.qpos().to_vec())
}
