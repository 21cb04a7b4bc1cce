//! What names in formulas stand for.

mod attributes;
mod faulty;

use std::sync::Arc;

use hwasp_core::Dimension;
use hwasp_expr::{Distribution, Formulas, Function, NameError, Part, Path, Quantity, Scope, Symbol, Value};

pub(crate) use self::attributes::attributes;
use self::attributes::{ENERGY, LENGTH, SPEED, three};
use self::faulty::Faulty;
use crate::anatomy::Anatomy;
use crate::columns::{Column, Columns, Reading, Stage};

/// First words of names, which nothing of one's own is called.
pub(crate) const RESERVED: [&str; 21] = [
    "joint", "body", "geom", "site", "tendon", "actuator", "sensor", "contact", "com", "energy", "command", "effort",
    "time", "step", "dt", "progress", "qpos", "qvel", "pi", "random", "option",
];

/// The place of an experiment that a formula is in, which decides what it may read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// A name for a formula: whoever uses it is asked.
    Define,
    /// A quantity of the episode, or a field of the model: there is no state yet.
    Model,
    /// Where an episode starts.
    Start,
    /// Observation, reward, ends, success.
    Step,
    /// Forces on bodies: before the step.
    Force,
    /// The law.
    Law,
}

impl Place {
    fn stage(self) -> Option<Stage> {
        match self {
            Self::Model => Some(Stage::Random),
            Self::Start => Some(Stage::Start),
            Self::Step => Some(Stage::Step),
            Self::Force => Some(Stage::Force),
            Self::Define | Self::Law => None,
        }
    }

    /// Why a column cannot be read here; none where it can.
    pub(crate) fn refuses(self, column: Column) -> Option<&'static str> {
        match (self, column) {
            (Self::Define, _) | (_, Column::Random(_) | Column::Progress) => None,
            (Self::Model, Column::Engine(_) | Column::Memory(_)) => {
                Some("the model is made before there is a state to read")
            }
            (Self::Model | Self::Start, Column::Command(_) | Column::Effort(_)) => {
                Some("an episode starts before anything is commanded")
            }
            (Self::Model, Column::Time | Column::Count) => Some("the model is made before the time begins"),
            (Self::Start, Column::Memory(_)) => Some("there is no step before the start"),
            (Self::Law | Self::Force, Column::Effort(_)) => Some("the effort is what comes of it"),
            (Self::Force, Column::Command(_)) => Some("forces act whatever is commanded"),
            (place, Column::Draw(stage, _)) if place.stage() != Some(stage) => {
                Some("what is drawn there is another draw")
            }
            _ => None,
        }
    }
}

/// A name of one's own.
#[derive(Clone, Debug)]
pub(crate) struct OwnName {
    pub(crate) name: String,
    pub(crate) value: Value,
}

/// Names, and the columns that they need.
#[derive(Debug, Default)]
pub(crate) struct Names {
    pub(crate) anatomy: Anatomy,
    pub(crate) columns: Columns,
    /// Commands, in order, with what they measure.
    pub(crate) commands: Vec<(String, Quantity)>,
    /// Efforts, in order.
    pub(crate) efforts: Vec<(String, Quantity)>,
    /// Design parameters, definitions, random quantities.
    pub(crate) own: Vec<OwnName>,
    /// Functions of `[task.define]`.
    pub(crate) functions: Vec<Arc<Function>>,
    /// What is remembered from step to step.
    pub(crate) memory: Vec<Part>,
    /// Time of an environment step, s.
    pub(crate) time_step: f64,
    pub(crate) faulty: Faulty,
}

/// The names as one place sees them.
pub(crate) struct InPlace<'n> {
    pub(crate) names: &'n mut Names,
    pub(crate) place: Place,
    /// Components of what the formula is for.
    pub(crate) width: usize,
}

impl Scope for InPlace<'_> {
    fn name(&mut self, formulas: &mut Formulas, path: &Path) -> Result<Symbol, NameError> {
        let names = &mut *self.names;
        if let Some(own) = names.own.iter().find(|own| own.name == path.first()) {
            return Ok(Symbol::new(own.value.parts.clone(), own.value.quantity, 1));
        }
        let (columns, quantity, used) = names.find(path).inspect_err(|_| names.faulty.note(path.first()))?;
        let parts = match columns {
            Found::Columns(columns) => columns
                .into_iter()
                .map(|(column, name, quantity)| {
                    let at = names.columns.place(column, || name);
                    names.columns.measures(at, quantity);
                    formulas.column(at)
                })
                .collect(),
            Found::Number(value) => vec![formulas.constant(value)],
        };
        Ok(Symbol::new(parts, quantity, used))
    }

    fn previous(&mut self, formulas: &mut Formulas, value: &Value) -> Result<Vec<Part>, String> {
        if matches!(self.place, Place::Model | Place::Start) {
            return Err("there is no step before the start of an episode".to_owned());
        }
        let parts = value.parts.iter().map(|&part| {
            let memory = &mut self.names.memory;
            let at = memory.iter().position(|&kept| kept == part).unwrap_or(memory.len());
            if at == memory.len() {
                memory.push(part);
            }
            formulas.column(self.names.columns.place(Column::Memory(at), || format!("previous {at}")))
        });
        Ok(parts.collect())
    }

    fn draw(&mut self, formulas: &mut Formulas, from: Distribution, count: usize) -> Result<Vec<Part>, String> {
        let Some(stage) = self.place.stage() else {
            return Err("a law and a definition draw nothing: name the draw in [task.random]".to_owned());
        };
        Ok((0..count).map(|_| formulas.column(self.names.columns.draw(stage, from))).collect())
    }

    fn function(&self, name: &str) -> Option<Arc<Function>> {
        let found = self.names.functions.iter().find(|function| function.name() == name).cloned();
        if found.is_none() {
            self.names.faulty.note(name);
        }
        found
    }

    fn functions(&self) -> Vec<String> {
        self.names.functions.iter().map(|function| function.name().to_owned()).collect()
    }

    fn width(&self) -> usize {
        self.width
    }

    fn strict(&self) -> bool {
        self.place == Place::Law
    }
}

enum Found {
    Columns(Vec<(Column, String, Quantity)>),
    Number(f64),
}

impl Names {
    fn elements(&self, kind: &str) -> Vec<String> {
        let anatomy = &self.anatomy;
        match kind {
            "joint" => anatomy.joints.iter().map(|joint| joint.name.clone()).collect(),
            "body" => anatomy.bodies.clone(),
            "geom" => anatomy.geoms.clone(),
            "site" => anatomy.sites.clone(),
            "tendon" => anatomy.tendons.clone(),
            "actuator" => anatomy.actuators.iter().map(|actuator| actuator.name.clone()).collect(),
            "sensor" => anatomy.sensors.iter().map(|sensor| sensor.name.clone()).collect(),
            "command" => self.commands.iter().map(|(name, _)| name.clone()).collect(),
            "effort" => self.efforts.iter().map(|(name, _)| name.clone()).collect(),
            _ => Vec::new(),
        }
    }

    /// What a name of the model stands for: columns with their names, what they measure, and the parts of the path it takes.
    fn find(&self, path: &Path) -> Result<(Found, Quantity, usize), NameError> {
        let kind = path.first();
        match kind {
            "time" => Ok(column(Column::Time, kind, Quantity::of(Dimension::Time))),
            "step" => Ok(column(Column::Count, kind, Quantity::Number)),
            "progress" => Ok(column(Column::Progress, kind, Quantity::Number)),
            "dt" => Ok((Found::Number(self.time_step), Quantity::of(Dimension::Time), 1)),
            "qpos" => {
                let all = self.anatomy.joints.iter().flat_map(|joint| joint.qpos.clone()).map(Reading::Position);
                Ok(engine(all.collect(), kind, Quantity::Unknown, 1))
            }
            "qvel" => {
                let all = self.anatomy.joints.iter().flat_map(|joint| joint.dof.clone()).map(Reading::Velocity);
                Ok(engine(all.collect(), kind, Quantity::Unknown, 1))
            }
            "com" => match path.word(1) {
                Some("pos") => Ok(engine(three(Reading::Centre), "com.pos", LENGTH, 2)),
                Some("vel") => Ok(engine(three(Reading::CentreVelocity), "com.vel", SPEED, 2)),
                _ => Err(attribute_missing(path, 1, &["pos", "vel"])),
            },
            "energy" => match path.word(1) {
                Some("kinetic") => Ok(engine(vec![Reading::Kinetic], "energy.kinetic", ENERGY, 2)),
                Some("potential") => Ok(engine(vec![Reading::Potential], "energy.potential", ENERGY, 2)),
                _ => Err(attribute_missing(path, 1, &["kinetic", "potential"])),
            },
            "command" | "effort" => self.port(path, kind),
            "sensor" => self.sensor(path),
            "contact" => self.contact(path),
            "joint" | "body" | "geom" | "site" | "tendon" | "actuator" => self.element(path, kind),
            _ => {
                let own = self.own.iter().map(|own| own.name.clone());
                let words = RESERVED.iter().filter(|word| !matches!(**word, "random" | "option"));
                Err(NameError::unknown(own.chain(words.map(|word| (*word).to_owned()))))
            }
        }
    }

    fn element(&self, path: &Path, kind: &str) -> Result<(Found, Quantity, usize), NameError> {
        let elements = self.elements(kind);
        let chosen = chosen(path, 1, &elements)?;
        let attributes = attributes(kind);
        let names: Vec<&str> = attributes.iter().map(|(name, ..)| *name).collect();
        let found = path.word(2).and_then(|word| attributes.iter().find(|(name, ..)| *name == word));
        let Some((attribute, read, _)) = found else { return Err(attribute_missing(path, 2, &names)) };
        let mut columns = Vec::new();
        let mut quantity: Option<Quantity> = None;
        for &index in &chosen {
            let (readings, of) = read(&self.anatomy, index);
            quantity = Some(match quantity {
                None => of,
                Some(before) if before == of => of,
                Some(_) => Quantity::Unknown,
            });
            let name = if elements[index].is_empty() { format!("#{index}") } else { elements[index].clone() };
            columns.extend(labelled(readings, &format!("{kind}.{name}.{attribute}"), of));
        }
        if columns.is_empty() {
            let message = format!("`{path}` is empty: none of them has one");
            return Err(NameError::because(2, message, "leave it out"));
        }
        Ok((Found::Columns(columns), quantity.unwrap_or(Quantity::Unknown), 3))
    }

    fn port(&self, path: &Path, kind: &str) -> Result<(Found, Quantity, usize), NameError> {
        let ports = if kind == "command" { &self.commands } else { &self.efforts };
        let column = |i: usize| if kind == "command" { Column::Command(i) } else { Column::Effort(i) };
        if ports.is_empty() {
            return Err(NameError::because(
                0,
                format!("there is no {kind} here"),
                "see [task.law] and the model's actuators",
            ));
        }
        let named = |i: usize| (column(i), format!("{kind}.{}", ports[i].0), ports[i].1);
        if path.len() == 1 {
            let alike = ports.iter().all(|(_, quantity)| *quantity == ports[0].1);
            let quantity = if alike { ports[0].1 } else { Quantity::Unknown };
            return Ok((Found::Columns((0..ports.len()).map(named).collect()), quantity, 1));
        }
        let names: Vec<String> = ports.iter().map(|(name, _)| name.clone()).collect();
        // `effort.joint.knee` has a name with a dot.
        let dotted = (2..=path.len().min(3)).rev().find_map(|parts| {
            let words: Option<Vec<&str>> = (1..parts).map(|at| path.word(at)).collect();
            let name = words?.join(".");
            names.iter().position(|known| *known == name).map(|i| (i, parts))
        });
        if let Some((i, parts)) = dotted {
            return Ok((Found::Columns(vec![named(i)]), ports[i].1, parts));
        }
        let chosen = chosen(path, 1, &names)?;
        let quantity = if chosen.len() == 1 { ports[chosen[0]].1 } else { Quantity::Unknown };
        Ok((Found::Columns(chosen.into_iter().map(named).collect()), quantity, 2))
    }

    fn sensor(&self, path: &Path) -> Result<(Found, Quantity, usize), NameError> {
        let elements = self.elements("sensor");
        let chosen = chosen(path, 1, &elements)?;
        let sensors = &self.anatomy.sensors;
        let columns = chosen.iter().flat_map(|&i| {
            let readings = sensors[i].data.clone().map(Reading::Sensor).collect();
            labelled(readings, &format!("sensor.{}", sensors[i].name), sensors[i].quantity)
        });
        let quantity = if chosen.len() == 1 { sensors[chosen[0]].quantity } else { Quantity::Unknown };
        Ok((Found::Columns(columns.collect()), quantity, 2))
    }

    /// `contact.foot.floor` (0 or 1), `contact.foot.floor.force` (N), `contact.foot` (with anything).
    fn contact(&self, path: &Path) -> Result<(Found, Quantity, usize), NameError> {
        let geoms = &self.anatomy.geoms;
        let one = |at: usize| -> Result<usize, NameError> {
            match chosen(path, at, geoms)?[..] {
                [only] => Ok(only),
                _ => Err(NameError::because(at, "a contact is between two geoms", "name one of them")),
            }
        };
        let first = one(1)?;
        if path.len() == 2 {
            return Ok(engine(vec![Reading::TouchAny(first)], &path.to_string(), Quantity::Number, 2));
        }
        let second = one(2)?;
        if path.word(3) == Some("force") {
            let reading = Reading::TouchForce(first, second);
            return Ok(engine(vec![reading], &path.to_string(), Quantity::of(Dimension::Force), 4));
        }
        Ok(engine(vec![Reading::Touch(first, second)], &path.to_string(), Quantity::Number, 3))
    }
}

fn column(column: Column, name: &str, quantity: Quantity) -> (Found, Quantity, usize) {
    (Found::Columns(vec![(column, name.to_owned(), quantity)]), quantity, 1)
}

fn engine(readings: Vec<Reading>, name: &str, quantity: Quantity, used: usize) -> (Found, Quantity, usize) {
    (Found::Columns(labelled(readings, name, quantity)), quantity, used)
}

/// Columns with names, counted where there are several, and what they measure.
fn labelled(readings: Vec<Reading>, name: &str, quantity: Quantity) -> Vec<(Column, String, Quantity)> {
    let several = readings.len() > 1;
    let label = |i| if several { format!("{name}[{i}]") } else { name.to_owned() };
    readings.into_iter().enumerate().map(|(i, reading)| (Column::Engine(reading), label(i), quantity)).collect()
}

/// The elements that part `at` of a path means: one by its name or number, or all.
fn chosen(path: &Path, at: usize, elements: &[String]) -> Result<Vec<usize>, NameError> {
    let kind = path.word(at - 1).unwrap_or_default();
    let named = || elements.iter().filter(|name| !name.is_empty()).cloned();
    if elements.is_empty() {
        let message = format!("the model has no {kind}");
        return Err(NameError::because(0, message, format!("leave it out, or add a {kind} to the model's file")));
    }
    if let Some(index) = path.index(at) {
        let last = elements.len() - 1;
        let message = || format!("there is no {kind} #{index}: they are counted from 0 to {last}");
        let known: Vec<String> = named().collect();
        let hint = if known.is_empty() {
            format!("none of them has a name: {kind}.#0 is the first")
        } else {
            format!("by name there are {}", hwasp_settings::listed(known.iter().map(String::as_str)))
        };
        return (index <= last).then(|| vec![index]).ok_or_else(|| NameError::because(at, message(), hint));
    }
    match path.word(at) {
        None => Err(NameError::because(
            at - 1,
            format!("`{kind}` names no element"),
            format!("write {kind}.NAME or {kind}.*"),
        )),
        Some("*") => Ok((0..elements.len()).collect()),
        Some(name) => match elements.iter().position(|known| known == name) {
            Some(index) => Ok(vec![index]),
            None => Err(NameError::at(at, named())),
        },
    }
}

/// What is missing behind the start of a name.
fn attribute_missing(path: &Path, at: usize, known: &[&str]) -> NameError {
    if path.len() > at {
        return NameError::at(at, known.iter().copied());
    }
    let hint = format!("it has {}", known.iter().map(|name| format!(".{name}")).collect::<Vec<_>>().join(", "));
    NameError::because(at - 1, format!("`{path}` is no value by itself"), hint)
}
