//! What commands add up to: in training and on the bench.

/// Where targets may be, and how fast they may move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The palm's, from and to, m: x, y and z.
    pub workspace: [[f64; 2]; 3],
    /// The most that the palm's target moves in a step, m.
    pub palm_step: f64,
    /// The most that the motor winds, m.
    pub travel: f64,
}

/// The targets of palm and spool: the sums of what was commanded, within bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Targets {
    /// m, in the world.
    pub palm: [f64; 3],
    /// m.
    pub travel: f64,
    bounds: Bounds,
}

impl Targets {
    /// From here.
    pub fn new(palm: [f64; 3], travel: f64, bounds: Bounds) -> Self {
        Self { palm, travel, bounds }
    }

    /// Moves them by a step of commands, m. A motion that is too fast is shortened, its direction stays.
    pub fn advance(&mut self, palm: [f64; 3], motor: f64) {
        let length = palm.iter().map(|x| x * x).sum::<f64>().sqrt();
        let share = if length > self.bounds.palm_step { self.bounds.palm_step / length } else { 1.0 };
        for ((target, motion), [lo, hi]) in self.palm.iter_mut().zip(palm).zip(self.bounds.workspace) {
            *target = (*target + share * motion).clamp(lo, hi);
        }
        self.travel = (self.travel + motor).clamp(0.0, self.bounds.travel);
    }

    /// Moves the palm's target towards a place by at most `step`, m; whether it is there.
    pub fn approach(&mut self, place: [f64; 3], step: f64) -> bool {
        let way = [0, 1, 2].map(|i| place[i] - self.palm[i]);
        let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length <= step {
            self.palm = place;
            return true;
        }
        self.palm = [0, 1, 2].map(|i| self.palm[i] + way[i] * step / length);
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn targets() -> Targets {
        let workspace = [[-0.15, 0.15], [-0.15, 0.15], [0.06, 0.5]];
        Targets::new([0.0, 0.0, 0.3], 0.0, Bounds { workspace, palm_step: 0.001, travel: 0.045 })
    }

    #[test]
    fn speed_and_workspace_are_kept() {
        let mut targets = targets();
        targets.advance([0.0012, 0.0, -0.0016], 0.0002);
        assert!((targets.palm[0] - 0.0006).abs() < 1e-12 && (targets.palm[2] - 0.2992).abs() < 1e-12, "{targets:?}");
        for _ in 0..1000 {
            targets.advance([0.002, -0.002, -0.002], 0.0002);
        }
        assert_eq!((targets.palm, targets.travel), ([0.15, -0.15, 0.06], 0.045));
        for _ in 0..1000 {
            targets.advance([0.0; 3], -0.0002);
        }
        assert_eq!(targets.travel, 0.0);
    }

    #[test]
    fn an_approach_arrives() {
        let mut targets = targets();
        let steps = (0..1000).take_while(|_| !targets.approach([0.03, 0.0, 0.34], 0.001)).count();
        assert_eq!(steps, 49);
        assert_eq!(targets.palm, [0.03, 0.0, 0.34]);
    }
}
