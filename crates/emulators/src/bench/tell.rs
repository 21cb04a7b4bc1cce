//! What the bench tells, as JSON.

use hwasp_drivers::Pose;
use hwasp_grasp::{Object, ShapeKind};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::hand::HandView;
use crate::world::SpoolState;

/// An object as text: SI units.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ObjectText {
    kind: String,
    size: [f64; 3],
    mass: f64,
    /// That of a homogeneous body where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    inertia: Option<[f64; 3]>,
    friction: f64,
    #[serde(default)]
    place: [f64; 2],
    #[serde(default)]
    yaw: f64,
    #[serde(default)]
    lying: bool,
}

impl ObjectText {
    /// The object, if it is one.
    pub(super) fn object(self) -> Result<Object, String> {
        let Self { kind, size, mass, inertia, friction, place, yaw, lying } = self;
        let known = ShapeKind::EACH.into_iter().find(|known| known.name() == kind);
        let kind = known.ok_or_else(|| {
            let names = ShapeKind::EACH.map(ShapeKind::name).join(", ");
            format!("kind = {kind:?} is not one of {names}")
        })?;
        for (name, values, least) in [
            ("size", &size[..], 0.0),
            ("mass", &[mass], 0.0),
            ("friction", &[friction], 0.0),
            ("place", &place, f64::NEG_INFINITY),
            ("yaw", &[yaw], f64::NEG_INFINITY),
        ] {
            if let Some(value) = values.iter().find(|value| !(value.is_finite() && **value >= least)) {
                return Err(format!("{name} has {value}, which is no finite number of at least {least}"));
            }
        }
        let object = Object { kind, size, mass, inertia: [0.0; 3], friction, place, yaw, lying };
        let inertia = inertia.unwrap_or_else(|| object.shape().inertia(mass));
        Ok(Object { inertia, ..object })
    }
}

/// An object, with the fields that an order may have: what `object` puts onto a bench.
pub fn object(object: &Object) -> Value {
    let Object { kind, size, mass, inertia, friction, place, yaw, lying } = object.clone();
    json!({
        "kind": kind.name(), "size": size, "mass": mass, "inertia": inertia, "friction": friction, "place": place,
        "yaw": yaw, "lying": lying,
    })
}

pub(super) fn pose(pose: &Pose) -> Value {
    json!({"position": pose.position, "rotation": pose.rotation})
}

pub(super) fn spool(spool: &SpoolState) -> Value {
    json!({"position": spool.position, "velocity": spool.velocity, "current": spool.current})
}

pub(super) fn hand(view: &HandView) -> Value {
    json!({
        "palm": view.palm,
        "joints": view.joints,
        "object": object(&view.object),
        "object_pose": view.object_pose,
        "clearance": view.clearance,
        "touching": view.touching,
        "success": view.success,
        "wound": view.wound,
        "tension": view.tension,
        "time": view.time,
        "fault": view.fault,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_object_that_was_told_can_be_ordered() {
        let told = Object {
            kind: ShapeKind::Cylinder,
            size: [0.05, 0.05, 0.08],
            mass: 0.3,
            inertia: [1e-4, 1e-4, 1.5e-4],
            friction: 0.7,
            place: [0.01, -0.02],
            yaw: 0.3,
            lying: true,
        };
        let text: ObjectText = serde_json::from_value(object(&told)).unwrap();
        assert_eq!(text.object(), Ok(told.clone()));
        let brief = r#"{"kind": "cylinder", "size": [0.05, 0.05, 0.08], "mass": 0.3, "friction": 0.7}"#;
        let brief: ObjectText = serde_json::from_str(brief).unwrap();
        let brief = brief.object().unwrap();
        assert!((brief.inertia[2] - 0.5 * 0.3 * 0.025 * 0.025).abs() < 1e-12 && brief.place == [0.0; 2]);
        let refused = |change: fn(&mut ObjectText)| {
            let mut text: ObjectText = serde_json::from_value(object(&told_again())).unwrap();
            change(&mut text);
            text.object().unwrap_err()
        };
        assert_eq!(
            refused(|t| t.kind = "cone".into()),
            "kind = \"cone\" is not one of sphere, box, cylinder, ellipsoid"
        );
        assert_eq!(refused(|t| t.size[1] = -1.0), "size has -1, which is no finite number of at least 0");
        assert!(refused(|t| t.yaw = f64::NAN).starts_with("yaw has NaN"));
    }

    fn told_again() -> Object {
        Object {
            kind: ShapeKind::Box,
            size: [0.05; 3],
            mass: 0.3,
            inertia: [1e-4; 3],
            friction: 0.7,
            place: [0.0; 2],
            yaw: 0.0,
            lying: false,
        }
    }
}
