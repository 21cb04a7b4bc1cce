//! The plant: physics without purpose, by the MuJoCo engine. What there is stands in `mechanism.xml`.

use std::error::Error;

use hwasp_core::Plant;
use hwasp_mujoco::engine::{PhysicsFault, Simulation};

/// Bodies, joints and motors. It is part of the program: build again after a change.
const MECHANISM: &str = include_str!("../mechanism.xml");
/// What gravity does to the arm when it is level, N·m: lamp and arm of `mechanism.xml`, at their centres of mass.
pub(crate) const GRAVITY_MOMENT: f64 = 9.81 * (0.6 * 0.4 + 0.2 * 0.2);
/// Steps of the engine in one of the controller. The law's torque is held meanwhile.
const STEPS: usize = 4;
/// Step of the controller, s: so many of the `timestep` in `mechanism.xml`.
pub(crate) const TIME_STEP: f64 = STEPS as f64 * 0.005;

/// The arm, at first upright and at rest.
#[derive(Clone, Debug)]
pub(crate) struct Arm {
    simulation: Simulation,
    /// Where the joint stands in positions and velocities, and the actuator in controls.
    position: usize,
    velocity: usize,
    actuator: usize,
    fault: Option<PhysicsFault>,
}

impl Arm {
    /// Compiles the model and looks up its names, once: environments are copies.
    pub(crate) fn new() -> Result<Self, Box<dyn Error + Send + Sync>> {
        let simulation = Simulation::from_mjcf(MECHANISM)?;
        let (pivot, torque) = (simulation.joint("pivot")?, simulation.actuator("torque")?);
        Ok(Self {
            simulation,
            position: pivot.qpos.start,
            velocity: pivot.dof.start,
            actuator: torque.index(),
            fault: None,
        })
    }

    /// Puts it at rest at `angle`, rad.
    pub(crate) fn place(&mut self, angle: f64) {
        // Everything else, faults included, as the model begins.
        self.simulation.reset();
        self.simulation.qpos_mut()[self.position] = angle;
        self.fault = None;
    }

    /// The angle, rad from upright.
    pub(crate) fn angle(&self) -> f64 {
        self.simulation.qpos()[self.position]
    }
}

impl Plant for Arm {
    /// `effort` is what the law says: the torque on the arm, N·m.
    fn advance(&mut self, effort: &[f64], _command: &[f64]) {
        self.simulation.ctrl_mut()[self.actuator] = effort[0];
        self.fault = self.simulation.step(STEPS).err();
    }

    /// What the law may read: angle, rad, and speed, rad/s.
    fn state(&self, out: &mut [f64]) {
        out.copy_from_slice(&[self.angle(), self.simulation.qvel()[self.velocity]]);
    }

    /// An episode in which the engine gives up is thrown away and counted.
    fn fault(&self) -> Option<String> {
        self.fault.as_ref().map(ToString::to_string)
    }
}
