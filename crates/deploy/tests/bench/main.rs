//! The loop and its rules over doubles of arm and motor, in virtual time.

mod doubles;
mod faults;
mod grasps;
mod logs;
