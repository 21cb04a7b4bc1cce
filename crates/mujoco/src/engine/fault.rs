//! What a simulation reports instead of going on with a broken state.

use std::fmt;

/// The engine's warnings; each is a fault here. `mjtWarning`, in its order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Warning {
    /// The inertia matrix is (almost) singular.
    Inertia,
    /// Contacts were dropped: there was no memory left for them.
    ContactsFull,
    /// Constraints were dropped: there was no memory left for them.
    ConstraintsFull,
    /// A position is not finite or above 1e10. The engine has reset the state.
    BadPosition,
    /// A velocity is not finite or above 1e10. The engine has reset the state.
    BadVelocity,
    /// An acceleration is not finite or above 1e10. The engine has reset the state.
    BadAcceleration,
    /// A control is not finite or above 1e10. The engine has set the controls to zero.
    BadControl,
}

impl Warning {
    /// All, in the order of the engine's counters.
    pub(super) const ALL: [Self; 7] = [
        Self::Inertia,
        Self::ContactsFull,
        Self::ConstraintsFull,
        Self::BadPosition,
        Self::BadVelocity,
        Self::BadAcceleration,
        Self::BadControl,
    ];
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Inertia => "singular inertia",
            Self::ContactsFull => "no memory for more contacts",
            Self::ConstraintsFull => "no memory for more constraints",
            Self::BadPosition => "bad position",
            Self::BadVelocity => "bad velocity",
            Self::BadAcceleration => "bad acceleration",
            Self::BadControl => "bad control",
        })
    }
}

/// The physics has broken down; the state means nothing any more until the simulation is reset.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("the physics broke down at {time} s: {warning} at index {index} ({message}); reset the simulation")]
pub struct PhysicsFault {
    /// What the engine warned of. Several at once: the first in the order of [`Warning`].
    pub warning: Warning,
    /// Simulation time before the step in which it happened, s.
    pub time: f64,
    /// The degree of freedom, control, or number of contacts or constraints that it is about.
    pub index: usize,
    /// The engine's own words, or ours where it has none.
    pub message: String,
}
