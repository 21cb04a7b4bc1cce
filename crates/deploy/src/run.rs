//! Episodes one after the other: to the start, the controller, set down, and again.

use std::time::Duration;

use hwasp_core::EnvSpec;
use hwasp_tasks::grasp::{CarriedObject, ShapeKind};

use crate::controller::{Controller, Training};
use crate::drive::{Approach, Drive, Finish, Grasp, GraspTold, SetDown, Wind};
use crate::error::DeployError;
use crate::object::{Object, ObjectKnown, Tracker};
use crate::safety::Verdict;

/// How high the palm is carried between episodes, m above the table, where the workspace lets it.
const HOME: f64 = 0.35;

/// How much is wound in the air before each grasp, m: the fingers close by a half and touch nothing.
const EXERCISE: f64 = 0.008;
/// How slowly, m a step, and for how many steps it rests then.
const EXERCISE_STEP: f64 = 8e-5;
const EXERCISE_REST: u32 = 15;

/// An object on the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Its bounding box, m.
    pub size: [f64; 3],
    /// Its centre in the task's world, m.
    pub place: [f64; 3],
    /// Its shape, where somebody said it.
    pub shape: Option<ShapeKind>,
    /// Where the palm begins, where somebody drew it, m.
    pub start: Option<[f64; 3]>,
}

/// Who puts objects there, and looks whether they were lifted.
pub trait Stage: Send {
    /// The object of an episode; none where there are no more.
    ///
    /// # Errors
    /// Where there is none.
    fn place(&mut self, episode: u32) -> Result<Placed, DeployError>;

    /// Whether the object is held, asked at the end of an episode while it should be; none where nobody looks.
    ///
    /// # Errors
    /// Where nobody can say.
    fn held(&mut self, episode: u32) -> Result<Option<bool>, DeployError>;
}

/// What is to be done.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Episodes.
    pub episodes: u32,
    /// The first of them, as the stage counts.
    pub first: u32,
    /// How it is known where the object is.
    pub object: ObjectKnown,
    /// The torque from which on it counts as held, N·m.
    pub felt: f64,
    /// Steps of the controller in an episode.
    pub steps: u32,
    /// The port of a tracker.
    pub tracker: u16,
    /// What the run was trained with.
    pub training: Training,
}

impl Plan {
    /// So many episodes as the run was trained.
    pub fn new(episodes: u32, object: ObjectKnown, env: &EnvSpec, training: Training) -> Self {
        let (felt, steps) = (training.felt, env.horizon as u32);
        Self { episodes, first: 0, object, felt, steps, tracker: 0, training }
    }
}

/// What an episode came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Episode {
    /// Which, as the stage counts.
    pub index: u32,
    /// The object.
    pub placed: Placed,
    /// Whether the grasp was felt.
    pub felt: bool,
    /// Whether the object was held at the end; none where nobody looked, or where it did not come to an end.
    pub held: Option<bool>,
    /// What ended it early.
    pub ended: Option<Verdict>,
}

/// Runs episodes until all are done or a rule ends one: the palm and the hand are in a safe state then. `told` hears of each.
///
/// # Errors
/// Of the devices before anything moved, and of the stage.
pub fn run(
    drive: &mut Drive<'_>,
    controller: &mut Controller<'_>,
    plan: &Plan,
    stage: &mut dyn Stage,
    told: &mut dyn FnMut(&Episode),
) -> Result<Vec<Episode>, DeployError> {
    drive.grip()?;
    let mut episodes = Vec::new();
    for count in 0..plan.episodes {
        let index = plan.first + count;
        let placed = match one(drive, controller, plan, stage, index) {
            Ok(episode) => episode,
            Err(error) => {
                // Nobody is there any more to say what comes: the hand is freed where it is.
                drive.free();
                return Err(error);
            }
        };
        told(&placed);
        episodes.push(placed);
        if placed.ended.is_some() {
            return Ok(episodes);
        }
    }
    drive.free();
    Ok(episodes)
}

fn one(
    drive: &mut Drive<'_>,
    controller: &mut Controller<'_>,
    plan: &Plan,
    stage: &mut dyn Stage,
    index: u32,
) -> Result<Episode, DeployError> {
    let [x, y, _] = drive.targets().palm;
    let [_, _, [_, top]] = drive.workspace();
    // Up first, then aside: what stands on the table is not swept away.
    let up = [x, y, HOME.min(top).max(drive.targets().palm[2])];
    let mut early = run_to(drive, up);
    let (placed, ended) = drive.resting(|| stage.place(index));
    let placed = placed?;
    early = early.or(ended);
    let start = placed.start.unwrap_or_else(|| {
        let [low, high] = plan.training.height;
        [0.0, 0.0, placed.size[2] + 0.5 * (low + high)]
    });
    let start = drive.within(start);
    let episode = Episode { index, placed, felt: false, held: None, ended: None };
    early = early.or_else(|| run_to(drive, [start[0], start[1], up[2]])).or_else(|| run_to(drive, start));
    if let Some(verdict) = early {
        return Ok(Episode { ended: Some(verdict), ..episode });
    }
    drive.begin_episode(index, placed.size, placed.place, placed.shape);
    // The open hand closes a little and opens again, in the air: what friction and tendons are like shows in each log.
    for goal in [EXERCISE, 0.0] {
        if let Finish::Ended(verdict) = drive.run(&mut Wind::to(goal, EXERCISE_STEP, EXERCISE_REST)) {
            return Ok(Episode { ended: Some(verdict), ..episode });
        }
    }
    let object = object(plan, &placed, drive.now())?;
    let told =
        GraspTold { object, size: placed.size, encoder: plan.training.encoder, felt_at: plan.felt, steps: plan.steps };
    let mut grasp = Grasp::new(controller, told);
    let finish = drive.run(&mut grasp);
    let (felt, lowest) = (grasp.felt(), crate::drive::Motion::lowest(&grasp));
    if let Finish::Ended(verdict) = finish {
        return Ok(Episode { felt, ended: Some(verdict), ..episode });
    }
    let (held, ended) = drive.resting(|| stage.held(index));
    let held = held?;
    if let Some(verdict) = ended {
        return Ok(Episode { felt, held, ended: Some(verdict), ..episode });
    }
    let height = lowest.unwrap_or(drive.targets().palm[2]);
    let ended = match drive.run(&mut SetDown::to(height)) {
        Finish::Done => None,
        Finish::Ended(verdict) => Some(verdict),
    };
    Ok(Episode { felt, held, ended, ..episode })
}

fn run_to(drive: &mut Drive<'_>, place: [f64; 3]) -> Option<Verdict> {
    match drive.run(&mut Approach::to(place)) {
        Finish::Done => None,
        Finish::Ended(verdict) => Some(verdict),
    }
}

/// Where the object is taken to be in an episode.
fn object(plan: &Plan, placed: &Placed, now: std::time::Instant) -> Result<Object, DeployError> {
    Ok(match plan.object {
        ObjectKnown::Fixed => Object::Fixed(placed.place),
        ObjectKnown::Carried => Object::Carried(CarriedObject::new(placed.place, plan.felt)),
        ObjectKnown::Tracker => {
            let mut tracker = Tracker::listen(plan.tracker, now)?;
            tracker.first(Duration::from_secs(5))?;
            Object::Tracked(tracker)
        }
    })
}

/// The same object each time, at the same place, which nobody looks at: a person puts it there.
#[derive(Clone, Copy, Debug)]
pub struct OnTheTable(pub Placed);

impl Stage for OnTheTable {
    fn place(&mut self, _: u32) -> Result<Placed, DeployError> {
        Ok(self.0)
    }

    fn held(&mut self, _: u32) -> Result<Option<bool>, DeployError> {
        Ok(None)
    }
}
