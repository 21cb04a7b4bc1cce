//! Designs at the corners of their limits, tried before anything is trained: the model is compiled, its loops are closed, its
//! delays are times that can be.

use hwasp_core::Stream;
use hwasp_expr::Distribution;
use hwasp_mujoco::engine::{Gap, Spec};
use hwasp_problem::AnyError;
use hwasp_settings::text::printable;
use rand::{RngExt, SeedableRng};

use crate::body::Body;
use crate::columns::Column;
use crate::delay::{DELAYS, Delay};
use crate::robot::Robot;

/// Parameters of which every corner is tried; of more, as many corners by chance.
const MOST: usize = 6;
/// Designs inside of the limits that are tried, too.
const INSIDE: usize = 8;
/// What is drawn: few, the middle, much.
const LUCK: [f64; 3] = [-1.0, 0.0, 1.0];
/// Standard deviations from the middle that much of a normal draw is: it has no most.
const WIDE: f64 = 3.0;
/// How far a loop may be open at the start, m and rad: what is within closes in the first steps.
const OPEN: [f64; 2] = [1e-3, 0.01];

/// What is wrong with a design within the limits.
#[derive(Debug)]
pub(crate) struct CornerFault {
    /// The key that is to be mended, below `[task]`.
    pub(crate) key: &'static str,
    pub(crate) message: String,
    pub(crate) hint: String,
}

/// Tries designs at the middle, the corners and inside of the limits of these parameters.
///
/// # Errors
/// The first design that the engine does not take, or that leaves a loop open or a delay impossible.
pub(crate) fn check_corners(robot: &Robot, parameters: &[usize]) -> Result<(), CornerFault> {
    let mut simulation = robot.simulation();
    // What cannot be computed here is told where it is tried out.
    let closes = simulation.forward().is_ok() && !simulation.gaps().is_empty();
    if robot.shaping.is_none() && robot.delays.is_none() && !closes {
        return Ok(());
    }
    let body = closes.then(|| Body::new(simulation, &robot.columns));
    let making = robot.shaping.is_some().then(|| robot.making()).transpose();
    let making = making.map_err(|error| CornerFault::of_model(error.to_string()))?;
    let mut tried = Tried { robot, parameters, making, body };
    let space = robot.law.design();
    let mut chance = Stream::seed_from_u64(0);
    let corners = 1_usize << parameters.len().min(MOST);
    tried.all(&space.middle(), 0.0)?;
    for number in 0..corners + INSIDE {
        let mut design = space.middle();
        for (k, &i) in parameters.iter().enumerate() {
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
        tried.all(&design, LUCK[number % LUCK.len()])?;
    }
    Ok(())
}

/// What designs are tried with.
struct Tried<'r> {
    robot: &'r Robot,
    parameters: &'r [usize],
    /// The model in the making; none where it is the same for all designs.
    making: Option<Spec>,
    /// The model at the start; none where it has no loop to close.
    body: Option<Body>,
}

impl Tried<'_> {
    /// Tries a design, where anything follows training as training begins, too.
    fn all(&mut self, design: &[f64], luck: f64) -> Result<(), CornerFault> {
        let stages: &[f64] = if self.robot.columns.contains(&Column::Progress) { &[0.0, 1.0] } else { &[1.0] };
        stages.iter().try_for_each(|&progress| self.one(design, luck, progress))
    }

    fn one(&mut self, design: &[f64], luck: f64, progress: f64) -> Result<(), CornerFault> {
        let robot = self.robot;
        let mut values = columns(robot, design, luck, progress);
        let at = self.told(design);
        if let (Some(shaping), Some(making)) = (&robot.shaping, &mut self.making) {
            let refused =
                |what: &dyn std::fmt::Display| CornerFault::of_model(format!("the model cannot be made{at}: {what}"));
            for (field, value) in shaping.fields.iter().zip(shaping.formula.run(design, &values)) {
                making.set(field, value).map_err(|error| refused(&error))?;
            }
            let simulation = making.compile().map_err(|error| refused(&error))?;
            if let Some(body) = &mut self.body {
                body.exchange(simulation);
            }
        }
        if let Some(body) = &mut self.body {
            start(robot, body, design, &mut values)
                .map_err(|error| CornerFault::of_start(format!("{error}{at}"), "see that they are numbers"))?;
            if let Some(gap) = body.simulation().gaps().into_iter().find(is_open) {
                let hint = "begin where it is closed: positions in [task.start], formulas of the design where lengths follow it; \
                            gaps up to 1 mm and 0.01 rad close by themselves";
                return Err(CornerFault::of_start(
                    format!("{} is open at the start, by {}{at}", called(&gap), size(&gap)),
                    hint,
                ));
            }
        }
        if let Some(formula) = &robot.delays {
            for (key, time) in DELAYS.into_iter().zip(formula.run(design, &values)) {
                if let Err(message) = Delay::steps(time, robot.env.time_step) {
                    let hint =
                        "narrow what it is made of, or keep it within its limits: clip(…, 0 s, 0.1 s)".to_owned();
                    return Err(CornerFault { key, message: format!("{message}{at}"), hint });
                }
            }
        }
        Ok(())
    }

    /// The parameters that are tried, as they are in a design.
    fn told(&self, design: &[f64]) -> String {
        let names = self.robot.law.design().names();
        let told: Vec<String> = self.parameters.iter().map(|&i| format!("{} = {:.4}", names[i], design[i])).collect();
        if told.is_empty() { String::new() } else { format!(" with {}", told.join(", ")) }
    }
}

impl CornerFault {
    fn of_model(message: String) -> Self {
        let hint = "narrow the limits, or mend the formulas that set fields of the model".to_owned();
        Self { key: "design", message, hint }
    }

    fn of_start(message: String, hint: &str) -> Self {
        Self { key: "start", message, hint: hint.to_owned() }
    }
}

/// Puts a robot where its episodes start, with what is drawn in `values`.
///
/// # Errors
/// Where it cannot start so.
pub(crate) fn start(robot: &Robot, body: &mut Body, design: &[f64], values: &mut [f64]) -> Result<(), String> {
    body.reset(robot.keyframe.as_deref())?;
    body.refresh(true)?;
    let Some((formula, targets)) = &robot.start else { return Ok(()) };
    body.read(values);
    body.write(targets, &formula.run(design, values))?;
    body.refresh(true)
}

/// Whether a loop is open so far that its bars would snap together.
pub(crate) fn is_open(gap: &Gap) -> bool {
    gap.distance > OPEN[0] || gap.angle > OPEN[1]
}

fn called(gap: &Gap) -> String {
    let name = gap.name.as_ref().map_or_else(|| format!("#{}", gap.index), |name| printable(name));
    format!("the {} constraint `{name}` of the model", gap.kind)
}

fn size(gap: &Gap) -> String {
    let distance = (gap.distance > OPEN[0]).then(|| format!("{:.4} m", gap.distance));
    let angle = (gap.angle > OPEN[1]).then(|| format!("{:.4} rad", gap.angle));
    distance.into_iter().chain(angle).collect::<Vec<_>>().join(" and ")
}

/// The columns that a model is made from at some progress of training, with everything drawn in its middle for a `luck` of 0, and at
/// its ends for -1 and 1; a start is drawn in its middle.
pub(crate) fn columns(robot: &Robot, design: &[f64], luck: f64, progress: f64) -> Vec<f64> {
    let mut values = vec![0.0; robot.columns.len()];
    let random = robot.random.iter().flat_map(|(formula, _)| &formula.draws);
    let shaping = robot.shaping.iter().flat_map(|shaping| &shaping.formula.draws);
    let start = robot.start.iter().flat_map(|(formula, _)| &formula.draws);
    for (&(from, column), luck) in random.chain(shaping).map(|draw| (draw, luck)).chain(start.map(|draw| (draw, 0.0))) {
        values[column] = match from {
            Distribution::Uniform => (0.5 + 0.5 * luck).min(1.0 - f64::EPSILON),
            Distribution::Normal => WIDE * luck,
        };
    }
    if let Some(at) = robot.columns.iter().position(|column| *column == Column::Progress) {
        values[at] = progress;
    }
    if let Some((formula, columns)) = &robot.random {
        for (&column, value) in columns.iter().zip(formula.run(design, &values)) {
            values[column] = value;
        }
    }
    values
}

/// A robot with a design where its episodes start, with what is drawn in its middle; and its columns as far as they are known then.
///
/// # Errors
/// Where it cannot be made or cannot start so.
pub(crate) fn begun(robot: &Robot, design: &[f64]) -> Result<(Body, Vec<f64>), AnyError> {
    let mut values = columns(robot, design, 0.0, 1.0);
    let simulation = match &robot.shaping {
        None => robot.simulation(),
        Some(shaping) => {
            let mut making = robot.making()?;
            for (field, value) in shaping.fields.iter().zip(shaping.formula.run(design, &values)) {
                making.set(field, value)?;
            }
            making.compile()?
        }
    };
    let mut body = Body::new(simulation, &robot.columns);
    start(robot, &mut body, design, &mut values)?;
    Ok((body, values))
}
