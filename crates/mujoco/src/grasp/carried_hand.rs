//! The hand of a design, carried about and wound by whoever has it, one simulation step at a time: what an arm and a motor
//! do to it, without a task.

use hwasp_tasks::hand::{DESIGN_LEN, Drive, HandDescription, MjcfOptions, mjcf, names};

use super::object::vertical;
use super::plant::{Drive as Moved, Places};
use super::{GraspError, Object};
use crate::engine::{ActuatorId, EditError, PhysicsFault, Simulation, TendonId};

/// A hand with its own tendons, an object and a floor.
#[derive(Clone, Debug)]
pub struct CarriedHand {
    sim: Simulation,
    places: Places,
    tendons: [TendonId; 3],
    /// The palm's degrees of freedom.
    palm_freedoms: [usize; 3],
    palm_targets: [usize; 3],
    winches: [usize; 3],
    /// By how much the palm's control is ahead of it per m/s, so that it pulls with nothing at an even speed, s.
    lead: f64,
    /// Where the palm was last carried, m.
    carried: Option<[f64; 3]>,
    object: Option<Object>,
}

impl CarriedHand {
    /// The hand of this design, as it is built.
    ///
    /// # Errors
    /// Where there can be no such hand.
    pub fn new(hand: &HandDescription, design: &[f64; DESIGN_LEN]) -> Result<Self, GraspError> {
        let options = MjcfOptions { drive: Drive::NativeTendon { design: *design }, ..MjcfOptions::default() };
        let sim = Simulation::from_mjcf(&mjcf(hand, &options)?)?;
        let [a, b, c] = names::TENDONS;
        let tendons = [sim.tendon(a)?, sim.tendon(b)?, sim.tendon(c)?];
        let places = Places::look_up(&sim, &Moved::Tendons(tendons))?;
        let (mut palm_targets, mut winches) = ([0; 3], [0; 3]);
        for (list, names) in [(&mut palm_targets, names::PALM_ACTUATORS), (&mut winches, names::TENDON_ACTUATORS)] {
            for (at, name) in list.iter_mut().zip(names) {
                *at = sim.actuator(name).map(ActuatorId::index)?;
            }
        }
        let mut palm_freedoms = [0; 3];
        for (at, name) in palm_freedoms.iter_mut().zip(names::PALM_JOINTS) {
            *at = sim.joint(name)?.dof.start;
        }
        let lead = hand.palm.velocity_gain / hand.palm.position_gain;
        Ok(Self { sim, places, tendons, palm_freedoms, palm_targets, winches, lead, carried: None, object: None })
    }

    /// Begins anew: the hand open with its palm at `palm`, m, and the object at rest on the floor.
    ///
    /// # Errors
    /// Where the object is none.
    pub fn start(&mut self, object: Object, palm: [f64; 3]) -> Result<(), EditError> {
        let places = &self.places;
        object.enter(&mut self.sim, places.object_body, places.object_geom[0], places.floor)?;
        let state = self.sim.qpos_mut();
        state[places.object..][..7].copy_from_slice(&object.pose());
        for (&at, place) in places.palm.iter().zip(palm) {
            state[at] = place;
        }
        self.object = Some(object);
        self.carried = Some(palm);
        self.aim(palm);
        Ok(())
    }

    /// Sends the palm to a place, m, by the compliant control with which controllers are trained.
    pub fn aim(&mut self, palm: [f64; 3]) {
        for (&control, place) in self.palm_targets.iter().zip(palm) {
            self.sim.ctrl_mut()[control] = place;
        }
    }

    /// Carries the palm on to a place, m, within the next step, as an arm does that does not yield.
    pub fn carry(&mut self, palm: [f64; 3]) {
        let from = self.carried.unwrap_or(palm);
        let step = self.sim.timestep();
        for axis in 0..3 {
            let velocity = (palm[axis] - from[axis]) / step;
            self.sim.qpos_mut()[self.places.palm[axis]] = from[axis];
            self.sim.qvel_mut()[self.palm_freedoms[axis]] = velocity;
            self.sim.ctrl_mut()[self.palm_targets[axis]] = from[axis] + self.lead * velocity;
        }
        self.carried = Some(palm);
    }

    /// Holds the tendons wound to `wound`, m.
    pub fn wind(&mut self, wound: f64) {
        for &control in &self.winches {
            self.sim.ctrl_mut()[control] = wound;
        }
    }

    /// What the digits have taken up of their tendons, as computed last, m.
    pub fn taken_up(&self) -> [f64; 3] {
        self.tendons.map(|tendon| self.sim.tendon_length(tendon))
    }

    /// Goes on by a simulation step of 1 ms.
    ///
    /// # Errors
    /// Where the physics break down.
    pub fn step(&mut self) -> Result<(), PhysicsFault> {
        self.sim.step(1)
    }

    /// The palm's position, m.
    pub fn palm(&self) -> [f64; 3] {
        self.places.palm.map(|at| self.sim.qpos()[at])
    }

    /// Angles of the joints, rad, in the order of [`names::JOINTS`].
    pub fn joints(&self) -> [f64; 6] {
        self.places.joints.map(|at| self.sim.qpos()[at])
    }

    /// What is grasped.
    pub fn object(&self) -> Option<&Object> {
        self.object.as_ref()
    }

    /// Where the object is: its centre, m, and its orientation (w, x, y, z).
    pub fn object_pose(&self) -> [f64; 7] {
        std::array::from_fn(|i| self.sim.qpos()[self.places.object + i])
    }

    /// Height of the object's lowest point above the floor, m.
    pub fn clearance(&self) -> f64 {
        let [_, _, z, a, b, c, d] = self.object_pose();
        z - self.object.as_ref().map_or(0.0, |object| object.reach_down(vertical([a, b, c, d])))
    }

    /// Which links touch the object, in the order of [`names::JOINTS`].
    pub fn touching(&self) -> [bool; 6] {
        let mut touched = [false; 6];
        self.sim.touching(&self.places.object_geom, &self.places.links, &mut touched);
        touched
    }

    /// The simulation, to look at.
    pub fn simulation(&self) -> &Simulation {
        &self.sim
    }
}
