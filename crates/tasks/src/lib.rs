//! The problems that come with the program: the paper's mass-spring problem, its underactuated hand, the classic pendulum
//! with a gear, and a point that has to reach a place, which any learner solves in about a second. Grasping with the hand needs
//! an engine; its physics are in `hwasp-mujoco`.
//!
//! Every module has a checked problem with its [`Law`](hwasp_core::Law) and its environments. Physics (plant), purpose (task)
//! and mechanism (law) are separate types, and none of them knows how it is trained. The file `problem` of a module implements
//! [`Problem`](hwasp_problem::Problem), by which experiment files name it.

#![forbid(unsafe_code)]

pub mod grasp;
pub mod hand;
pub mod mass_spring;
mod paint;
pub mod pendulum;
pub mod reach;
