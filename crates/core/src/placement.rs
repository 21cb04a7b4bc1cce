//! Where a design parameter sits, and what an action therefore consists of.

use thiserror::Error;

use crate::environment::CommandPort;
use crate::law::Law;

/// Where one design parameter sits (paper, section 4).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Placement {
    /// In the computational graph: HWasP. The law is part of the policy, and its effort is sampled.
    Graph,
    /// In the action: HWasP-Minimal. The parameter is sampled at every step, and the plant evaluates the law.
    Action,
    /// Nowhere: it keeps this value, SI, which lies within the limits.
    Fixed(f64),
    /// Nowhere: the mechanism was built with this value, SI. Limits are for what is chosen; what came out of a workshop, with its
    /// errors, may lie outside of them.
    Built(f64),
}

impl Placement {
    /// The value that it keeps, SI, if it keeps one.
    pub fn kept(self) -> Option<f64> {
        match self {
            Self::Fixed(value) | Self::Built(value) => Some(value),
            Self::Graph | Self::Action => None,
        }
    }
}

/// Why a design cannot be placed so.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PlacementError {
    /// Not one place per parameter.
    #[error("{given} placements for {needed} design parameters")]
    Count {
        /// Places given.
        given: usize,
        /// Parameters there are.
        needed: usize,
    },
    /// A value outside of the limits.
    #[error("{name} fixed at {value} is outside its limits [{lo}, {hi}]")]
    Outside {
        /// The parameter.
        name: String,
        /// Its value.
        value: f64,
        /// Its lower limit.
        lo: f64,
        /// Its upper limit.
        hi: f64,
    },
    /// Law and plant do not fit.
    #[error("the law's {what} ports are {law:?}, the environment's are {environment:?}")]
    Ports {
        /// command, state or effort.
        what: &'static str,
        /// Names on the law's side.
        law: Vec<String>,
        /// Names on the environment's side.
        environment: Vec<String>,
    },
    /// Not one standard deviation per command.
    #[error("noise for {given} commands, but there are {needed}")]
    Noise {
        /// Standard deviations given.
        given: usize,
        /// Commands there are.
        needed: usize,
    },
}

/// The components of an action, in this order: design parameters in the action, efforts if any parameter is in the graph,
/// commands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ActionLayout {
    /// Indices of the design parameters in the action.
    pub(crate) sampled: Vec<usize>,
    /// Efforts in the action: the law's, or none.
    pub(crate) efforts: usize,
    /// Commands.
    pub(crate) commands: usize,
}

impl ActionLayout {
    pub(crate) fn new(placements: &[Placement], efforts: usize, commands: usize) -> Self {
        let sampled = (0..placements.len()).filter(|&i| placements[i] == Placement::Action).collect();
        let graph = placements.contains(&Placement::Graph);
        Self { sampled, efforts: if graph { efforts } else { 0 }, commands }
    }

    pub(crate) fn len(&self) -> usize {
        self.sampled.len() + self.efforts + self.commands
    }
}

/// Turns actions into what the environment takes. Where the effort is not in the action, the law is evaluated here, in
/// the simulator's numbers, on the command within the motors' limits.
#[derive(Clone, Debug)]
pub(crate) struct ActionDecoder {
    law: Law,
    layout: ActionLayout,
    limits: Vec<(f64, f64)>,
    /// The design of this step: fixed values, and the action's where it has them.
    design: Vec<f64>,
    pub(crate) effort: Vec<f64>,
    pub(crate) command: Vec<f64>,
}

impl ActionDecoder {
    pub(crate) fn new(law: &Law, placements: &[Placement], layout: &ActionLayout, ports: &[CommandPort]) -> Self {
        Self {
            law: law.clone(),
            layout: layout.clone(),
            limits: ports.iter().map(|p| (p.lo, p.hi)).collect(),
            design: placements.iter().map(|place| place.kept().unwrap_or(0.0)).collect(),
            effort: vec![0.0; law.ports().effort.len()],
            command: vec![0.0; ports.len()],
        }
    }

    /// Fills `effort` and `command` from an action at a state.
    #[inline]
    pub(crate) fn decode(&mut self, action: &[f64], state: &[f64]) {
        let (sampled, rest) = action.split_at(self.layout.sampled.len());
        let (efforts, commands) = rest.split_at(self.layout.efforts);
        for ((limited, &command), &(lo, hi)) in self.command.iter_mut().zip(commands).zip(&self.limits) {
            *limited = command.clamp(lo, hi);
        }
        if self.layout.efforts > 0 {
            self.effort.copy_from_slice(efforts);
            return;
        }
        for (&i, &value) in self.layout.sampled.iter().zip(sampled) {
            let (lo, hi) = self.law.design().bounds(i);
            self.design[i] = value.clamp(lo, hi);
        }
        self.law.effort(&self.design, &self.command, state, &mut self.effort);
    }
}
