//! A program run for one row at a time, by any number of threads.

use std::sync::{Arc, Mutex};

use hwasp_diff::{Program, ProgramTape};

/// Runs a program for single rows. Working memory is kept from call to call.
pub(super) struct RowRunner {
    program: Arc<Program>,
    /// As many as there ever were calls at the same time.
    idle: Mutex<Vec<Memory>>,
}

/// What one call needs.
struct Memory {
    tape: ProgramTape<f64>,
    /// The uniform inputs that the tape is bound to; none at first.
    bound: Option<Vec<f64>>,
    columns: Vec<f64>,
}

impl RowRunner {
    pub(super) fn new(program: Arc<Program>) -> Self {
        Self { program, idle: Mutex::new(Vec::new()) }
    }

    /// Fills `outputs` from the uniform inputs and the columns, which come in two pieces.
    pub(super) fn run(&self, uniforms: &[f64], columns: [&[f64]; 2], outputs: &mut [f64]) {
        let idle = self.idle().pop();
        let mut memory = idle.unwrap_or_else(|| Memory {
            tape: self.program.tape(1),
            bound: None,
            columns: vec![0.0; self.program.column_names().len()],
        });
        memory.bind(&self.program, uniforms);
        let (first, second) = memory.columns.split_at_mut(columns[0].len());
        first.copy_from_slice(columns[0]);
        second.copy_from_slice(columns[1]);
        self.program.forward(&memory.columns, 1, 1, &mut memory.tape, outputs, 1);
        self.idle().push(memory);
    }

    fn idle(&self) -> std::sync::MutexGuard<'_, Vec<Memory>> {
        self.idle.lock().expect("nothing panics while the list is locked")
    }
}

impl Memory {
    /// A design stays the same for an episode and more: only another one is bound, compared by its bits.
    fn bind(&mut self, program: &Program, uniforms: &[f64]) {
        let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).eq(uniforms.iter().map(|x| x.to_bits()));
        if self.bound.as_deref().is_some_and(bits) {
            return;
        }
        program.bind(uniforms, &mut self.tape);
        match &mut self.bound {
            Some(bound) => bound.copy_from_slice(uniforms),
            None => self.bound = Some(uniforms.to_vec()),
        }
    }
}
