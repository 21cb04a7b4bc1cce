//! The hand in numbers: everything about it that is not designed.
//!
//! Marks in the comments: [P] the paper (section 6, appendix B); [S] another public source, such as a data sheet; [M] our
//! choice. All in SI units.

mod finger;
mod transmission;

pub use finger::{FingerDescription, JointDescription, LinkDescription};
pub use transmission::TransmissionDescription;

use super::error::{HandError, positive, within};

/// Simulation steps of an environment step: 10 ms of 1 ms each \[P\].
pub const SUBSTEPS: usize = 10;

/// The palm and how it is held.
#[derive(Clone, Debug, PartialEq)]
pub struct PalmDescription {
    /// Mass, kg. 1 \[M\]; the physical palm has 0.26 to 0.5 \[S\], and what carries it is not without mass either.
    pub mass: f64,
    /// Half widths of its box along x, y and z, m; its lower face lies in the plane of the proximal joints \[M\].
    pub half_size: [f64; 3],
    /// Stiffness of the position control, N/m. 2500 \[M\]: at 1e4, 1 mm of actuation noise shakes the palm at 13 to 16 mm/s.
    pub position_gain: f64,
    /// Damping of the position control, N·s/m. 100 \[M\]: nearly critical with the palm's mass.
    pub velocity_gain: f64,
    /// The most force of either sign on each axis, N. 100 \[M\].
    pub force_limit: f64,
    /// Height of the palm's origin in the home pose, m \[M\].
    pub home_height: f64,
}

impl Default for PalmDescription {
    fn default() -> Self {
        Self {
            mass: 1.0,
            half_size: [0.037, 0.047, 0.010],
            position_gain: 2500.0,
            velocity_gain: 100.0,
            force_limit: 100.0,
            home_height: 0.300,
        }
    }
}

impl PalmDescription {
    /// Principal moments about its centre along x, y and z, kg·m²: those of a solid box. In the simulation it does not turn,
    /// and nothing depends on them.
    pub fn inertia(&self) -> [f64; 3] {
        let [x, y, z] = self.half_size;
        [y * y + z * z, x * x + z * z, x * x + y * y].map(|sum| self.mass / 3.0 * sum)
    }
}

/// The object as the model is compiled with it: a sphere. Tasks edit shape, size, mass, inertia and friction.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectDescription {
    /// Radius, m \[M\].
    pub radius: f64,
    /// Mass, kg \[M\].
    pub mass: f64,
    /// Coefficient of sliding friction, on hand and floor \[M\].
    pub friction: f64,
    /// Coefficient of torsional friction on hand and floor, m. 0.005 \[M\]: a soft pad's contact patch of some mm.
    pub torsional_friction: f64,
    /// Coefficient of rolling friction on the floor, m. 0.005 \[M\]: without it the disturbance rolls objects away before the
    /// hand arrives. There is none on the hand.
    pub rolling_friction: f64,
}

impl Default for ObjectDescription {
    fn default() -> Self {
        Self { radius: 0.030, mass: 0.300, friction: 0.75, torsional_friction: 0.005, rolling_friction: 0.005 }
    }
}

/// The whole hand.
#[derive(Clone, Debug, PartialEq)]
pub struct HandDescription {
    /// The thumb, on the side of negative y.
    pub thumb: FingerDescription,
    /// The two fingers that it opposes.
    pub fingers: [FingerDescription; 2],
    /// What all six joints have in common.
    pub joint: JointDescription,
    /// The palm.
    pub palm: PalmDescription,
    /// Motor, spool and tendons.
    pub transmission: TransmissionDescription,
    /// The object to begin with.
    pub object: ObjectDescription,
    /// Length of a simulation step, s. 0.001 \[P\].
    pub time_step: f64,
    /// Acceleration of gravity, m/s² (downwards).
    pub gravity: f64,
}

impl Default for HandDescription {
    fn default() -> Self {
        Self {
            // Finger spacing 50 mm, 70 mm between the rows [P].
            thumb: FingerDescription::thumb([0.0, -0.035, 0.0]),
            fingers: [FingerDescription::finger([0.025, 0.035, 0.0]), FingerDescription::finger([-0.025, 0.035, 0.0])],
            joint: JointDescription::default(),
            palm: PalmDescription::default(),
            transmission: TransmissionDescription::default(),
            object: ObjectDescription::default(),
            time_step: 0.001,
            gravity: 9.81,
        }
    }
}

impl HandDescription {
    /// Thumb, first and second finger: the order of [`DIGITS`](super::names::DIGITS).
    pub fn digits(&self) -> [&FingerDescription; 3] {
        [&self.thumb, &self.fingers[0], &self.fingers[1]]
    }

    /// Mass of palm and links, kg.
    pub fn mass(&self) -> f64 {
        self.palm.mass + self.digits().iter().map(|d| d.proximal.mass + d.distal.mass).sum::<f64>()
    }

    /// Length of an environment step, s.
    pub fn step_time(&self) -> f64 {
        SUBSTEPS as f64 * self.time_step
    }

    /// Whether a hand can be made of these numbers.
    pub fn check(&self) -> Result<(), HandError> {
        for (name, digit) in super::names::DIGITS.iter().zip(self.digits()) {
            digit.check(name)?;
        }
        self.joint.check()?;
        self.transmission.check()?;
        let (palm, object) = (&self.palm, &self.object);
        for (name, value, unit) in [
            ("palm.mass", palm.mass, "kg"),
            ("palm.half_size[0]", palm.half_size[0], "m"),
            ("palm.half_size[1]", palm.half_size[1], "m"),
            ("palm.half_size[2]", palm.half_size[2], "m"),
            ("palm.position_gain", palm.position_gain, "N/m"),
            ("palm.force_limit", palm.force_limit, "N"),
            ("object.radius", object.radius, "m"),
            ("object.mass", object.mass, "kg"),
            ("time_step", self.time_step, "s"),
        ] {
            positive(name, value, unit)?;
        }
        for (name, value, unit) in [
            ("palm.velocity_gain", palm.velocity_gain, "N·s/m"),
            ("palm.home_height", palm.home_height, "m"),
            ("object.friction", object.friction, ""),
            ("object.torsional_friction", object.torsional_friction, "m"),
            ("object.rolling_friction", object.rolling_friction, "m"),
            ("gravity", self.gravity, "m/s²"),
        ] {
            within(name, value, 0.0, f64::MAX, unit)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_open_hand_is_173_mm_wide() {
        let hand = HandDescription::default();
        let inside = |digit: &FingerDescription| {
            let reach = digit.proximal.length + digit.distal.length;
            digit.base[1].abs() + reach * hand.joint.rest_angle.sin() - digit.distal.radius
        };
        let opening = inside(&hand.thumb) + inside(&hand.fingers[0]);
        assert!((opening - 0.173).abs() < 5e-4, "{opening} m");
        assert!((hand.mass() - 1.0763).abs() < 1e-9);
    }

    #[test]
    fn impossible_numbers_are_refused_by_name() {
        let refused = |change: fn(&mut HandDescription)| {
            let mut hand = HandDescription::default();
            change(&mut hand);
            hand.check().unwrap_err().to_string()
        };
        assert_eq!(HandDescription::default().check(), Ok(()));
        assert_eq!(refused(|h| h.palm.mass = 0.0), "palm.mass = 0 kg is not a positive finite number");
        assert!(refused(|h| h.thumb.distal.length = f64::NAN).starts_with("thumb.distal.length = NaN m"));
        assert!(refused(|h| h.fingers[1].proximal.inertia[0] = 1.0).contains("no rigid body"));
        assert!(refused(|h| h.joint.range = [0.5, 0.2]).starts_with("joint.range[1] = 0.2 rad"));
        assert!(refused(|h| h.transmission.tension_limit = f64::INFINITY).starts_with("transmission.tension_limit"));
        assert!(refused(|h| h.object.friction = -1.0).starts_with("object.friction = -1"));
    }
}
