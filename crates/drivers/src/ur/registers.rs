//! The registers over which the driver speaks with its program on the controller.
//!
//! Registers 0 to 23 belong to the field buses of the controller, 24 to 47 to clients of RTDE (RTDE guide). `ur_rtde` takes those
//! from 0 or from 24 on for itself, as it is told, and leaves 36 to 43 to others: ours, so that it can look on. The program reads inputs of one packet together: the controller takes over packets between its periods.

/// Integer input: what to do, a [`Command`].
pub const COMMAND: u8 = 36;
/// Integer input: the command's number. A number that differs from the last makes the command a new one.
pub const NUMBER: u8 = 37;
/// Integer input: the heart. A new value says that whoever commands still lives.
pub const BEAT: u8 = 38;
/// Real inputs, this and the next five: the target, m and axis times angle in rad.
pub const TARGET: u8 = 36;
/// Real input: m/s of a straight move.
pub const SPEED: u8 = 42;
/// Integer output: what the program does, a [`Doing`].
pub const DOING: u8 = 36;
/// Integer output: the number of the command that it has taken.
pub const TAKEN: u8 = 37;
/// Integer output: the last value of the heart that it has seen.
pub const HEARD: u8 = 38;
/// Integer output: [`VERSION`] of the program.
pub const PROGRAM: u8 = 39;
/// Of the program; one that reads its registers otherwise has another.
pub const VERSION: i32 = 36_001;

/// What the program is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Stand still.
    Stand = 0,
    /// Follow the target.
    Follow = 1,
    /// Move straight to the target.
    Move = 2,
    /// Stand still and end.
    End = 9,
}

/// What the program says of itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Doing {
    /// It stands and waits.
    Standing = 1,
    /// It follows the target.
    Following = 2,
    /// It moves straight to the target.
    Moving = 3,
    /// The heart stopped: it stood still and has ended.
    Deserted = 4,
    /// It was told to end.
    Ended = 5,
}

impl Doing {
    /// What the register says, if that is anything.
    pub fn of(register: i32) -> Option<Self> {
        [Self::Standing, Self::Following, Self::Moving, Self::Deserted, Self::Ended]
            .into_iter()
            .find(|doing| *doing as i32 == register)
    }
}
