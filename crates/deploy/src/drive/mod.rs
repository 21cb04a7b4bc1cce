//! The loop: motions of palm and spool, step by step, with the rules of [`safety`](crate::safety) over each.
//!
//! Everything that moves, moves through here: the way to the start, the controller, setting down. The arm is sent a pose in each
//! of its own periods, on the straight line between the targets of two steps.

mod courier;
mod motions;
mod senses;
mod stop;

use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

use hwasp_drivers::{Arm, Motor};
use hwasp_tasks::grasp::{Bounds, ShapeKind, Targets};

use crate::clock::Clock;
use crate::controller::Spool;
use crate::pace::{Jitter, Pace};
use crate::record::{Event, Sink, Step};
use crate::rig::{Frame, Rig};
use crate::safety::{Limits, Response, Verdict, Watch};

pub use courier::Courier;
pub use motions::{Approach, Grasp, GraspTold, Motion, Progress, Rest, SetDown, Wind};
pub use senses::Senses;

/// The devices, and what belongs to them.
pub struct Bench<'a> {
    /// The arm.
    pub arm: &'a mut dyn Arm,
    /// The motor.
    pub motor: &'a mut dyn Motor,
    /// Time.
    pub clock: &'a dyn Clock,
    /// How often a person asked to stop.
    pub interrupts: &'a AtomicU32,
    /// Where steps are told to.
    pub sink: &'a mut dyn Sink,
}

/// How they are driven.
#[derive(Clone, Debug)]
pub struct Manner {
    /// The task's world on the arm.
    pub frame: Frame,
    /// The spool on the motor.
    pub spool: Spool,
    /// What the rules keep.
    pub limits: Limits,
    /// The controller's period.
    pub step: Duration,
    /// The arm's period.
    pub servo: Duration,
    /// The most that the palm moves with, m/s.
    pub palm_speed: f64,
    /// How much tendon is unwound in a step, m.
    pub unwind: f64,
    /// For how long the motor holds after a stop.
    pub hold: Duration,
    /// Whether nothing is moved: what would be sent is only told.
    pub shadow: bool,
}

impl Manner {
    /// Of a rig and a spool, for a controller with this period, s, that winds at most `wind`, m, in it.
    pub fn new(rig: &Rig, spool: Spool, period: f64, wind: f64) -> Self {
        Self {
            frame: rig.frame(),
            spool,
            limits: Limits::of(rig, spool.travel, spool.current),
            step: Duration::from_secs_f64(period),
            servo: Duration::from_secs_f64(1.0 / rig.arm.rate),
            palm_speed: rig.limits.palm_speed,
            unwind: wind,
            hold: Duration::from_secs_f64(rig.limits.hold),
            shadow: false,
        }
    }

    fn bounds(&self) -> Bounds {
        Bounds {
            workspace: self.limits.workspace,
            palm_step: self.palm_speed * self.step.as_secs_f64(),
            travel: self.spool.travel,
        }
    }
}

/// In which state a motion left arm and hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finish {
    /// It came to its end.
    Done,
    /// A rule ended it; what it asked for is done.
    Ended(Verdict),
}

/// The loop over arm and motor.
pub struct Drive<'a> {
    bench: Bench<'a>,
    manner: Manner,
    watch: Watch,
    senses: Senses,
    targets: Targets,
    /// Between these the arm moves in this step.
    path: [[f64; 3]; 2],
    path_began: Instant,
    steps: Pace,
    servos: Pace,
    jitter: Jitter,
    began: Instant,
    episode: u32,
    count: u32,
    /// Whether the motor was told to hold.
    holding: bool,
    /// What the motor was sent to last, as tendon, m.
    goal: f64,
    arm_stopped: bool,
}

impl<'a> Drive<'a> {
    /// Looks where arm and hand are. Nothing moves, and the motor is as it was.
    pub fn new(bench: Bench<'a>, manner: Manner) -> Self {
        let now = bench.clock.now();
        let mut drive = Self {
            watch: Watch::new(manner.limits.clone()),
            senses: Senses::default(),
            targets: Targets::new([0.0; 3], 0.0, manner.bounds()),
            path: [[0.0; 3]; 2],
            path_began: now,
            steps: Pace::new(now, manner.step),
            servos: Pace::new(now, manner.servo),
            jitter: Jitter::default(),
            began: now,
            episode: 0,
            count: 0,
            holding: false,
            goal: f64::NAN,
            arm_stopped: false,
            bench,
            manner,
        };
        drive.sense();
        drive.aim();
        drive
    }

    /// The targets are where palm and spool are.
    fn aim(&mut self) {
        self.targets = Targets::new(self.senses.palm, self.senses.wound, self.manner.bounds());
        self.path = [self.senses.palm; 2];
    }

    /// How late steps began.
    pub fn jitter(&self) -> &Jitter {
        &self.jitter
    }

    /// What was sensed last.
    pub fn senses(&self) -> &Senses {
        &self.senses
    }

    /// What was decided so far.
    pub fn decided(&self) -> Verdict {
        self.watch.decided()
    }

    /// Where palm and spool are sent.
    pub fn targets(&self) -> &Targets {
        &self.targets
    }

    /// Where the palm may be, m.
    pub fn workspace(&self) -> [[f64; 2]; 3] {
        self.manner.limits.workspace
    }

    /// The nearest place in the workspace, m.
    pub fn within(&self, place: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| place[i].clamp(self.workspace()[i][0], self.workspace()[i][1]))
    }

    /// The loop's now.
    pub fn now(&self) -> Instant {
        self.bench.clock.now()
    }

    /// Counts the episodes in what is told.
    pub fn begin_episode(&mut self, episode: u32, size: [f64; 3], place: [f64; 3], shape: Option<ShapeKind>) {
        self.episode = episode;
        self.tell(Event::Episode { size, place, shape });
    }

    /// Does a motion to its end, or until a rule ends it: then what the rule asks for is done before this returns, and palm and
    /// hand are in a safe state.
    pub fn run(&mut self, motion: &mut dyn Motion) -> Finish {
        let finish = self.steps_of(motion);
        match finish {
            Finish::Ended(Verdict { response: Response::SetDown, .. }) => {
                let lowest = motion.lowest().unwrap_or(self.targets.palm[2]);
                match self.steps_of(&mut SetDown::to(lowest)) {
                    Finish::Done => {
                        self.tell(Event::Down);
                        self.free();
                    }
                    Finish::Ended(_) => self.hold(),
                }
                Finish::Ended(self.watch.decided())
            }
            Finish::Ended(_) => {
                self.hold();
                Finish::Ended(self.watch.decided())
            }
            Finish::Done => Finish::Done,
        }
    }

    fn steps_of(&mut self, motion: &mut dyn Motion) -> Finish {
        self.count = 0;
        let now = self.bench.clock.now();
        self.steps.restart(now);
        self.servos.restart(now);
        self.path_began = now;
        loop {
            let late = self.wait();
            self.jitter.note(late);
            self.sense();
            let mut verdict = self.judge(late, motion.object_age(&self.senses, self.bench.clock.now()));
            let mut progress = Progress::Going;
            if verdict.response == Response::GoOn
                || verdict.response <= motion.bears() && verdict.response != Response::Hold
            {
                let before = self.targets;
                progress = motion.step(&self.senses, &mut self.targets, &self.manner);
                if let Progress::NotFinite { controller } = progress {
                    // Nothing of it is obeyed.
                    self.targets = before;
                    verdict = self.decided_by(|watch| watch.not_finite(controller));
                } else if let Progress::Felt(torque) = progress {
                    self.tell(Event::Felt(torque));
                }
            }
            let ended = verdict.response > motion.bears().max(Response::Hold);
            if ended && verdict.response >= Response::StopArm {
                self.stop(verdict.response);
            } else {
                self.path = [self.path[1], self.targets.palm];
                self.wind();
            }
            self.record(motion, late, verdict.response);
            self.count += 1;
            if ended {
                return Finish::Ended(verdict);
            }
            if matches!(progress, Progress::Done) {
                return Finish::Done;
            }
        }
    }

    fn judge(&mut self, late: Duration, object_age: Option<Duration>) -> Verdict {
        let glance = crate::safety::Glance {
            now: self.bench.clock.now(),
            late,
            arm: self.senses.arm,
            arm_lost: self.senses.arm_lost,
            motor: self.senses.motor,
            motor_lost: self.senses.motor_lost,
            palm: self.senses.palm,
            palm_target: if self.manner.shadow || self.arm_stopped { self.senses.palm } else { self.targets.palm },
            wound: self.senses.wound,
            wound_target: if self.goal.is_finite() { self.goal } else { self.senses.wound },
            holding: self.holding,
            object_age,
            interrupts: self.bench.interrupts.load(Ordering::Relaxed),
            log_lost: self.bench.sink.lost(),
        };
        self.decided_by(|watch| watch.judge(&glance))
    }

    /// Tells what was decided anew.
    fn decided_by(&mut self, decide: impl FnOnce(&mut Watch) -> Verdict) -> Verdict {
        let before = self.watch.decided();
        let verdict = decide(&mut self.watch);
        if let Some(cause) = verdict.cause.filter(|_| verdict != before) {
            self.tell(Event::Decided(verdict.response, cause));
            if verdict.response == Response::StopArm && !self.manner.shadow {
                // Once; whoever stands there has to know before the time for holding is over.
                let hold = self.manner.hold.as_secs_f64();
                tracing::warn!("{}: the arm stands, the motor holds for {hold} s; Ctrl-C frees it", cause.name());
            }
        }
        verdict
    }

    /// Waits for the next step, and sends the arm along meanwhile. Returns how late the step begins.
    fn wait(&mut self) -> Duration {
        while self.servos.next() < self.steps.next() {
            self.bench.clock.sleep_until(self.servos.next());
            let now = self.bench.clock.now();
            self.servos.met(now);
            self.send(now);
        }
        let due = self.steps.next();
        self.bench.clock.sleep_until(due);
        let late = self.steps.met(self.bench.clock.now());
        self.path_began = due;
        late
    }

    /// Sends the arm to where it should be at this moment.
    fn send(&mut self, now: Instant) {
        if self.manner.shadow || self.arm_stopped {
            return;
        }
        let share = now.saturating_duration_since(self.path_began).as_secs_f64() / self.manner.step.as_secs_f64();
        let share = share.min(1.0);
        let [from, to] = self.path;
        let place = [0, 1, 2].map(|i| from[i] + share * (to[i] - from[i]));
        if let Err(error) = self.bench.arm.servo(&self.manner.frame.pose(place)) {
            self.senses.arm_failed(&error);
            self.tell(Event::ArmFault);
        }
    }

    fn sense(&mut self) {
        let faults = self.senses.sense(self.bench.arm, self.bench.motor, &self.manner);
        for (fault, event) in faults.into_iter().zip([Event::ArmFault, Event::MotorFault]) {
            if fault {
                self.tell(event);
            }
        }
    }

    /// Sends the spool to its target: no further ahead of what is wound than it helps.
    fn wind(&mut self) {
        if self.manner.shadow || !self.holding {
            return;
        }
        let goal = self.targets.travel.min(self.senses.wound.max(0.0) + self.manner.limits.lead);
        self.wind_to(goal);
    }

    fn wind_to(&mut self, goal: f64) {
        if !goal.is_finite() {
            return;
        }
        self.goal = goal;
        let position = self.manner.spool.position(goal);
        if let Err(error) = self.bench.motor.goal(position, self.manner.spool.current) {
            self.senses.motor_failed(&error);
            self.tell(Event::MotorFault);
        }
    }

    /// The motor holds where it is.
    ///
    /// # Errors
    /// The motor's.
    pub fn grip(&mut self) -> Result<(), hwasp_drivers::DriverError> {
        self.sense();
        self.aim();
        if self.manner.shadow {
            return Ok(());
        }
        let spool = self.manner.spool;
        self.bench.motor.goal(spool.position(self.senses.wound), spool.current)?;
        self.bench.motor.torque(true)?;
        self.goal = self.senses.wound;
        // The next answers are of a motor that holds.
        self.sense();
        self.holding = true;
        Ok(())
    }

    fn time(&self) -> f64 {
        self.bench.clock.now().saturating_duration_since(self.began).as_secs_f64()
    }

    fn tell(&mut self, event: Event) {
        self.bench.sink.event(self.time(), self.episode, event);
    }

    fn record(&mut self, motion: &dyn Motion, late: Duration, response: Response) {
        let now = self.bench.clock.now();
        let mut step = Step {
            time: self.time(),
            episode: self.episode,
            phase: motion.phase(),
            step: self.count,
            late: late.as_secs_f64(),
            palm_target: self.targets.palm,
            goal: self.goal,
            travel: self.targets.travel,
            response,
            ..self.senses.told(now)
        };
        motion.tell(&mut step);
        self.bench.sink.step(&step);
    }
}
