//! How a motion ends before its end, and what is waited for.

use std::sync::atomic::{AtomicBool, Ordering};

use hwasp_tasks::grasp::Targets;

use super::{Drive, Finish, Manner, Motion, Progress, Rest, Senses};
use crate::record::{Event, Phase};
use crate::safety::{Response, Verdict};

impl Drive<'_> {
    /// The arm stands still at once; the motor holds what it has, or is freed.
    pub(super) fn stop(&mut self, response: Response) {
        self.stop_arm();
        if response == Response::Release {
            self.free();
        } else if !self.manner.shadow && self.holding {
            // What is wound now is held with the current that it takes, and no more is wound.
            let goal = if self.goal.is_finite() { self.goal } else { self.senses.wound };
            self.wind_to(goal.min(self.senses.wound + self.manner.limits.lead));
        }
    }

    fn stop_arm(&mut self) {
        self.path = [self.senses.palm; 2];
        let stopped = self.manner.shadow || self.bench.arm.stop().is_ok();
        if stopped && !self.arm_stopped {
            self.tell(Event::ArmStopped);
        }
        self.arm_stopped = true;
    }

    /// After a stop: the motor holds until the time for it is over or a person asks, and is freed then.
    pub(super) fn hold(&mut self) {
        let until = self.bench.clock.now() + self.manner.hold;
        let interrupts = self.bench.interrupts.load(Ordering::Relaxed);
        let now = self.bench.clock.now();
        self.steps.restart(now);
        self.servos.restart(now);
        while self.holding && self.bench.clock.now() < until {
            let late = self.wait();
            self.sense();
            let verdict = self.judge(late.min(self.manner.limits.overrun), None);
            if verdict.response == Response::Release || self.bench.interrupts.load(Ordering::Relaxed) > interrupts {
                break;
            }
            let _ = self.bench.arm.stop();
            self.wind_to(self.goal);
            self.record(&Still, late, verdict.response);
        }
        self.free();
    }

    /// Asks somebody who may take his time, while palm and spool stay as they are; what he said, and what ended the rest early.
    pub fn resting<T: Send>(&mut self, ask: impl FnOnce() -> T + Send) -> (T, Option<Verdict>) {
        let answered = AtomicBool::new(false);
        std::thread::scope(|scope| {
            let asked = scope.spawn(|| {
                let answer = ask();
                answered.store(true, Ordering::Release);
                answer
            });
            let finish = self.run(&mut Rest(&answered));
            let ended = if let Finish::Ended(verdict) = finish { Some(verdict) } else { None };
            match asked.join() {
                Ok(answer) => (answer, ended),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        })
    }

    /// The motor turns freely.
    pub fn free(&mut self) {
        // It is told until it has heard: once is enough where the line is whole.
        for _ in 0..3 {
            if self.manner.shadow || self.bench.motor.torque(false).is_ok() {
                break;
            }
        }
        if self.holding {
            self.tell(Event::Freed);
        }
        (self.holding, self.goal) = (false, f64::NAN);
    }
}

/// Nothing moves.
struct Still;

impl Motion for Still {
    fn phase(&self) -> Phase {
        Phase::Held
    }

    fn step(&mut self, _: &Senses, _: &mut Targets, _: &Manner) -> Progress {
        Progress::Going
    }
}
