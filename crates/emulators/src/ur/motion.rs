//! How the arm moves: it follows with a lag, goes straight, or comes to a stop, and its joints have a greatest speed.

use nalgebra::Isometry3;

use super::kinematics::{Joints, Lengths, between};

/// The fastest a joint turns, rad/s: 180° of the vendor's data sheet.
const FASTEST: f64 = std::f64::consts::PI;
/// Of stops that nobody gave a deceleration, rad/s².
pub(crate) const HARD: f64 = 40.0;
/// Following goes on for so many periods after its time is over, then the arm stops by itself.
const GRACE: f64 = 2.0;

/// A way with a ramp up, a pace, and a ramp down.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ramp {
    length: f64,
    speed: f64,
    acceleration: f64,
    since: f64,
}

impl Ramp {
    fn new(length: f64, speed: f64, acceleration: f64) -> Self {
        // A short way never reaches the pace.
        let speed = speed.min((length * acceleration).sqrt());
        Self { length, speed, acceleration, since: 0.0 }
    }

    fn over(&self) -> bool {
        self.length <= 0.0 || self.since >= self.length / self.speed + self.speed / self.acceleration
    }

    /// How much of the way is done, 0 to 1.
    fn part(&self) -> f64 {
        if self.over() {
            return 1.0;
        }
        let ramp = self.speed / self.acceleration;
        let left = self.length / self.speed + ramp - self.since;
        let done = if self.since < ramp {
            0.5 * self.acceleration * self.since * self.since
        } else if left < ramp {
            self.length - 0.5 * self.acceleration * left * left
        } else {
            self.speed * (self.since - 0.5 * ramp)
        };
        done / self.length
    }
}

/// What the arm does.
#[derive(Clone, Debug)]
pub(crate) enum Motion {
    /// It stands.
    Still,
    /// It follows joints with a lag, for so much longer, s.
    Follow { target: Joints, lag: f64, left: f64 },
    /// The flange goes straight.
    Straight { from: Isometry3<f64>, to: Isometry3<f64>, ramp: Ramp },
    /// All joints arrive together.
    Joints { from: Joints, to: Joints, ramp: Ramp },
    /// Joints slow down together, rad/s².
    Stop { deceleration: f64 },
}

/// The arm's body.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub(crate) lengths: Lengths,
    pub(crate) q: Joints,
    pub(crate) qd: Joints,
    motion: Motion,
    /// Counts motions, so that whoever waits knows that his is over.
    pub(crate) count: u64,
}

impl Body {
    pub(crate) fn new(lengths: Lengths, q: Joints) -> Self {
        Self { lengths, q, qd: [0.0; 6], motion: Motion::Still, count: 0 }
    }

    pub(crate) fn still(&self) -> bool {
        matches!(self.motion, Motion::Still)
    }

    fn begin(&mut self, motion: Motion) {
        self.motion = motion;
        self.count += 1;
    }

    pub(crate) fn follow(&mut self, target: Joints, lag: f64, time: f64, period: f64) {
        let left = time + GRACE * period;
        // Following on is one motion.
        match &mut self.motion {
            Motion::Follow { target: old, lag: old_lag, left: old_left } => {
                (*old, *old_lag, *old_left) = (target, lag, left);
            }
            _ => self.begin(Motion::Follow { target, lag, left }),
        }
    }

    /// Straight to a frame of the flange; `None` where it does not reach.
    pub(crate) fn straight(&mut self, to: Isometry3<f64>, speed: f64, acceleration: f64) -> Option<()> {
        self.lengths.inverse(&to, &self.q)?;
        let from = self.lengths.forward(&self.q);
        // Where it but turns, the turn is the way; a mixed way is paced by whichever is longer, a radian as 0.25 m.
        let length =
            (to.translation.vector - from.translation.vector).norm().max(from.rotation.angle_to(&to.rotation) * 0.25);
        self.begin(Motion::Straight { from, to, ramp: Ramp::new(length, speed, acceleration) });
        Some(())
    }

    pub(crate) fn joints(&mut self, to: Joints, speed: f64, acceleration: f64) {
        let length = (0..6).map(|joint| (to[joint] - self.q[joint]).abs()).fold(0.0, f64::max);
        self.begin(Motion::Joints { from: self.q, to, ramp: Ramp::new(length, speed, acceleration) });
    }

    pub(crate) fn stop(&mut self, deceleration: f64) {
        if !self.still() {
            self.begin(Motion::Stop { deceleration });
        }
    }

    /// Goes on by `dt`, s. Says where the way leaves what it reaches.
    pub(crate) fn advance(&mut self, dt: f64) -> Result<(), String> {
        let before = self.q;
        let mut fault = None;
        match &mut self.motion {
            Motion::Still => {}
            Motion::Follow { target, lag, left } => {
                *left -= dt;
                let part = 1.0 - (-dt / *lag).exp();
                for joint in 0..6 {
                    self.q[joint] += ((target[joint] - self.q[joint]) * part).clamp(-FASTEST * dt, FASTEST * dt);
                }
                if *left <= 0.0 {
                    self.begin(Motion::Stop { deceleration: HARD });
                }
            }
            Motion::Straight { from, to, ramp } => {
                ramp.since += dt;
                let frame = between(from, to, ramp.part());
                let over = ramp.over();
                match self.lengths.inverse(&frame, &self.q) {
                    Some(q) if (0..6).all(|joint| (q[joint] - before[joint]).abs() <= FASTEST * dt + 1e-9) => {
                        self.q = q;
                    }
                    Some(_) => fault = Some("a joint would turn faster than it can"),
                    None => fault = Some("the straight way leaves what the arm reaches"),
                }
                if over {
                    self.motion = Motion::Still;
                }
            }
            Motion::Joints { from, to, ramp } => {
                ramp.since += dt;
                let part = ramp.part();
                for joint in 0..6 {
                    self.q[joint] = from[joint] + (to[joint] - from[joint]) * part;
                }
                if ramp.over() {
                    self.motion = Motion::Still;
                }
            }
            Motion::Stop { deceleration } => {
                let fastest = self.qd.iter().fold(0.0_f64, |most, speed| most.max(speed.abs()));
                let slower = (fastest - *deceleration * dt).max(0.0);
                for joint in 0..6 {
                    let speed = if fastest > 0.0 { self.qd[joint] * slower / fastest } else { 0.0 };
                    self.q[joint] += speed * dt;
                }
                if slower == 0.0 {
                    self.motion = Motion::Still;
                }
            }
        }
        for joint in 0..6 {
            self.qd[joint] = (self.q[joint] - before[joint]) / dt;
        }
        match fault {
            Some(fault) => {
                self.begin(Motion::Stop { deceleration: HARD });
                Err(fault.to_owned())
            }
            None => Ok(()),
        }
    }
}
