//! Where an episode starts, what is seen and rewarded, and what pushes.

use hwasp_core::{CommandPort, Dimension, EnvSpec, Law, MOST_TERMS, Port};
use hwasp_expr::{Exponents, Part, Quantity, Value};
use hwasp_settings::nearest;
use hwasp_settings::text::{column_fault, shorten};

use super::{Compiler, HORIZON, MOST_OBSERVED};
use crate::columns::{Column, Reading};
use crate::delay::{DELAYS, Delay};
use crate::names::{InPlace, Place};
use crate::texts::Named;

impl Compiler<'_, '_> {
    /// Where an episode starts: the values, and the positions and velocities that they are for.
    pub(super) fn start(&mut self) -> Option<(Vec<Part>, Vec<Reading>)> {
        let settings = self.settings;
        let (mut parts, mut targets): (Vec<Part>, Vec<Reading>) = (Vec::new(), Vec::new());
        for (key, text) in &settings.start {
            let Some(places) = self.start_places(key) else { continue };
            let Some(value) = self.read(&["start", key], text, 0, Place::Start, places.len()) else { continue };
            let count = value.parts.len();
            if count != 1 && count != places.len() {
                let message = format!("{key} has {} components, and this has {count}", places.len());
                self.refuse(&["start", key], message, Some("give one for all, or one each".into()));
                continue;
            }
            if let Some(twice) = places.iter().find(|place| targets.contains(place)) {
                let at = self.names.columns.place(Column::Engine(*twice), String::new);
                let name = self.names.columns.names()[at].clone();
                let hint = "let one entry be for each position and velocity";
                self.refuse(&["start", key], format!("`{name}` starts at two values"), Some(hint.into()));
                continue;
            }
            parts.extend((0..places.len()).map(|i| value.parts[if count == 1 { 0 } else { i }]));
            targets.extend(places);
        }
        (!settings.start.is_empty()).then_some((parts, targets))
    }

    /// The positions and velocities that a key of `start` names.
    pub(super) fn start_places(&mut self, key: &str) -> Option<Vec<Reading>> {
        self.names.faulty.take();
        let mut scope = InPlace { names: &mut self.names, place: Place::Start, width: 1 };
        let value = match self.formulas.read(key, &mut scope) {
            Ok(value) => value,
            Err(error) if self.follows(&error, &["start", key], 0) => return None,
            Err(error) => {
                let hint = error.hint.unwrap_or_else(|| "a start is of joint.NAME.pos or joint.NAME.vel".to_owned());
                self.refuse(&["start", key], format!("`{key}`: {}", error.message), Some(hint));
                return None;
            }
        };
        let place = |&part: &Part| match self.names.columns.all()[self.formulas.as_column(part)?] {
            Column::Engine(reading @ (Reading::Position(_) | Reading::Velocity(_))) => Some(reading),
            _ => None,
        };
        let places: Option<Vec<Reading>> = value.parts.iter().map(place).collect();
        if places.is_none() {
            let message = format!("`{key}` is no position or velocity of joints");
            self.refuse(
                &["start", key],
                message,
                Some("write \"joint.*.pos\", \"joint.knee.vel\" or \"qpos[0:3]\"".into()),
            );
        }
        places
    }

    /// What is seen and what it is worth.
    pub(super) fn step(&mut self) -> Watched {
        let settings = self.settings;
        let all = ["joint.*.pos".to_owned(), "joint.*.vel".to_owned()];
        let observe = if settings.observe.is_empty() { &all[..] } else { &settings.observe[..] };
        let mut observed = Vec::new();
        for (i, text) in observe.iter().enumerate() {
            if let Some(value) = self.read(&["observe", &i.to_string()], text, 0, Place::Step, 1) {
                let ports = self.called(text, &value);
                observed.push((ports, value));
            }
        }
        let count: usize = observed.iter().map(|(_, value)| value.parts.len()).sum();
        if count > MOST_OBSERVED {
            self.refuse(&["observe"], format!("{count} values are observed, more than {MOST_OBSERVED}"), None);
        }
        if settings.reward.is_empty() && self.entries("reward").is_empty() {
            let hint = "write [task.reward] with terms: forward = \"joint.root.vel\"";
            self.refuse(&["reward"], "the reward has no term", Some(hint.into()));
        }
        if settings.reward.len() > MOST_TERMS {
            let message = format!("the reward has {} terms, more than {MOST_TERMS}", settings.reward.len());
            self.refuse(&["reward"], message, Some("put several into one: their sum is the same".into()));
        }
        for (name, _) in &settings.reward {
            if let Some(why) = column_fault(name) {
                let message = format!("a term cannot be called `{}`", shorten(name, 60));
                self.note(&["reward", name], message, Some(format!("it has a curve of its name: {why}")));
            }
        }
        let terms = self.each("reward", &settings.reward);
        let kinds = self.each("kinds", &settings.kinds).into_iter().map(|(_, part)| part).collect();
        let ends = self.each("ends", &settings.ends);
        let success = match &*settings.success {
            "" => None,
            text => self.scalar(&["success"], text, Place::Step).map(|(part, _)| part),
        };
        Watched { observed, terms, ends, success, kinds }
    }

    /// Scalars by name; one without a name stands in the place of the table.
    pub(super) fn each(&mut self, table: &str, texts: &Named) -> Vec<(String, Part)> {
        let mut parts = Vec::new();
        for (name, text) in texts {
            let keys = [table, name];
            let keys = if name.is_empty() { &keys[..1] } else { &keys };
            if let Some((part, _)) = self.scalar(keys, text, Place::Step) {
                parts.push((name.clone(), part));
            }
        }
        parts
    }

    /// Forces on bodies: components, and for each body how many.
    pub(super) fn forces(&mut self) -> Option<(Vec<Part>, Pushes)> {
        let settings = self.settings;
        let (mut parts, mut bodies) = (Vec::new(), Vec::new());
        for (key, text) in &settings.forces {
            let name = key.strip_prefix("body.").unwrap_or_default();
            let Some(body) = self.names.anatomy.bodies.iter().position(|known| known == name && !name.is_empty())
            else {
                let known: Vec<String> = self.names.anatomy.bodies.iter().map(|name| format!("body.{name}")).collect();
                let hint = match nearest(key, known.iter().map(String::as_str)) {
                    Some(near) => format!("did you mean `{near}`?"),
                    None => "forces act on bodies: \"body.torso\" = \"[0, 0, 5 N]\"".to_owned(),
                };
                self.refuse(&["forces", key], format!("`{key}` is no body of the model"), Some(hint));
                continue;
            };
            let Some(value) = self.read(&["forces", key], text, 0, Place::Force, 1) else { continue };
            if !matches!(value.parts.len(), 3 | 6) {
                let message =
                    format!("a force has 3 components, or 6 with the torque, and this has {}", value.parts.len());
                self.refuse(&["forces", key], message, Some("write [x, y, z]".into()));
                continue;
            }
            bodies.push((body, value.parts.len()));
            parts.extend(value.parts);
        }
        (!settings.forces.is_empty()).then_some((parts, bodies))
    }

    pub(super) fn delays(&mut self) -> Option<Vec<Part>> {
        let settings = self.settings;
        let texts = [&settings.observation_delay, &settings.command_delay];
        if texts.iter().all(|text| text.is_empty()) {
            return None;
        }
        let zero = self.formulas.constant(0.0);
        Some(
            DELAYS
                .into_iter()
                .zip(texts)
                .map(|(key, text)| {
                    if text.is_empty() {
                        return zero;
                    }
                    let Some((part, quantity)) = self.scalar(&[key], text, Place::Model) else { return zero };
                    if !matches!(quantity, Quantity::Known(own) if own.fits(Exponents::of(Dimension::Time))) {
                        self.refuse(
                            &[key],
                            format!("a delay is a time, and this is {quantity}"),
                            Some("write it 20 ms".into()),
                        );
                    } else if let Some(time) = self.formulas.known(part)
                        && let Err(message) = Delay::steps(time, self.names.time_step)
                    {
                        let hint = "a delay is kept in whole steps of the environment; 0 s is none";
                        self.refuse(&[key], message, Some(hint.into()));
                    }
                    part
                })
                .collect(),
        )
    }

    /// What the environment is from outside.
    pub(super) fn env(&mut self, observed: &[(Vec<Port>, Value)], law: &Law) -> EnvSpec {
        let settings = self.settings;
        let named = |quantity: Quantity| quantity.dimension().unwrap_or(Dimension::None);
        let columns = self.names.columns.clone();
        let read = |at: usize| Port { name: columns.names()[at].clone(), dimension: columns.dimension(at) };
        let observation = observed.iter().flat_map(|(ports, _)| ports.clone()).collect();
        let commands = self.names.commands.clone();
        let mut command = Vec::new();
        for (name, quantity) in &commands {
            let declared = settings.commands.iter().find(|command| command.name == *name);
            let of_model = self.names.anatomy.actuators.iter().find(|actuator| actuator.name == *name);
            let limits = declared
                .map(|declared| [declared.limits.low.value, declared.limits.high.value])
                .or_else(|| of_model.and_then(|actuator| actuator.limits));
            // Where there are none, that was told.
            let [lo, hi] = limits.unwrap_or([-1.0, 1.0]);
            command.push(CommandPort { name: name.clone(), dimension: named(*quantity), lo, hi, direct: true });
        }
        let state = law.ports().state.iter().map(|name| {
            let at = columns.names().iter().position(|column| column == name);
            at.map_or_else(|| Port { name: name.clone(), dimension: Dimension::None }, read)
        });
        let effort =
            self.names.efforts.iter().map(|(name, quantity)| Port { name: name.clone(), dimension: named(*quantity) });
        EnvSpec {
            observation,
            state: state.collect(),
            context: vec![],
            effort: effort.collect(),
            command,
            horizon: HORIZON,
            time_step: self.names.time_step,
            shaped_by: vec![],
            terms: vec![],
        }
    }
}

/// Bodies that are pushed, each with the components of its force.
pub(super) type Pushes = Vec<(usize, usize)>;

/// What is computed after a step.
pub(super) struct Watched {
    /// What is seen, with what its components are called.
    pub(super) observed: Vec<(Vec<Port>, Value)>,
    /// Terms of the reward, by name.
    pub(super) terms: Vec<(String, Part)>,
    /// When an episode ends, by name.
    pub(super) ends: Vec<(String, Part)>,
    pub(super) success: Option<Part>,
    pub(super) kinds: Vec<Part>,
}
