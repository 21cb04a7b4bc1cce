//! What can be wrong with an environment.

use thiserror::Error;

use crate::environment::End;

/// Which promise an environment broke.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum EnvFault {
    /// A port without a name.
    #[error("the {kind} port {index} has no name")]
    Unnamed {
        /// Which list: observation, state, effort or command.
        kind: &'static str,
        /// Where in it.
        index: usize,
    },
    /// Two ports of one list with one name.
    #[error("two {kind} ports are called `{name}`")]
    Twice {
        /// Which list.
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// Nothing to see, or nothing to do.
    #[error("there is no {kind} port")]
    NoPort {
        /// Which list.
        kind: &'static str,
    },
    /// Limits of a motor that leave no room.
    #[error("command `{name}`: [{lo}, {hi}] is not an interval of finite numbers")]
    Limits {
        /// The command.
        name: String,
        /// Its lower limit.
        lo: f64,
        /// Its upper limit.
        hi: f64,
    },
    /// An episode without steps.
    #[error("the horizon is 0, but an episode has at least one step")]
    Horizon,
    /// A step that takes no time.
    #[error("the time step is {time_step} s, but it has to be positive and finite")]
    TimeStep {
        /// What the environment says, s.
        time_step: f64,
    },
    /// The law reads or drives other ports than the environment has.
    #[error("the law's {kind} ports are {law:?}, the environment's {environment:?}")]
    Ports {
        /// Which list.
        kind: &'static str,
        /// The names that the law has.
        law: Vec<String>,
        /// The names that the environment has.
        environment: Vec<String>,
    },
    /// A command that does nothing.
    #[error(
        "nobody reads command `{name}`: it is no port of the law, and `direct = false` says that plant and task do not either"
    )]
    Unread {
        /// The command.
        name: String,
    },
    /// A model made from what is no part of the design.
    #[error("the world's model is made from `{name}`, but the design has {groups:?}")]
    Shaped {
        /// The group that `shaped_by` names.
        name: String,
        /// The groups of the law's design.
        groups: Vec<String>,
    },
    /// A value that is not finite, or was not written.
    #[error("step {step}: {kind}[{index}] is {value}")]
    NotFinite {
        /// Observation, state, reward or end (0 none, 1 terminated, 2 truncated).
        kind: &'static str,
        /// Where in it.
        index: usize,
        /// What was found; NaN where nothing was written.
        value: f64,
        /// Steps since the reset.
        step: usize,
    },
    /// Physics that failed, or formulas that gave no number.
    #[error("step {step}: the physics failed: {why}")]
    Faulted {
        /// Steps since the reset.
        step: usize,
        /// What the environment says of it.
        why: String,
    },
    /// Two episodes that should be the same are not.
    #[error("step {step}: {cause}, but {kind}[{index}] is {first} once and {second} another time")]
    Differs {
        /// Why they should be the same.
        cause: &'static str,
        /// Observation, state, reward or end (0 none, 1 terminated, 2 truncated).
        kind: &'static str,
        /// Where in it.
        index: usize,
        /// The one value.
        first: f64,
        /// The other.
        second: f64,
        /// Steps since the reset.
        step: usize,
    },
    /// Random starts that are all the same, or a fixed start that is not.
    #[error("{distinct} different starts in {streams} random streams, where the start should be {}", if *.fixed { "fixed" } else { "random" })]
    Starts {
        /// How many starts were different.
        distinct: usize,
        /// How many streams were tried.
        streams: usize,
        /// Whether all should have been the same.
        fixed: bool,
    },
    /// An episode that does not end when, or as, it should.
    #[error("with a horizon of {horizon}, step {step} gave the end {end:?}, not {expected:?}")]
    End {
        /// The horizon.
        horizon: usize,
        /// Steps since the reset, this one included.
        step: usize,
        /// What it gave.
        end: Option<End>,
        /// What it should have given.
        expected: Option<End>,
    },
    /// A horizon that was asked for and is not there.
    #[error("a horizon of {asked} was asked for, but the environment says {found}")]
    Override {
        /// What was asked for.
        asked: usize,
        /// What the environment says.
        found: usize,
    },
}
