//! What an experiment says of a robot.

use std::fmt::Write;
use std::sync::Arc;

use hwasp_settings::{Fields, Files, Item, Keys, Kind, Section, Settings, Value, choice};
use sha2::{Digest, Sha256};

use crate::parameter::{Command, Parameter};
use crate::robot::Robot;
use crate::source::gather;
use crate::texts::{Named, list, list_item, named, named_item, tell_at, text};

choice! {
    /// When what is derived of the state is computed anew.
    pub enum Readings {
        /// After every step: positions of bodies and what touches what are those of the new state.
        Fresh = "fresh",
        /// As the engine leaves it: what is derived of positions is that of the last simulation step's start, as in Gymnasium.
        AsLeft = "as-left",
    }
}

choice! {
    /// How the root of a robot is held.
    pub enum Base {
        /// As its file says: to the world where a URDF says nothing.
        AsModel = "as-model",
        /// To the world.
        Fixed = "fixed",
        /// Not at all.
        Free = "free",
    }
}

/// `[task]` of a problem from a model.
#[derive(Clone, Debug)]
pub struct ModelSettings {
    /// The model's path, from the experiment's folder.
    pub model: String,
    /// SHA-256 of all files of the model, in hexadecimal digits, where they were read before: others are refused.
    pub model_sha256: Option<String>,
    /// Simulation steps of an environment step.
    pub frame_skip: usize,
    /// See [`Readings`].
    pub readings: Readings,
    /// How the root is held.
    pub base: Base,
    /// Whether a floor is added.
    pub floor: bool,
    /// Motors that are added to joints.
    pub motors: Vec<Command>,
    /// Limits and units of commands, where the model has none.
    pub commands: Vec<Command>,
    /// The keyframe where episodes start.
    pub keyframe: String,
    /// Names for formulas.
    pub define: Named,
    /// Quantities that are drawn when an episode starts.
    pub random: Named,
    /// What the controller sees.
    pub observe: Vec<String>,
    /// The terms of the reward.
    pub reward: Named,
    /// When an episode ends in failure: conditions by name, or one whose name is empty.
    pub ends: Named,
    /// Whether an episode is a success, at its end.
    pub success: String,
    /// Kinds of episodes, of which success is told apart: the first by name that holds at the start.
    pub kinds: Named,
    /// Where an episode starts: fields of the state.
    pub start: Named,
    /// Fields of the model that formulas set.
    pub set: Vec<String>,
    /// Forces on bodies.
    pub forces: Named,
    /// Time between what is and what is seen, s.
    pub observation_delay: String,
    /// Time between a command and what the motors do, s.
    pub command_delay: String,
    /// The law of the hardware: efforts.
    pub law: Named,
    /// The design parameters.
    pub design: Vec<Parameter>,
    /// The files of the model.
    pub(crate) files: Arc<Files>,
    /// What came of it; none where something is wrong, or nothing was read.
    pub(crate) robot: Option<Arc<Robot>>,
}

impl Default for ModelSettings {
    fn default() -> Self {
        Self {
            model: String::new(),
            model_sha256: None,
            frame_skip: 1,
            readings: Readings::Fresh,
            base: Base::AsModel,
            floor: false,
            motors: Vec::new(),
            commands: Vec::new(),
            keyframe: String::new(),
            define: Vec::new(),
            random: Vec::new(),
            observe: Vec::new(),
            reward: Vec::new(),
            ends: Vec::new(),
            success: String::new(),
            kinds: Vec::new(),
            start: Vec::new(),
            set: Vec::new(),
            forces: Vec::new(),
            observation_delay: String::new(),
            command_delay: String::new(),
            law: Vec::new(),
            design: Vec::new(),
            files: Arc::default(),
            robot: None,
        }
    }
}

impl PartialEq for ModelSettings {
    /// Whether they say the same; what came of them is then the same, too.
    fn eq(&self, other: &Self) -> bool {
        let plain = |s: &Self| (s.model.clone(), s.frame_skip, s.readings, s.base, s.floor, s.keyframe.clone());
        let texts = |s: &Self| {
            let one = [&s.success, &s.observation_delay, &s.command_delay].map(Clone::clone);
            let named =
                [&s.define, &s.random, &s.reward, &s.ends, &s.kinds, &s.start, &s.forces, &s.law].map(Clone::clone);
            (one, named, s.observe.clone(), s.set.clone())
        };
        plain(self) == plain(other)
            && texts(self) == texts(other)
            && (&self.motors, &self.commands, &self.design) == (&other.motors, &other.commands, &other.design)
            && self.files == other.files
    }
}

impl Settings for ModelSettings {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        self.model_fields(fields);
        self.purpose_fields(fields);
        self.law_fields(fields);
        fields.finally(|section| self.resolve(section));
    }
}

/// What a formula may be, for editors.
fn formula() -> Kind {
    Kind::AnyOf(vec![Kind::Line(hwasp_expr::LONGEST_TEXT), Kind::Number([f64::MIN, f64::MAX])])
}

fn formulas() -> Kind {
    Kind::Table(Box::new(formula()))
}

/// A table of formulas.
fn named_field(fields: &mut Fields<'_, '_>, key: &str, value: &mut Named, meaning: &str) {
    let item = named_item(value);
    fields.default("none").kind(formulas()).open(key, meaning, item, |section, node| {
        if let Some(found) = named(section, key, node) {
            *value = found;
        }
    });
}

/// A list of formulas.
fn list_field(fields: &mut Fields<'_, '_>, key: &str, value: &mut Vec<String>, meaning: &str) {
    let kind = Kind::List { of: Box::new(formula()), length: [1, 1000], single: true };
    let item = list_item(value);
    fields.default("none").kind(kind).open(key, meaning, item, |section, node| {
        if let Some(found) = list(section, key, node) {
            *value = found;
        }
    });
}

/// One formula.
fn text_field(fields: &mut Fields<'_, '_>, key: &str, value: &mut String, meaning: &str) {
    let item = (!value.is_empty()).then(|| Item::from(value.as_str()));
    fields.default("none").kind(formula()).open(key, meaning, item, |section, node| {
        if let Some(found) = text(section, key, node) {
            *value = found;
        }
    });
}

/// One formula, whose name is empty, or a table of them.
fn either_field(fields: &mut Fields<'_, '_>, key: &str, value: &mut Named, meaning: &str) {
    let item = match &value[..] {
        [(name, text)] if name.is_empty() => Some(Item::from(text.as_str())),
        _ => named_item(value),
    };
    let kind = Kind::AnyOf(vec![formula(), formulas()]);
    fields.default("none").kind(kind).open(key, meaning, item, |section, node| {
        let found = match node.value {
            Value::Table(_) => named(section, key, node),
            _ => {
                text(section, key, node).map(|text| if text.is_empty() { vec![] } else { vec![(String::new(), text)] })
            }
        };
        if let Some(found) = found {
            *value = found;
        }
    });
}

/// A table of commands.
fn commands_field(fields: &mut Fields<'_, '_>, key: &str, value: &mut Vec<Command>, meaning: &str) {
    let keys = value.iter().map(|command| (command.name.clone(), command.item())).collect();
    let item = (!value.is_empty()).then_some(Item::Keys(Keys(keys)));
    fields.default("none").kind(Kind::Table(Box::new(Kind::Open))).open(key, meaning, item, |section, node| {
        let Value::Table(table) = &node.value else {
            return section.wrong(key, node, "is no table", Some(format!("write [{}.NAME]", section.path(key))));
        };
        let read = table.iter().map(|(name, entry)| Command::read(section, key, name, &entry.node));
        *value = read.collect::<Vec<_>>().into_iter().flatten().collect();
    });
}

impl ModelSettings {
    fn model_fields(&mut self, fields: &mut Fields<'_, '_>) {
        fields.default("required").limits("inside of the experiment's folder");
        fields.line("model", &mut self.model, 1000, "the robot's model, MJCF or URDF, from the experiment's folder");
        let digest = self.model_sha256.as_deref().map(Item::from);
        let known = &mut self.model_sha256;
        let about = "of all files of the model: written into run folders, where others are refused";
        fields.default("none").kind(Kind::Line(64)).open("model_sha256", about, digest, |section, node| {
            *known = text(section, "model_sha256", node);
        });
        fields.count("frame_skip", &mut self.frame_skip, 1..=10_000, "simulation steps of an environment step");
        let about =
            "whether what is derived of the state is that of the new state, or as the engine leaves it (Gymnasium)";
        fields.choice("readings", &mut self.readings, about);
        fields.line(
            "keyframe",
            &mut self.keyframe,
            200,
            "where episodes start, before `start`; empty: as the model says",
        );
        fields.choice(
            "base",
            &mut self.base,
            "how the robot's root is held: as its file says, to the world, or not at all",
        );
        fields.flag("floor", &mut self.floor, "whether a floor is added, a plane at height 0");
        let about = "motors that are added to joints: `{ knee = { limits = [-1, 1], gear = 50 } }`";
        commands_field(fields, "motors", &mut self.motors, about);
        let about =
            "limits and units of commands where the model has none: `{ knee = { limits = [\"-3 N*m\", \"3 N*m\"] } }`";
        commands_field(fields, "commands", &mut self.commands, about);
        list_field(fields, "set", &mut self.set, "fields of the model that formulas set, `\"body.box.mass = load\"`");
    }

    fn purpose_fields(&mut self, fields: &mut Fields<'_, '_>) {
        let about = "names for formulas, to be used in others, and functions, `\"soft(x)\" = \"x / (1 + abs(x))\"`";
        named_field(fields, "define", &mut self.define, about);
        named_field(fields, "random", &mut self.random, "quantities that are drawn when an episode starts");
        list_field(fields, "observe", &mut self.observe, "what the controller sees");
        named_field(fields, "reward", &mut self.reward, "terms of the reward of a step, by name");
        let about = "when an episode ends before its time, in failure: one condition, or several by name, `{ fallen = \"body.torso.pos.z < 0.5 m\" }`";
        either_field(fields, "ends", &mut self.ends, about);
        text_field(fields, "success", &mut self.success, "whether an episode is a success, at its end");
        let about =
            "kinds of episodes of which success is told apart: the first by name that holds at the start, else `other`";
        named_field(fields, "kinds", &mut self.kinds, about);
        let about =
            "where an episode starts: `\"joint.*.pos\" = \"uniform(-0.1, 0.1)\"`, positions and velocities of joints";
        named_field(fields, "start", &mut self.start, about);
        let about = "forces on bodies, 3 components in N, or 6 with the torque: `\"body.torso\" = \"[push, 0, 0]\"`";
        named_field(fields, "forces", &mut self.forces, about);
        text_field(fields, "observation_delay", &mut self.observation_delay, "time from what is to what is seen, s");
        text_field(
            fields,
            "command_delay",
            &mut self.command_delay,
            "time from a decision to when it acts, s: of commands, and of the efforts that the law made of them",
        );
    }

    fn law_fields(&mut self, fields: &mut Fields<'_, '_>) {
        let about = "the law of the hardware: efforts on `joint.NAME` (N·m, N), `tendon.NAME` (tension, N) or `actuator.NAME` (its control)";
        named_field(fields, "law", &mut self.law, about);
        let keys = self.design.iter().map(|parameter| (parameter.name.clone(), parameter.item())).collect();
        let item = (!self.design.is_empty()).then_some(Item::Keys(Keys(keys)));
        let design = &mut self.design;
        let about = "design parameters: `{ shank = { limits = [\"0.3 m\", \"0.7 m\"], initial = \"0.5 m\", sets = [\"geom.shin.size[1] = shank/2\"] } }`";
        fields.default("none").kind(Kind::Table(Box::new(Kind::Open))).open("design", about, item, |section, node| {
            let Value::Table(table) = &node.value else {
                return section.wrong("design", node, "is no table", Some("write [task.design.NAME]".into()));
            };
            let read = table.iter().map(|(name, entry)| Parameter::read(section, name, entry));
            *design = read.collect::<Vec<_>>().into_iter().flatten().collect();
        });
    }

    /// Reads the model's files and compiles all that was said, once every key was read.
    fn resolve(&mut self, section: &Section<'_>) {
        self.robot = None;
        if !section.has("model") {
            let hint = "name the robot's model, MJCF or URDF, relative to the experiment: model = \"robot.xml\"";
            return section.clash("model", "task.model is missing".into(), hint);
        }
        // What is wrong elsewhere hides no fault of the formulas.
        let whole = ["model", "model_sha256", "frame_skip", "readings", "base", "floor", "motors", "commands"];
        if !whole.iter().all(|key| section.sound(&[key]) && section.sound_below(&section.path(key))) {
            return;
        }
        match gather(section.folder(), &self.model) {
            Ok(files) => self.files = Arc::new(files),
            Err(fault) => {
                let whole = 0..self.model.len();
                return tell_at(section, &["model"], &whole, &fault.message, Some(fault.hint));
            }
        }
        let digest = self.digest();
        if self.model_sha256.as_ref().is_some_and(|known| *known != digest) {
            let hint = "put the files back, or leave model_sha256 out and train anew";
            return section.clash(
                "model_sha256",
                "the model's files are not those that it was trained with".into(),
                hint,
            );
        }
        self.model_sha256 = Some(digest);
        self.robot = Robot::compile(self, section).map(Arc::new);
    }

    /// SHA-256 of the model's files: names, lengths and contents, in the order of the names.
    fn digest(&self) -> String {
        let mut hash = Sha256::new();
        for (path, bytes) in self.files.iter() {
            hash.update(format!("{path}\n{}\n", bytes.len()));
            hash.update(bytes);
        }
        hash.finalize().iter().fold(String::new(), |mut digits, byte| {
            // Writing to a string cannot fail.
            let _ = write!(digits, "{byte:02x}");
            digits
        })
    }
}
