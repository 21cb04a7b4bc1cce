//! What all grasping tasks have in common: how long, how far and how fast, and what counts as success.

/// Steps of an episode, 10 ms each (paper, appendix B).
pub const HORIZON: usize = 500;
/// Motion of the palm in a step, ± m.
pub const PALM_STEP: f64 = 0.002;
/// Where the palm's target may be, m: from here to there in x, y and z.
pub const WORKSPACE: [[f64; 2]; 3] = [[-0.15, 0.15], [-0.15, 0.15], [0.02, 0.60]];

/// The steps at the end of an episode over which a grasp has to hold.
pub const HOLD_STEPS: usize = 100;
/// How high the object's lowest point has to be over all of them, m.
pub const HOLD_HEIGHT: f64 = 0.100;
/// The share of them in which thumb and a finger have to touch the object.
pub const HOLD_TOUCH: f64 = 0.9;
/// How far the object may move relative to the palm over them, m.
pub const HOLD_DRIFT: f64 = 0.010;
