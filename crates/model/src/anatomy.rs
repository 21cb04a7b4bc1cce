//! What a compiled model has, by name.

use std::ops::Range;

use hwasp_core::Dimension;
use hwasp_expr::Quantity;
use hwasp_mujoco::engine::{self, Drive, JointType, Simulation};

#[derive(Clone, Debug)]
pub(crate) struct Joint {
    pub(crate) name: String,
    pub(crate) kind: JointType,
    pub(crate) qpos: Range<usize>,
    pub(crate) dof: Range<usize>,
}

impl Joint {
    pub(crate) fn position(&self) -> Quantity {
        match self.kind {
            JointType::Hinge => Quantity::of(Dimension::Angle),
            JointType::Slide => Quantity::of(Dimension::Length),
            JointType::Ball => Quantity::Number,
            JointType::Free => Quantity::Unknown,
        }
    }

    pub(crate) fn velocity(&self) -> Quantity {
        match self.kind {
            JointType::Hinge | JointType::Ball => Quantity::of(Dimension::AngularSpeed),
            JointType::Slide => Quantity::of(Dimension::Speed),
            JointType::Free => Quantity::Unknown,
        }
    }

    /// What acts on it.
    pub(crate) fn effort(&self) -> Dimension {
        match self.kind {
            JointType::Hinge | JointType::Ball => Dimension::Torque,
            JointType::Slide => Dimension::Force,
            JointType::Free => Dimension::None,
        }
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Actuator {
    pub(crate) name: String,
    /// Limits of its control, where the model has any.
    pub(crate) limits: Option<[f64; 2]>,
    /// Where its activation stands, where it has one.
    pub(crate) activation: Option<usize>,
}

#[derive(Clone, Debug)]
pub(crate) struct Sensor {
    pub(crate) name: String,
    pub(crate) data: Range<usize>,
    pub(crate) quantity: Quantity,
}

/// Everything that formulas can name, in the order of the model.
#[derive(Clone, Debug, Default)]
pub(crate) struct Anatomy {
    pub(crate) bodies: Vec<String>,
    pub(crate) joints: Vec<Joint>,
    pub(crate) geoms: Vec<String>,
    pub(crate) sites: Vec<String>,
    pub(crate) tendons: Vec<String>,
    pub(crate) actuators: Vec<Actuator>,
    pub(crate) sensors: Vec<Sensor>,
    pub(crate) keyframes: Vec<String>,
    /// Simulation time of a step, s.
    pub(crate) timestep: f64,
}

impl Anatomy {
    /// What a simulation has.
    pub(crate) fn of(simulation: &Simulation) -> Self {
        let inventory = simulation.inventory();
        let name = |name: Option<String>| name.unwrap_or_default();
        let joints: Vec<Joint> = inventory
            .joints
            .into_iter()
            .map(|joint| Joint {
                name: name(joint.name),
                kind: joint.kind,
                qpos: joint.address.qpos,
                dof: joint.address.dof,
            })
            .collect();
        let driven = |drive: Drive| match drive {
            Drive::Joint(_, name) | Drive::Tendon(_, name) | Drive::Site(_, name) => name,
            Drive::Other(_) => None,
        };
        // Gymnasium's have no names: they go by what they drive, and by their number where that is no name of one alone.
        let called: Vec<(bool, String)> = inventory
            .actuators
            .iter()
            .map(|actuator| {
                let own = actuator.name.clone();
                (own.is_some(), own.or_else(|| driven(actuator.drives.clone())).unwrap_or_default())
            })
            .collect();
        let clear = |(named, name): &(bool, String)| {
            *named || !name.is_empty() && called.iter().filter(|(_, other)| other == name).count() == 1
        };
        let actuators = inventory.actuators.into_iter().zip(&called).enumerate().map(|(i, (actuator, own))| Actuator {
            name: if clear(own) { own.1.clone() } else { format!("actuator_{i}") },
            limits: actuator.control_range,
            activation: actuator.activations.clone().next(),
        });
        let sensors = inventory.sensors.into_iter().map(|sensor| Sensor {
            name: name(sensor.name),
            data: sensor.values,
            quantity: measured(sensor.quantity),
        });
        Self {
            actuators: actuators.collect(),
            sensors: sensors.collect(),
            bodies: inventory.bodies.into_iter().map(|body| name(body.name)).collect(),
            geoms: inventory.geoms.into_iter().map(|geom| name(geom.name)).collect(),
            sites: inventory.sites.into_iter().map(|site| name(site.name)).collect(),
            tendons: inventory.tendons.into_iter().map(|tendon| name(tendon.name)).collect(),
            keyframes: inventory.keyframes.into_iter().filter_map(|(name, _)| name).collect(),
            timestep: inventory.timestep,
            joints,
        }
    }
}

/// What a sensor or field measures, in the terms of formulas.
pub(crate) fn measured(of: engine::Quantity) -> Quantity {
    match of {
        engine::Quantity::Number => Quantity::Number,
        other => hwasp_expr::parse_unit(&other.unit().replace('²', "^2").replace('³', "^3"))
            .map_or(Quantity::Unknown, |(_, exponents)| Quantity::Known(exponents)),
    }
}
