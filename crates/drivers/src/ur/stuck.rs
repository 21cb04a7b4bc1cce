//! A pose that does not change though it should.

use std::time::{Duration, Instant};

use crate::arm::Pose;

/// Closer to its target than this, m, an arm may rest.
const NEAR: f64 = 2e-3;

/// Since when the pose is what it is. The encoders of a living arm tremble in their last bits.
#[derive(Debug, Default)]
pub(super) struct Stillness {
    since: Option<(Instant, Pose)>,
}

impl Stillness {
    /// How far the tool is from its target, m, if it has one and its pose has not changed for `most`.
    pub(super) fn stuck(&mut self, at: Instant, tool: &Pose, target: Option<&Pose>, most: Duration) -> Option<f64> {
        let Some(target) = target else {
            self.since = None;
            return None;
        };
        match self.since {
            Some((since, pose)) if pose == *tool => {
                let away = tool.distance(target);
                (away > NEAR && at.saturating_duration_since(since) > most).then_some(away)
            }
            _ => {
                self.since = Some((at, *tool));
                None
            }
        }
    }
}
