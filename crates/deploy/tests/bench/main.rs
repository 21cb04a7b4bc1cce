//! The loop and its rules over doubles of arm and motor, in virtual time.

#![allow(clippy::unwrap_used)] // helpers of tests are tests too

mod doubles;
mod faults;
mod grasps;
mod identified;
mod logs;
