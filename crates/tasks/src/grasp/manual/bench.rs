//! What stands between the controller and the hand.

use hwasp_problem::Topic;

/// What is sensed, how late, and what arm and hand really do.
pub(super) fn bench() -> Topic {
    Topic::new("bench", "what stands between controller and hand; each range is drawn from once an episode, evenly")
        .with("travel_sensed", "commanded", "", TRAVEL)
        .with("object_sensed", "tracked", "", OBJECT)
        .with("delay", [0.0; 2], "s", "from the sensors to the command, in whole periods: `motor_travel`, `motor_torque`, palm and object are those of so long ago")
        .with("arm_lag", [0.0; 2], "s", "time constant with which the arm follows the palm's target, before the position control")
        .with("slack", [0.0; 2], "m", "of the tendons: wound before they pull")
        .with("torque_gain", [1.0; 2], "", "what `motor_torque` reads as a multiple of what it is")
        .with("limit_gain", [1.0; 2], "", "the real tension limit as a multiple of `tension_limit`")
}

const TRAVEL: &str = "what `motor_travel` tells. `commanded`: the sum of the commands, also while the motor's limit keeps the spool \
                      from winding; not what an encoder reads. `encoder`: the tendon that is on the spool";

const OBJECT: &str = "what `object_x`, `object_y` and `object_z` tell. `tracked`: where the object is. `fixed`: what was read at the \
                      start. `carried`: what was read at the start, until `motor_torque` reads `grasp_felt`; from then on it moves \
                      with what the palm's sensors read";
