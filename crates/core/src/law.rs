//! A hardware law as data: its program, traced once, and how the simulator runs it.

mod fault;
mod row;

use std::fmt;
use std::sync::Arc;

use hwasp_diff::{Program, Var};

use crate::design::{DesignError, DesignGroup, DesignSpace, Initial};
use crate::environment::CommandPort;
use crate::hardware::{Hardware, Ports};
pub use fault::LawError;
use fault::check_names;
use row::RowRunner;

type Direct = dyn Fn(&[f64], &[f64], &[f64], &mut [f64]) + Send + Sync;
type AsBuilt = dyn Fn(&[f64]) -> Vec<f64> + Send + Sync;

/// A hardware law: a design space, the names of inputs and outputs, and a [`Program`] that is traced once and shared by
/// policies, drawings and exports.
///
/// It comes from arithmetic in Rust ([`Law::new`]) or from a program ([`Law::from_program`]). In the simulator the first
/// runs as it was compiled, the second runs its program; both give the bits of the program.
#[derive(Clone)]
pub struct Law {
    design: DesignSpace,
    ports: Ports,
    program: Arc<Program>,
    direct: Arc<Direct>,
    /// None where what is built is the design itself.
    as_built: Option<Arc<AsBuilt>>,
}

impl fmt::Debug for Law {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Law").field("design", &self.design).field("ports", &self.ports).finish_non_exhaustive()
    }
}

/// The names of a law's columns: commands, then states.
fn columns(ports: &Ports) -> Vec<String> {
    ports.command.iter().chain(&ports.state).cloned().collect()
}

impl Law {
    /// Traces a law that is written in Rust and erases its type. The simulator runs the compiled `f64` form.
    pub fn new<H: Hardware + 'static>(hardware: H) -> Self {
        let hardware = Arc::new(hardware);
        let (design, ports) = (hardware.design().clone(), hardware.ports());
        let commands = ports.command.len();
        let program = Program::trace(&design.names(), &columns(&ports), |u, c| {
            let mut effort = vec![hwasp_diff::Scalar::constant(0.0); ports.effort.len()];
            hardware.effort(u, &c[..commands], &c[commands..], &mut effort);
            ports.effort.iter().cloned().zip(effort).collect()
        });
        let built = Arc::clone(&hardware);
        Self {
            design,
            ports,
            program: Arc::new(program),
            direct: Arc::new(move |d, c, s, e| hardware.effort::<f64>(d, c, s, e)),
            as_built: Some(Arc::new(move |d| built.as_built(d))),
        }
    }

    /// Takes a program for a law: its uniform inputs are the design parameters (SI), its columns the commands and then the
    /// states, its outputs the efforts, each under the name that `design` and `ports` give it.
    ///
    /// ```
    /// use hwasp_core::{DesignGroup, DesignSpace, Dimension, Initial, Law, Ports};
    /// use hwasp_diff::Program;
    ///
    /// let stiffness = DesignGroup {
    ///     name: "stiffness".into(),
    ///     dimension: Dimension::Stiffness,
    ///     lo: 1.0,
    ///     hi: 9.0,
    ///     count: 1,
    ///     initial: Initial::Value(5.0),
    /// };
    /// let ports = Ports {
    ///     command: vec!["pull".into()],
    ///     state: vec!["position".into()],
    ///     effort: vec!["force".into()],
    /// };
    /// let spring = Program::trace(&["stiffness"], &["pull", "position"], |u, c| {
    ///     vec![("force".into(), c[0] - u[0] * c[1])]
    /// });
    /// let law = Law::from_program(spring, DesignSpace::new(vec![stiffness])?, ports)?;
    /// let mut force = [0.0];
    /// law.effort(&[4.0], &[1.0], &[0.5], &mut force);
    /// assert_eq!(force, [-1.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Where a count or a name differs.
    pub fn from_program(program: Program, design: DesignSpace, ports: Ports) -> Result<Self, LawError> {
        check_names("design parameters", program.uniform_names(), &design.names())?;
        check_names("commands and states", program.column_names(), &columns(&ports))?;
        check_names("efforts", program.output_names(), &ports.effort)?;
        let program = Arc::new(program);
        let runner = RowRunner::new(Arc::clone(&program));
        let direct = Arc::new(move |d: &[f64], c: &[f64], s: &[f64], e: &mut [f64]| runner.run(d, [c, s], e));
        Ok(Self { design, ports, program, direct, as_built: None })
    }

    /// The same law where it only approximates the part that is built: `program` says what to build. Its uniform inputs
    /// and its outputs are the design parameters (SI), and it has no columns. See [`Hardware::as_built`].
    ///
    /// # Errors
    /// Where a count or a name differs.
    pub fn building(mut self, program: Program) -> Result<Self, LawError> {
        let names = self.design.names();
        check_names("design parameters", program.uniform_names(), &names)?;
        check_names("commands and states", program.column_names(), &[])?;
        check_names("design parameters to build", program.output_names(), &names)?;
        let runner = RowRunner::new(Arc::new(program));
        self.as_built = Some(Arc::new(move |design| {
            let mut built = vec![0.0; design.len()];
            runner.run(design, [&[], &[]], &mut built);
            built
        }));
        Ok(self)
    }

    /// The same law whose parameters begin elsewhere.
    ///
    /// # Errors
    /// Where there is not one start for each group, or a start is outside of its group's limits.
    pub fn beginning(mut self, initial: &[Initial]) -> Result<Self, DesignError> {
        let (given, needed) = (initial.len(), self.design.groups().len());
        if given != needed {
            return Err(DesignError::Starts { given, needed });
        }
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

    /// Where the law's commands are among those of an environment, which has them in the same order, and may have others that
    /// the law does not read. None where one of them is missing or out of order.
    pub fn reads(&self, commands: &[CommandPort]) -> Option<Vec<usize>> {
        let mut places = commands.iter().enumerate();
        let mut place = |name: &String| places.find(|(_, port)| port.name == *name).map(|(place, _)| place);
        self.ports.command.iter().map(&mut place).collect()
    }

    /// The law in the simulator's numbers. Nothing is allocated, but by the first calls that run at the same time.
    pub fn effort(&self, design: &[f64], command: &[f64], state: &[f64], effort: &mut [f64]) {
        (self.direct)(design, command, state, effort);
    }

    /// The law over traced numbers, for composition into a larger program.
    pub fn effort_traced<'t>(&self, design: &[Var<'t>], command: &[Var<'t>], state: &[Var<'t>]) -> Vec<Var<'t>> {
        self.program.retrace(design, &[command, state].concat())
    }

    /// See [`Hardware::as_built`].
    pub fn as_built(&self, design: &[f64]) -> Vec<f64> {
        self.as_built.as_ref().map_or_else(|| design.to_vec(), |as_built| as_built(design))
    }

    /// The bare law: design parameters (SI) are uniform inputs, command and state are columns, efforts are outputs.
    pub fn program(&self) -> &Arc<Program> {
        &self.program
    }
}
