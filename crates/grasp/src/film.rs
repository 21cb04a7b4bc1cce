//! Episodes to be looked at again: a film keeps where everything was after each step, and a stage takes these poses once more.
//!
//! Drawing is apart from running, as it must not touch the state of an episode that is under way: even computing what
//! depends on the state anew would change the next step's last bits.

use std::sync::{Arc, Mutex, MutexGuard};

use hwasp_core::{End, EnvSpec, Environment, MakeEnvironment, Outcome, Robot, Step, Stream};

use crate::grasp::Grasp;
use crate::object::Object;
use crate::task::GraspTask;
use hwasp_mujoco::engine::{EditError, GeomId, PhysicsFault, Simulation};

/// One moment of an episode.
#[derive(Clone, Debug, PartialEq)]
pub struct Still {
    /// Positions of all joints ([`Simulation::qpos`]).
    pub positions: Vec<f64>,
    /// Height of the object's lowest point above the floor, m.
    pub clearance: f64,
    /// Whether any link touches the object.
    pub touches: bool,
}

/// An episode: the start, then one still for each step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Film {
    /// What was grasped; none before the first episode.
    pub object: Option<Object>,
    /// Still t is after t steps of 10 ms.
    pub stills: Vec<Still>,
}

/// A grasping task whose environments film. They share one film, the last episode that was begun: to be run one episode at
/// a time.
#[derive(Clone, Debug)]
pub struct Filmed {
    grasp: Arc<Grasp>,
    film: Arc<Mutex<Film>>,
}

impl Filmed {
    /// The same task, filmed.
    pub fn new(grasp: Grasp) -> Self {
        Self { grasp: Arc::new(grasp), film: Arc::default() }
    }

    /// The film of the last episode, which is then forgotten.
    pub fn take(&self) -> Film {
        std::mem::take(&mut *lock(&self.film))
    }
}

impl MakeEnvironment for Filmed {
    fn make(&self, horizon: Option<usize>) -> Box<dyn Environment> {
        Box::new(Recorder { robot: self.grasp.robot(horizon), film: Arc::clone(&self.film) })
    }
}

fn lock(film: &Mutex<Film>) -> MutexGuard<'_, Film> {
    film.lock().expect("nothing panics while the film is locked")
}

/// The robot, and what it does on film.
struct Recorder {
    robot: Robot<GraspTask>,
    film: Arc<Mutex<Film>>,
}

impl Recorder {
    fn still(&self) -> Still {
        let plant = self.robot.plant();
        Still {
            positions: plant.simulation().qpos().to_vec(),
            clearance: plant.clearance(),
            touches: plant.touching().contains(&true),
        }
    }
}

impl Environment for Recorder {
    fn spec(&self) -> &EnvSpec {
        self.robot.spec()
    }

    fn set_design(&mut self, design: &[f64]) {
        self.robot.set_design(design);
    }

    fn reset(&mut self, rng: &mut Stream) {
        self.robot.reset(rng);
        // Contacts are computed by the first step; before it there are none.
        let start = Still { touches: false, ..self.still() };
        *lock(&self.film) = Film { object: Some(self.robot.plant().object().clone()), stills: vec![start] };
    }

    fn observe(&self, out: &mut [f64]) {
        self.robot.observe(out);
    }

    fn state(&self, out: &mut [f64]) {
        self.robot.state(out);
    }

    fn context(&self, out: &mut [f64]) {
        self.robot.context(out);
    }

    fn step(&mut self, effort: &[f64], command: &[f64]) -> Step {
        let step = self.robot.step(effort, command);
        // Where the physics failed there is nothing to see.
        if step.end != Some(End::Faulted) {
            let still = self.still();
            lock(&self.film).stills.push(still);
        }
        step
    }

    fn outcome(&self) -> Option<Outcome> {
        self.robot.outcome()
    }

    fn fault(&self) -> Option<String> {
        self.robot.fault()
    }
}

/// A hand and an object that take the poses of a film.
#[derive(Clone, Debug)]
pub struct Stage {
    simulation: Simulation,
    object: GeomId,
}

impl Stage {
    /// One for films of this task.
    pub fn new(grasp: &Grasp) -> Self {
        Self { simulation: grasp.plant.sim.clone(), object: grasp.plant.places.object_geom[0] }
    }

    /// Brings an object on.
    pub fn set(&mut self, object: &Object) -> Result<(), EditError> {
        self.simulation.edit().shape(self.object, object.shape())?;
        Ok(())
    }

    /// Takes a pose.
    ///
    /// # Panics
    /// If the still is not of this task.
    pub fn pose(&mut self, still: &Still) -> Result<(), PhysicsFault> {
        self.simulation.qpos_mut().copy_from_slice(&still.positions);
        self.simulation.forward()
    }

    /// What there is to be seen.
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// The same for a painter, which writes into it.
    pub fn simulation_mut(&mut self) -> &mut Simulation {
        &mut self.simulation
    }
}
