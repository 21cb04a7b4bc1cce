//! What stands between the hand and its controller: what is told of the sensors, and how late.

use hwasp_core::{Stream, share_done};
use hwasp_tasks::grasp::{Bench, CarriedObject, ObjectSensed, TravelSensed};
use rand::RngExt;

/// What the sensors say at one moment.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Reading {
    /// m.
    pub(super) palm: [f64; 3],
    /// The object's centre, as a camera sees it, m.
    pub(super) object: [f64; 3],
    /// What was commanded to be wound, m.
    pub(super) commanded: f64,
    /// What is wound, m.
    pub(super) encoder: f64,
    /// The same as the program knows it, without noise, m.
    pub(super) target: f64,
    /// Of the motor, N·m.
    pub(super) torque: f64,
}

/// What the controller is told of it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Told {
    /// m.
    pub(super) palm: [f64; 3],
    /// m.
    pub(super) object: [f64; 3],
    /// m.
    pub(super) travel: f64,
    /// N·m.
    pub(super) torque: f64,
    /// m.
    pub(super) target: f64,
}

/// The bench of an episode.
#[derive(Clone, Copy, Debug)]
pub(super) struct Drawn {
    /// Steps from sensors to commands.
    pub(super) delay: usize,
    /// What is left, after a step, of the way that the arm is behind its target.
    pub(super) behind: f64,
    /// m.
    pub(super) slack: f64,
    /// What the torque reads as a multiple of what it is.
    pub(super) torque_gain: f64,
    /// The motor's limit as a multiple of what it should be.
    pub(super) limit_gain: f64,
    /// Of motor and spool, N·m.
    pub(super) friction: f64,
}

impl Default for Drawn {
    fn default() -> Self {
        Self { delay: 0, behind: 0.0, slack: 0.0, torque_gain: 1.0, limit_gain: 1.0, friction: 0.0 }
    }
}

/// The sensors as the controller is told them.
#[derive(Clone, Debug)]
pub(super) struct Sensors {
    settings: Bench,
    /// Of a step, s.
    period: f64,
    object: CarriedObject,
    delay: usize,
    /// What was told at the last steps, as many as the longest delay has and one more; the newest at `newest`.
    told: Vec<Told>,
    newest: usize,
}

impl Sensors {
    pub(super) fn new(settings: &Bench, period: f64) -> Self {
        let most = steps(settings.delay[1], period);
        Self {
            settings: settings.clone(),
            period,
            object: CarriedObject::new([0.0; 3], f64::INFINITY),
            delay: 0,
            told: vec![Told::default(); most + 1],
            newest: 0,
        }
    }

    /// Draws the bench of an episode at this fraction of training.
    pub(super) fn draw(&self, progress: f64, rng: &mut Stream) -> Drawn {
        let Bench { delay, arm_lag, slack, torque_gain, limit_gain, motor_friction, growth: [from, to], .. } =
            &self.settings;
        let grown = share_done(progress, *from, *to);
        let mut between = |[lo, hi]: &[f64; 2], none: f64| {
            let drawn = lo + (hi - lo) * rng.random::<f64>();
            if grown < 1.0 { none + grown * (drawn - none) } else { drawn }
        };
        let delay = steps(between(delay, 0.0), self.period);
        let lag = between(arm_lag, 0.0);
        Drawn {
            delay,
            behind: if lag > 0.0 { (-self.period / lag).exp() } else { 0.0 },
            slack: between(slack, 0.0),
            torque_gain: between(torque_gain, 1.0),
            limit_gain: between(limit_gain, 1.0),
            friction: between(motor_friction, 0.0),
        }
    }

    /// Begins an episode in which the controller is told things `delay` steps late.
    pub(super) fn start(&mut self, first: Reading, delay: usize) {
        self.delay = delay;
        let felt_at = match self.settings.object_sensed {
            ObjectSensed::Carried => self.settings.grasp_felt,
            ObjectSensed::Tracked | ObjectSensed::Fixed => f64::INFINITY,
        };
        self.object = CarriedObject::new(first.object, felt_at);
        let told = self.tell(first);
        self.told.fill(told);
    }

    /// Takes the next reading.
    pub(super) fn read(&mut self, reading: Reading) {
        self.newest = (self.newest + 1) % self.told.len();
        self.told[self.newest] = self.tell(reading);
    }

    fn tell(&mut self, Reading { palm, object, commanded, encoder, target, torque }: Reading) -> Told {
        let place = self.object.place(palm, torque);
        Told {
            palm,
            object: if self.settings.object_sensed == ObjectSensed::Tracked { object } else { place },
            travel: match self.settings.travel_sensed {
                TravelSensed::Commanded => commanded,
                TravelSensed::Encoder | TravelSensed::Both => encoder,
            },
            torque,
            target,
        }
    }

    /// What the controller is told now.
    pub(super) fn told(&self) -> &Told {
        &self.told[(self.newest + self.told.len() - self.delay) % self.told.len()]
    }
}

/// Whole periods.
fn steps(time: f64, period: f64) -> usize {
    (time / period).round() as usize
}
