//! Hardware laws: what a mechanism does to a command, written once.

use hwasp_diff::Scalar;

use crate::design::DesignSpace;

/// The names of what goes into a law and what comes out.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Ports {
    /// Motor commands, as the controller gives them.
    pub command: Vec<String>,
    /// The plant's privileged state, as the law reads it.
    pub state: Vec<String>,
    /// What the mechanism does to the rest of the world.
    pub effort: Vec<String>,
}

/// A mechanism with physical parameters (the paper's hardware policy, section 4).
///
/// The law is ordinary arithmetic over [`Scalar`], without branches on values. That is all there is to write: run with
/// `f64` it acts inside the simulator; traced, it becomes part of the policy and is differentiated.
pub trait Hardware: Send + Sync {
    /// The parameters: names, SI units, limits, counts.
    fn design(&self) -> &DesignSpace;

    /// The names of commands, states and efforts; their lengths are those of the slices below.
    fn ports(&self) -> Ports;

    /// Fills `effort` from the design, the motors' command and the state, all in SI.
    fn effort<T: Scalar>(&self, design: &[T], command: &[T], state: &[T], effort: &mut [T]);

    /// What to build, where the law only approximates the part that is built: the design that the real mechanism
    /// should have. Most laws are what they say, and return the design unchanged.
    fn as_built(&self, design: &[f64]) -> Vec<f64> {
        design.to_vec()
    }
}
