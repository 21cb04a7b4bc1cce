//! What a robot is made of: a design space, a hardware law over it, a plant with a task (the environment), and a policy
//! that joins a controller and the law.
//!
//! Random streams have names and episodes have indices, so the number of threads changes no bit.

#![forbid(unsafe_code)]

pub mod bits;
mod check_env;
mod design;
mod environment;
mod executor;
pub mod gaussian;
mod hardware;
mod law;
mod mesh;
mod moments;
mod placement;
mod policy;
mod rollout;
mod schedule;
mod sight;
mod streams;
mod units;
mod watched;

pub use check_env::{EnvFault, MADE_FROM, check_env};
pub use design::{DesignError, DesignGroup, DesignSpace, Initial};
pub use environment::{
    CommandPort, End, EnvSpec, Environment, MOST_TERMS, MakeEnvironment, Outcome, Plant, Port, Robot, Step, Task,
};
pub use executor::{Executor, Serial, Threads};
pub use hardware::{Hardware, Ports};
pub use law::{Law, LawError};
pub use mesh::Mesh;
pub use moments::Moments;
pub use placement::{ActionDecoder, Placement, PlacementError};
pub use policy::{
    Actor, Anneal, HardwarePolicy, Noise, NoiseSizes, Normalizer, ParamGroup, ParamKind, Policy, PolicySpec,
    PolicyTape, Reparameterised, Rows, Spread,
};
pub use rollout::{Batch, Episode, EpisodeKind, EpisodeResult, Episodes, LaneSteps, RolloutError, Sampler, all_failed};
pub use schedule::{share_done, share_left};
pub use sight::{Cord, Form, Sight, Solid};
pub use streams::{Purpose, Stream, stream};
pub use units::{Dimension, Unit, UnitError, parse_quantity, split_quantity, unit};
pub use watched::{Watch, Watched};
