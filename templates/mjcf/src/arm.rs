//! The plant: physics without purpose, by the MuJoCo engine. What there is stands in `mechanism.xml`.
//!
//! A task reads what it needs of `arm.simulation`. Names are looked up once, in `Arm::new`; what they give is kept:
//!
//! | of | looked up by | read by |
//! |---|---|---|
//! | joints | `joint("pivot")?` | `qpos()[joint.qpos]`, `qvel()[joint.dof]` |
//! | bodies | `body("arm")?` | `body_position`, `body_orientation`, `body_velocity`, `external_force` |
//! | sites | `site("bulb")?` | `site_position`, `site_orientation` |
//! | sensors | `sensor("turning")?` | `sensor_values` |
//! | tendons | `tendon("cable")?` | `tendon_length`, `tendon_velocity`; `add_tendon_tension` pulls |
//! | contacts | `geom("lamp")?` | `touch`, `contact_force`, `contacts` |
//! | keyframes | `keyframe("leaning")?` | `set_keyframe` starts there |
//!
//! Positions and velocities of joints are those of now. What is derived of them is as the last step found it, before it moved
//! on; `forward()` brings it up to date. The tests below read each of them.

use std::error::Error;

use hwasp_core::{Plant, Sight};
use hwasp_mujoco::engine::{PhysicsFault, Simulation, View};

/// Bodies, joints and motors. It is part of the program: build again after a change.
const MECHANISM: &str = include_str!("../mechanism.xml");
/// What gravity does to the arm when it is level, N·m: lamp and arm of `mechanism.xml`, at their centres of mass.
pub(crate) const GRAVITY_MOMENT: f64 = 9.81 * (0.6 * 0.4 + 0.2 * 0.2);
/// Height of the pivot in `mechanism.xml`, m.
pub(crate) const PIVOT: f64 = 0.15;
/// Steps of the engine in one of the controller. The law's torque is held meanwhile.
const STEPS: usize = 4;
/// Step of the controller, s: so many of the `timestep` in `mechanism.xml`.
pub(crate) const TIME_STEP: f64 = STEPS as f64 * 0.005;

/// The arm, at first upright and at rest.
#[derive(Clone, Debug)]
pub(crate) struct Arm {
    pub(crate) simulation: Simulation,
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

    /// How it looks in films: as `mechanism.xml` says. The view is a copy, so that looking changes nothing.
    pub(crate) fn sight(&self) -> Sight {
        View::new(self.simulation.clone()).sight(self.simulation.qpos())
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

#[cfg(test)]
mod tests {
    use super::*;

    /// What `mechanism.xml` has beside joint and motor, by its names. Keep what you need, and move the look-ups into `Arm::new`.
    #[test]
    fn everything_of_the_model_can_be_read() -> Result<(), Box<dyn Error + Send + Sync>> {
        let mut simulation = Arm::new()?.simulation;
        let (leaning, arm, bulb) = (simulation.keyframe("leaning")?, simulation.body("arm")?, simulation.site("bulb")?);
        let (turning, cable) = (simulation.sensor("turning")?, simulation.tendon("cable")?);
        let (lamp, table) = (simulation.geom("lamp")?, simulation.geom("table")?);

        simulation.set_keyframe(leaning);
        let (angle, speed) = (1.2_f64, 0.5);
        simulation.qvel_mut()[0] = speed;
        simulation.forward()?;

        let near = |found: f64, wanted: f64| assert!((found - wanted).abs() < 1e-9, "{found}, not {wanted}");
        let place = simulation.site_position(bulb);
        near(place[0], 0.45 * angle.sin());
        near(place[2], 0.15 + 0.45 * angle.cos());
        near(simulation.body_velocity(arm).angular[1], speed);
        near(simulation.sensor_values(turning)[1], speed);
        near(simulation.tendon_length(cable), 0.03 * angle);
        near(simulation.tendon_velocity(cable), 0.03 * speed);

        // Beyond its stop it would lie on the table.
        assert!(!simulation.touch(lamp, table));
        simulation.qpos_mut()[0] = 2.0;
        simulation.forward()?;
        assert!(simulation.touch(lamp, table) && simulation.contact_force(lamp, table).contacts == 1);
        Ok(())
    }
}
