//! What numbers measure.

use std::fmt;

/// What a number of a model or of a sensor measures, in SI.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Quantity {
    /// A number without unit: components of unit vectors and quaternions, ratios, controls, whose unit is that of their
    /// actuator.
    Number,
    /// rad.
    Angle,
    /// rad/s.
    AngularVelocity,
    /// rad/s².
    AngularAcceleration,
    /// m.
    Length,
    /// m/s.
    Velocity,
    /// m/s².
    Acceleration,
    /// s.
    Time,
    /// kg.
    Mass,
    /// kg/m³.
    Density,
    /// kg·m².
    Inertia,
    /// N.
    Force,
    /// N·m.
    Torque,
    /// J.
    Energy,
    /// kg·m²/s.
    AngularMomentum,
    /// N/m.
    Stiffness,
    /// N·m/rad.
    TorsionalStiffness,
    /// N·s/m.
    Damping,
    /// N·m·s/rad.
    TorsionalDamping,
    /// Pa·s.
    Viscosity,
    /// T.
    MagneticFluxDensity,
    /// Pixels of a camera.
    Pixels,
    /// Several numbers of different kinds, or one whose unit depends on what the model does with it.
    Mixed,
}

impl Quantity {
    /// The unit's symbol; empty for pure and mixed numbers.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Number | Self::Mixed => "",
            Self::Angle => "rad",
            Self::AngularVelocity => "rad/s",
            Self::AngularAcceleration => "rad/s²",
            Self::Length => "m",
            Self::Velocity => "m/s",
            Self::Acceleration => "m/s²",
            Self::Time => "s",
            Self::Mass => "kg",
            Self::Density => "kg/m³",
            Self::Inertia => "kg·m²",
            Self::Force => "N",
            Self::Torque => "N·m",
            Self::Energy => "J",
            Self::AngularMomentum => "kg·m²/s",
            Self::Stiffness => "N/m",
            Self::TorsionalStiffness => "N·m/rad",
            Self::Damping => "N·s/m",
            Self::TorsionalDamping => "N·m·s/rad",
            Self::Viscosity => "Pa·s",
            Self::MagneticFluxDensity => "T",
            Self::Pixels => "px",
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Number => "a number",
            Self::Mixed => "numbers of different kinds",
            other => other.unit(),
        })
    }
}
