//! A robot, compiled: everything that an environment of it needs.

use std::ops::Range;
use std::sync::{Arc, Mutex};

use hwasp_core::{EnvSpec, Law};
use hwasp_diff::Program;
use hwasp_expr::Distribution;
use hwasp_mujoco::engine::{Element, FieldPath, Files, Simulation, Spec, SpecError, View};
use hwasp_problem::AnyError;

use crate::columns::{Column, Reading};

/// What a law's effort acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Target {
    /// A generalised force on a degree of freedom.
    Joint(usize),
    /// The tension of a tendon.
    Tendon(usize),
    /// The control of an actuator.
    Actuator(usize),
}

/// A program over all columns, and what it draws before it runs.
#[derive(Clone, Debug)]
pub(crate) struct Formula {
    pub(crate) program: Program,
    pub(crate) draws: Vec<(Distribution, usize)>,
}

impl Formula {
    /// What it comes to once; for steps there is [`Ready`](crate::ready::Ready).
    pub(crate) fn run(&self, design: &[f64], values: &[f64]) -> Vec<f64> {
        let mut tape = self.program.tape::<f64>(1);
        let mut out = vec![0.0; self.program.output_names().len()];
        self.program.bind(design, &mut tape);
        self.program.forward(values, 1, 1, &mut tape, &mut out, 1);
        out
    }
}

/// Fields of the model that follow design and random quantities.
#[derive(Clone, Debug)]
pub(crate) struct Shaping {
    pub(crate) formula: Formula,
    pub(crate) fields: Vec<FieldPath>,
    /// Design parameters that it reads.
    pub(crate) parameters: Vec<usize>,
}

/// Where the outputs of the program after a step lie.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Outputs {
    pub(crate) observations: usize,
    pub(crate) terms: usize,
    pub(crate) ends: usize,
    pub(crate) success: bool,
    pub(crate) kinds: usize,
    pub(crate) memory: usize,
}

impl Outputs {
    /// All of them, in order: observations, terms, ends, success, kinds, memory.
    pub(crate) fn terms_at(&self) -> Range<usize> {
        self.observations..self.observations + self.terms
    }

    pub(crate) fn ends_at(&self) -> Range<usize> {
        let from = self.terms_at().end;
        from..from + self.ends
    }

    pub(crate) fn success_at(&self) -> Option<usize> {
        self.success.then_some(self.ends_at().end)
    }

    pub(crate) fn kinds_at(&self) -> Range<usize> {
        let from = self.ends_at().end + usize::from(self.success);
        from..from + self.kinds
    }
}

/// A robot.
#[derive(Debug)]
pub(crate) struct Robot {
    /// Whether what is only seen is left out when the model is compiled.
    pub(crate) plain: bool,
    pub(crate) env: EnvSpec,
    pub(crate) law: Law,
    /// The model's path, and its files.
    pub(crate) main: String,
    pub(crate) files: Files,
    pub(crate) additions: Additions,
    pub(crate) columns: Vec<Column>,
    /// Columns of the law's states, in its order.
    pub(crate) states: Vec<usize>,
    /// The quantities of an episode, and their columns.
    pub(crate) random: Option<(Formula, Vec<usize>)>,
    pub(crate) shaping: Option<Shaping>,
    /// Targets in positions and velocities.
    pub(crate) start: Option<(Formula, Vec<Reading>)>,
    pub(crate) step: Formula,
    pub(crate) outputs: Outputs,
    /// What ends are called; one that stands alone has no name.
    pub(crate) ends: Vec<Arc<str>>,
    pub(crate) kinds: Vec<Arc<str>>,
    /// Bodies that forces act on, with 3 or 6 components.
    pub(crate) forces: Option<(Formula, Vec<(usize, usize)>)>,
    /// Times in s: of the observation, of the command.
    pub(crate) delays: Option<Formula>,
    pub(crate) targets: Vec<Target>,
    /// The actuator that each command goes to as it is.
    pub(crate) direct: Vec<Option<usize>>,
    pub(crate) keyframe: Option<String>,
    pub(crate) frame_skip: usize,
    /// Whether readings have to be computed anew after a step.
    pub(crate) fresh: bool,
    /// The columns of every memory, in order.
    pub(crate) memory: Vec<usize>,
    /// What each design parameter does, in words.
    pub(crate) uses: Vec<String>,
    /// Compiled as the design begins, to be cloned.
    pub(crate) simulation: Mutex<Simulation>,
}

/// What is added to a model.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Additions {
    pub(crate) floor: bool,
    pub(crate) free_base: bool,
    /// Joint, gear, limits.
    pub(crate) motors: Vec<(String, f64, [f64; 2])>,
}

impl Additions {
    /// The model with them, in the making.
    pub(crate) fn spec(&self, main: &str, files: &Files) -> Result<Spec, AnyError> {
        let mut spec = Spec::parse(main, files)?;
        self.add(&mut spec).map_err(|(_, error)| error)?;
        Ok(spec)
    }

    /// Adds them to a model.
    ///
    /// # Errors
    /// With the keys of what cannot be added.
    pub(crate) fn add(&self, spec: &mut Spec) -> Result<(), (Vec<&str>, SpecError)> {
        if self.free_base {
            spec.free_base().map_err(|error| (vec!["base"], error))?;
        }
        if self.floor {
            spec.add_floor().map_err(|error| (vec!["floor"], error))?;
        }
        for (joint, gear, limits) in &self.motors {
            spec.add_motor(joint, joint, *gear, *limits).map_err(|error| (vec!["motors", joint.as_str()], error))?;
        }
        Ok(())
    }
}

impl Robot {
    /// Its model in the making, as environments have it.
    pub(crate) fn making(&self) -> Result<Spec, AnyError> {
        let mut spec = self.additions.spec(&self.main, &self.files)?;
        if self.plain {
            spec.discard_visual()?;
        }
        Ok(spec)
    }

    /// Leaves out what is only seen, textures and geoms without mass that touch nothing, where no formula names it: nine tenths
    /// of the time to compile a model go into it. The motion is the same to the bit.
    pub(crate) fn discard_visual(&mut self) {
        use Reading::{GeomOrientation, GeomPosition, Touch, TouchAny, TouchForce};
        let names_geoms = |column: &Column| {
            let Column::Engine(reading) = column else { return false };
            matches!(reading, GeomPosition(..) | GeomOrientation(..) | Touch(..) | TouchForce(..) | TouchAny(_))
        };
        if self.columns.iter().any(names_geoms) {
            return;
        }
        let plain = || -> Result<Option<Simulation>, AnyError> {
            let mut spec = self.additions.spec(&self.main, &self.files)?;
            let mut fields = self.shaping.iter().flat_map(|shaping| &shaping.fields);
            // Geoms are counted without those that are left out: a number would mean another one.
            let counted = fields.clone().any(|field| matches!(field.element(), Element::Index(_)));
            if counted || !spec.discard_visual()? || fields.any(|field| spec.field(field).is_err()) {
                return Ok(None);
            }
            Ok(Some(spec.compile()?))
        };
        // What fails here is told with the model as it is.
        if let Ok(Some(simulation)) = plain() {
            (self.plain, self.simulation) = (true, Mutex::new(simulation));
        }
    }

    /// What is seen of it: of the whole model, whatever environments leave out, with these numbers of the shaped fields; as the
    /// model has them where there are none. None where it cannot be compiled, which environments tell.
    pub(crate) fn view(&self, shaped: &[f64]) -> Option<View> {
        let mut spec = self.additions.spec(&self.main, &self.files).ok()?;
        let fields = self.shaping.iter().flat_map(|shaping| &shaping.fields);
        fields.zip(shaped).try_for_each(|(field, &value)| spec.set(field, value)).ok()?;
        Some(View::new(spec.compile().ok()?))
    }

    /// What an output of the step's program is, for messages.
    pub(crate) fn output_name(&self, at: usize) -> String {
        let outputs = self.outputs;
        if let Some(port) = self.env.observation.get(at) {
            return format!("the observation `{}`", port.name);
        }
        match self.env.terms.get(at - outputs.observations) {
            Some(term) => format!("the reward `{term}`"),
            None if outputs.ends_at().contains(&at) => match &*self.ends[at - outputs.ends_at().start] {
                "" => "`ends`".to_owned(),
                name => format!("the end `{name}`"),
            },
            None if outputs.success_at() == Some(at) => "`success`".to_owned(),
            None => format!("the kind `{}`", self.kinds[at - outputs.kinds_at().start]),
        }
    }

    /// A simulation of it as the design begins.
    pub(crate) fn simulation(&self) -> Simulation {
        self.simulation.lock().expect("nothing panics while a simulation is cloned").clone()
    }
}
