//! Robots to learn with: the paper's mass-spring problem, its underactuated hand (the mechanism; grasping with it needs an
//! engine and is in `hwasp-mujoco`), the classic pendulum with a gear, and a point that has to reach a place, which any
//! learner solves in about a second.
//!
//! Every module gives a checked problem that hands out its [`Law`](hwasp_core::Law) and makes its environments. Physics
//! (plant), purpose (task) and mechanism (law) are separate types; none of them knows how it is trained. A module's `problem`
//! is its door to experiment files: it implements [`Problem`](hwasp_problem::Problem).

#![forbid(unsafe_code)]

pub mod grasp;
pub mod hand;
pub mod mass_spring;
pub mod pendulum;
pub mod reach;
