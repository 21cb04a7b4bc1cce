//! Hardware laws: what a mechanism does to a command, written once.

use std::fmt;
use std::sync::Arc;

use hwasp_diff::{Program, Scalar};

use crate::design::{DesignError, DesignGroup, DesignSpace, Initial};

/// The names of what goes into a law and what comes out.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Ports {
    /// Motor commands, as the controller gives them.
    pub command: Vec<String>,
    /// The plant's privileged state, as the law reads it.
    pub state: Vec<String>,
    /// What the mechanism does to the rest of the world.
    pub effort: Vec<String>,
}

/// A mechanism with physical parameters (the paper's hardware policy, section 4).
///
/// The law is ordinary arithmetic over [`Scalar`], without branches on values. That is all there is to write: run with
/// `f64` it acts inside the simulator; traced, it becomes part of the policy and is differentiated.
pub trait Hardware: Send + Sync {
    /// The parameters: names, SI units, limits, counts.
    fn design(&self) -> &DesignSpace;

    /// The names of commands, states and efforts; their lengths are those of the slices below.
    fn ports(&self) -> Ports;

    /// Fills `effort` from the design, the motors' command and the state, all in SI.
    fn effort<T: Scalar>(&self, design: &[T], command: &[T], state: &[T], effort: &mut [T]);

    /// What to build, where the law only approximates the part that is built: the design that the real mechanism
    /// should have. Most laws are what they say, and return the design unchanged.
    fn as_built(&self, design: &[f64]) -> Vec<f64> {
        design.to_vec()
    }
}

type Direct = dyn Fn(&[f64], &[f64], &[f64], &mut [f64]) + Send + Sync;
type AsBuilt = dyn Fn(&[f64]) -> Vec<f64> + Send + Sync;

/// A [`Hardware`] law with its type erased: the direct form for the simulator and a way to trace it.
#[derive(Clone)]
pub struct Law {
    design: DesignSpace,
    ports: Ports,
    direct: Arc<Direct>,
    as_built: Arc<AsBuilt>,
    trace: Arc<dyn TraceLaw>,
}

impl fmt::Debug for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Law").field("design", &self.design).field("ports", &self.ports).finish_non_exhaustive()
    }
}

/// The one instance of a law over traced numbers, behind a vtable.
trait TraceLaw: Send + Sync {
    fn effort<'t>(
        &self,
        design: &[hwasp_diff::Var<'t>],
        command: &[hwasp_diff::Var<'t>],
        state: &[hwasp_diff::Var<'t>],
        effort: &mut [hwasp_diff::Var<'t>],
    );
}

struct Traceable<H>(Arc<H>);

impl<H: Hardware> TraceLaw for Traceable<H> {
    fn effort<'t>(
        &self,
        design: &[hwasp_diff::Var<'t>],
        command: &[hwasp_diff::Var<'t>],
        state: &[hwasp_diff::Var<'t>],
        effort: &mut [hwasp_diff::Var<'t>],
    ) {
        self.0.effort(design, command, state, effort);
    }
}

impl Law {
    /// Erases the type of a law.
    pub fn new<H: Hardware + 'static>(hardware: H) -> Self {
        let hardware = Arc::new(hardware);
        let (direct, built) = (Arc::clone(&hardware), Arc::clone(&hardware));
        Self {
            design: hardware.design().clone(),
            ports: hardware.ports(),
            direct: Arc::new(move |d, c, s, e| direct.effort::<f64>(d, c, s, e)),
            as_built: Arc::new(move |d| built.as_built(d)),
            trace: Arc::new(Traceable(hardware)),
        }
    }

    /// The same law whose parameters begin elsewhere: at one start for each group.
    pub fn beginning(mut self, initial: &[Initial]) -> Result<Self, DesignError> {
        let groups = self.design.groups().iter().zip(initial);
        self.design = DesignSpace::new(groups.map(|(g, &initial)| DesignGroup { initial, ..g.clone() }).collect())?;
        Ok(self)
    }

    /// The parameters.
    pub fn design(&self) -> &DesignSpace {
        &self.design
    }

    /// The names of inputs and outputs.
    pub fn ports(&self) -> &Ports {
        &self.ports
    }

    /// The law in the simulator's numbers.
    pub fn effort(&self, design: &[f64], command: &[f64], state: &[f64], effort: &mut [f64]) {
        (self.direct)(design, command, state, effort);
    }

    /// The law over traced numbers, for composition into a larger program.
    pub fn effort_traced<'t>(
        &self,
        design: &[hwasp_diff::Var<'t>],
        command: &[hwasp_diff::Var<'t>],
        state: &[hwasp_diff::Var<'t>],
    ) -> Vec<hwasp_diff::Var<'t>> {
        let mut effort = vec![hwasp_diff::Var::constant(0.0); self.ports.effort.len()];
        self.trace.effort(design, command, state, &mut effort);
        effort
    }

    /// See [`Hardware::as_built`].
    pub fn as_built(&self, design: &[f64]) -> Vec<f64> {
        (self.as_built)(design)
    }

    /// The bare law as a program: design parameters (SI) are uniform inputs, command and state are columns. For drawing
    /// and for derivative checks.
    pub fn program(&self) -> Program {
        let design = self.design.names();
        let columns: Vec<String> = self.ports.command.iter().chain(&self.ports.state).cloned().collect();
        let commands = self.ports.command.len();
        Program::trace(&design, &columns, |u, c| {
            let effort = self.effort_traced(u, &c[..commands], &c[commands..]);
            self.ports.effort.iter().cloned().zip(effort).collect()
        })
    }
}
