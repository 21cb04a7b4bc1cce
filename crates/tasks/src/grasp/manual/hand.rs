//! The hand itself: frames, the order of things, transmission, palm, and its names in the exported model.

use hwasp_problem::{Frame, Topic};

use super::ports::{OBJECT, PALM, WORLD};
use crate::hand::{HandDescription, PalmDescription, SUBSTEPS, TransmissionDescription, names};

/// Where origins are and where axes point.
pub(super) fn frames(hand: &HandDescription) -> Vec<Frame> {
    let frame = |name: &str, meaning: String| Frame { name: name.to_owned(), meaning };
    let mm = |[x, y, z]: [f64; 3]| format!("({:.0}, {:.0}, {:.0}) mm", 1e3 * x, 1e3 * y, 1e3 * z);
    let [thumb, first, second] = hand.digits().map(|digit| mm(digit.base));
    vec![
        frame(
            WORLD,
            "fixed. z points up and is 0 on the floor, the plane on which the object lies; x = y = 0 is below the \
             palm at the start"
                .to_owned(),
        ),
        frame(
            PALM,
            format!(
                "moves with the palm and never turns: its axes are parallel to the world's. The origin lies in \
                 the plane of the proximal joints' axes. The proximal joints are at {thumb} (thumb), {first} \
                 (finger1) and {second} (finger2); all joints turn about axes parallel to x. The digits reach \
                 towards -z. The palm's body is between z = 0 and z = {:.0} mm: an arm holds it from above",
                2e3 * hand.palm.half_size[2]
            ),
        ),
        frame(
            OBJECT,
            "moves with the object. The origin is the centre of its bounding box, which is its centre of mass; \
             the axes are the world's as the object lies at the start, before it is turned about the vertical"
                .to_owned(),
        ),
    ]
}

/// What happens in a control period, in order.
pub(super) fn period(hand: &HandDescription) -> Topic {
    let order: &[&str] = &[
        "read the sensors: all values are of the end of the period before",
        "give the observation to the controller: its answer is within the commands' limits",
        "add each command to its target, and keep the target within its limits",
        "give the targets to the position controls of arm and motor, and hold them until the period ends",
    ];
    Topic::new("period", "what happens in a control period")
        .with("order", order, "", "one after the other; the simulation takes no time between reading and acting")
        .with("simulation_step", hand.time_step, "s", "a step of the physics")
        .with("simulation_steps", SUBSTEPS as f64, "", "steps of the physics in a period")
}

/// Motor, spool and tendons.
pub(super) fn transmission(motor: &TransmissionDescription) -> Topic {
    let torque = motor.spool_radius * motor.tension_limit;
    Topic::new(
        "transmission",
        "motor, spool and three tendons; `motor_torque` = spool_radius × sum of the three tensions",
    )
    .with("spool_radius", motor.spool_radius, "m", "of the spool, to the middle of the line")
    .with("travel", motor.travel, "m", "the most tendon on the spool")
    .with(
        "tension_limit",
        motor.tension_limit,
        "N",
        "the most that the tendons pull together: in every simulation step in which they would pull more at \
         `motor_travel_target`, the spool gives way to the travel at which they pull this",
    )
    .with(
        "torque_limit",
        torque,
        "N·m",
        "the same at the spool: the motor's current limit times its torque constant. `motor_torque` is never \
         more, and never negative",
    )
    .with("current_limit", motor.current(motor.tension_limit), "A", "the same as current of this motor")
    .with(
        "torque_constant",
        motor.torque_constant,
        "N·m/A",
        "torque of the motor per current (Dynamixel XM430-W210-T at stall): `motor_torque` on a bench = current × \
         this, less what friction takes",
    )
    .with(
        "tendon_stiffness",
        motor.tendon_stiffness,
        "N/m",
        "of each tendon: tension = this × (travel - length over the pulleys), and 0 where it is slack",
    )
}

/// What holds the palm.
pub(super) fn palm(palm: &PalmDescription) -> Topic {
    Topic::new("palm", "the position control that moves the palm in training, axis by axis; an arm shall be as quick")
        .with("mass", palm.mass, "kg", "of palm and what carries it; its weight is carried")
        .with("position_gain", palm.position_gain, "N/m", "force per distance from the target")
        .with("velocity_gain", palm.velocity_gain, "N·s/m", "force against the speed")
        .with("force_limit", palm.force_limit, "N", "the most force of either sign, axis by axis")
        .with("lag", palm.velocity_gain / palm.position_gain, "s", "how late the palm is behind a target of even speed")
}

/// What is what in the exported model.
pub(super) fn model() -> Topic {
    let links = &names::LINK_GEOMS;
    Topic::new(
        "model",
        "names in the exported `hand.xml`; angles of the joints are 0 in the open hand and grow as it closes",
    )
    .with("palm", names::PALM, "", "the palm's body")
    .with(
        "palm_joints",
        &names::PALM_JOINTS[..],
        "",
        "its slides in x, y and z: their coordinates are its place in the world",
    )
    .with("palm_actuators", &names::PALM_ACTUATORS[..], "", "their controls are the palm's targets in x, y and z, m")
    .with("joints", &names::JOINTS[..], "", "of the digits")
    .with("tendons", &names::TENDONS[..], "", "their lengths are those over the pulleys, m")
    .with(
        "winches",
        &names::TENDON_ACTUATORS[..],
        "",
        "an actuator for each tendon: the control of all three is the travel, m",
    )
    .with("thumb", &links[..2], "", "geoms of the thumb")
    .with("fingers", &links[2..], "", "geoms of the fingers")
    .with("object", names::OBJECT, "", "the object's body")
    .with(
        "object_joint",
        names::OBJECT_JOINT,
        "",
        "its free joint: the place of its centre, then its quaternion w, x, y, z",
    )
    .with("object_geom", names::OBJECT_GEOM, "", "its geom, to be given shape, size and friction")
    .with("floor_geom", names::FLOOR, "", "the floor, whose sliding friction is set to the object's")
}
