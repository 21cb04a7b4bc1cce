//! When an object counts as held.

use hwasp_tasks::grasp::rules::{HOLD_DRIFT, HOLD_HEIGHT, HOLD_STEPS, HOLD_TOUCH};

/// One step of the hold.
#[derive(Clone, Copy, Debug, Default)]
struct Moment {
    clearance: f64,
    touches: bool,
    /// The object relative to the palm, m.
    held: [f64; 3],
}

/// The last steps of an episode.
#[derive(Clone, Debug)]
pub struct Hold {
    /// The last [`HOLD_STEPS`] steps, step t at t modulo their number.
    moments: Vec<Moment>,
    taken: usize,
}

impl Default for Hold {
    fn default() -> Self {
        Self { moments: vec![Moment::default(); HOLD_STEPS], taken: 0 }
    }
}

impl Hold {
    /// An episode begins.
    pub fn start(&mut self) {
        self.taken = 0;
    }

    /// The steps of the episode so far.
    pub fn steps(&self) -> usize {
        self.taken
    }

    /// A step of 10 ms: how high the object's lowest point is, m, which links touch it, and where palm and object are, m.
    pub fn note(&mut self, clearance: f64, touching: [bool; 6], palm: [f64; 3], object: [f64; 3]) {
        let digit = |d: usize| touching[2 * d] || touching[2 * d + 1];
        self.moments[self.taken % HOLD_STEPS] = Moment {
            clearance,
            touches: digit(0) && (digit(1) || digit(2)),
            held: [0, 1, 2].map(|i| object[i] - palm[i]),
        };
        self.taken += 1;
    }

    /// Whether the last steps were a hold.
    pub fn success(&self) -> bool {
        if self.taken < HOLD_STEPS {
            return false;
        }
        let first = self.moments[self.taken % HOLD_STEPS].held;
        let touches = self.moments.iter().filter(|m| m.touches).count();
        self.moments.iter().all(|m| m.clearance >= HOLD_HEIGHT && distance(m.held, first) <= HOLD_DRIFT)
            && touches as f64 >= HOLD_TOUCH * HOLD_STEPS as f64
    }
}

/// How far one point is from the other, m.
pub(super) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hold_is_high_and_still_and_touched() {
        let all = [true, false, false, false, false, true];
        let held = |change: &dyn Fn(usize) -> (f64, [bool; 6], f64)| {
            let mut hold = Hold::default();
            for step in 0..150 {
                let (clearance, touching, drift) = change(step);
                hold.note(clearance, touching, [0.0, 0.0, 0.3], [drift, 0.0, 0.25]);
            }
            hold.success()
        };
        assert!(held(&|_| (0.1, all, 0.0)));
        assert!(held(&|step| (if step < 50 { 0.0 } else { 0.1 }, all, 0.0)));
        assert!(!held(&|step| (if step < 51 { 0.0 } else { 0.1 }, all, 0.0)));
        assert!(held(&|step| (0.1, if step % 10 == 0 { [false; 6] } else { all }, 0.0)));
        assert!(!held(&|step| (0.1, if step % 9 == 0 { [false; 6] } else { all }, 0.0)));
        assert!(!held(&|step| (0.1, all, if step == 140 { 0.011 } else { 0.0 })));
        assert!(!held(&|_| (0.1, [true, true, false, false, false, false], 0.0)));
        assert!(!held(&|_| (0.1, [false, false, true, true, true, true], 0.0)));
        let mut short = Hold::default();
        (0..99).for_each(|_| short.note(0.2, all, [0.0; 3], [0.0; 3]));
        assert!(!short.success() && short.steps() == 99);
    }
}
