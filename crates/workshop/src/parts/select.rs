//! Which parts come nearest to a design.

use std::f64::consts::TAU;
use std::fmt;

use hwasp_fabrication::Workshop;
use hwasp_tasks::hand::names::{KIND_OF_JOINT, KINDS};
use hwasp_tasks::hand::{DESIGN_LEN, HandDescription};
use thiserror::Error;

use super::{CatalogueSpring, JointDesign, JointParts, PulleyPart, SpringCatalogue, SpringPart, TorsionSpring};

/// Limits of every design parameter, SI.
pub(super) type Limits = [(f64, f64); DESIGN_LEN];

/// Why there are no parts for a joint.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SelectError {
    /// No spring will do.
    #[error(
        "no spring of {springs} in the catalogue {catalogue} suits {joint}, which needs {} in {count} of them, wound up by up \
         to {:.0}°: {rejected}\n  = hint: give `hwasp parts` a catalogue with others, --catalogue FILE, or another workshop, --bench \
         KEY=VALUE",
        per_radian(*stiffness), deflection.to_degrees()
    )]
    Spring {
        /// The joint.
        joint: &'static str,
        /// The catalogue.
        catalogue: String,
        /// How many springs it has.
        springs: usize,
        /// Springs side by side.
        count: u32,
        /// What they should have together, N·m/rad.
        stiffness: f64,
        /// How far they are wound up with the joint closed, rad.
        deflection: f64,
        /// Why not.
        rejected: Rejected,
    },
    /// No groove will do.
    #[error(
        "no groove radius in steps of {} mm, and none from {:.3} mm on, puts the pulley of {joint} between {} and {} mm\n  = hint: \
         choose a finer step, --bench radius_step=…, or a thinner axle, --bench axle=…",
        1e3 * step, 1e3 * least, 1e3 * limits.0, 1e3 * limits.1
    )]
    Pulley {
        /// The joint.
        joint: &'static str,
        /// The step, m.
        step: f64,
        /// The least groove that has a wall around the axle, m.
        least: f64,
        /// Limits of the pulley's radius, m.
        limits: (f64, f64),
    },
}

fn per_radian(stiffness: f64) -> String {
    format!("{:.2} N·mm/rad", 1e3 * stiffness)
}

/// What keeps a spring from a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// The coil is too wide for its room.
    Wide,
    /// Wound up, it clamps the axle.
    Tight,
    /// Wound up, it is too long for its room.
    Long,
    /// It is stressed more than it may be.
    Stressed,
    /// Stiffness or preload would lie outside of the design's limits.
    Outside,
}

/// Springs that will not do, by the first reason of each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rejected {
    counts: [usize; 5],
}

impl fmt::Display for Rejected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let whys = [
            "too wide a coil",
            "too tight on the axle when wound up",
            "too long when wound up",
            "overstressed",
            "out of the design's limits with every hole",
        ];
        let told = self.counts.iter().zip(whys).filter(|(count, _)| **count > 0);
        f.write_str(&told.map(|(count, why)| format!("{count} {why}")).collect::<Vec<_>>().join(", "))
    }
}

/// What keeps a spring from being wound up by an angle, rad, in the room of a workshop; nothing if it will do.
pub fn unfit(spring: &TorsionSpring, deflection: f64, workshop: &Workshop) -> Option<Reason> {
    if spring.outer > workshop.coil_room {
        return Some(Reason::Wide);
    }
    if spring.inner_wound(deflection) < workshop.axle * (1.0 + workshop.clearance) {
        return Some(Reason::Tight);
    }
    if spring.length_wound(deflection) > workshop.spring_room {
        return Some(Reason::Long);
    }
    let stress = spring.stress(spring.rate() * deflection);
    (stress > workshop.stress_share * spring.strength).then_some(Reason::Stressed)
}

/// Parts for the four kinds of joints of a `design` (SI) whose parameters have `limits`.
pub fn select(
    hand: &HandDescription,
    design: &[f64; DESIGN_LEN],
    limits: &Limits,
    catalogue: &SpringCatalogue,
    workshop: &Workshop,
) -> Result<[JointParts; 4], SelectError> {
    let parts = |kind: usize| {
        let trained = JointDesign { radius: design[kind], stiffness: design[4 + kind], preload: design[8 + kind] };
        let limits = [0, 4, 8].map(|group| limits[group + kind]);
        let joint = Joint { kind, trained, limits, closed: hand.joint.range[1] };
        joint.parts(catalogue, workshop)
    };
    Ok([parts(0)?, parts(1)?, parts(2)?, parts(3)?])
}

/// A kind of joint that parts are wanted for.
struct Joint {
    kind: usize,
    trained: JointDesign,
    /// Limits of radius, stiffness and preload, SI.
    limits: [(f64, f64); 3],
    /// Its angle when it is closed, rad; open it is 0.
    closed: f64,
}

/// Inside of limits and not on them: there, a parameter cannot begin (and the last bit of a sum of angles is nothing).
fn inside(value: f64, (lo, hi): (f64, f64)) -> bool {
    let margin = 1e-9 * (hi - lo);
    value > lo + margin && value < hi - margin
}

impl Joint {
    fn parts(&self, catalogue: &SpringCatalogue, workshop: &Workshop) -> Result<JointParts, SelectError> {
        let pulley = self.pulley(workshop)?;
        let (entry, hole, springs) = self.springs(catalogue, workshop)?;
        let built = JointDesign { radius: pulley.groove_radius + 0.5 * pulley.line, ..springs };
        Ok(JointParts {
            joint: KINDS[self.kind].to_owned(),
            joints: KIND_OF_JOINT.iter().filter(|&&kind| kind == self.kind).count() as u32,
            trained: self.trained,
            built,
            pulley,
            spring: spring_part(entry, hole, built.preload + self.closed, workshop),
            torque_error: self.torque_error(&built),
        })
    }

    /// The groove whose pulley is nearest.
    fn pulley(&self, workshop: &Workshop) -> Result<PulleyPart, SelectError> {
        let (step, line, limits) = (workshop.radius_step, workshop.line, self.limits[0]);
        let least = workshop.least_groove();
        let nearest = ((self.trained.radius - 0.5 * line) / step).round();
        // At a limit the nearest step may lie beyond it; the last bit of a sum is nothing.
        let thinnest = (least / step - 1e-6).ceil();
        let grooves = [nearest, nearest - 1.0, nearest + 1.0, thinnest].map(|steps| steps * step);
        let fits = |groove: &f64| *groove > least - 1e-6 * step && inside(groove + 0.5 * line, limits);
        match grooves.into_iter().find(fits) {
            Some(groove_radius) => Ok(PulleyPart { groove_radius, line }),
            None => Err(SelectError::Pulley { joint: KINDS[self.kind], step, least, limits }),
        }
    }

    /// How far the springs' torque is off at worst, N·m. It is linear in the angle, and so at one of the ends.
    fn torque_error(&self, built: &JointDesign) -> f64 {
        [0.0, self.closed]
            .map(|at| (built.spring_torque(at) - self.trained.spring_torque(at)).abs())
            .into_iter()
            .fold(0.0, f64::max)
    }

    /// The spring and the hole whose torque is off least; the radius of what is returned is the trained one.
    fn springs<'c>(
        &self,
        catalogue: &'c SpringCatalogue,
        workshop: &Workshop,
    ) -> Result<(&'c CatalogueSpring, u32, JointDesign), SelectError> {
        let mut best: Option<(f64, (&CatalogueSpring, u32, JointDesign))> = None;
        let mut rejected = Rejected::default();
        for entry in &catalogue.springs {
            let mut why = Some(Reason::Outside);
            for hole in 0..workshop.holes() {
                let preload = (f64::from(hole) * workshop.hole_pitch - entry.leg_angle).rem_euclid(TAU);
                let stiffness = f64::from(workshop.springs) * entry.spring.rate();
                if !inside(stiffness, self.limits[1]) || !inside(preload, self.limits[2]) {
                    continue;
                }
                let reason = unfit(&entry.spring, preload + self.closed, workshop);
                // With another hole it is wound up less.
                if why.is_some() {
                    why = reason;
                }
                let built = JointDesign { stiffness, preload, ..self.trained };
                let error = self.torque_error(&built);
                if reason.is_none() && best.is_none_or(|(least, _)| error < least) {
                    best = Some((error, (entry, hole, built)));
                }
            }
            if let Some(reason) = why {
                rejected.counts[reason as usize] += 1;
            }
        }
        best.map(|(_, found)| found).ok_or_else(|| SelectError::Spring {
            joint: KINDS[self.kind],
            catalogue: catalogue.name.clone(),
            springs: catalogue.springs.len(),
            count: workshop.springs,
            stiffness: self.trained.stiffness,
            deflection: self.trained.preload + self.closed,
            rejected,
        })
    }
}

/// A spring of the catalogue in its place, wound up by `deflection`, rad, when the joint is closed.
fn spring_part(entry: &CatalogueSpring, hole: u32, deflection: f64, workshop: &Workshop) -> SpringPart {
    let spring = &entry.spring;
    let largest_torque = spring.rate() * deflection;
    let stress = spring.stress(largest_torque);
    SpringPart {
        part: entry.part.clone(),
        count: workshop.springs,
        wire: spring.wire,
        outer: spring.outer,
        inner: spring.inner(),
        turns: spring.turns,
        leg_angle: entry.leg_angle,
        leg: spring.leg,
        rate: spring.rate(),
        largest_torque,
        stress,
        stress_share: stress / spring.strength,
        inner_wound: spring.inner_wound(deflection),
        length_wound: spring.length_wound(deflection),
        hole,
    }
}
