//! The hand of a design, carried about and wound by whoever has it, one simulation step at a time: what an arm and a motor
//! do to it, without a task.

use hwasp_tasks::hand::{DESIGN_LEN, Drive, HandDescription, MjcfOptions, mjcf, names};

use crate::error::GraspError;
use crate::object::Object;
use crate::object::vertical;
use crate::places::{Drive as Moved, Places};
use hwasp_mujoco::engine::{EditError, PhysicsFault, Simulation, TendonId};

/// A hand with its own tendons, an object and a floor.
#[derive(Clone, Debug)]
pub struct CarriedHand {
    sim: Simulation,
    places: Places,
    tendons: [TendonId; 3],
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
        Ok(Self { sim, places, tendons, object: None })
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
        self.carry(palm);
        Ok(())
    }

    /// Carries the palm to a place, m, with the stiffness that the description has.
    pub fn carry(&mut self, palm: [f64; 3]) {
        for (&control, place) in self.places.palm_ctrl.iter().zip(palm) {
            self.sim.ctrl_mut()[control] = place;
        }
    }

    /// Holds the tendons wound to `wound`, m.
    pub fn wind(&mut self, wound: f64) {
        for &control in &self.places.drive_ctrl {
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
