//! Laws in Python: a function over traced numbers becomes the same program as a law in Rust, or as text.
//!
//! A traced number is a scalar of [`Formulas`], so that everything a formula of an experiment can say, a law in Python can say, too.

mod number;

use std::sync::Arc;

use hwasp_core::{DesignGroup, DesignSpace, Dimension, Initial, Law as CoreLaw, Ports, unit};
use hwasp_diff::{GradCheckSettings, gradcheck};
use hwasp_expr::{Formulas, Part};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::error::{self, Wrong};
use crate::value::kind;
pub(crate) use number::Number;
use number::{Tracing, lock};

/// A law of the hardware: design space, names, and the program.
#[pyclass(frozen, module = "hwasp._hwasp")]
#[derive(Clone)]
pub(crate) struct Law {
    pub(crate) traced: CoreLaw,
    formulas: Formulas,
    outputs: Vec<Part>,
}

/// A group of design parameters: name, unit, lower and upper limit, count, start.
type Group = (String, String, f64, f64, usize, Option<f64>);

/// What a unit measures.
pub(crate) fn dimension(symbol: &str) -> PyResult<Dimension> {
    let dotted = symbol.replace('*', "·");
    unit(&dotted).filter(|unit| unit.to_si == 1.0).map(|unit| unit.dimension).ok_or_else(|| {
        let known: Vec<&str> =
            Dimension::ALL.iter().map(|dimension| dimension.si()).filter(|si| !si.is_empty()).collect();
        error::input(format!("`{symbol}` is no unit of a law; they are SI: {}", known.join(", ")))
    })
}

/// Traces a law: `function` is called once with lists of traced numbers (design, commands, states) and gives the efforts.
#[pyfunction]
pub(crate) fn trace<'py>(
    py: Python<'py>,
    function: &Bound<'py, PyAny>,
    design: Vec<Group>,
    command: Vec<String>,
    state: Vec<String>,
    effort: Vec<String>,
) -> PyResult<Law> {
    let group = |(name, unit, lo, hi, count, initial): Group| {
        let initial = initial.map_or(Initial::Value(0.5 * (lo + hi)), Initial::Value);
        Ok(DesignGroup { name, dimension: dimension(&unit)?, lo, hi, count, initial })
    };
    let groups = design.into_iter().map(group).collect::<PyResult<Vec<_>>>()?;
    let space = DesignSpace::new(groups).map_err(Wrong::input)?;
    let tracing = Tracing::default();
    let number = |part| Bound::new(py, Number { tracing: Arc::clone(&tracing), part });
    let uniform = (0..space.len()).map(|i| number(lock(&tracing).uniform(i))).collect::<PyResult<Vec<_>>>()?;
    let columns = (0..command.len() + state.len()).map(|i| number(lock(&tracing).column(i)));
    let mut columns = columns.collect::<PyResult<Vec<_>>>()?;
    let states = columns.split_off(command.len());
    let efforts: Vec<Bound<'py, PyAny>> = function.call1((uniform, columns, states))?.extract()?;
    if efforts.len() != effort.len() {
        let (given, needed) = (efforts.len(), effort.len());
        return Err(error::input(format!("the law gives {given} efforts, and names {needed}: {}", effort.join(", "))));
    }
    let mut outputs = Vec::with_capacity(efforts.len());
    for (given, name) in efforts.iter().zip(&effort) {
        outputs.push(match (given.cast::<Number>(), given.extract::<f64>()) {
            (Ok(number), _) if Arc::ptr_eq(&number.get().tracing, &tracing) => number.get().part,
            (Ok(_), _) => return Err(PyValueError::new_err("numbers of two laws must not be mixed")),
            (_, Ok(value)) => lock(&tracing).constant(value),
            _ => return Err(PyTypeError::new_err(format!("the effort {name} is {}, no number", kind(given)))),
        });
    }
    let formulas = lock(&tracing).clone();
    let columns: Vec<String> = command.iter().chain(&state).cloned().collect();
    let named = effort.iter().cloned().zip(outputs.iter().copied()).collect();
    let program = formulas.program(&space.names(), &columns, named);
    let law = CoreLaw::from_program(program, space, Ports { command, state, effort }).map_err(Wrong::input)?;
    Ok(Law { traced: law, formulas, outputs })
}

/// Definitions, and a formula for each effort.
type Texts = (Vec<(String, String)>, Vec<String>);
/// A batch of rows.
type Rows<'py> = PyReadonlyArray2<'py, f64>;
/// Derivatives by design, commands and states.
type Cotangents<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>);

impl Law {
    /// Inputs as a program reads them: column after column.
    fn columns(&self, design: &[f64], command: &Rows<'_>, state: &Rows<'_>) -> PyResult<(Vec<f64>, usize)> {
        let (ports, needed) = (self.traced.ports(), self.traced.design().len());
        if design.len() != needed {
            return Err(error::input(format!(
                "the design has {} values, and the law {needed} parameters",
                design.len()
            )));
        }
        let (command, state) = (command.as_array(), state.as_array());
        let rows = command.nrows();
        for (what, found, names) in [("command", &command, &ports.command), ("state", &state, &ports.state)] {
            if found.shape() != [rows, names.len()] {
                let shape = found.shape();
                let message = format!("{what} has the shape {shape:?}; the law reads ({rows}, {})", names.len());
                return Err(error::input(message));
            }
        }
        let columns = command.columns().into_iter().chain(state.columns());
        Ok((columns.flat_map(|column| column.to_vec()).collect(), rows))
    }
}

#[pymethods]
impl Law {
    /// Efforts `[rows, E]` at one design and rows of commands and states, SI.
    fn efforts<'py>(
        &self,
        py: Python<'py>,
        design: Vec<f64>,
        command: Rows<'py>,
        state: Rows<'py>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (columns, rows) = self.columns(&design, &command, &state)?;
        let (program, outputs) = (self.traced.program(), self.outputs.len());
        let effort = py.detach(|| {
            let mut effort = vec![0.0; outputs * rows];
            let mut tape = program.tape::<f64>(rows.max(1));
            program.bind(&design, &mut tape);
            program.forward(&columns, rows, rows, &mut tape, &mut effort, rows);
            effort
        });
        by_rows(py, &effort, outputs, rows)
    }

    /// The way back: from cotangents of the efforts `[rows, E]` to those of design (summed over rows), commands and states.
    fn pullback<'py>(
        &self,
        py: Python<'py>,
        design: Vec<f64>,
        command: Rows<'py>,
        state: Rows<'py>,
        cotangent: Rows<'py>,
    ) -> PyResult<Cotangents<'py>> {
        let (columns, rows) = self.columns(&design, &command, &state)?;
        let (program, outputs) = (self.traced.program(), self.outputs.len());
        let cotangent = cotangent.as_array();
        if cotangent.shape() != [rows, outputs] {
            let shape = cotangent.shape();
            return Err(error::input(format!(
                "the cotangent has the shape {shape:?}; the law gives ({rows}, {outputs})"
            )));
        }
        let cotangent: Vec<f64> = cotangent.columns().into_iter().flat_map(|column| column.to_vec()).collect();
        let (back, by_design) = py.detach(|| {
            let mut tape = program.tape::<f64>(rows.max(1));
            program.bind(&design, &mut tape);
            let mut effort = vec![0.0; outputs * rows];
            program.forward(&columns, rows, rows, &mut tape, &mut effort, rows);
            let mut back = vec![0.0; columns.len()];
            program.vjp(&columns, rows, rows, &cotangent, rows, &mut tape, &mut back, rows);
            let mut by_design = vec![0.0; design.len()];
            program.vjp_uniform(&mut tape, &mut by_design);
            (back, by_design)
        });
        let (commands, states) = (self.traced.ports().command.len(), self.traced.ports().state.len());
        let (by_command, by_state) = back.split_at(commands * rows);
        Ok((
            PyArray1::from_vec(py, by_design),
            by_rows(py, by_command, commands, rows)?,
            by_rows(py, by_state, states, rows)?,
        ))
    }

    /// Compares the derivatives with finite differences; returns the largest relative error.
    fn gradcheck(&self, design: Vec<f64>, command: Rows<'_>, state: Rows<'_>) -> PyResult<f64> {
        let (columns, rows) = self.columns(&design, &command, &state)?;
        if rows == 0 {
            return Err(error::input("gradcheck takes a row at least"));
        }
        let checked = gradcheck(self.traced.program(), &design, &columns, &GradCheckSettings::default());
        Ok(checked.map_err(Wrong::input)?.max_relative_error)
    }

    /// The computational graph as SVG.
    fn svg(&self) -> String {
        self.traced.program().to_svg()
    }

    /// As text over these names of design parameters, and of commands and states: definitions, and a formula for each effort.
    fn text(&self, design: Vec<String>, columns: Vec<String>) -> PyResult<Texts> {
        let ports = self.traced.ports();
        let needed = [self.traced.design().len(), ports.command.len() + ports.state.len()];
        if [design.len(), columns.len()] != needed {
            return Err(PyValueError::new_err(format!(
                "there are {} and {} names, not {needed:?}",
                design.len(),
                columns.len()
            )));
        }
        let texts = self.formulas.text(&design, &columns, "law_", &self.outputs);
        Ok((texts.definitions, texts.formulas))
    }
}

/// Columns, one after the other, as an array of rows.
fn by_rows<'py>(py: Python<'py>, columns: &[f64], width: usize, rows: usize) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let at = |row: usize| (0..width).map(move |column| columns[column * rows + row]);
    PyArray1::from_iter(py, (0..rows).flat_map(at)).reshape([rows, width])
}
