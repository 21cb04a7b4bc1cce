//! What moves the joints: torques given from outside, or tendons inside the engine.

use super::super::description::HandDescription;
use super::super::names::{
    DIGITS, JOINTS, KIND_OF_JOINT, PALM_ACTUATORS, PALM_JOINTS, TENDON_ACTUATORS, TENDONS, TORQUE_ACTUATORS,
};
use super::super::space::DESIGN_LEN;
use super::super::xml::Element;

/// What moves the joints.
#[derive(Clone, Debug, PartialEq)]
pub enum Drive {
    /// Six actuators whose control is a torque, N·m: the [law](super::super::TendonHand) runs outside, springs and all.
    JointTorque,
    /// Springs, tendons and winches inside the engine, which evaluates the same law in every simulation step. The control of
    /// the three winches is the motor travel x + Δx, m, limited to the spool by whoever sets it. The motor's limit on the
    /// sum of tensions is not part of the model: an actuator knows its own force alone.
    NativeTendon {
        /// The transmission, in the order of the law's design.
        design: [f64; DESIGN_LEN],
    },
}

/// More tension than any hand sees: what matters is that a tendon does not push.
const NO_LIMIT: f64 = 1e6;

/// A joint with the spring that its drive gives it, if any.
pub(super) fn spring(joint: Element, index: usize, drive: &Drive) -> Element {
    let Drive::NativeTendon { design } = drive else { return joint };
    let kind = KIND_OF_JOINT[index];
    joint.set("stiffness", design[4 + kind]).set("springref", -design[8 + kind])
}

/// The tendons, whose length is Σ r·θ.
pub(super) fn tendons(drive: &Drive) -> Option<Element> {
    let Drive::NativeTendon { design } = drive else { return None };
    let fixed = (0..DIGITS.len()).map(|digit| {
        let pulleys = [2 * digit, 2 * digit + 1]
            .map(|joint| Element::new("joint").set("joint", JOINTS[joint]).set("coef", design[KIND_OF_JOINT[joint]]));
        Element::new("fixed").set("name", TENDONS[digit]).with_all(pulleys)
    });
    Some(Element::new("tendon").with_all(fixed))
}

/// What an actuator cannot say of the motor on the spool, for whoever sets the winches' controls: N, m, m, and m in each of
/// the steps that the controller makes, s.
pub(super) fn motor(hand: &HandDescription, drive: &Drive) -> Option<Element> {
    let Drive::NativeTendon { .. } = drive else { return None };
    let motor = &hand.transmission;
    let numbers = [
        ("tension_limit", motor.tension_limit),
        ("spool_radius", motor.spool_radius),
        ("travel", motor.travel),
        ("step_limit", motor.step_limit),
        ("step_time", hand.step_time()),
    ];
    let numeric = |(name, value)| Element::new("numeric").set("name", name).set("data", value);
    Some(Element::new("custom").with_all(numbers.map(numeric)))
}

/// Position control of the palm, then torques or winches.
pub(super) fn actuators(hand: &HandDescription, drive: &Drive) -> Element {
    let palm = PALM_JOINTS.iter().zip(PALM_ACTUATORS).map(|(joint, name)| {
        Element::new("position")
            .set("name", name)
            .set("joint", joint)
            .set("kp", hand.palm.position_gain)
            .set("kv", hand.palm.velocity_gain)
            .set_all("forcerange", &[-hand.palm.force_limit, hand.palm.force_limit])
    });
    let actuator = Element::new("actuator").with_all(palm);
    match drive {
        Drive::JointTorque => actuator.with_all(
            JOINTS
                .iter()
                .zip(TORQUE_ACTUATORS)
                .map(|(joint, name)| Element::new("motor").set("name", name).set("joint", joint)),
        ),
        Drive::NativeTendon { design } => actuator.with_all((0..DIGITS.len()).map(|digit| winch(hand, design, digit))),
    }
}

/// f = K·(ctrl + Σ r·`theta_ref` - length), and never less than nothing.
fn winch(hand: &HandDescription, design: &[f64; DESIGN_LEN], digit: usize) -> Element {
    let stiffness = hand.transmission.tendon_stiffness;
    let reference: f64 = [2 * digit, 2 * digit + 1]
        .map(|joint| KIND_OF_JOINT[joint])
        .map(|kind| design[kind] * hand.transmission.reference[kind])
        .iter()
        .sum();
    Element::new("general")
        .set("name", TENDON_ACTUATORS[digit])
        .set("tendon", TENDONS[digit])
        .set("gaintype", "fixed")
        .set("gainprm", stiffness)
        .set("biastype", "affine")
        .set_all("biasprm", &[stiffness * reference, -stiffness, 0.0])
        .set_all("forcerange", &[0.0, NO_LIMIT])
}
