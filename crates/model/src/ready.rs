//! A formula that is ready to run.

use hwasp_diff::ProgramTape;

use crate::robot::Formula;

/// A program that is ready to run, and where its numbers go.
#[derive(Debug)]
pub(crate) struct Ready {
    tape: ProgramTape<f64>,
    pub(crate) out: Vec<f64>,
}

impl Ready {
    pub(crate) fn new(formula: &Formula) -> Self {
        Self { tape: formula.program.tape(1), out: vec![0.0; formula.program.output_names().len()] }
    }

    pub(crate) fn bind(&mut self, formula: &Formula, design: &[f64]) {
        formula.program.bind(design, &mut self.tape);
    }

    pub(crate) fn run(&mut self, formula: &Formula, values: &[f64]) {
        formula.program.forward(values, 1, 1, &mut self.tape, &mut self.out, 1);
    }
}
