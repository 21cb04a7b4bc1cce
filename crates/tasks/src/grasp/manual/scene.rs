//! What is around the hand: where an episode starts, objects, disturbances, and what counts as success.

use hwasp_problem::Topic;

use crate::grasp::rules::{HOLD_DRIFT, HOLD_HEIGHT, HOLD_STEPS, HOLD_TOUCH};
use crate::grasp::{GraspTaskSettings, Inertia};

/// Where an episode starts.
pub(super) fn start(task: &GraspTaskSettings) -> Topic {
    let beside = [0.0 - task.offset, task.offset];
    Topic::new(
        "start",
        "the hand is open, at rest, with nothing on the spool; the object lies at rest on the floor. Ranges are \
         drawn from evenly",
    )
    .with("palm_x", 0.0, "m", "the palm in the world")
    .with("palm_y", 0.0, "m", "the palm in the world")
    .with("palm_height", task.height, "m", "height of the palm's origin above the object's highest point")
    .with("object_x", beside, "m", "the object's centre in the world")
    .with("object_y", beside, "m", "the object's centre in the world")
    .with("object_yaw", [0.0 - task.yaw, task.yaw], "rad", "the object's turn about the vertical")
}

/// What objects there are.
pub(super) fn objects(task: &GraspTaskSettings) -> Topic {
    let shapes: Vec<&str> = task.shapes.iter().map(|shape| shape.name()).collect();
    let topic = Topic::new(
        "objects",
        "what is grasped, one at a time, drawn anew for each episode, evenly and independently",
    )
    .with("shapes", &shapes[..], "", "each entry is as likely")
    .with(
        "size",
        task.size,
        "m",
        "edges x, y and z of the bounding box: three draws for `box` and `ellipsoid`; one for the `sphere`; for \
         the `cylinder` one for diameter (x and y), one for height (z)",
    )
    .with(
        "lying",
        task.lying,
        "",
        "share of cylinders that lie on their side, turned by 90° about y before the yaw: size_x is their height \
         then, and size_z their diameter",
    )
    .with("mass", task.mass, "kg", "of the object")
    .with("friction", task.friction, "", "coefficient of sliding friction, on hand and floor");
    match task.inertia {
        Inertia::Independent(range) => topic.with(
            "inertia",
            range,
            "kg·m²",
            "each principal moment about the centre, along the object's axes; draws of which one is more than the \
             two others together are drawn again",
        ),
        Inertia::Physical => topic.with("inertia", "physical", "", "that of a solid body of even density"),
    }
}

/// What disturbs the hand.
pub(super) fn disturbance(task: &GraspTaskSettings) -> Topic {
    let about = "standard deviation in each of x, y and z of the world, on the palm's and on the object's centre \
                 of mass, drawn anew each period";
    Topic::new(
        "disturbance",
        "what pushes palm and object in training. This and all noise is normally distributed, each quantity and \
         period by itself",
    )
    .with("force", task.disturbance_force, "N", about)
    .with("torque", task.disturbance_torque, "N·m", about)
}

/// What counts as success.
pub(super) fn success() -> Topic {
    Topic::new(
        "success",
        "all of it, over the last `hold_steps` periods of an episode, seen at the end of each; an episode ends \
         after `control.horizon_steps` and not before",
    )
    .with("hold_steps", HOLD_STEPS as f64, "", "periods at the end")
    .with(
        "hold_height",
        HOLD_HEIGHT,
        "m",
        "in all of them the object's lowest point is at least so high above the floor",
    )
    .with("touch_share", HOLD_TOUCH, "", "in at least this share of them the thumb and a finger touch the object")
    .with(
        "drift",
        HOLD_DRIFT,
        "m",
        "in all of them the object's centre, seen from the palm, is at most so far from where it was in the first \
         of them",
    )
    .with("afterwards", AFTERWARDS, "", "what comes then")
}

const AFTERWARDS: &str = "the controller holds the object until the end and knows of nothing beyond: setting it \
                          down, opening the hand and the way back are the caller's";
