//! A log held against the simulation: the same goals to the same hand, step by step.

use std::fmt::Write;

use hwasp_drivers::Pose;
use hwasp_emulators::hand::{Carry, HandWorld, HandWorldSettings, Planted};
use hwasp_emulators::{SpoolDrive, World};
use hwasp_export::Deployed;
use hwasp_grasp::{Object, settings_of};
use hwasp_tasks::grasp::{GraspTaskSettings, ShapeKind};
use hwasp_tasks::hand::{DESIGN_LEN, HandDescription};

use crate::controller::hand;
use crate::error::DeployError;
use crate::log::{Logged, LoggedObject, Row};

/// Simulation steps of a step of the loop.
const SUBSTEPS: usize = 10;
/// What an object weighs that nobody weighed, kg, and its friction: the middle of what was trained with.
const MASS: f64 = 0.3;
const FRICTION: f64 = 0.75;
/// From the loop to the motor, s: half a period of whoever carries goals to it, and the line.
const OWN_DELAY: f64 = 0.004;

/// A simulated hand for logs of a run.
pub struct Simulation {
    settings: HandWorldSettings,
    hand: HandDescription,
    object: LoggedObject,
    /// Which way the logged motor winds, 1 or -1.
    sign: f64,
}

/// A step of a log beside the simulation's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// s since the log began.
    pub time: f64,
    /// Wound, m: logged and simulated.
    pub wound: [f64; 2],
    /// Current, A; positive winds.
    pub current: [f64; 2],
}

impl Simulation {
    /// The hand of a run above an object of a log.
    ///
    /// # Errors
    /// Where the run has no hand.
    pub fn new(deployed: &Deployed, object: LoggedObject, sign: f64) -> Result<Self, DeployError> {
        let spec = deployed.spec();
        let no_hand = || DeployError::NoHand { problem: spec.task.name().to_owned() };
        let task = spec.task.settings::<GraspTaskSettings>().ok_or_else(no_hand)?;
        let design: [f64; DESIGN_LEN] = deployed.design().try_into().map_err(|_| no_hand())?;
        let settings = HandWorldSettings {
            grasp: settings_of(task),
            design,
            base: Pose::default(),
            palm: [0.0; 3],
            carry: Carry::Stiff,
            planted: Planted::default(),
        };
        Ok(Self { settings, hand: hand(spec)?.clone(), object, sign })
    }

    /// Goes through rows of a log with the hand different by `planted`. The motor's torque per current as it was taken for while
    /// it was logged, N·m/A, is `per_ampere`.
    ///
    /// # Errors
    /// Where there is no such hand, or its physics break down.
    pub fn run(&self, rows: &[Row], planted: Planted, per_ampere: f64) -> Result<Vec<Pair>, DeployError> {
        let wrong = |what: String| DeployError::Bench { what };
        let settings = HandWorldSettings { planted, ..self.settings.clone() };
        let mut world = HandWorld::new(settings).map_err(|error| wrong(error.to_string()))?;
        let Some(first) = rows.first() else { return Ok(Vec::new()) };
        let tool = |palm: [f64; 3]| Pose { position: palm, rotation: [0.0; 3] };
        world.put(self.body(), &tool(first.palm)).map_err(|error| wrong(error.to_string()))?;
        let transmission = &self.hand.transmission;
        let radius = transmission.spool_radius;
        let current = transmission.tension_limit * radius / per_ampere;
        let sign = self.sign;
        let own = (OWN_DELAY * 1e3) as usize;
        let mut pairs = Vec::with_capacity(rows.len());
        // What the simulation was in the milliseconds before.
        let mut past = vec![(0.0, 0.0); 2 * SUBSTEPS];
        let mut goal = 0.0;
        for (i, row) in rows.iter().enumerate() {
            // The row was written when its goal was sent; what it sensed is of a moment before.
            let age = ((1e3 * row.motor_age).round() as usize).min(past.len() - 1);
            let (wound, amperes) = past[past.len() - 1 - age];
            pairs.push(Pair { time: row.time, wound: [row.wound, wound], current: [sign * row.current, amperes] });
            let next = rows.get(i + 1).map_or(row.palm, |next| next.palm);
            for k in 0..SUBSTEPS {
                if k == own && row.goal.is_finite() {
                    goal = row.goal;
                }
                let share = (k + 1) as f64 / SUBSTEPS as f64;
                let palm = [0, 1, 2].map(|axis| row.palm[axis] + share * (next[axis] - row.palm[axis]));
                let spool = world.step(&tool(palm), SpoolDrive::Position { goal: goal / radius, current });
                past.rotate_left(1);
                if let Some(last) = past.last_mut() {
                    *last = (radius * spool.position, spool.current);
                }
            }
            if !past.iter().all(|(wound, current)| wound.is_finite() && current.is_finite()) {
                return Err(wrong("its physics broke down".to_owned()));
            }
        }
        if let Some(fault) = world.look().fault {
            return Err(wrong(format!("its physics broke down: {fault}")));
        }
        Ok(pairs)
    }

    fn body(&self) -> Object {
        let LoggedObject { size, place, shape } = self.object;
        let kind = shape.unwrap_or(ShapeKind::Box);
        let object = Object {
            kind,
            size,
            mass: MASS,
            inertia: [1e-3; 3],
            friction: FRICTION,
            place: [place[0], place[1]],
            yaw: 0.0,
            lying: false,
        };
        Object { inertia: object.shape().inertia(MASS), ..object }
    }
}

/// How a log and the simulation differ in an episode.
#[derive(Clone, Debug, PartialEq)]
pub struct Compared {
    /// Which.
    pub episode: u32,
    /// Steps that were held against each other.
    pub pairs: Vec<Pair>,
    /// Root of the mean square of the difference of what is wound, m.
    pub wound: f64,
    /// The largest, m, and when, s.
    pub worst_wound: (f64, f64),
    /// The same of the current, A.
    pub current: f64,
    /// A, s.
    pub worst_current: (f64, f64),
}

/// The rows of an episode in which the controller acts.
pub fn acting(logged: &Logged, episode: u32) -> &[Row] {
    of_phase(logged, episode, "grasp")
}

/// The rows of an episode in which this is done.
pub(crate) fn of_phase<'l>(logged: &'l Logged, episode: u32, phase: &str) -> &'l [Row] {
    let acts = |row: &Row| row.episode == episode && row.phase == phase;
    let from = logged.rows.iter().position(acts).unwrap_or(0);
    let count = logged.rows[from..].iter().take_while(|row| acts(row)).count();
    &logged.rows[from..from + count]
}

/// Holds each episode of a log against the simulation of its run.
///
/// # Errors
/// Where the log has no episode, or is of another hand.
pub fn replay(logged: &Logged, deployed: &Deployed) -> Result<Vec<Compared>, DeployError> {
    of_this_hand(logged, deployed)?;
    let mut compared = Vec::new();
    for (&episode, &object) in &logged.episodes {
        let rows = acting(logged, episode);
        if rows.is_empty() {
            continue;
        }
        let pairs = Simulation::new(deployed, object, logged.about.winding_sign)?.run(
            rows,
            Planted::default(),
            logged.about.torque_per_current,
        )?;
        let differ = |of: fn(&Pair) -> [f64; 2]| {
            let off =
                pairs.iter().map(|pair| (pair.time, of(pair)[0] - of(pair)[1])).filter(|(_, off)| off.is_finite());
            let (mut sum, mut count, mut worst) = (0.0, 0_u32, (0.0, 0.0));
            for (time, off) in off {
                (sum, count) = (sum + off * off, count + 1);
                if off.abs() > f64::abs(worst.0) {
                    worst = (off, time);
                }
            }
            ((sum / f64::from(count.max(1))).sqrt(), worst)
        };
        let (wound, worst_wound) = differ(|pair| pair.wound);
        let (current, worst_current) = differ(|pair| pair.current);
        compared.push(Compared { episode, pairs, wound, worst_wound, current, worst_current });
    }
    if compared.is_empty() {
        return Err(DeployError::Fit {
            what: "the log has no step in which the controller acted".to_owned(),
            hint: "name a log of `hwasp deploy run` that came to its first grasp",
        });
    }
    Ok(compared)
}

/// Refuses a log of another hand.
pub(crate) fn of_this_hand(logged: &Logged, deployed: &Deployed) -> Result<(), DeployError> {
    if logged.about.design == deployed.design() {
        return Ok(());
    }
    Err(DeployError::Fit {
        what: format!("the log is of another hand: it names {}", logged.about.run),
        hint: "name that run with --run",
    })
}

impl Compared {
    /// A table of its steps, CSV.
    pub fn csv(&self) -> String {
        let mut text = String::new();
        for Pair { time, wound, current } in &self.pairs {
            let [logged_wound, wound] = wound;
            let [logged_current, current] = current;
            let _ = writeln!(
                text,
                "{},{time:.4},{logged_wound:.6},{wound:.6},{logged_current:.5},{current:.5}",
                self.episode
            );
        }
        text
    }

    /// The columns of that table.
    pub const COLUMNS: &str = "episode,time_s,logged_wound_m,simulated_wound_m,logged_current_a,simulated_current_a\n";
}
