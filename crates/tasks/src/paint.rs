//! The colours of films.

/// What the controller moves.
pub(crate) const BODY: [u8; 3] = [0, 114, 178];
/// The same beside another one.
pub(crate) const SECOND: [u8; 3] = [86, 180, 233];
/// The mechanism that is designed.
pub(crate) const DESIGN: [u8; 3] = [213, 94, 0];
/// The same, every other part.
pub(crate) const DESIGN_TOO: [u8; 3] = [240, 178, 122];
/// The motor.
pub(crate) const MOTOR: [u8; 3] = [90, 96, 104];
/// What marks how it has turned, and strings.
pub(crate) const MARK: [u8; 3] = [150, 156, 164];
/// Where something has to be.
pub(crate) const GOAL: [u8; 3] = [0, 158, 115];
/// What holds the rest.
pub(crate) const STAND: [u8; 3] = [196, 200, 206];
