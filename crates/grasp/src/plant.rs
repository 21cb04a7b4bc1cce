//! The hand, the object and the floor, one environment step at a time.

use hwasp_core::{Law, Plant, Stream};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;

use crate::object::{Object, vertical};
use crate::places::{Drive, Places};
use crate::sensors::{Drawn, Reading, Sensors};
use crate::settings::GraspSettings;
use hwasp_mujoco::engine::{EditError, PhysicsFault, Simulation, TendonId, UnknownName, Wrench};
use hwasp_tasks::grasp::rules::WORKSPACE;
use hwasp_tasks::grasp::{Bounds, Targets};
use hwasp_tasks::hand::{DESIGN_LEN, SUBSTEPS, TransmissionDescription, names};

/// Hand and object in MuJoCo. Implements [`Plant`]: efforts are the six joint torques and the motor's, commands the palm's
/// motion and the motor's.
#[derive(Clone, Debug)]
pub struct GraspPlant {
    pub(super) sim: Simulation,
    pub(super) places: Places,
    drive: Drive,
    law: Law,
    transmission: TransmissionDescription,
    /// The design that the hand has, SI.
    design: [f64; DESIGN_LEN],
    sensors: Sensors,
    /// What the bench of this episode is like.
    drawn: Drawn,
    /// Standard deviations, as in the settings.
    sensor_noise: [f64; 2],
    actuation_noise: [f64; 2],
    disturbance: [f64; 2],
    /// Which axes of the palm are commanded: z, or all.
    axes: std::ops::Range<usize>,
    object: Object,
    /// What commands add up to: the palm's target, and what is wound.
    targets: Targets,
    /// How far the arm has followed the palm's target, m.
    followed: [f64; 3],
    /// Where the spool is, m of tendon.
    held: f64,
    /// The motor's torque in the last step, N·m.
    motor_torque: f64,
    /// What of it friction takes: more while the spool winds, less while it pays out, N·m.
    rubbed: f64,
    noise: Stream,
    /// What the motor travel is off in this step, m.
    travel_error: f64,
    /// What the sensors are off: palm, object, motor travel, m.
    sensed: [f64; 7],
    fault: Option<PhysicsFault>,
}

impl GraspPlant {
    pub(super) fn new(settings: &GraspSettings, law: Law, sim: Simulation, drive: Drive) -> Result<Self, UnknownName> {
        let mut rng = Stream::seed_from_u64(0);
        let period = settings.hand.step_time();
        let bounds = Bounds {
            workspace: WORKSPACE,
            palm_step: settings.bench.palm_speed.map_or(f64::INFINITY, |speed| speed * period),
            travel: settings.hand.transmission.travel,
        };
        Ok(Self {
            places: Places::look_up(&sim, &drive)?,
            sim,
            drive,
            law,
            design: [0.0; DESIGN_LEN],
            sensors: Sensors::new(&settings.bench, period),
            drawn: Drawn::default(),
            transmission: settings.hand.transmission.clone(),
            sensor_noise: settings.sensor_noise,
            actuation_noise: settings.actuation_noise,
            disturbance: settings.disturbance,
            axes: 3 - settings.palm.commands().len()..3,
            object: Object::draw(settings, 1.0, &mut rng),
            targets: Targets::new([0.0; 3], 0.0, bounds),
            followed: [0.0; 3],
            held: 0.0,
            motor_torque: 0.0,
            rubbed: 0.0,
            noise: rng,
            travel_error: 0.0,
            sensed: [0.0; 7],
            fault: None,
        })
    }

    /// The object of this episode.
    pub fn object(&self) -> &Object {
        &self.object
    }

    /// The simulation, to look at.
    pub fn simulation(&self) -> &Simulation {
        &self.sim
    }

    /// The palm's position, m.
    pub fn palm(&self) -> [f64; 3] {
        self.places.palm.map(|at| self.sim.qpos()[at])
    }

    /// The position of the object's centre, m.
    pub fn object_position(&self) -> [f64; 3] {
        std::array::from_fn(|i| self.sim.qpos()[self.places.object + i])
    }

    /// Height of the object's lowest point above the floor, m.
    pub fn clearance(&self) -> f64 {
        let pose = &self.sim.qpos()[self.places.object..][..7];
        pose[2] - self.object.reach_down(vertical([pose[3], pose[4], pose[5], pose[6]]))
    }

    /// Wound so far, as commanded, m.
    pub fn travel(&self) -> f64 {
        self.targets.travel
    }

    /// The motor's torque in the last step, N·m.
    pub fn motor_torque(&self) -> f64 {
        self.motor_torque
    }

    /// Which links touch the object, in the order of [`names::JOINTS`].
    pub fn touching(&self) -> [bool; 6] {
        let mut touched = [false; 6];
        self.sim.touching(&self.places.object_geom, &self.places.links, &mut touched);
        touched
    }

    /// Starts an episode at this fraction of training: open hand above an object at rest.
    pub(super) fn start(
        &mut self,
        object: Object,
        palm_height: f64,
        progress: f64,
        rng: &mut Stream,
    ) -> Result<(), EditError> {
        let places = &self.places;
        object.enter(&mut self.sim, places.object_body, places.object_geom[0], places.floor)?;
        let state = self.sim.qpos_mut();
        state[places.object..][..7].copy_from_slice(&object.pose());
        (self.targets.palm, self.targets.travel) = ([0.0, 0.0, palm_height], 0.0);
        for (&at, target) in places.palm.iter().zip(self.targets.palm) {
            state[at] = target;
        }
        self.followed = self.targets.palm;
        self.object = object;
        (self.held, self.motor_torque, self.rubbed, self.fault) = (0.0, 0.0, 0.0, None);
        self.noise = Stream::seed_from_u64(rng.random());
        self.drawn = self.sensors.draw(progress, rng);
        let reading = self.look();
        self.sensors.start(reading, self.drawn.delay);
        Ok(())
    }

    fn normal(&mut self, std: f64) -> f64 {
        std * self.noise.sample::<f64, _>(StandardNormal)
    }

    /// Draws what sensors and motor are off until the next step, and reads the sensors.
    fn look(&mut self) -> Reading {
        self.travel_error = self.normal(self.actuation_noise[1]);
        for i in 0..6 {
            self.sensed[i] = self.normal(self.sensor_noise[0]);
        }
        self.sensed[6] = self.normal(self.sensor_noise[1]);
        let off = |at: usize, values: [f64; 3]| [0, 1, 2].map(|i| values[i] + self.sensed[at + i]);
        Reading {
            palm: off(0, self.palm()),
            object: off(3, self.object_position()),
            commanded: self.targets.travel + self.sensed[6],
            encoder: self.held + self.sensed[6],
            target: self.targets.travel,
            torque: (self.motor_torque + self.rubbed) * self.drawn.torque_gain,
        }
    }

    /// Palm, object, bounding box, motor travel and torque, and the travel's target where it has a place, as the controller is
    /// told them.
    pub(super) fn observe(&self, out: &mut [f64]) {
        let told = self.sensors.told();
        out[..3].copy_from_slice(&told.palm);
        out[3..6].copy_from_slice(&told.object);
        out[6..9].copy_from_slice(&self.object.bounding_box());
        out[9..11].copy_from_slice(&[told.travel, told.torque]);
        if let Some(target) = out.get_mut(11) {
            *target = told.target;
        }
    }

    /// The most that the tendons of this episode pull together, N: what the motor can do less what friction takes.
    fn limit(&self) -> f64 {
        let most = self.transmission.tension_limit * self.drawn.limit_gain;
        (most - self.drawn.friction / self.transmission.spool_radius).max(0.0)
    }

    /// How much of the tendon is wound beyond the slack, m.
    fn wound(&self) -> f64 {
        (self.targets.travel + self.travel_error).clamp(0.0, self.transmission.travel) - self.drawn.slack
    }

    /// What the digits have taken up of their tendons, m.
    fn taken_up(&self) -> [f64; 3] {
        let angle = |joint: usize| self.sim.qpos()[self.places.joints[joint]];
        let of = |joint: usize| {
            let kind = names::KIND_OF_JOINT[joint];
            self.design[kind] * (angle(joint) - self.transmission.reference[kind])
        };
        [0, 1, 2].map(|digit| of(2 * digit) + of(2 * digit + 1))
    }

    /// By how much all tensions are larger or smaller where the motor's real limit is not the law's.
    fn real_share(&self) -> f64 {
        let (limit, real) = (self.transmission.tension_limit, self.limit());
        if real == limit {
            return 1.0;
        }
        let stiffness = self.transmission.tendon_stiffness;
        let (_, tension) = yielding(self.wound(), self.taken_up(), stiffness, f64::INFINITY);
        if tension > 0.0 { tension.min(real) / tension.min(limit) } else { 1.0 }
    }

    /// The law's torques: the tendons' share of them as large as the motor's real limit makes it, the springs' as it is.
    fn apply(&mut self, effort: &[f64]) {
        let share = self.real_share();
        for (joint, (&control, &torque)) in self.places.drive_ctrl.iter().zip(effort).enumerate() {
            let mut real = torque;
            if share != 1.0 {
                let kind = names::KIND_OF_JOINT[joint];
                let angle = self.sim.qpos()[self.places.joints[joint]];
                let spring = self.design[4 + kind] * (angle + self.design[8 + kind]);
                real = share * (torque + spring) - spring;
            }
            self.sim.ctrl_mut()[control] = real;
        }
        self.motor_torque = (share * effort[6]).clamp(0.0, self.transmission.spool_radius * self.limit());
    }

    /// Winds the tendons of the simulation, each simulation step anew: the spool gives way where the motor's torque does not
    /// suffice to hold it.
    fn step_tendons(&mut self, tendons: [TendonId; 3]) -> Result<(), PhysicsFault> {
        let TransmissionDescription { tendon_stiffness, spool_radius, .. } = self.transmission;
        let (wound, limit) = (self.wound(), self.limit());
        for _ in 0..SUBSTEPS {
            let taut = tendons.map(|tendon| self.sim.tendon_length(tendon));
            let (held, tension) = yielding(wound, taut, tendon_stiffness, limit);
            self.held = held + self.drawn.slack;
            for &control in &self.places.drive_ctrl {
                self.sim.ctrl_mut()[control] = held;
            }
            self.motor_torque = spool_radius * tension;
            self.sim.step(1)?;
        }
        Ok(())
    }
}

/// The travel at which tendons of lengths `taut` pull with `limit` together, if at `wound` they pull more; and their tension
/// there.
pub fn yielding(wound: f64, mut taut: [f64; 3], stiffness: f64, limit: f64) -> (f64, f64) {
    let tension = |x: f64, taut: &[f64]| stiffness * taut.iter().map(|&length| (x - length).max(0.0)).sum::<f64>();
    if tension(wound, &taut) <= limit {
        return (wound, tension(wound, &taut));
    }
    taut.sort_unstable_by(f64::total_cmp);
    // With the m shortest taut: stiffness·(m·x - Σ) = limit.
    let at = |m: usize| (limit / stiffness + taut[..m].iter().sum::<f64>()) / m as f64;
    let m = (1..=3).rev().find(|&m| at(m) > taut[m - 1]).unwrap_or(1);
    (at(m), limit)
}

impl Plant for GraspPlant {
    fn advance(&mut self, effort: &[f64], command: &[f64]) {
        let (motor, palm) = (command[command.len() - 1], &command[..command.len() - 1]);
        let mut motion = [0.0; 3];
        motion[self.axes.clone()].copy_from_slice(palm);
        self.targets.advance(motion, motor);
        for axis in 0..3 {
            let off = if self.axes.contains(&axis) { self.normal(self.actuation_noise[0]) } else { 0.0 };
            let behind = self.targets.palm[axis] - self.followed[axis];
            self.followed[axis] = self.targets.palm[axis] - self.drawn.behind * behind;
            self.sim.ctrl_mut()[self.places.palm_ctrl[axis]] = self.followed[axis] + off;
        }
        for body in [self.places.palm_body, self.places.object_body] {
            let force = std::array::from_fn(|_| self.normal(self.disturbance[0]));
            let torque = std::array::from_fn(|_| self.normal(self.disturbance[1]));
            self.sim.set_wrench(body, Wrench { force, torque });
        }
        let stepped = match self.drive {
            Drive::Torques => {
                self.apply(effort);
                let stepped = self.sim.step(SUBSTEPS);
                let stiffness = self.transmission.tendon_stiffness;
                self.held = yielding(self.wound(), self.taken_up(), stiffness, self.limit()).0 + self.drawn.slack;
                stepped
            }
            Drive::Tendons(tendons) => self.step_tendons(tendons),
        };
        if motor != 0.0 {
            let winds = motor > 0.0 || self.wound() + self.drawn.slack > self.held;
            self.rubbed = if winds { self.drawn.friction } else { -self.drawn.friction };
        }
        self.fault = stepped.err();
        let reading = self.look();
        self.sensors.read(reading);
    }

    fn set_design(&mut self, design: &[f64]) {
        self.design.copy_from_slice(&self.law.as_built(design));
    }

    fn state(&self, out: &mut [f64]) {
        out[0] = self.targets.travel + self.travel_error - self.drawn.slack;
        for (out, &at) in out[1..].iter_mut().zip(&self.places.joints) {
            *out = self.sim.qpos()[at];
        }
    }

    fn fault(&self) -> Option<String> {
        self.fault.as_ref().map(ToString::to_string)
    }
}

#[cfg(test)]
mod tests {
    use super::yielding;

    #[test]
    fn the_spool_gives_way_at_the_limit() {
        let sum = |x: f64, taut: [f64; 3]| 5000.0 * taut.iter().map(|l| (x - l).max(0.0)).sum::<f64>();
        for taut in [[0.001, 0.002, 0.003], [0.01, 0.0, 0.012], [0.0; 3], [0.03, 0.001, 0.03]] {
            let (x, tension) = yielding(0.02, taut, 5000.0, 75.0);
            assert!((sum(x, taut) - 75.0).abs() < 1e-9 && tension == 75.0 && x < 0.02, "{taut:?}: {x}");
        }
        assert_eq!(yielding(0.004, [0.003, 0.004, 0.005], 5000.0, 75.0), (0.004, 5.0));
        assert_eq!(yielding(0.001, [0.003, 0.004, 0.005], 5000.0, 75.0), (0.001, 0.0));
    }
}
