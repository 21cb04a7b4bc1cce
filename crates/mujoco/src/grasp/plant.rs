//! The hand, the object and the floor, one environment step at a time.

use hwasp_core::{Plant, Stream};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;

use super::object::{Object, vertical};
use super::settings::GraspSettings;
use crate::engine::{BodyId, EditError, GeomId, PhysicsFault, Simulation, TendonId, UnknownName, Wrench};
use hwasp_tasks::hand::{SUBSTEPS, TransmissionDescription, names};

/// Where the palm's target may be, m: from here to there in x, y and z.
const WORKSPACE: [[f64; 2]; 3] = [[-0.15, 0.15], [-0.15, 0.15], [0.02, 0.60]];

/// What moves the joints.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Drive {
    /// The law's torques, held for an environment step.
    Torques,
    /// MuJoCo's own tendons, evaluated at each simulation step.
    Tendons([TendonId; 3]),
}

/// Where things stand in the simulation.
#[derive(Clone, Debug)]
pub(super) struct Places {
    pub(super) palm: [usize; 3],
    pub(super) joints: [usize; 6],
    pub(super) object: usize,
    pub(super) object_body: BodyId,
    pub(super) palm_body: BodyId,
    pub(super) object_geom: [GeomId; 1],
    pub(super) floor: GeomId,
    pub(super) links: [GeomId; 6],
    palm_ctrl: [usize; 3],
    drive_ctrl: Vec<usize>,
}

impl Places {
    pub(super) fn look_up(sim: &Simulation, drive: &Drive) -> Result<Self, UnknownName> {
        let joint = |name: &str| sim.joint(name).map(|address| address.qpos.start);
        let actuator = |name: &str| sim.actuator(name).map(crate::engine::ActuatorId::index);
        let drive_names = match drive {
            Drive::Torques => &names::TORQUE_ACTUATORS[..],
            Drive::Tendons(_) => &names::TENDON_ACTUATORS[..],
        };
        let [px, py, pz] = names::PALM_JOINTS;
        let [ax, ay, az] = names::PALM_ACTUATORS;
        let mut joints = [0; 6];
        let mut links = [sim.geom(names::OBJECT_GEOM)?; 6];
        for (i, (name, pad)) in names::JOINTS.iter().zip(names::LINK_GEOMS).enumerate() {
            joints[i] = joint(name)?;
            links[i] = sim.geom(pad)?;
        }
        Ok(Self {
            palm: [joint(px)?, joint(py)?, joint(pz)?],
            joints,
            object: joint(names::OBJECT_JOINT)?,
            object_body: sim.body(names::OBJECT)?,
            palm_body: sim.body(names::PALM)?,
            object_geom: [sim.geom(names::OBJECT_GEOM)?],
            floor: sim.geom(names::FLOOR)?,
            links,
            palm_ctrl: [actuator(ax)?, actuator(ay)?, actuator(az)?],
            drive_ctrl: drive_names.iter().map(|name| actuator(name)).collect::<Result<_, _>>()?,
        })
    }
}

/// Hand and object in MuJoCo. Implements [`Plant`]: efforts are the six joint torques and the motor's, commands the palm's
/// motion and the motor's.
#[derive(Clone, Debug)]
pub struct GraspPlant {
    pub(super) sim: Simulation,
    pub(super) places: Places,
    drive: Drive,
    transmission: TransmissionDescription,
    /// Standard deviations, as in the settings.
    sensor_noise: [f64; 2],
    actuation_noise: [f64; 2],
    disturbance: [f64; 2],
    /// Which axes of the palm are commanded: z, or all.
    axes: std::ops::Range<usize>,
    object: Object,
    /// The palm's target, m.
    target: [f64; 3],
    /// Wound so far, m.
    travel: f64,
    /// The motor's torque in the last step, N·m.
    motor_torque: f64,
    noise: Stream,
    /// What the motor travel is off in this step, m.
    travel_error: f64,
    /// What the sensors are off: palm, object, motor travel, m.
    sensed: [f64; 7],
    fault: Option<PhysicsFault>,
}

impl GraspPlant {
    pub(super) fn new(settings: &GraspSettings, sim: Simulation, drive: Drive) -> Result<Self, UnknownName> {
        let mut rng = Stream::seed_from_u64(0);
        Ok(Self {
            places: Places::look_up(&sim, &drive)?,
            sim,
            drive,
            transmission: settings.hand.transmission.clone(),
            sensor_noise: settings.sensor_noise,
            actuation_noise: settings.actuation_noise,
            disturbance: settings.disturbance,
            axes: 3 - settings.palm.commands().len()..3,
            object: Object::draw(settings, 1.0, &mut rng),
            target: [0.0; 3],
            travel: 0.0,
            motor_torque: 0.0,
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
        self.travel
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

    /// Starts an episode: open hand above an object at rest.
    pub(super) fn start(&mut self, object: Object, palm_height: f64, rng: &mut Stream) -> Result<(), EditError> {
        let places = &self.places;
        object.enter(&mut self.sim, places.object_body, places.object_geom[0], places.floor)?;
        let state = self.sim.qpos_mut();
        state[places.object..][..7].copy_from_slice(&object.pose());
        self.target = [0.0, 0.0, palm_height];
        for (&at, target) in places.palm.iter().zip(self.target) {
            state[at] = target;
        }
        self.object = object;
        (self.travel, self.motor_torque, self.fault) = (0.0, 0.0, None);
        self.noise = Stream::seed_from_u64(rng.random());
        self.look();
        Ok(())
    }

    fn normal(&mut self, std: f64) -> f64 {
        std * self.noise.sample::<f64, _>(StandardNormal)
    }

    /// Draws what sensors and motor are off until the next step.
    fn look(&mut self) {
        self.travel_error = self.normal(self.actuation_noise[1]);
        for i in 0..6 {
            self.sensed[i] = self.normal(self.sensor_noise[0]);
        }
        self.sensed[6] = self.normal(self.sensor_noise[1]);
    }

    /// Palm, object, bounding box, motor travel and torque, as the sensors tell them.
    pub(super) fn observe(&self, out: &mut [f64]) {
        for (out, (value, off)) in
            out.iter_mut().zip(self.palm().into_iter().chain(self.object_position()).zip(self.sensed))
        {
            *out = value + off;
        }
        out[6..9].copy_from_slice(&self.object.bounding_box());
        out[9] = self.travel + self.sensed[6];
        out[10] = self.motor_torque;
    }

    /// Winds the tendons of the simulation, each simulation step anew: the spool gives way where the motor's torque does not
    /// suffice to hold it.
    fn step_tendons(&mut self, tendons: [TendonId; 3]) -> Result<(), PhysicsFault> {
        let TransmissionDescription { tendon_stiffness, tension_limit, spool_radius, travel, .. } = self.transmission;
        let wound = (self.travel + self.travel_error).clamp(0.0, travel);
        for _ in 0..SUBSTEPS {
            let taut = tendons.map(|tendon| self.sim.tendon_length(tendon));
            let (held, tension) = yielding(wound, taut, tendon_stiffness, tension_limit);
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
        for (axis, motion) in self.axes.clone().zip(palm) {
            let [lo, hi] = WORKSPACE[axis];
            self.target[axis] = (self.target[axis] + motion).clamp(lo, hi);
        }
        for axis in 0..3 {
            let off = if self.axes.contains(&axis) { self.normal(self.actuation_noise[0]) } else { 0.0 };
            self.sim.ctrl_mut()[self.places.palm_ctrl[axis]] = self.target[axis] + off;
        }
        for body in [self.places.palm_body, self.places.object_body] {
            let force = std::array::from_fn(|_| self.normal(self.disturbance[0]));
            let torque = std::array::from_fn(|_| self.normal(self.disturbance[1]));
            self.sim.set_wrench(body, Wrench { force, torque });
        }
        self.travel = (self.travel + motor).clamp(0.0, self.transmission.travel);
        let stepped = match self.drive {
            Drive::Torques => {
                for (&control, &torque) in self.places.drive_ctrl.iter().zip(effort) {
                    self.sim.ctrl_mut()[control] = torque;
                }
                let most = self.transmission.spool_radius * self.transmission.tension_limit;
                self.motor_torque = effort[6].clamp(0.0, most);
                self.sim.step(SUBSTEPS)
            }
            Drive::Tendons(tendons) => self.step_tendons(tendons),
        };
        self.fault = stepped.err();
        self.look();
    }

    fn state(&self, out: &mut [f64]) {
        out[0] = self.travel + self.travel_error;
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
