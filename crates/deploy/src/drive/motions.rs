//! What palm and spool do, step by step.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use hwasp_tasks::grasp::Targets;

use super::{Manner, Senses};
use crate::controller::{Controller, Sensed};
use crate::object::Object;
use crate::record::{Phase, Step};
use crate::safety::Response;

/// How a step went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Progress {
    /// It goes on.
    Going,
    /// It goes on, and the grasp was felt in this step, at this torque, N·m.
    Felt(f64),
    /// This was the last step.
    Done,
    /// Something was no number: nothing of the step is obeyed.
    NotFinite {
        /// Whether the controller said it, and not a sensor.
        controller: bool,
    },
}

/// A motion of palm and spool. A step allocates nothing.
pub trait Motion {
    /// What it is called in logs.
    fn phase(&self) -> Phase;
    /// Moves the targets by a step.
    fn step(&mut self, senses: &Senses, targets: &mut Targets, manner: &Manner) -> Progress;
    /// The strongest response that it goes on under.
    fn bears(&self) -> Response {
        Response::GoOn
    }
    /// How old what is known of the object is, where that can grow old.
    fn object_age(&mut self, _senses: &Senses, _now: Instant) -> Option<Duration> {
        None
    }
    /// The lowest that the palm was sent to, m, where an object could be in the hand.
    fn lowest(&self) -> Option<f64> {
        None
    }
    /// Adds what it knows to what is told of a step.
    fn tell(&self, _step: &mut Step) {}
}

/// To a place on a straight line, opening the hand on the way.
#[derive(Clone, Debug)]
pub struct Approach {
    place: [f64; 3],
    /// After so many steps at the goal the arm is there.
    settled: u32,
}

/// How long the arm may take to come to rest after its target does, steps.
const SETTLING: u32 = 30;
/// What is left of the tendon when a hand counts as open, m.
const OPEN: f64 = 1e-3;
/// How near the palm is to a place when it is there, m.
const THERE: f64 = 2e-3;

impl Approach {
    /// To here, in the task's world, m.
    pub fn to(place: [f64; 3]) -> Self {
        Self { place, settled: 0 }
    }
}

impl Motion for Approach {
    fn phase(&self) -> Phase {
        Phase::Approach
    }

    fn step(&mut self, senses: &Senses, targets: &mut Targets, manner: &Manner) -> Progress {
        targets.advance([0.0; 3], -manner.unwind);
        let there = targets.approach(self.place, manner.palm_speed * manner.step.as_secs_f64());
        let off = (0..3).map(|i| (senses.palm[i] - self.place[i]).powi(2)).sum::<f64>().sqrt();
        self.settled = if there && targets.travel <= 0.0 { self.settled + 1 } else { 0 };
        let arrived = off < THERE && senses.wound < OPEN;
        let waited = self.settled >= SETTLING;
        if self.settled > 0 && (arrived || waited) || manner.shadow { Progress::Done } else { Progress::Going }
    }
}

/// The trained controller.
pub struct Grasp<'g, 'd> {
    controller: &'g mut Controller<'d>,
    object: Object,
    size: [f64; 3],
    encoder: bool,
    steps: u32,
    taken: u32,
    lowest: f64,
    /// Where the object is taken to be in this step, and how old that is.
    place: ([f64; 3], Option<Duration>),
    felt_at: f64,
    felt: bool,
}

/// What is told to a grasp.
pub struct GraspTold {
    /// Where the object is.
    pub object: Object,
    /// Its bounding box, m.
    pub size: [f64; 3],
    /// Whether `motor_travel` is what the encoder says.
    pub encoder: bool,
    /// The torque from which on it counts as held, N·m.
    pub felt_at: f64,
    /// Steps.
    pub steps: u32,
}

impl<'g, 'd> Grasp<'g, 'd> {
    /// Of an object.
    pub fn new(controller: &'g mut Controller<'d>, told: GraspTold) -> Self {
        let GraspTold { object, size, encoder, felt_at, steps } = told;
        let (lowest, place) = (f64::INFINITY, ([f64::NAN; 3], None));
        Self { controller, object, size, encoder, steps, taken: 0, lowest, place, felt_at, felt: false }
    }

    /// Whether the grasp was felt.
    pub fn felt(&self) -> bool {
        self.felt
    }
}

impl Motion for Grasp<'_, '_> {
    fn phase(&self) -> Phase {
        Phase::Grasp
    }

    fn object_age(&mut self, senses: &Senses, now: Instant) -> Option<Duration> {
        self.place = self.object.place(senses.palm, senses.torque, now);
        self.place.1
    }

    fn step(&mut self, senses: &Senses, targets: &mut Targets, _: &Manner) -> Progress {
        self.controller.act(&Sensed {
            palm: senses.palm,
            object: self.place.0,
            size: self.size,
            travel: if self.encoder { senses.wound } else { targets.travel },
            torque: senses.torque,
            travel_target: targets.travel,
        });
        if !self.controller.observation().iter().all(|x| x.is_finite()) {
            return Progress::NotFinite { controller: false };
        }
        if !self.controller.command().iter().all(|x| x.is_finite()) {
            return Progress::NotFinite { controller: true };
        }
        let (palm, motor) = self.controller.motion();
        targets.advance(palm, motor);
        self.lowest = self.lowest.min(targets.palm[2]);
        self.taken += 1;
        if self.taken >= self.steps {
            return Progress::Done;
        }
        if !self.felt && senses.torque >= self.felt_at {
            self.felt = true;
            return Progress::Felt(senses.torque);
        }
        Progress::Going
    }

    fn lowest(&self) -> Option<f64> {
        self.lowest.is_finite().then_some(self.lowest)
    }

    fn tell(&self, step: &mut Step) {
        let (seen, commanded) = (self.controller.observation(), self.controller.command());
        step.seen[..seen.len()].copy_from_slice(seen);
        step.commanded[..commanded.len()].copy_from_slice(commanded);
    }
}

/// Down to where the hand grasped, and open.
#[derive(Clone, Debug)]
pub struct SetDown {
    height: f64,
    opened: u32,
}

/// How fast objects are set down, m/s.
const GENTLY: f64 = 0.05;
/// A hand that does not open in so many steps is left as it is: its motor is freed next.
const OPENING: u32 = 400;

impl SetDown {
    /// Down to a height of the palm, m.
    pub fn to(height: f64) -> Self {
        Self { height, opened: 0 }
    }
}

impl Motion for SetDown {
    fn phase(&self) -> Phase {
        Phase::SetDown
    }

    fn bears(&self) -> Response {
        Response::SetDown
    }

    fn step(&mut self, senses: &Senses, targets: &mut Targets, manner: &Manner) -> Progress {
        let [x, y, z] = targets.palm;
        // It never goes up: an object that is on the table stays there.
        let speed = manner.palm_speed.min(GENTLY);
        if !targets.approach([x, y, self.height.min(z)], speed * manner.step.as_secs_f64()) {
            return Progress::Going;
        }
        if self.opened == 0 {
            // From what is wound on: what the commands had added up to beyond it would only delay.
            targets.travel = targets.travel.min(senses.wound.max(0.0));
        }
        targets.advance([0.0; 3], -manner.unwind);
        self.opened += 1;
        let open = targets.travel <= 0.0 && senses.wound < OPEN;
        if open || self.opened >= OPENING || manner.shadow { Progress::Done } else { Progress::Going }
    }
}

/// All stays as it is until somebody who is asked has answered.
#[derive(Clone, Copy, Debug)]
pub struct Rest<'r>(pub &'r AtomicBool);

impl Motion for Rest<'_> {
    fn phase(&self) -> Phase {
        Phase::Held
    }

    fn step(&mut self, _: &Senses, _: &mut Targets, _: &Manner) -> Progress {
        if self.0.load(Ordering::Acquire) { Progress::Done } else { Progress::Going }
    }
}

/// The spool to a goal, slowly; the palm stays.
#[derive(Clone, Debug)]
pub struct Wind {
    goal: f64,
    step: f64,
    wait: u32,
}

impl Wind {
    /// To so much wound, m, by `step`, m, a step; then `wait` steps more.
    pub fn to(goal: f64, step: f64, wait: u32) -> Self {
        Self { goal, step, wait }
    }
}

impl Motion for Wind {
    fn phase(&self) -> Phase {
        Phase::Measure
    }

    fn step(&mut self, _: &Senses, targets: &mut Targets, _: &Manner) -> Progress {
        let way = self.goal - targets.travel;
        targets.travel += way.clamp(-self.step, self.step);
        if way.abs() > self.step {
            return Progress::Going;
        }
        if self.wait == 0 {
            return Progress::Done;
        }
        self.wait -= 1;
        Progress::Going
    }
}
