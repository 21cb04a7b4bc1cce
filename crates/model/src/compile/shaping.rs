//! The design, what is drawn for an episode, and the fields of the model that follow both.

use hwasp_core::{DesignGroup, DesignSpace, Initial};
use hwasp_expr::{Part, Quantity, Value};
use hwasp_mujoco::engine::{FieldPath, Spec};
use hwasp_settings::text::shorten;

use super::Compiler;
use crate::anatomy::measured;
use crate::columns::Column;
use crate::names::{OwnName, Place};
use crate::parameter::name_fault;
use crate::reference::TIME_STEP;
use crate::texts::tell_at;

impl Compiler<'_, '_> {
    pub(super) fn design(&mut self) -> Option<DesignSpace> {
        let mut groups = Vec::new();
        for (i, parameter) in self.settings.design.iter().enumerate() {
            let (low, high) = (parameter.limits.low.value, parameter.limits.high.value);
            groups.push(DesignGroup {
                name: parameter.name.clone(),
                dimension: parameter.dimension()?,
                lo: low,
                hi: high,
                count: 1,
                initial: Initial::Value(parameter.initial.as_ref().map_or(0.5 * (low + high), |initial| initial.value)),
            });
            let quantity = parameter.limits.exponents().map_or(Quantity::Unknown, Quantity::Known);
            let value = Value { parts: vec![self.formulas.uniform(i)], quantity };
            self.names.own.push(OwnName { name: parameter.name.clone(), value });
        }
        match DesignSpace::new(groups) {
            Ok(space) => Some(space),
            Err(error) => {
                self.refuse(&["design"], error.to_string(), None);
                None
            }
        }
    }

    /// Notes the names whose entries could not be read, which was told: what names them is not told again.
    pub(super) fn unread(&mut self) {
        let settings = self.settings;
        for (table, read) in [("random", &settings.random), ("define", &settings.define)] {
            let unread = self.entries(table).into_iter().filter(|name| read.iter().all(|(known, _)| known != name));
            let called = unread.map(|name| name.split('(').next().unwrap_or_default().trim().to_owned());
            self.names.faulty.own.extend(called.filter(|name| name_fault(name).is_none()));
        }
        for name in self.entries("design") {
            if name_fault(&name).is_none() && settings.design.iter().all(|known| known.name != name) {
                // A number of no known unit: what else is wrong with the formulas that name it is told.
                let value = Value { parts: vec![self.formulas.uniform(usize::MAX)], quantity: Quantity::Unknown };
                self.names.own.push(OwnName { name, value });
                self.sound = false;
            }
        }
        self.names.faulty.ports = self.entries("law").len() > settings.law.len();
    }

    /// Whether names of one's own can be called so; faults are told.
    pub(super) fn own_name(&mut self, table: &str, name: &str) -> bool {
        if let Some(why) = self.own_name_fault(name) {
            let message = format!("`{}` cannot be called so: {why}", shorten(name, 60));
            self.refuse(&[table, name], message, Some("take another name".into()));
            return false;
        }
        true
    }

    /// Why nothing new can be called so.
    pub(super) fn own_name_fault(&self, name: &str) -> Option<String> {
        name_fault(name).or_else(|| {
            let known = self.names.own.iter().any(|own| own.name == name);
            known.then(|| "something else has this name".to_owned())
        })
    }

    /// What is drawn for an episode: its components, which have columns of their own.
    pub(super) fn random(&mut self) -> Option<Vec<Part>> {
        let texts = &self.settings.random;
        let mut parts = Vec::new();
        let mut drawn: Vec<OwnName> = Vec::new();
        for (name, text) in texts {
            if !self.own_name("random", name) {
                continue;
            }
            let Some(value) = self.read(&["random", name], text, 0, Place::Model, 1) else {
                self.names.faulty.own.push(name.clone());
                continue;
            };
            let first = parts.len();
            parts.extend(&value.parts);
            // Those that come later see the draw itself, formulas of other places its column.
            let columns = (first..parts.len()).map(|i| {
                self.formulas.column(self.names.columns.place(Column::Random(i), || format!("{name}[{}]", i - first)))
            });
            let seen = Value { parts: columns.collect(), quantity: value.quantity };
            drawn.push(OwnName { name: name.clone(), value: seen });
            self.names.own.push(OwnName { name: name.clone(), value });
        }
        for own in drawn {
            if let Some(known) = self.names.own.iter_mut().find(|known| known.name == own.name) {
                known.value = own.value;
            }
        }
        (!texts.is_empty()).then_some(parts)
    }

    /// What each parameter of the design does, in words.
    pub(super) fn uses(
        &self,
        count: usize,
        shaping: Option<&Found>,
        places: &[(&[Part], &'static str)],
    ) -> Vec<String> {
        let reads = |parts: &[Part]| self.formulas.inputs(parts).1;
        let places: Vec<_> = places.iter().map(|(parts, name)| (reads(parts), *name)).collect();
        let set: Vec<(&FieldPath, Vec<usize>)> = shaping
            .iter()
            .flat_map(|found| found.fields.iter().zip(&found.parts).map(|(field, &part)| (field, reads(&[part]))))
            .collect();
        let words = |i: usize| {
            let own = |(field, reads): &(&FieldPath, Vec<usize>)| reads.contains(&i).then(|| field.to_string());
            let fields: Vec<String> = set.iter().filter_map(own).collect();
            let read: Vec<&str> =
                places.iter().filter(|(reads, _)| reads.contains(&i)).map(|(_, name)| *name).collect();
            match (fields.is_empty(), read.is_empty()) {
                (true, true) => "nothing reads it".to_owned(),
                (true, false) => format!("in {}", read.join(", ")),
                (false, true) => format!("sets {}", fields.join(", ")),
                (false, false) => format!("sets {}; in {}", fields.join(", "), read.join(", ")),
            }
        };
        (0..count).map(words).collect()
    }

    /// Fields of the model that formulas set.
    pub(super) fn shaping(&mut self, spec: &Spec) -> Option<Found> {
        let settings = self.settings;
        let mut found = Found::default();
        let own: Vec<(Vec<String>, &String)> = (0..)
            .zip(&settings.set)
            .map(|(i, text): (usize, _)| (vec!["set".to_owned(), i.to_string()], text))
            .chain(settings.design.iter().flat_map(|parameter| {
                let keys = move |i: usize| vec!["design".into(), parameter.name.clone(), "sets".into(), i.to_string()];
                (0..).zip(&parameter.sets).map(move |(i, text)| (keys(i), text))
            }))
            .collect();
        for (keys, text) in own {
            let keys: Vec<&str> = keys.iter().map(String::as_str).collect();
            let Some(at) = text.find('=').filter(|&at| !text[at + 1..].starts_with('=')) else {
                let hint = "write it \"geom.shin.size[1] = shank/2\"";
                self.refuse(&keys, "this sets no field", Some(hint.into()));
                continue;
            };
            let field = match text[..at].trim().parse::<FieldPath>() {
                Ok(field) => field,
                Err(error) => {
                    tell_at(self.section, &keys, &(0..at), &error.to_string(), None);
                    self.sound = false;
                    continue;
                }
            };
            if let Err(error) = spec.field(&field) {
                tell_at(self.section, &keys, &(0..at), &error.to_string(), None);
                self.sound = false;
                continue;
            }
            let refusal = if found.fields.contains(&field) {
                Some("this field is set twice")
            } else {
                (field.to_string() == TIME_STEP).then_some("the time step is that of the model's file")
            };
            if let Some(why) = refusal {
                tell_at(self.section, &keys, &(0..at), why, None);
                self.sound = false;
                continue;
            }
            let Some(value) = self.read(&keys, text, at + 1, Place::Model, 1) else { continue };
            let [part] = value.parts[..] else {
                self.refuse(&keys, "a field takes one number", Some("set its components one by one".into()));
                continue;
            };
            let wanted = spec.quantity(&field).map_or(Quantity::Unknown, measured);
            if let (Quantity::Known(a), Quantity::Known(b)) = (value.quantity, wanted)
                && !a.fits(b)
            {
                let hint = "see the units of the parameters and numbers in it";
                self.refuse(&keys, format!("the formula is in {a}, and {field} takes {b}"), Some(hint.into()));
                continue;
            }
            let (_, parameters) = self.formulas.inputs(&[part]);
            found.parameters.extend(parameters);
            found.fields.push(field);
            found.parts.push(part);
        }
        found.parameters.sort_unstable();
        found.parameters.dedup();
        (!found.fields.is_empty()).then_some(found)
    }
}

/// Fields that formulas set.
#[derive(Default)]
pub(super) struct Found {
    pub(super) parts: Vec<Part>,
    pub(super) fields: Vec<FieldPath>,
    pub(super) parameters: Vec<usize>,
}
