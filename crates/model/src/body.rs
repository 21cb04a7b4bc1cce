//! The simulation behind the columns: what is read of it, and what is done to it.

use hwasp_mujoco::engine::{ActuatorId, BodyId, GeomId, KeyframeId, Simulation, SiteId, TendonId, Wrench};

use crate::columns::{Column, Reading};
use crate::robot::Target;

/// A simulation with the values that are read of it.
#[derive(Debug)]
pub(crate) struct Body {
    sim: Simulation,
    ids: Ids,
    /// What is read, each with the columns that its components go to.
    blocks: Vec<(Source, Vec<(usize, usize)>)>,
    /// For one wrench after the other.
    pushed: Vec<usize>,
}

/// Identities by index: those of one model hold for all that are made of the same text.
#[derive(Debug)]
struct Ids {
    bodies: Vec<BodyId>,
    geoms: Vec<GeomId>,
    sites: Vec<SiteId>,
    tendons: Vec<TendonId>,
    actuators: Vec<ActuatorId>,
    keyframes: Vec<(Option<String>, KeyframeId)>,
}

/// A quantity of some components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Source {
    Positions,
    Velocities,
    Accelerations,
    ActuatorForces,
    ConstraintForces,
    Activations,
    Controls,
    Sensors,
    BodyPosition(usize),
    BodyOrientation(usize),
    BodyVelocity(usize),
    BodyAngularVelocity(usize),
    BodyCentre(usize),
    BodyForce(usize),
    GeomPosition(usize),
    GeomOrientation(usize),
    SitePosition(usize),
    SiteOrientation(usize),
    Centre,
    CentreVelocity,
    /// A number by itself.
    Single(Reading),
}

/// The quantity that a reading is part of, and which component of it.
fn source(reading: Reading) -> (Source, usize) {
    match reading {
        Reading::Position(i) => (Source::Positions, i),
        Reading::Velocity(i) => (Source::Velocities, i),
        Reading::Acceleration(i) => (Source::Accelerations, i),
        Reading::ActuatorForceOn(i) => (Source::ActuatorForces, i),
        Reading::ConstraintForceOn(i) => (Source::ConstraintForces, i),
        Reading::Activation(i) => (Source::Activations, i),
        Reading::Control(i) => (Source::Controls, i),
        Reading::Sensor(i) => (Source::Sensors, i),
        Reading::BodyPosition(i, k) => (Source::BodyPosition(i), k),
        Reading::BodyOrientation(i, k) => (Source::BodyOrientation(i), k),
        Reading::BodyVelocity(i, k) => (Source::BodyVelocity(i), k),
        Reading::BodyAngularVelocity(i, k) => (Source::BodyAngularVelocity(i), k),
        Reading::BodyCentre(i, k) => (Source::BodyCentre(i), k),
        Reading::BodyForce(i, k) => (Source::BodyForce(i), k),
        Reading::GeomPosition(i, k) => (Source::GeomPosition(i), k),
        Reading::GeomOrientation(i, k) => (Source::GeomOrientation(i), k),
        Reading::SitePosition(i, k) => (Source::SitePosition(i), k),
        Reading::SiteOrientation(i, k) => (Source::SiteOrientation(i), k),
        Reading::Centre(k) => (Source::Centre, k),
        Reading::CentreVelocity(k) => (Source::CentreVelocity, k),
        single => (Source::Single(single), 0),
    }
}

impl Body {
    /// Of a simulation, for these columns.
    pub(crate) fn new(sim: Simulation, columns: &[Column]) -> Self {
        let inventory = sim.inventory();
        let ids = Ids {
            bodies: inventory.bodies.iter().map(|body| body.id).collect(),
            geoms: inventory.geoms.iter().map(|geom| geom.id).collect(),
            sites: inventory.sites.iter().map(|site| site.id).collect(),
            tendons: inventory.tendons.iter().map(|tendon| tendon.id).collect(),
            actuators: inventory.actuators.iter().map(|actuator| actuator.id).collect(),
            keyframes: inventory.keyframes,
        };
        let mut blocks: Vec<(Source, Vec<(usize, usize)>)> = Vec::new();
        for (at, column) in columns.iter().enumerate() {
            let Column::Engine(reading) = *column else { continue };
            let (source, component) = source(reading);
            match blocks.iter_mut().find(|(known, _)| *known == source) {
                Some((_, columns)) => columns.push((component, at)),
                None => blocks.push((source, vec![(component, at)])),
            }
        }
        Self { sim, ids, blocks, pushed: Vec::new() }
    }

    /// What is simulated.
    pub(crate) fn simulation(&self) -> &Simulation {
        &self.sim
    }

    /// Takes another model of the same text.
    pub(crate) fn exchange(&mut self, sim: Simulation) {
        self.sim = sim;
        self.pushed.clear();
    }

    /// Back to the model's own start, or a keyframe.
    pub(crate) fn reset(&mut self, keyframe: Option<&str>) -> Result<(), String> {
        self.pushed.clear();
        let Some(name) = keyframe else {
            self.sim.reset();
            return Ok(());
        };
        let found = self.ids.keyframes.iter().find(|(known, _)| known.as_deref() == Some(name));
        let (_, id) = found.ok_or_else(|| format!("the model has lost its keyframe {name}"))?;
        self.sim.set_keyframe(*id);
        // A keyframe's controls are its author's. Here nothing has been commanded yet, and who is not commanded rests.
        self.sim.ctrl_mut().fill(0.0);
        Ok(())
    }

    /// Writes positions and velocities.
    pub(crate) fn write(&mut self, targets: &[Reading], values: &[f64]) -> Result<(), String> {
        for (target, &value) in targets.iter().zip(values) {
            if !value.is_finite() {
                return Err(format!("an episode would start at {value}: see the formulas of [task.start]"));
            }
            match *target {
                Reading::Position(i) => self.sim.qpos_mut()[i] = value,
                Reading::Velocity(i) => self.sim.qvel_mut()[i] = value,
                _ => {}
            }
        }
        Ok(())
    }

    /// All positions, as the engine has them.
    pub(crate) fn positions(&self) -> &[f64] {
        self.sim.qpos()
    }

    /// Computes what is derived of the state, where that is wanted.
    pub(crate) fn refresh(&mut self, wanted: bool) -> Result<(), String> {
        if wanted { self.sim.forward().map_err(|fault| fault.to_string()) } else { Ok(()) }
    }

    /// Lets time pass.
    pub(crate) fn step(&mut self, steps: usize) -> Result<(), String> {
        self.sim.step(steps).map_err(|fault| fault.to_string())
    }

    /// Tells an actuator.
    pub(crate) fn control(&mut self, actuator: usize, value: f64) {
        self.sim.ctrl_mut()[actuator] = value;
    }

    /// Lets efforts act, in the place of those before.
    pub(crate) fn apply(&mut self, targets: &[Target], efforts: &[f64]) {
        if targets.iter().any(|target| !matches!(target, Target::Actuator(_))) {
            self.sim.qfrc_applied_mut().fill(0.0);
        }
        for (target, &effort) in targets.iter().zip(efforts) {
            match *target {
                Target::Joint(dof) => self.sim.qfrc_applied_mut()[dof] += effort,
                Target::Tendon(tendon) => self.sim.add_tendon_tension(self.ids.tendons[tendon], effort),
                Target::Actuator(actuator) => self.sim.ctrl_mut()[actuator] = effort,
            }
        }
    }

    /// Pushes bodies, with forces or forces and torques.
    pub(crate) fn push(&mut self, bodies: &[(usize, usize)], values: &[f64]) {
        for body in self.pushed.drain(..) {
            self.sim.set_wrench(self.ids.bodies[body], Wrench::default());
        }
        let mut at = 0;
        for &(body, count) in bodies {
            let part = &values[at..at + count];
            let force = [part[0], part[1], part[2]];
            let torque = if count == 6 { [part[3], part[4], part[5]] } else { [0.0; 3] };
            self.sim.set_wrench(self.ids.bodies[body], Wrench { force, torque });
            self.pushed.push(body);
            at += count;
        }
    }

    /// Fills the columns.
    pub(crate) fn read(&mut self, values: &mut [f64]) {
        let (ids, sim) = (&self.ids, &mut self.sim);
        for (source, columns) in &self.blocks {
            let mut from = |all: &[f64]| {
                for &(component, column) in columns {
                    values[column] = all[component];
                }
            };
            match *source {
                Source::Positions => from(sim.qpos()),
                Source::Velocities => from(sim.qvel()),
                Source::Accelerations => from(sim.qacc()),
                Source::ActuatorForces => from(sim.qfrc_actuator()),
                Source::ConstraintForces => from(sim.qfrc_constraint()),
                Source::Activations => from(sim.activations()),
                Source::Controls => from(sim.ctrl()),
                Source::Sensors => from(sim.sensordata()),
                Source::BodyPosition(i) => from(&sim.body_position(ids.bodies[i])),
                Source::BodyOrientation(i) => from(&sim.body_orientation(ids.bodies[i])),
                Source::BodyVelocity(i) => from(&sim.body_velocity(ids.bodies[i]).linear),
                Source::BodyAngularVelocity(i) => from(&sim.body_velocity(ids.bodies[i]).angular),
                Source::BodyCentre(i) => from(&sim.body_center(ids.bodies[i])),
                Source::BodyForce(i) => from(&sim.external_force(ids.bodies[i])),
                Source::GeomPosition(i) => from(&sim.geom_position(ids.geoms[i])),
                Source::GeomOrientation(i) => from(&sim.geom_orientation(ids.geoms[i])),
                Source::SitePosition(i) => from(&sim.site_position(ids.sites[i])),
                Source::SiteOrientation(i) => from(&sim.site_orientation(ids.sites[i])),
                Source::Centre => from(&sim.subtree_center(ids.bodies[0])),
                Source::CentreVelocity => from(&sim.subtree_velocity(ids.bodies[0])),
                Source::Single(reading) => from(&[single(sim, ids, reading)]),
            }
        }
    }
}

/// A number by itself.
fn single(sim: &mut Simulation, ids: &Ids, reading: Reading) -> f64 {
    match reading {
        Reading::TendonLength(i) => sim.tendon_length(ids.tendons[i]),
        Reading::TendonVelocity(i) => sim.tendon_velocity(ids.tendons[i]),
        Reading::ActuatorForce(i) => sim.actuator_force(ids.actuators[i]),
        Reading::ActuatorLength(i) => sim.actuator_length(ids.actuators[i]),
        Reading::ActuatorVelocity(i) => sim.actuator_velocity(ids.actuators[i]),
        Reading::Touch(a, b) => f64::from(sim.touch(ids.geoms[a], ids.geoms[b])),
        Reading::TouchForce(a, b) => sim.contact_force(ids.geoms[a], ids.geoms[b]).normal,
        Reading::TouchAny(a) => f64::from(sim.contacts().any(|contact| contact.geoms.contains(&ids.geoms[a]))),
        Reading::Kinetic => sim.energy().kinetic,
        Reading::Potential => sim.energy().potential,
        // Components of vectors are read together.
        _ => f64::NAN,
    }
}
