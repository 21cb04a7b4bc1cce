//! What can be read of each kind of element.

use hwasp_expr::{Exponents, Quantity};

use crate::anatomy::Anatomy;
use crate::columns::Reading;

/// What the attribute of an element reads.
pub(crate) type Attribute = fn(&Anatomy, usize) -> (Vec<Reading>, Quantity);

pub(super) const LENGTH: Quantity = Quantity::Known(Exponents::new([0, 1, 0, 0, 0]));
pub(super) const SPEED: Quantity = Quantity::Known(Exponents::new([0, 1, -1, 0, 0]));
pub(super) const ENERGY: Quantity = Quantity::Known(Exponents::new([1, 2, -2, 0, 0]));
pub(super) const TURNING: Quantity = Quantity::Known(Exponents::new([0, 0, -1, 0, 1]));

pub(super) fn three(reading: impl Fn(usize) -> Reading) -> Vec<Reading> {
    (0..3).map(reading).collect()
}

fn four(reading: impl Fn(usize) -> Reading) -> Vec<Reading> {
    (0..4).map(reading).collect()
}

/// The attributes of a kind of element, with what each means.
pub(crate) fn attributes(kind: &str) -> &'static [(&'static str, Attribute, &'static str)] {
    match kind {
        "joint" => &[
            (
                "pos",
                |a, i| (a.joints[i].qpos.clone().map(Reading::Position).collect(), a.joints[i].position()),
                "position: rad or m; a quaternion of a ball; place and quaternion of a free joint",
            ),
            (
                "vel",
                |a, i| (a.joints[i].dof.clone().map(Reading::Velocity).collect(), a.joints[i].velocity()),
                "velocity: rad/s or m/s",
            ),
            (
                "acc",
                |a, i| (a.joints[i].dof.clone().map(Reading::Acceleration).collect(), Quantity::Unknown),
                "acceleration in the last simulation step",
            ),
            (
                "force",
                |a, i| {
                    (
                        a.joints[i].dof.clone().map(Reading::ActuatorForceOn).collect(),
                        Quantity::of(a.joints[i].effort()),
                    )
                },
                "force of the actuators on it",
            ),
            (
                "constraint",
                |a, i| {
                    let forces = a.joints[i].dof.clone().map(Reading::ConstraintForceOn).collect();
                    (forces, Quantity::of(a.joints[i].effort()))
                },
                "force of contacts and limits on it",
            ),
        ],
        "body" => &[
            ("pos", |_, i| (three(|k| Reading::BodyPosition(i, k)), LENGTH), "place of its frame in the world, m"),
            (
                "quat",
                |_, i| (four(|k| Reading::BodyOrientation(i, k)), Quantity::Number),
                "orientation, a quaternion (w, x, y, z)",
            ),
            (
                "vel",
                |_, i| (three(|k| Reading::BodyVelocity(i, k)), SPEED),
                "velocity of its frame's origin in the world, m/s",
            ),
            (
                "angvel",
                |_, i| (three(|k| Reading::BodyAngularVelocity(i, k)), TURNING),
                "angular velocity in the world, rad/s",
            ),
            ("com", |_, i| (three(|k| Reading::BodyCentre(i, k)), LENGTH), "place of its centre of mass, m"),
            (
                "force",
                |_, i| ((0..6).map(|k| Reading::BodyForce(i, k)).collect(), Quantity::Unknown),
                "torque and force on it from outside (`cfrc_ext`), N·m and N",
            ),
        ],
        "geom" => &[
            ("pos", |_, i| (three(|k| Reading::GeomPosition(i, k)), LENGTH), "place of its centre in the world, m"),
            ("quat", |_, i| (four(|k| Reading::GeomOrientation(i, k)), Quantity::Number), "orientation, a quaternion"),
        ],
        "site" => &[
            ("pos", |_, i| (three(|k| Reading::SitePosition(i, k)), LENGTH), "place in the world, m"),
            ("quat", |_, i| (four(|k| Reading::SiteOrientation(i, k)), Quantity::Number), "orientation, a quaternion"),
        ],
        "tendon" => &[
            ("length", |_, i| (vec![Reading::TendonLength(i)], LENGTH), "length, m"),
            ("vel", |_, i| (vec![Reading::TendonVelocity(i)], SPEED), "rate of the length, m/s"),
        ],
        "actuator" => &[
            ("force", |_, i| (vec![Reading::ActuatorForce(i)], Quantity::Unknown), "force or torque of it"),
            ("length", |_, i| (vec![Reading::ActuatorLength(i)], Quantity::Unknown), "length of its transmission"),
            ("vel", |_, i| (vec![Reading::ActuatorVelocity(i)], Quantity::Unknown), "rate of that length"),
            ("control", |_, i| (vec![Reading::Control(i)], Quantity::Unknown), "what it is told"),
            (
                "act",
                |a, i| (a.actuators[i].activation.into_iter().map(Reading::Activation).collect(), Quantity::Unknown),
                "its activation, where it has one",
            ),
        ],
        _ => &[],
    }
}
