//! Reading and writing numbers of a model.

use std::f64::consts::PI;

use mujoco_rs::prelude::{MjtGeomBase, MjtJoint};

use super::super::{BuildError, Kind, Quantity};
use super::fields::Limits;
use super::find::Item;
use super::{FieldPath, Spec, SpecError};

/// Radians in a degree, as the engine converts them.
const DEGREE: f64 = PI / 180.0;

impl Spec {
    /// The value of a field, SI, as the model has it now: what the text says, what its classes say, or what was set.
    ///
    /// # Errors
    ///
    /// The model has no such element, or no value there.
    pub fn field(&self, path: &FieldPath) -> Result<f64, SpecError> {
        let (_, item) = self.find(path)?;
        let value = item.number(path.field(), path.index());
        let unset = |reason: &str| Err(SpecError::Unset { path: Box::new(path.clone()), reason: reason.to_owned() });
        match item {
            Item::Tendon(tendon) if path.field() == "springlength" && is_unset(tendon.springlength()) => {
                unset("the spring rests at the tendon's length in the initial position")
            }
            _ if value.is_nan() => unset("the text gives none, so the compiler computes it"),
            _ if is_angle(path, item) => Ok(value * DEGREE),
            _ => Ok(value),
        }
    }

    /// Sets a field, SI. The change counts from the next [`Self::compile`] on.
    ///
    /// Lower and upper ends of ranges are compared when the model is compiled, so that both can be moved. A `springlength`
    /// that the text does not give is set as a whole by either number, as MJCF does it.
    ///
    /// # Errors
    ///
    /// The model has no such element, the value is outside the limits of the field, or the field has no effect.
    pub fn set(&mut self, path: &FieldPath, value: f64) -> Result<(), SpecError> {
        let (place, item) = self.find(path)?;
        let limits = limits(path, item);
        if !limits.hold(value) {
            return Err(SpecError::Value {
                path: Box::new(path.clone()),
                value,
                unit: quantity(path, item).unit(),
                low: limits.low,
                high: limits.high,
                above: limits.above,
            });
        }
        if let Some(reason) = self.unused(path, place, item) {
            return Err(SpecError::Unused { path: Box::new(path.clone()), reason });
        }
        let both =
            matches!(item, Item::Tendon(tendon) if path.field() == "springlength" && is_unset(tendon.springlength()));
        let written = if is_angle(path, item) { value / DEGREE } else { value };
        let (kind, field) = (path.kind(), path.field());
        self.write(kind, place, field, path.index(), written);
        if both {
            self.write(kind, place, field, 1 - path.index(), written);
        }
        if field.ends_with("range") || field == "springlength" {
            let first = path.at(0);
            if !self.ranges.contains(&first) {
                self.ranges.push(first);
            }
        }
        Ok(())
    }

    /// What a field measures.
    ///
    /// # Errors
    ///
    /// The model has no such element.
    pub fn quantity(&self, path: &FieldPath) -> Result<Quantity, SpecError> {
        self.find(path).map(|(_, item)| quantity(path, item))
    }

    /// The least and the greatest value that a field takes, SI; the least itself is too low where a size or a mass may not
    /// be zero.
    ///
    /// # Errors
    ///
    /// The model has no such element.
    pub fn limits(&self, path: &FieldPath) -> Result<[f64; 2], SpecError> {
        let (_, item) = self.find(path)?;
        let Limits { low, high, .. } = limits(path, item);
        Ok([low, high])
    }

    /// Refuses ranges that were set upside down.
    pub(super) fn check_ranges(&self) -> Result<(), BuildError> {
        for path in &self.ranges {
            let Ok((_, item)) = self.find(path) else { continue };
            let [low, high] = [0, 1].map(|index| item.number(path.field(), index));
            // No range at all, as the engine reads it.
            if [low, high] == [0.0; 2] {
                continue;
            }
            let empty = if path.field() == "springlength" { low > high } else { low >= high };
            if empty {
                let scale = if is_angle(path, item) { DEGREE } else { 1.0 };
                let unit = quantity(path, item).unit();
                let shown = |value: f64| format!("{} {unit}", value * scale).trim_end().to_owned();
                return Err(BuildError::Range { path: path.without_index(), low: shown(low), high: shown(high) });
            }
        }
        Ok(())
    }
}

fn is_unset(springlength: &[f64; 2]) -> bool {
    *springlength == [-1.0, -1.0]
}

fn quantity(path: &FieldPath, item: Item<'_>) -> Quantity {
    let slides = matches!(item, Item::Joint(joint) if joint.type_() == MjtJoint::mjJNT_SLIDE);
    path.entry().quantity(path.index(), slides)
}

fn limits(path: &FieldPath, item: Item<'_>) -> Limits {
    let limits = path.entry().limits(path.index());
    match item {
        // A plane of size 0 has no end; its third size is the distance of its lines in pictures.
        Item::Geom(geom) if path.field() == "size" && path.index() < 2 && geom.type_() == MjtGeomBase::mjGEOM_PLANE => {
            Limits { above: false, ..limits }
        }
        _ => limits,
    }
}

/// Whether the text has the number in degrees.
fn is_angle(path: &FieldPath, item: Item<'_>) -> bool {
    let angle = match (path.field(), item) {
        ("euler", _) => true,
        ("range", Item::Joint(joint)) => matches!(joint.type_(), MjtJoint::mjJNT_HINGE | MjtJoint::mjJNT_BALL),
        ("ref" | "springref", Item::Joint(joint)) => joint.type_() == MjtJoint::mjJNT_HINGE,
        _ => false,
    };
    angle
        && path.kind() != Kind::Options
        && item.compiler().is_some_and(mujoco_rs::wrappers::mj_editing::MjsCompiler::degree)
}
