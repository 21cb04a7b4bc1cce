//! From what an experiment says to a robot.

use std::sync::{Arc, Mutex};

use hwasp_expr::{ExprError, Formulas, Part, Quantity, Value};
use hwasp_mujoco::engine::{Files, JointEntry, JointType, Simulation, Spec};
use hwasp_settings::text::printable;
use hwasp_settings::{Section, listed, nearest};

use crate::anatomy::Anatomy;
use crate::columns::{Column, Stage};
use crate::corners::check_corners;
use crate::names::{InPlace, Names, Place};
use crate::robot::{Additions, Formula, Outputs, Robot, Shaping};
use crate::settings::{Base, ModelSettings, Readings};
use crate::texts::{node_at, tell, tell_at};

/// Places of an experiment that may read the design.
const PLACES: [&str; 5] = ["the law", "the start", "the observation", "reward and end", "draws and forces"];
/// Steps of an episode where an experiment says nothing.
const HORIZON: usize = 1000;
/// The most columns that a law's states and an observation have.
const MOST_OBSERVED: usize = 10_000;

mod define;
mod episode;
mod ports;
mod shaping;
mod watched;

use self::episode::Watched;

/// What is compiled, and where its faults are told.
pub(super) struct Compiler<'c, 'r> {
    settings: &'c ModelSettings,
    section: &'c Section<'r>,
    formulas: Formulas,
    names: Names,
    /// Keys of `[task.define]` that were read.
    defined: Vec<String>,
    /// Whether there can be a robot.
    sound: bool,
    /// Whether a fault was told without which there could be one.
    flawed: bool,
    /// Faults of what names a definition that may be in order later: its keys, where its formula begins, and the definition.
    waiting: Vec<(Vec<String>, usize, ExprError, String)>,
}

impl Robot {
    /// Compiles what was said. What is wrong is told at its place; there is none then.
    pub(crate) fn compile(settings: &ModelSettings, section: &Section<'_>) -> Option<Self> {
        let files = settings.files.iter().map(|(path, bytes)| (path.clone(), Arc::clone(bytes)));
        let whole = 0..settings.model.len();
        let refuse = |message: &str, hint: Option<String>| tell_at(section, &["model"], &whole, message, hint);
        let files = match Files::new(files) {
            Ok(files) => files,
            Err(error) => {
                refuse(&error.to_string(), None);
                return None;
            }
        };
        let additions = Additions {
            floor: settings.floor,
            free_base: settings.base == Base::Free,
            motors: settings
                .motors
                .iter()
                .map(|motor| (motor.name.clone(), motor.gear, [motor.limits.low.value, motor.limits.high.value]))
                .collect(),
        };
        let main = hwasp_settings::inside(&settings.model)?;
        let hint = || Some("the model has to compile as it is, before anything is changed".to_owned());
        let mut spec = match Spec::parse(&main, &files) {
            Ok(spec) => spec,
            Err(error) => {
                refuse(&error.to_string(), hint());
                return None;
            }
        };
        if let Err((key, error)) = additions.add(&mut spec) {
            let hint = match key[..] {
                ["base"] => {
                    "base = \"free\" is for a model whose base nothing holds or frees yet, as in URDF: leave it out"
                }
                ["floor"] => "floor = true is for a model without one, as in URDF: leave it out",
                _ => "a motor is for a hinge or slide without one, by the joint's name",
            };
            tell_at(section, &key, &(0..0), &error.to_string(), Some(hint.to_owned()));
            return None;
        }
        let simulation = match spec.compile() {
            Ok(simulation) => simulation,
            Err(error) => {
                refuse(&error.to_string(), hint());
                return None;
            }
        };
        if settings.base == Base::Fixed
            && let Some(joint) = freed(&simulation)
        {
            let hint = "leave base out, and it goes as the model says; or take the joint out of the model's file";
            let message = format!("\"fixed\" does not hold what {joint} of the model frees");
            tell_at(section, &["base"], &(0.."fixed".len()), &message, Some(hint.to_owned()));
            return None;
        }
        let anatomy = Anatomy::of(&simulation);
        let time_step = anatomy.timestep * settings.frame_skip as f64;
        let names = Names { anatomy, time_step, ..Names::default() };
        let formulas = Formulas::default();
        let mut compiler = Compiler {
            settings,
            section,
            formulas,
            names,
            defined: Vec::new(),
            sound: true,
            flawed: false,
            waiting: Vec::new(),
        };
        compiler.robot(main, files, additions, simulation, &spec)
    }
}

impl Compiler<'_, '_> {
    fn robot(
        &mut self,
        main: String,
        files: Files,
        additions: Additions,
        simulation: Simulation,
        spec: &Spec,
    ) -> Option<Robot> {
        let settings = self.settings;
        self.unread();
        let space = self.design()?;
        let uniforms = space.names();
        // Those that need nothing that is drawn, nor commands: what is drawn may follow them.
        self.definitions(false);
        let random = self.random();
        let targets = self.targets();
        let direct = self.commands(&targets);
        self.definitions(true);
        let law = self.law();
        let shaping = self.shaping(spec);
        let start = self.start();
        let Watched { observed, terms, ends, success, kinds } = self.step();
        let forces = self.forces();
        let delays = self.delays();
        self.check_keyframe();
        if !self.sound {
            return None;
        }
        // Only now are all columns known.
        let formula = |compiler: &Self, stage: Option<Stage>, outputs: Vec<(String, Part)>| Formula {
            program: compiler.formulas.program(&uniforms, compiler.names.columns.names(), outputs),
            draws: stage.map_or_else(Vec::new, |stage| compiler.names.columns.draws_of(stage)),
        };
        let numbered = |parts: &[Part]| parts.iter().enumerate().map(|(i, &part)| (format!("y{i}"), part)).collect();
        let law_reads = self.commands_of(&law);
        let watched: Vec<Part> = observed.iter().flat_map(|(_, value)| value.parts.clone()).collect();
        let purpose: Vec<Part> = terms.iter().chain(&ends).map(|(_, part)| *part).chain(success).collect();
        let around: Vec<Part> =
            forces.iter().flat_map(|(parts, _)| parts).chain(random.iter().flatten()).copied().collect();
        let begun = start.as_ref().map_or(&[][..], |(parts, _)| parts);
        let places = [&law[..], begun, &watched, &purpose, &around].into_iter().zip(PLACES).collect::<Vec<_>>();
        let uses = self.uses(uniforms.len(), shaping.as_ref(), &places);
        let shaped = shaping.as_ref().map_or(&[][..], |found| &found.parts);
        let tried = self.parameters_of(&[begun, delays.as_deref().unwrap_or_default(), shaped].concat());
        let (law, states) = self.traced_law(&space, &law)?;
        let shaping = shaping.map(|found| Shaping {
            formula: formula(self, None, numbered(&found.parts)),
            fields: found.fields,
            parameters: found.parameters,
        });
        let (mut outputs, observations) = (watched.clone(), watched.len());
        outputs.extend(terms.iter().chain(&ends).map(|(_, part)| *part).chain(success));
        outputs.extend(&kinds);
        let memory = self.names.memory.clone();
        outputs.extend(&memory);
        let place = |column: Column| self.names.columns.all().iter().position(|&known| known == column);
        let memory_columns: Vec<usize> = (0..memory.len()).filter_map(|i| place(Column::Memory(i))).collect();
        // Fields and delays draw too, with no quantity of the episode.
        let drawn = !self.names.columns.draws_of(Stage::Random).is_empty();
        let random = random.or_else(|| drawn.then(Vec::new)).map(|parts| {
            let columns: Vec<usize> = (0..parts.len()).filter_map(|i| place(Column::Random(i))).collect();
            let named = columns.iter().map(|&at| self.names.columns.names()[at].clone()).zip(parts).collect();
            (formula(self, Some(Stage::Random), named), columns)
        });
        let mut env = self.env(&observed, &law);
        // What only the law reads is not sampled where the law's efforts are.
        let by_task = self.commands_of(&outputs);
        for i in law_reads.into_iter().filter(|&i| direct[i].is_none() && !by_task.contains(&i)) {
            env.command[i].direct = false;
        }
        let groups = shaping.iter().flat_map(|shaping: &Shaping| &shaping.parameters);
        env.shaped_by = groups.map(|&i| uniforms[i].clone()).collect();
        env.terms = terms.iter().map(|(name, _)| name.clone()).collect();
        let derived = |column: &Column| matches!(column, Column::Engine(reading) if reading.is_derived());
        let mut robot = Robot {
            plain: false,
            env,
            law,
            main,
            files,
            additions,
            columns: self.names.columns.all().to_vec(),
            states,
            random,
            shaping,
            start: start.map(|(parts, targets)| (formula(self, Some(Stage::Start), numbered(&parts)), targets)),
            step: formula(self, Some(Stage::Step), numbered(&outputs)),
            outputs: Outputs {
                observations,
                terms: terms.len(),
                ends: ends.len(),
                success: success.is_some(),
                kinds: kinds.len(),
                memory: memory.len(),
            },
            ends: ends.iter().map(|(name, _)| Arc::from(name.as_str())).collect(),
            kinds: kind_names(settings),
            forces: forces.map(|(parts, bodies)| (formula(self, Some(Stage::Force), numbered(&parts)), bodies)),
            delays: delays.map(|parts| formula(self, None, numbered(&parts))),
            targets: targets.iter().map(|(_, target, _)| *target).collect(),
            direct,
            keyframe: (!settings.keyframe.is_empty()).then(|| settings.keyframe.clone()),
            frame_skip: settings.frame_skip,
            fresh: settings.readings == Readings::Fresh && self.names.columns.all().iter().any(derived),
            memory: memory_columns,
            uses,
            simulation: Mutex::new(simulation),
        };
        robot.discard_visual();
        self.at_corners(robot, &tried)
    }

    /// The robot, where it can be made and can start at the corners of the design.
    fn at_corners(&mut self, robot: Robot, parameters: &[usize]) -> Option<Robot> {
        let Err(fault) = check_corners(&robot, parameters) else { return (!self.flawed).then_some(robot) };
        let key = match fault.key {
            "design" if self.settings.design.is_empty() => "set",
            "start" if self.settings.start.is_empty() && self.settings.keyframe.is_empty() => "model",
            "start" if self.settings.start.is_empty() => "keyframe",
            key => key,
        };
        self.refuse(&[key], fault.message, Some(fault.hint));
        None
    }

    fn check_keyframe(&mut self) {
        let settings = self.settings;
        if !settings.keyframe.is_empty() && !self.names.anatomy.keyframes.contains(&settings.keyframe) {
            let known = self.names.anatomy.keyframes.iter().map(String::as_str);
            let hint = match nearest(&settings.keyframe, known.clone()) {
                Some(near) => format!("did you mean `{near}`?"),
                None if self.names.anatomy.keyframes.is_empty() => "it has none that is named".to_owned(),
                None => format!("it has {}", listed(known)),
            };
            self.refuse(&["keyframe"], format!("the model has no keyframe `{}`", settings.keyframe), Some(hint));
        }
    }

    /// The parameters of the design that some scalars depend on.
    fn parameters_of(&self, parts: &[Part]) -> Vec<usize> {
        self.formulas.inputs(parts).1
    }

    /// The commands that some scalars depend on.
    fn commands_of(&self, parts: &[Part]) -> Vec<usize> {
        let command = |at: usize| match self.names.columns.all()[at] {
            Column::Command(i) => Some(i),
            _ => None,
        };
        self.formulas.inputs(parts).0.into_iter().filter_map(command).collect()
    }

    /// The names of the entries of a table, whether they could be read or not.
    fn entries(&self, table: &str) -> Vec<String> {
        match self.section.node(table).map(|node| &node.value) {
            Some(hwasp_settings::Value::Table(table)) => table.keys().cloned().collect(),
            _ => Vec::new(),
        }
    }

    /// Whether a fault came of another one, which is told at its own place. Faults of what may be in order later wait.
    fn follows(&mut self, error: &ExprError, keys: &[&str], offset: usize) -> bool {
        let Some(name) = self.names.faulty.take() else { return false };
        if self.names.faulty.pending.contains(&name) {
            let keys = keys.iter().map(|key| (*key).to_owned()).collect();
            self.waiting.push((keys, offset, error.clone(), name));
        }
        self.sound = false;
        true
    }

    /// Tells what has waited for definitions that turned out to be in order, or to be wrong for no other reason.
    fn tell_waiting(&mut self, roots: usize) {
        for (keys, offset, error, name) in std::mem::take(&mut self.waiting) {
            if roots == 0 || !self.names.faulty.own.contains(&name) {
                let keys: Vec<&str> = keys.iter().map(String::as_str).collect();
                tell(self.section, &keys, offset, &error);
            }
        }
    }

    /// Tells a fault without which there could be a robot, so that others are found, too.
    fn note(&mut self, keys: &[&str], message: impl Into<String>, hint: Option<String>) {
        let sound = self.sound;
        self.refuse(keys, message, hint);
        (self.sound, self.flawed) = (sound, true);
    }

    fn refuse(&mut self, keys: &[&str], message: impl Into<String>, hint: Option<String>) {
        let whole = match node_at(self.section, keys).map(|node| &node.value) {
            Some(hwasp_settings::Value::Text(text)) => 0..text.len(),
            _ => 0..0,
        };
        tell_at(self.section, keys, &whole, &message.into(), hint);
        self.sound = false;
    }

    /// Reads a formula at the end of some keys, the first `offset` bytes of whose text are no part of it.
    fn read(&mut self, keys: &[&str], text: &str, offset: usize, place: Place, width: usize) -> Option<Value> {
        let formula = &text[offset..];
        self.names.faulty.take();
        let mut scope = InPlace { names: &mut self.names, place, width };
        let value = match self.formulas.read(formula, &mut scope) {
            Ok(value) => value,
            Err(error) if self.follows(&error, keys, offset) => return None,
            Err(error) => {
                tell(self.section, keys, offset, &error);
                self.sound = false;
                return None;
            }
        };
        let (columns, _) = self.formulas.inputs(&value.parts);
        for at in columns {
            if let Some(why) = place.refuses(self.names.columns.all()[at]) {
                let message = format!("`{}` cannot be read here: {why}", self.names.columns.names()[at]);
                tell_at(self.section, keys, &(offset..text.len()), &message, None);
                self.sound = false;
                return None;
            }
        }
        Some(value)
    }

    /// A formula of one component.
    fn scalar(&mut self, keys: &[&str], text: &str, place: Place) -> Option<(Part, Quantity)> {
        let value = self.read(keys, text, 0, place, 1)?;
        if let [only] = value.parts[..] {
            return Some((only, value.quantity));
        }
        let message = format!("a number is wanted here, and this has {} components", value.parts.len());
        self.refuse(keys, message, Some("sum, norm, any or a component make one of it".into()));
        None
    }
}

/// What kinds of episodes are called; the last is of those that are of no other.
fn kind_names(settings: &ModelSettings) -> Vec<Arc<str>> {
    let other = if settings.kinds.is_empty() { "all" } else { "other" };
    settings.kinds.iter().map(|(name, _)| name.as_str()).chain([other]).map(Arc::from).collect()
}

/// The joint that frees a robot's base; none where anything that moves is held to the world.
fn freed(simulation: &Simulation) -> Option<String> {
    let has = simulation.inventory();
    let root = |mut body: usize| {
        while let Some(parent) = has.bodies[body].parent.filter(|parent| parent.index() > 0) {
            body = parent.index();
        }
        body
    };
    let free = |joint: &&JointEntry| joint.kind == JointType::Free;
    let frees = |at: usize| has.joints.iter().filter(free).any(|joint| joint.body.index() == at);
    let first = has.joints.iter().position(|joint| free(&joint))?;
    let all = has.joints.iter().all(|joint| frees(root(joint.body.index())));
    let name = has.joints[first].name.as_ref().map_or_else(|| format!("#{first}"), |name| printable(name));
    all.then(|| format!("joint.{name}"))
}
