//! What stands between the controller and the hand.

use hwasp_problem::Topic;

use crate::grasp::{Bench, ObjectSensed};

/// What is sensed, how late, and what arm and hand really do.
pub(super) fn topic(bench: &Bench) -> Topic {
    let about = "what stands between controller and hand; each range is drawn from once an episode, evenly";
    let mut topic = Topic::new("bench", about).with("travel_sensed", bench.travel_sensed.name(), "", TRAVEL).with(
        "object_sensed",
        bench.object_sensed.name(),
        "",
        OBJECT,
    );
    if bench.object_sensed == ObjectSensed::Carried {
        let about = "the reading of `motor_torque` from which on the object counts as held";
        topic = topic.with("grasp_felt", bench.grasp_felt, "N·m", about);
    }
    if let Some(speed) = bench.palm_speed {
        let about = "the most in any direction: where a period's commands to the palm are together longer than \
                     this times the period, all of them are shortened by one factor before they are added up";
        topic = topic.with("palm_speed", speed, "m/s", about);
    }
    let delay = "from the sensors to the command, in whole periods: palm, object and all that is told of \
                 the motor are those of so long ago, or of the start";
    let lag = "time constant with which the arm follows the palm's target, before the position control";
    topic
        .with("delay", bench.delay, "s", delay)
        .with("arm_lag", bench.arm_lag, "s", lag)
        .with("slack", bench.slack, "m", "of the tendons: wound before they pull")
        .with("torque_gain", bench.torque_gain, "", "what `motor_torque` reads as a multiple of what it is")
        .with("limit_gain", bench.limit_gain, "", "the real tension limit as a multiple of `tension_limit`")
        .with("motor_friction", bench.motor_friction, "N·m", FRICTION)
}

const TRAVEL: &str = "what `motor_travel` tells. `commanded`: the sum of the commands, also while the motor's \
                      limit keeps the spool from winding; not what an encoder reads. `encoder`: the tendon that \
                      is on the spool. `both`: the same, and the sum of the commands is `motor_travel_target`";

const FRICTION: &str = "of motor and spool: the real tension limit is smaller by this divided by `spool_radius`, and \
                        `motor_torque` reads more by this while the spool winds or is held back, less while it pays \
                        out, before `torque_gain`";

const OBJECT: &str = "what `object_x`, `object_y` and `object_z` tell. `tracked`: where the object is. `fixed`: \
                      what was read at the start. `carried`: what was read at the start, until `motor_torque` \
                      reads `grasp_felt`; from then on it moves with what the palm's sensors read";
