//! Where things stand in the simulation.

use hwasp_tasks::hand::names;

use hwasp_mujoco::engine::{BodyId, GeomId, Simulation, TendonId, UnknownName};

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
    pub(super) palm_ctrl: [usize; 3],
    pub(super) drive_ctrl: Vec<usize>,
}

impl Places {
    pub(super) fn look_up(sim: &Simulation, drive: &Drive) -> Result<Self, UnknownName> {
        let joint = |name: &str| sim.joint(name).map(|address| address.qpos.start);
        let actuator = |name: &str| sim.actuator(name).map(hwasp_mujoco::engine::ActuatorId::index);
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
