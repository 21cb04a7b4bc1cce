//! Digits: two links, two joints.

use super::super::error::{HandError, positive, within};

/// One link: a capsule from its joint to the next joint, or to the centre of the tip's hemisphere.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkDescription {
    /// Joint to joint, or joint to tip, m. 50 mm proximal, 40 mm distal \[P\].
    pub length: f64,
    /// Radius of the capsule, m. 12 mm \[P\]: the finger's diameter is 24 mm.
    pub radius: f64,
    /// Mass, kg. Proximal 12.7 g, of the thumb 12.8 g; distal 13.2 g, of the thumb 11.7 g \[S\].
    pub mass: f64,
    /// From the joint to the centre of mass, along the link, m. Proximal 18 mm, out of 16 to 20; distal 18.4 mm \[S\].
    pub centre: f64,
    /// Principal moments about the centre of mass, kg·m²: about the joint's axis, across link and axis, about the link.
    /// Proximal (2.42, 2.12, 0.69)e-6, distal (1.12, 0.93, 0.78)e-6 \[S\].
    pub inertia: [f64; 3],
}

impl LinkDescription {
    fn check(&self, name: &str) -> Result<(), HandError> {
        let inertia_name = format!("{name}.inertia");
        positive(&format!("{name}.length"), self.length, "m")?;
        positive(&format!("{name}.radius"), self.radius, "m")?;
        positive(&format!("{name}.mass"), self.mass, "kg")?;
        within(&format!("{name}.centre"), self.centre, 0.0, self.length, "m")?;
        for moment in self.inertia {
            positive(&inertia_name, moment, "kg·m²")?;
        }
        let largest = self.inertia.into_iter().fold(0.0, f64::max);
        if 2.0 * largest > self.inertia.iter().sum() {
            return Err(HandError::Inertia { name: inertia_name, inertia: self.inertia });
        }
        Ok(())
    }
}

/// A digit: a proximal link on the palm, a distal one on it. Both joints turn about x and close towards the plane y = 0; the
/// sign of `base[1]` says which way that is.
#[derive(Clone, Debug, PartialEq)]
pub struct FingerDescription {
    /// The proximal joint in the palm's frame, m \[M\] from the paper's spacings.
    pub base: [f64; 3],
    /// The link on the palm.
    pub proximal: LinkDescription,
    /// The link with the tip.
    pub distal: LinkDescription,
}

impl FingerDescription {
    /// One of the two fingers, with its proximal joint at `base`, m in the palm's frame.
    pub fn finger(base: [f64; 3]) -> Self {
        Self {
            base,
            proximal: LinkDescription {
                length: 0.050,
                radius: 0.012,
                mass: 0.0127,
                centre: 0.018,
                inertia: [2.42e-6, 2.12e-6, 0.69e-6],
            },
            distal: LinkDescription {
                length: 0.040,
                radius: 0.012,
                mass: 0.0132,
                centre: 0.0184,
                inertia: [1.12e-6, 0.93e-6, 0.78e-6],
            },
        }
    }

    /// The thumb, with its proximal joint at `base`, m in the palm's frame.
    pub fn thumb(base: [f64; 3]) -> Self {
        let mut thumb = Self::finger(base);
        thumb.proximal.mass = 0.0128;
        thumb.distal.mass = 0.0117;
        thumb
    }

    /// Which way the digit opens along y: 1 or -1.
    pub fn outward(&self) -> f64 {
        1f64.copysign(self.base[1])
    }

    pub(super) fn check(&self, name: &str) -> Result<(), HandError> {
        for (axis, &value) in self.base.iter().enumerate() {
            within(&format!("{name}.base[{axis}]"), value, -1.0, 1.0, "m")?;
        }
        self.proximal.check(&format!("{name}.proximal"))?;
        self.distal.check(&format!("{name}.distal"))
    }
}

/// What the six joints have in common, beside the springs, which are designed.
#[derive(Clone, Debug, PartialEq)]
pub struct JointDescription {
    /// How far outward from straight down both links point at angle 0, rad. 45° \[M\].
    pub rest_angle: f64,
    /// The hard stops, rad. 0 to 1.57 \[M\].
    pub range: [f64; 2],
    /// Viscous damping, N·m·s/rad. 0.01 \[M\]: a torque held for T on an elastic tendon acts as negative damping, and
    /// (T/2)·λ(`k_tend`·r·r') makes up for it: 0.0072 at T = 10 ms, 5 N/mm and two pulleys of 12 mm.
    pub damping: f64,
    /// Inertia added to the joint, kg·m². 1e-4 \[M\]: with less, joints are pushed through their stops.
    pub armature: f64,
    /// Time constant (s) and damping ratio of the stops. 0.005, 1 \[M\].
    pub stop: [f64; 2],
}

impl Default for JointDescription {
    fn default() -> Self {
        Self {
            rest_angle: std::f64::consts::FRAC_PI_4,
            range: [0.0, 1.57],
            damping: 0.01,
            armature: 1e-4,
            stop: [0.005, 1.0],
        }
    }
}

impl JointDescription {
    pub(super) fn check(&self) -> Result<(), HandError> {
        let pi = std::f64::consts::PI;
        within("joint.rest_angle", self.rest_angle, 0.0, pi / 2.0, "rad")?;
        within("joint.range[0]", self.range[0], -pi, pi, "rad")?;
        within("joint.range[1]", self.range[1], self.range[0], pi, "rad")?;
        within("joint.damping", self.damping, 0.0, f64::MAX, "N·m·s/rad")?;
        within("joint.armature", self.armature, 0.0, f64::MAX, "kg·m²")?;
        positive("joint.stop[0]", self.stop[0], "s")?;
        positive("joint.stop[1]", self.stop[1], "")
    }
}
