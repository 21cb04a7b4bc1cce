//! When something is due that befalls the design beside the critics' slope.

use hwasp_algos::{Exchange, Persist, StateError};
use hwasp_diff::Scalar;

/// What is remembered of the design.
#[derive(Clone, Debug, Default)]
pub(crate) struct Watch {
    /// The stand-ins of its parameters when the replay was last emptied; none before it first could be.
    then: Vec<f32>,
    /// Steps of the simulator since it was last searched.
    unsearched: u64,
}

impl Watch {
    /// Whether one of the stand-ins has moved by more than this share of its range since this was last so.
    pub(crate) fn moved(&mut self, design: &[f32], most: f64) -> bool {
        let share = |u: f32| f64::from(u).sigmoid();
        let beyond = self.then.iter().zip(design).any(|(&then, &now)| (share(now) - share(then)).abs() > most);
        if beyond || self.then.is_empty() {
            self.then = design.to_vec();
        }
        beyond
    }

    /// Whether a search is due after so many steps more.
    pub(crate) fn due(&mut self, steps: usize, every: usize) -> bool {
        self.unsearched += steps as u64;
        let due = every > 0 && self.unsearched >= every as u64;
        if due {
            self.unsearched = 0;
        }
        due
    }
}

impl Persist for Watch {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        with.series("then", &mut self.then)?;
        with.number("unsearched", &mut self.unsearched)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// u of 0, 0.1 and 0.2 are 50, 52.5 and 55 % of a range.
    #[test]
    fn a_move_counts_from_where_it_was_last_noticed() {
        let mut watch = Watch::default();
        let moved = [0.0, 0.1, 0.2, 0.3, -0.1].map(|u| watch.moved(&[0.0, u], 0.04));
        assert_eq!(moved, [false, false, true, false, true]);
    }

    #[test]
    fn a_search_is_due_after_so_many_steps() {
        let mut watch = Watch::default();
        assert_eq!([400, 400, 400, 900].map(|steps| watch.due(steps, 1000)), [false, false, true, false]);
        assert!(!watch.due(1_000_000, 0));
    }
}
