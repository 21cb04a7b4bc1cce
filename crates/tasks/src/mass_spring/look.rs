//! How the masses look in films: from the front, at the places that they have, between a ceiling and the motor's drum.

use std::ops::Range;

use hwasp_core::{Cord, Form, Sight, Solid};

use super::{Coupling, MassSpringPlant, MassSpringSettings};
use crate::paint::{BODY, DESIGN, DESIGN_TOO, GOAL, MARK, MOTOR, SECOND, STAND};

/// The most springs or segments that are drawn; where there are more, each stands for several.
const MOST_SHOWN: usize = 10;
/// Bends of a spring.
const BENDS: usize = 11;
/// Half the height of a mass of 0.1 kg, m.
const HALF_HEIGHT: f64 = 0.012;
/// Half of what everything goes to the back, m.
const DEPTH: f64 = 0.03;
/// Half the width of the bar, m.
const BAR: f64 = 0.012;
/// So near to the goal, m, and so slow, m/s, it counts as there.
const THERE: [f64; 2] = [0.01, 0.05];

/// What is drawn besides the state.
#[derive(Clone, Debug)]
pub(super) struct Looks {
    goal: f64,
    max_position: f64,
    /// Half the heights of the masses, m.
    heights: [f64; 2],
    /// The most of one spring, N/m.
    stiffest: f64,
    /// SI; empty before it is told.
    design: Vec<f64>,
}

impl Looks {
    pub(super) fn new(settings: &MassSpringSettings) -> Self {
        let height = |mass: f64| HALF_HEIGHT * (mass / 0.1).cbrt().clamp(0.5, 2.0);
        Self {
            goal: settings.goal,
            max_position: settings.max_position,
            heights: [settings.upper_mass, settings.lower_mass].map(height),
            stiffest: settings.max_total_stiffness / settings.count as f64,
            design: Vec::new(),
        }
    }

    pub(super) fn set_design(&mut self, design: &[f64]) {
        self.design.clear();
        self.design.extend_from_slice(design);
    }

    pub(super) fn sight(&self, plant: &MassSpringPlant) -> Sight {
        let ((y1, _), (y2, v2)) = (plant.upper(), plant.lower());
        let [high, low] = self.heights;
        let wide = 0.36 * self.max_position;
        let block = |half: [f64; 3], z: f64, colour| Solid::new(Form::Box(half), [0.0, 0.0, z], colour);
        let ceiling = block([1.15 * wide, 1.2 * DEPTH, 0.01], high + 0.01, STAND).fixed();
        let goal = [-1.3, 1.3].map(|side| [side * wide, 1.5 * DEPTH, -self.goal]);
        let total: f64 = self.design.iter().sum();
        let lowest = match plant.coupling() {
            Coupling::FixedBar(length) => self.max_position + length,
            Coupling::GivenBar => self.max_position + total,
            Coupling::Free => self.max_position,
        };
        let radius = 3.0 * HALF_HEIGHT;
        let (floor, below) = (-lowest - low - 2.0 * radius, -y2 - low);
        let drum = [-1.0, 1.0].map(|side| [radius, side * DEPTH, floor]);
        let mut solids = vec![
            ceiling,
            Solid::rod(goal, 0.003, GOAL).fixed(),
            Solid::cylinder(drum, radius, MOTOR).fixed(),
            block([wide, DEPTH, high], -y1, BODY),
            block([wide, DEPTH, low], -y2, SECOND),
        ];
        let string = Cord::new(vec![[0.0, 0.0, below], [0.0, 0.0, floor]], MARK);
        let hung = |x: f64, across: f64, colour| {
            Cord::spring([[x, 0.0, high], [x, 0.0, high - y1]], [across, 0.0, 0.0], BENDS, colour)
        };
        let mut cords = vec![string];
        let about = if let Coupling::FixedBar(length) = plant.coupling() {
            solids.push(segment([y1, y1 + length], MARK));
            let slot = 0.95 * wide / self.shown() as f64;
            let spring = |(i, of): (usize, Range<usize>)| {
                let share = self.design[of.clone()].iter().sum::<f64>() / (of.len() as f64 * self.stiffest);
                let place = 2.0 * i as f64 + 1.0 - self.shown() as f64;
                hung(place * slot, 0.8 * slot * share.clamp(0.0, 1.0).sqrt(), DESIGN)
            };
            cords.extend(self.groups().enumerate().map(spring));
            format!("{} springs, {total:.1} N/m together", self.design.len())
        } else {
            let mut upper = 0.0;
            for (i, of) in self.groups().enumerate() {
                let lower = upper + self.design[of].iter().sum::<f64>() / total.max(f64::MIN_POSITIVE);
                let ends = [upper, lower].map(|share| y1 + share * (y2 - y1));
                solids.push(segment(ends, if i.is_multiple_of(2) { DESIGN } else { DESIGN_TOO }));
                upper = lower;
            }
            cords.push(hung(0.0, 0.3 * wide, MARK));
            format!("a bar of {:.1} mm", 1e3 * total)
        };
        let off = y2 - self.goal;
        let there = off.abs() < THERE[0] && v2.abs() < THERE[1];
        let side = if off > 0.0 { "below" } else { "above" };
        Sight {
            solids,
            cords,
            about,
            told: format!("{:.0} mm {side} the goal", 1e3 * off.abs()),
            moments: if there { vec!["at the goal"] } else { vec![] },
        }
    }

    /// Springs or segments that are drawn.
    fn shown(&self) -> usize {
        self.design.len().min(MOST_SHOWN)
    }

    /// The parameters that each one stands for.
    fn groups(&self) -> impl Iterator<Item = Range<usize>> {
        let (count, shown) = (self.design.len(), self.shown());
        (0..shown).map(move |i| i * count / shown..(i + 1) * count / shown)
    }
}

/// A part of the bar, before the masses, between two distances from the ceiling.
fn segment([from, to]: [f64; 2], colour: [u8; 3]) -> Solid {
    let half = [BAR, 0.3 * BAR, 0.5 * (to - from).abs()];
    Solid::new(Form::Box(half), [0.0, -DEPTH - BAR, -0.5 * (from + to)], colour)
}
