//! Checks of a program's derivatives at a point: reverse against finite differences, reverse against tangent.

use crate::{Program, ProgramTape};

/// How strict [`gradcheck`] is.
///
/// | name | default | purpose | range |
/// |---|---|---|---|
/// | `tolerance` | 1e-6 | largest relative error of an entry of the Jacobian | > 0 |
/// | `dot_product_tolerance` | 1e-12 | largest relative gap between wᵀ(Jv) and (Jᵀw)ᵀv | > 0 |
/// | `first_step` | 1e-2 | first step of the finite differences, relative to the input | (0, 1) |
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GradCheckSettings {
    /// The largest relative error of an entry of the Jacobian that passes.
    pub tolerance: f64,
    /// The largest relative gap between wᵀ(Jv) and (Jᵀw)ᵀv that passes.
    pub dot_product_tolerance: f64,
    /// The first step of the finite differences, relative to the size of the input.
    pub first_step: f64,
}

impl Default for GradCheckSettings {
    fn default() -> Self {
        Self { tolerance: 1e-6, dot_product_tolerance: 1e-12, first_step: 1e-2 }
    }
}

/// Derivatives much smaller than this cannot be told from rounding noise (in SI units of the output over the input).
const SMALLEST_SCALE: f64 = 1e-9;

/// What [`gradcheck`] found where everything passed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GradCheck {
    /// The largest relative error of an entry of the Jacobian against finite differences.
    pub max_relative_error: f64,
    /// The input of that entry (empty if there is no entry).
    pub worst_input: String,
    /// The output of that entry (empty if there is no entry).
    pub worst_output: String,
    /// The relative gap between wᵀ(Jv) and (Jᵀw)ᵀv for fixed irregular v and w over all rows.
    pub dot_product_error: f64,
}

/// Why a program's derivatives are not to be trusted at a point.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GradCheckError {
    /// The program's derivative and the finite differences differ.
    #[error(
        "d({output})/d({input}) in row {row}, at {input} = {at:e}: the program says {program:e}, \
         finite differences {numeric:e}; relative error {error:.1e} is above {tolerance:.1e}"
    )]
    Disagrees {
        /// The name of the output.
        output: String,
        /// The name of the input.
        input: String,
        /// The row of the columns.
        row: usize,
        /// The value of the input.
        at: f64,
        /// What the program's vjp says.
        program: f64,
        /// What finite differences say.
        numeric: f64,
        /// Their relative difference.
        error: f64,
        /// What was allowed.
        tolerance: f64,
    },
    /// A value or derivative is infinite or NaN.
    #[error("d({output})/d({input}) in row {row}, at {input} = {at:e}: value {value:e}, derivative {program:e}")]
    NotFinite {
        /// The name of the output.
        output: String,
        /// The name of the input.
        input: String,
        /// The row of the columns.
        row: usize,
        /// The value of the input.
        at: f64,
        /// The value of the output.
        value: f64,
        /// What the program's vjp says.
        program: f64,
    },
    /// The reverse and the tangent pass are not transposes of each other.
    #[error("w'(Jv) = {tangent:e} but (J'w)'v = {reverse:e}; relative gap {error:.1e} is above {tolerance:.1e}")]
    DotProduct {
        /// wᵀ(Jv), from the tangent pass.
        tangent: f64,
        /// (Jᵀw)ᵀv, from the reverse pass.
        reverse: f64,
        /// Their relative difference.
        error: f64,
        /// What was allowed.
        tolerance: f64,
    },
}

/// Checks the derivatives of `program` in `f64` at `uniforms` (U values) and `columns` (C × R values, column-major with
/// stride R; one or more rows R).
///
/// Every entry of the Jacobian is compared with Ridders' extrapolation of central differences. The difference is taken
/// relative to the larger of the two; where both are tiny, relative to a thousandth of what the output varies by over the
/// size of the input, and never less than 1e-9, below which finite differences are noise. Choose points away from the
/// kinks of `abs`, `min`, `max` and `clamp`: there finite differences are right to disagree.
///
/// # Panics
/// If there is not one value per uniform input, or the columns do not hold whole rows.
pub fn gradcheck(
    program: &Program,
    uniforms: &[f64],
    columns: &[f64],
    settings: &GradCheckSettings,
) -> Result<GradCheck, GradCheckError> {
    let width = program.column_names().len();
    let rows = columns.len().checked_div(width).unwrap_or(1);
    assert!(rows > 0 && rows * width == columns.len(), "{} values for {width} columns", columns.len());
    let mut report = GradCheck::default();
    for row in 0..rows {
        let mut point = uniforms.to_vec();
        point.extend((0..width).map(|c| columns[c * rows + row]));
        check_row(program, uniforms.len(), row, &point, settings, &mut report)?;
    }
    report.dot_product_error = check_dot_product(program, uniforms, columns, rows, settings)?;
    Ok(report)
}

/// Checks the Jacobian of one row, where `point` is the uniforms, then the row's column values.
fn check_row(
    program: &Program,
    uniforms: usize,
    row: usize,
    point: &[f64],
    settings: &GradCheckSettings,
    report: &mut GradCheck,
) -> Result<(), GradCheckError> {
    let mut tape = program.tape::<f64>(1);
    let outputs = program.output_names().len();
    let mut value = vec![0.0; outputs];
    let mut moved = point.to_vec();
    evaluate(program, uniforms, point, &mut tape, &mut value);
    for (o, output) in program.output_names().iter().enumerate() {
        let gradient = reverse(program, uniforms, point, o, &mut tape);
        // How much of the output is at stake: rounding noise is judged against it.
        let variation =
            gradient.iter().zip(point).map(|(slope, &x)| slope.abs() * size(x)).fold(value[o].abs(), f64::max);
        let names = program.uniform_names().iter().chain(program.column_names());
        for (j, input) in names.enumerate() {
            let size = size(point[j]);
            let numeric = ridders(settings.first_step * size, |step| {
                let mut out = vec![0.0; outputs];
                let mut at = |x: f64| {
                    moved[j] = x;
                    evaluate(program, uniforms, &moved, &mut tape, &mut out);
                    out[o]
                };
                let (hi, lo) = (point[j] + step, point[j] - step);
                let slope = (at(hi) - at(lo)) / (hi - lo);
                moved[j] = point[j];
                slope
            });
            let (at, exact) = (point[j], gradient[j]);
            let (input, output) = (input.clone(), output.clone());
            if !(value[o].is_finite() && exact.is_finite()) {
                return Err(GradCheckError::NotFinite { output, input, row, at, value: value[o], program: exact });
            }
            let scale = (exact.abs().max(numeric.abs())).max(1e-3 * variation / size).max(SMALLEST_SCALE);
            let error = if exact == numeric { 0.0 } else { (exact - numeric).abs() / scale };
            // Written so that a NaN from the finite differences fails too.
            if !matches!(error.partial_cmp(&settings.tolerance), Some(o) if o.is_le()) {
                let tolerance = settings.tolerance;
                return Err(GradCheckError::Disagrees {
                    output,
                    input,
                    row,
                    at,
                    program: exact,
                    numeric,
                    error,
                    tolerance,
                });
            }
            if error > report.max_relative_error || report.worst_input.is_empty() {
                report.max_relative_error = error;
                report.worst_input = input;
                report.worst_output = output;
            }
        }
    }
    Ok(())
}

/// The size of an input, which steps are relative to.
fn size(x: f64) -> f64 {
    x.abs().max(1e-2)
}

fn evaluate(program: &Program, uniforms: usize, point: &[f64], tape: &mut ProgramTape<f64>, out: &mut [f64]) {
    program.bind(&point[..uniforms], tape);
    program.forward(&point[uniforms..], 1, 1, tape, out, 1);
}

/// The gradient of output `o` by uniforms, then columns, in the one row of `point`.
fn reverse(program: &Program, uniforms: usize, point: &[f64], o: usize, tape: &mut ProgramTape<f64>) -> Vec<f64> {
    let mut cotangent = vec![0.0; program.output_names().len()];
    let mut gradient = vec![0.0; point.len()];
    evaluate(program, uniforms, point, tape, &mut cotangent);
    cotangent.fill(0.0);
    cotangent[o] = 1.0;
    let (by_uniform, by_column) = gradient.split_at_mut(uniforms);
    program.vjp(&point[uniforms..], 1, 1, &cotangent, 1, tape, by_column, 1);
    program.vjp_uniform(tape, by_uniform);
    gradient
}

/// Ridders' method: central differences `slope(step)` at shrinking steps, extrapolated to step zero; returns the entry of
/// the table whose neighbours agree best. (C. J. F. Ridders, Advances in Engineering Software 4(2), 1982.)
fn ridders(first: f64, mut slope: impl FnMut(f64) -> f64) -> f64 {
    const SIZE: usize = 12;
    const SHRINK: f64 = 1.6;
    let mut previous = [0.0; SIZE];
    let (mut best, mut best_error) = (f64::NAN, f64::INFINITY);
    let mut step = first;
    for i in 0..SIZE {
        let mut current = [0.0; SIZE];
        current[0] = slope(step);
        let mut factor = SHRINK * SHRINK;
        for j in 1..=i {
            current[j] = (current[j - 1] * factor - previous[j - 1]) / (factor - 1.0);
            factor *= SHRINK * SHRINK;
            let error = (current[j] - current[j - 1]).abs().max((current[j] - previous[j - 1]).abs());
            if error < best_error {
                (best, best_error) = (current[j], error);
            }
        }
        previous = current;
        step /= SHRINK;
    }
    best
}

/// Checks wᵀ(Jv) = (Jᵀw)ᵀv over all rows at once.
fn check_dot_product(
    program: &Program,
    uniforms: &[f64],
    columns: &[f64],
    rows: usize,
    settings: &GradCheckSettings,
) -> Result<f64, GradCheckError> {
    let mut tape = program.tape::<f64>(rows);
    let mut out = vec![0.0; program.output_names().len() * rows];
    let mut by_column = vec![0.0; columns.len()];
    let mut by_uniform = vec![0.0; uniforms.len()];
    let (w, v_uniform, v_column) = (irregular(out.len(), 1), irregular(uniforms.len(), 2), irregular(columns.len(), 3));
    program.bind(uniforms, &mut tape);
    program.forward(columns, rows, rows, &mut tape, &mut out, rows);
    program.vjp(columns, rows, rows, &w, rows, &mut tape, &mut by_column, rows);
    program.vjp_uniform(&mut tape, &mut by_uniform);
    program.bind_tangent(&v_uniform, &mut tape);
    program.jvp(columns, &v_column, rows, rows, &mut tape, &mut out, rows);
    let (tangent, size) = dot(&w, &out);
    let ((a, size_a), (b, size_b)) = (dot(&by_uniform, &v_uniform), dot(&by_column, &v_column));
    let reverse = a + b;
    let gap = (tangent - reverse).abs();
    let error = if gap == 0.0 { 0.0 } else { gap / size.max(size_a + size_b) };
    let tolerance = settings.dot_product_tolerance;
    if matches!(error.partial_cmp(&tolerance), Some(o) if o.is_le()) {
        Ok(error)
    } else {
        Err(GradCheckError::DotProduct { tangent, reverse, error, tolerance })
    }
}

/// The dot product, and the sum of the magnitudes of its terms.
fn dot(a: &[f64], b: &[f64]) -> (f64, f64) {
    a.iter().zip(b).fold((0.0, 0.0), |(sum, size), (a, b)| (sum + a * b, size + (a * b).abs()))
}

/// Fixed numbers without pattern in (-1, 1): the golden-ratio sequence.
fn irregular(len: usize, salt: usize) -> Vec<f64> {
    let golden = 0.618_033_988_749_894_9;
    (1..=len).map(|i| 2.0 * ((i as f64 + 0.37 * salt as f64) * golden).fract() - 1.0).collect()
}
