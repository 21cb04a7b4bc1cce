//! Where a design parameter sits, and what an action therefore consists of.

use thiserror::Error;

use crate::design::DesignSpace;
use crate::environment::CommandPort;
use crate::law::Law;

/// Where one design parameter sits (paper, section 4).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Placement {
    /// In the computational graph: HWasP. The law is part of the policy, and its effort is sampled.
    Graph,
    /// In the action: HWasP-Minimal. The parameter is sampled at every step, and the plant evaluates the law.
    Action,
    /// In the action, drawn once at the start of an episode and held: HWasP-Minimal at the rate at which a body can change. Its
    /// probability counts once an episode.
    Episode,
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
            Self::Graph | Self::Action | Self::Episode => None,
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
    /// Not one standard deviation per command, or per effort that is sampled.
    #[error("noise for {given} {what}, but there are {needed}")]
    Noise {
        /// commands or efforts.
        what: &'static str,
        /// Standard deviations given.
        given: usize,
        /// Commands or efforts there are.
        needed: usize,
    },
    /// A parameter that the world's model is made from, placed where it would change within an episode.
    #[error(
        "the world's model is made from {name}, which stays as it is during an episode: place it as Episode or Fixed, not as \
         {place:?}"
    )]
    Shaped {
        /// The parameter.
        name: String,
        /// Where it was placed.
        place: Placement,
    },
    /// A command that does nothing.
    #[error("nobody reads the command {name}: it is no port of the law, and plant and task leave it to the law")]
    Unread {
        /// The command.
        name: String,
    },
}

/// The components of an action, in this order: design parameters that are drawn once an episode, design parameters of every
/// step, efforts if any parameter is in the graph, commands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ActionLayout {
    /// Indices of the design parameters in the action, those that are drawn once an episode first.
    pub(crate) sampled: Vec<usize>,
    /// How many of them are drawn once an episode.
    pub(crate) drawn: usize,
    /// Efforts in the action: the law's, or none.
    pub(crate) efforts: usize,
    /// Indices of the commands in the action.
    pub(crate) commands: Vec<usize>,
    /// Indices of the others: only the law reads them, and its effort is sampled.
    pub(crate) unsampled: Vec<usize>,
}

impl ActionLayout {
    pub(crate) fn new(placements: &[Placement], efforts: usize, ports: &[CommandPort]) -> Self {
        let at = |place| (0..placements.len()).filter(move |&i| placements[i] == place);
        let sampled = at(Placement::Episode).chain(at(Placement::Action)).collect();
        let efforts = if placements.contains(&Placement::Graph) { efforts } else { 0 };
        let (commands, unsampled) = (0..ports.len()).partition(|&c| efforts == 0 || ports[c].direct);
        Self { sampled, drawn: at(Placement::Episode).count(), efforts, commands, unsampled }
    }

    pub(crate) fn len(&self) -> usize {
        self.sampled.len() + self.efforts + self.commands.len()
    }

    /// Limits of each component, SI; none of an effort.
    pub(crate) fn limits(&self, space: &DesignSpace, ports: &[CommandPort]) -> Vec<Option<(f32, f32)>> {
        let limits = |(lo, hi): (f64, f64)| Some((lo as f32, hi as f32));
        let sampled = self.sampled.iter().map(|&i| limits(space.bounds(i)));
        let commands = self.commands.iter().map(|&c| limits((ports[c].lo, ports[c].hi)));
        sampled.chain(std::iter::repeat_n(None, self.efforts)).chain(commands).collect()
    }
}

/// Turns actions into what the environment takes. Where the effort is not in the action, the law is evaluated here, in
/// the simulator's numbers, on the command within the motors' limits.
///
/// A rollout uses it on the actions of a policy ([`HardwarePolicy::action_decoder`](crate::HardwarePolicy::action_decoder)); so
/// does whoever brings actions of another learner.
#[derive(Clone, Debug)]
pub struct ActionDecoder {
    law: Law,
    layout: ActionLayout,
    limits: Vec<(f64, f64)>,
    /// Where the law's commands are among the environment's.
    reads: Vec<usize>,
    /// The law's commands.
    read: Vec<f64>,
    /// The design of this step: fixed values, and the action's where it has them.
    design: Vec<f64>,
    pub(crate) effort: Vec<f64>,
    pub(crate) command: Vec<f64>,
}

impl ActionDecoder {
    /// `reads` are the places of the law's commands among `ports`.
    pub(crate) fn new(
        (law, reads): (&Law, &[usize]),
        placements: &[Placement],
        layout: &ActionLayout,
        ports: &[CommandPort],
    ) -> Self {
        Self {
            law: law.clone(),
            layout: layout.clone(),
            limits: ports.iter().map(|p| (p.lo, p.hi)).collect(),
            reads: reads.to_vec(),
            read: vec![0.0; reads.len()],
            design: placements.iter().map(|place| place.kept().unwrap_or(0.0)).collect(),
            effort: vec![0.0; law.ports().effort.len()],
            command: vec![0.0; ports.len()],
        }
    }

    /// What the law gives the environment, SI, after [`decode`](Self::decode).
    pub fn effort(&self) -> &[f64] {
        &self.effort
    }

    /// The motors' commands, SI, within their limits, after [`decode`](Self::decode).
    pub fn command(&self) -> &[f64] {
        &self.command
    }

    /// Builds the hardware to another design, SI, as far as it is not in the action.
    ///
    /// # Panics
    /// If there is not one value for each parameter.
    pub fn build(&mut self, design: &[f64]) {
        self.design.copy_from_slice(design);
    }

    /// The law that acts.
    pub fn law(&self) -> &Law {
        &self.law
    }

    /// How many commands are not in the action, because only the law reads them and its effort is.
    pub fn unsampled(&self) -> usize {
        self.layout.unsampled.len()
    }

    /// Fills [`effort`](Self::effort) and [`command`](Self::command) from an action, and the commands that are not in it, at a
    /// state; all in SI.
    #[inline]
    pub fn decode(&mut self, action: &[f64], unsampled: &[f64], state: &[f64]) {
        let (sampled, rest) = action.split_at(self.layout.sampled.len());
        let (efforts, commands) = rest.split_at(self.layout.efforts);
        if unsampled.is_empty() {
            for ((limited, &command), &(lo, hi)) in self.command.iter_mut().zip(commands).zip(&self.limits) {
                *limited = command.clamp(lo, hi);
            }
        } else {
            let sent = self.layout.commands.iter().zip(commands).chain(self.layout.unsampled.iter().zip(unsampled));
            for (&c, &command) in sent {
                let (lo, hi) = self.limits[c];
                self.command[c] = command.clamp(lo, hi);
            }
        }
        if self.layout.efforts > 0 {
            self.effort.copy_from_slice(efforts);
            return;
        }
        for (&i, &value) in self.layout.sampled.iter().zip(sampled) {
            let (lo, hi) = self.law.design().bounds(i);
            self.design[i] = value.clamp(lo, hi);
        }
        // A law that reads as many as there are reads them all, in their order.
        let read = if self.reads.len() == self.command.len() {
            &self.command
        } else {
            for (read, &c) in self.read.iter_mut().zip(&self.reads) {
                *read = self.command[c];
            }
            &self.read
        };
        self.law.effort(&self.design, read, state, &mut self.effort);
    }
}
