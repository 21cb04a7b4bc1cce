//! Which moments of a grasp a sheet shows.

use hwasp_grasp::Still;

/// Pictures in a row of a sheet.
pub const MOMENTS: usize = 6;

/// Over the floor by more than this, m, an object counts as lifted.
const OFF_THE_FLOOR: f64 = 0.002;
/// Half of what success asks for, and all of it, m.
const HEIGHTS: [f64; 2] = [0.050, 0.100];

/// One moment of an episode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Moment {
    /// The step.
    pub step: usize,
    /// What happens there; empty where nothing of note does.
    pub name: &'static str,
}

/// Start, first contact, closed (just before the object leaves the floor), raised by 5 and by 10 cm, end. What does not
/// happen, or not in this order, makes room for moments evenly spread between its neighbours.
pub fn moments(stills: &[Still]) -> [Moment; MOMENTS] {
    let end = stills.len().saturating_sub(1);
    let first = |seen: &dyn Fn(&Still) -> bool| stills.iter().position(seen);
    let closed = first(&|s| s.clearance > OFF_THE_FLOOR).map(|step| step.saturating_sub(1));
    let raised = HEIGHTS.map(|height| first(&|s| s.clearance >= height));
    let found = [Some(0), first(&|s| s.touches), closed, raised[0], raised[1], Some(end)];
    let names = ["start", "contact", "closed", "raised 5 cm", "raised 10 cm", "end"];
    let mut chosen = [Moment { step: 0, name: names[0] }; MOMENTS];
    let mut last = 0;
    for i in 1..MOMENTS {
        let room = |step: &usize| (chosen[last].step + 1..=end).contains(step) && (i + 1 == MOMENTS || *step < end);
        let Some(step) = found[i].filter(room).or((i + 1 == MOMENTS).then_some(end)) else { continue };
        chosen[i] = Moment { step, name: names[i] };
        let from = chosen[last].step;
        for between in last + 1..i {
            let step = from + (step - from) * (between - last) / (i - last);
            chosen[between] = Moment { step, name: "" };
        }
        last = i;
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An episode by its object's clearance, m, in steps of which the ones from `touched` on touch it.
    fn steps(clearances: impl Iterator<Item = f64>, touched: usize) -> Vec<(f64, bool)> {
        clearances.enumerate().map(|(step, clearance)| (clearance, step >= touched)).collect()
    }

    fn chosen(episode: &[(f64, bool)]) -> [(usize, &'static str); MOMENTS] {
        let still = |&(clearance, touches): &(f64, bool)| Still { positions: Vec::new(), clearance, touches };
        let stills: Vec<Still> = episode.iter().map(still).collect();
        moments(&stills).map(|moment| (moment.step, moment.name))
    }

    #[test]
    fn a_grasp_has_all_of_them() {
        // On the floor until step 200, then up by 1 mm a step.
        let lifted = steps((0..=500).map(|t| (f64::from(t) - 200.0).max(0.0) * 1e-3), 120);
        let named = [
            (0, "start"),
            (120, "contact"),
            (202, "closed"),
            (250, "raised 5 cm"),
            (300, "raised 10 cm"),
            (500, "end"),
        ];
        assert_eq!(chosen(&lifted), named);
    }

    #[test]
    fn what_does_not_happen_makes_room() {
        let left = steps((0..=500).map(|_| 0.0), 100);
        assert_eq!(chosen(&left), [(0, "start"), (100, "contact"), (200, ""), (300, ""), (400, ""), (500, "end")]);
        let never = steps((0..=500).map(|_| 0.0), 1000);
        assert_eq!(chosen(&never).map(|(step, _)| step), [0, 100, 200, 300, 400, 500]);
        // Dropped half-way.
        let dropped =
            steps((0..=500).map(|t| if (200..260).contains(&t) { f64::from(t - 199) * 1e-3 } else { 0.0 }), 100);
        let named = [(0, "start"), (100, "contact"), (201, "closed"), (249, "raised 5 cm"), (374, ""), (500, "end")];
        assert_eq!(chosen(&dropped), named);
    }

    #[test]
    fn short_episodes_repeat_themselves() {
        assert_eq!(chosen(&steps(std::iter::once(0.0), 0)).map(|(step, _)| step), [0; MOMENTS]);
        assert_eq!(chosen(&steps([0.0, 0.2].into_iter(), 0)).map(|(step, _)| step), [0, 0, 0, 0, 0, 1]);
    }
}
