//! The names of everything in the model, and the order of digits, joints and parameters.

/// The digits, in the order of tendons and states.
pub const DIGITS: [&str; 3] = ["thumb", "finger1", "finger2"];

/// The six driven joints, in the order of states, efforts and torque actuators: two per digit, the proximal one first.
pub const JOINTS: [&str; 6] =
    ["thumb_proximal", "thumb_distal", "finger1_proximal", "finger1_distal", "finger2_proximal", "finger2_distal"];

/// The four kinds of joints that the design tells apart: the fingers share theirs.
pub const KINDS: [&str; 4] = ["thumb_proximal", "thumb_distal", "finger_proximal", "finger_distal"];

/// The kind (index into [`KINDS`]) of each of [`JOINTS`].
pub const KIND_OF_JOINT: [usize; 6] = [0, 1, 2, 3, 2, 3];

/// The bodies of the links, in the order of [`JOINTS`].
pub const LINK_BODIES: [&str; 6] = [
    "thumb_proximal_link",
    "thumb_distal_link",
    "finger1_proximal_link",
    "finger1_distal_link",
    "finger2_proximal_link",
    "finger2_distal_link",
];

/// The geoms of the links, in the order of [`JOINTS`]; 1, 3 and 5 are the distal ones, whose contacts count.
pub const LINK_GEOMS: [&str; 6] = [
    "thumb_proximal_pad",
    "thumb_distal_pad",
    "finger1_proximal_pad",
    "finger1_distal_pad",
    "finger2_proximal_pad",
    "finger2_distal_pad",
];

/// The actuators that apply joint torques, N·m, in the order of [`JOINTS`] ([`Drive::JointTorque`](super::Drive)).
pub const TORQUE_ACTUATORS: [&str; 6] = [
    "thumb_proximal_torque",
    "thumb_distal_torque",
    "finger1_proximal_torque",
    "finger1_distal_torque",
    "finger2_proximal_torque",
    "finger2_distal_torque",
];

/// The tendons, in the order of [`DIGITS`] ([`Drive::NativeTendon`](super::Drive)).
pub const TENDONS: [&str; 3] = ["thumb_tendon", "finger1_tendon", "finger2_tendon"];

/// The actuators on the tendons, in the order of [`DIGITS`]; their control is the motor travel, m.
pub const TENDON_ACTUATORS: [&str; 3] = ["thumb_winch", "finger1_winch", "finger2_winch"];

/// The palm's body; its origin lies in the plane of the proximal joints, between thumb and fingers.
pub const PALM: &str = "palm";
/// The palm's geom.
pub const PALM_GEOM: &str = "palm_box";
/// The palm's slide joints. Their coordinates are its position in the world, m.
pub const PALM_JOINTS: [&str; 3] = ["palm_x", "palm_y", "palm_z"];
/// The position actuators on them; their control is the target in the world, m. They come before all other actuators.
pub const PALM_ACTUATORS: [&str; 3] = ["palm_x_target", "palm_y_target", "palm_z_target"];

/// The object's body.
pub const OBJECT: &str = "object";
/// Its free joint.
pub const OBJECT_JOINT: &str = "object_pose";
/// Its one geom.
pub const OBJECT_GEOM: &str = "object_shape";

/// The floor's geom.
pub const FLOOR: &str = "floor";
/// The camera that looks at the grasp from the side.
pub const CAMERA: &str = "side";
/// The keyframe of the hand, open and high above the object.
pub const HOME: &str = "home";

/// The printed part that every digit is joined to.
pub const PALM_PART: &str = "palm";

/// The printed link after the joints of each of [`KINDS`]; the fingers share theirs.
pub const LINK_PARTS: [&str; 4] =
    ["thumb_proximal_link", "thumb_distal_link", "finger_proximal_link", "finger_distal_link"];

/// The printed pulley on the joints of each of [`KINDS`].
pub const PULLEY_PARTS: [&str; 4] =
    ["thumb_proximal_pulley", "thumb_distal_pulley", "finger_proximal_pulley", "finger_distal_pulley"];

/// The printed parts on the palm, up to the robot's flange, in the palm's frame.
pub const MOUNT_PARTS: [&str; 6] =
    ["line_guide", "spool_drum", "spool_hub", "motor_cage", "flange_plate", "centring_ring"];
