//! The names at the interface of laws and plant, written once.

use hwasp_core::{Dimension, Port, Ports};

/// A name with what it measures.
pub(super) type Named = (&'static str, Dimension);

/// The plant's privileged state.
pub(super) const STATE: &[Named] =
    &[("y1", Dimension::Length), ("v1", Dimension::Speed), ("y2", Dimension::Length), ("v2", Dimension::Speed)];
/// What the controller sees of it: y1 and v1.
pub(super) const OBSERVATION: &[Named] = STATE.split_at(2).0;
/// The motor.
pub(super) const MOTOR: Named = ("motor", Dimension::Force);
/// Effort of the springs.
pub(super) const EFFORT: &[Named] = &[("effort", Dimension::Force)];
/// Effort of the rigid bar.
pub(super) const LENGTH: &[Named] = &[("length", Dimension::Length)];
/// Efforts of the softened bar.
pub(super) const INTERFACE: &[Named] = &[("interface1", Dimension::Force), ("interface2", Dimension::Force)];

/// The ports of a law with these efforts.
pub(super) fn of_law(effort: &[Named]) -> Ports {
    let names = |ports: &[Named]| ports.iter().map(|(name, _)| (*name).to_owned()).collect();
    Ports { command: names(&[MOTOR]), state: names(STATE), effort: names(effort) }
}

/// The same for an environment.
pub(super) fn of_environment(ports: &[Named]) -> Vec<Port> {
    ports.iter().map(|&(name, dimension)| Port { name: name.to_owned(), dimension }).collect()
}
