//! The law: what the mechanism does with the motor's command. This is the file to write anew for a mechanism of your own.
//!
//! ```text
//!      ○ anchor, ANCHOR above the pivot
//!      │ \
//!      │   \  the spring, pulled from length zero
//!      │ θ  ╱\
//!      │  ╱   ● hook, HOOK along the arm
//!      │╱
//!      ⊙ pivot, with the motor
//! ```
//!
//! Such a spring turns the arm back by k·ANCHOR·HOOK·sin θ, and gravity turns it on by m·g·l·sin θ: at one stiffness the arm
//! stays wherever it is put (the balanced-arm lamp). The training has to find it.

use hwasp_core::{DesignError, DesignGroup, DesignSpace, Dimension, Hardware, Initial, Ports};
use hwasp_diff::Scalar;

use crate::arm::GRAVITY_MOMENT;

/// Height of the spring's anchor above the pivot, m.
pub(crate) const ANCHOR: f64 = 0.05;
/// Where the spring hooks into the arm, m from the pivot.
pub(crate) const HOOK: f64 = 0.1;

/// A motor at the pivot, beside a spring of free length zero.
pub(crate) struct Spring {
    design: DesignSpace,
}

impl Spring {
    /// The stiffness that carries the arm at every angle, N/m.
    pub(crate) const BALANCE: f64 = GRAVITY_MOMENT / (ANCHOR * HOOK);

    /// What may change: one stiffness. A mechanism may have many groups, each with a name, a unit, limits and a count.
    pub(crate) fn new() -> Result<Self, DesignError> {
        let stiffness = DesignGroup {
            name: "stiffness".into(),
            dimension: Dimension::Stiffness,
            lo: 0.0,
            hi: 1000.0,
            count: 1,
            initial: Initial::Value(800.0),
        };
        Ok(Self { design: DesignSpace::new(vec![stiffness])? })
    }
}

impl Hardware for Spring {
    fn design(&self) -> &DesignSpace {
        &self.design
    }

    /// The names have to be those of the task's ports (`hold.rs`), in the same order.
    fn ports(&self) -> Ports {
        let names = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
        Ports { command: names(&["motor"]), state: names(&["angle", "speed"]), effort: names(&["torque"]) }
    }

    /// The torque on the arm, N·m. Written once over a number type: the simulator runs it, and training differentiates it.
    ///
    /// So it must not branch on values. `if angle > limit` does not compile, and the compiler's advice, `T: PartialOrd`, leads
    /// nowhere: what is recorded once for training has to be right for every value. Say it without a branch:
    ///
    /// | instead of | write |
    /// |---|---|
    /// | a force that only pulls | `force.max(T::constant(0.0))` |
    /// | a motor with limits | `motor.clamp(-5.0, 5.0)` |
    /// | friction against the motion | `-(speed * 50.0).tanh() * FRICTION` |
    /// | a stop that pushes back beyond `LIMIT` | `-(angle - LIMIT).max(T::constant(0.0)) * STOP` |
    /// | one formula below `LIMIT` and another above | `here + ((angle - LIMIT) * 50.0).sigmoid() * (there - here)` |
    fn effort<T: Scalar>(&self, design: &[T], command: &[T], state: &[T], effort: &mut [T]) {
        let (stiffness, motor, angle) = (design[0], command[0], state[0]);
        effort[0] = motor - stiffness * (ANCHOR * HOOK) * angle.sin();
    }
}

#[cfg(test)]
mod tests {
    use hwasp_core::{Law, Plant};

    use super::*;
    use crate::arm::Arm;

    /// A fact that is known without any training: law and plant agree on it. Find one for your mechanism; it finds wrong signs
    /// and units.
    #[test]
    fn the_balanced_arm_stays_where_it_is_put() -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        let (law, mut arm) = (Law::new(Spring::new()?), Arm::default());
        for start in [-1.0, 0.2, 0.7] {
            arm.place(start);
            let (mut state, mut effort) = ([0.0; 2], [0.0]);
            for _ in 0..100 {
                arm.state(&mut state);
                law.effort(&[Spring::BALANCE], &[0.0], &state, &mut effort);
                arm.advance(&effort, &[0.0]);
            }
            assert!((arm.angle() - start).abs() < 1e-6, "put at {start} rad, it went to {} rad", arm.angle());
        }
        Ok(())
    }
}
