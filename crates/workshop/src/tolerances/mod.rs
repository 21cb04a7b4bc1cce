//! Which part has to be precise. Each design parameter in turn is off by its manufacturing error; return and success are measured
//! on the same held-out episodes.

mod errors;
mod list;

use std::path::Path;

use hwasp_plot::{Plot, TornadoRow, tornado_plot, write_plot};
use hwasp_runs::files::{self, Disk};
use hwasp_runs::{encode, io_error};
use hwasp_training::{Assembly, Collector, EvaluateError, Reference};

pub use self::errors::{ManufacturingError, ManufacturingErrorFault, manufacturing_errors};
pub use self::list::{Sensitivities, Sensitivity, Side};
use crate::error::WorkshopError;
use crate::folder::writable;

/// The sensitivities as programs have them.
pub const TOLERANCES: &str = "tolerances.json";
/// Their pictures.
pub const PICTURES: [&str; 2] = ["tolerances.svg", "tolerances.png"];

/// An error for each parameter of the design in `params`; see [`manufacturing_errors`].
pub fn errors_of(
    assembly: &Assembly,
    params: &[f32],
    given: &[String],
) -> Result<Vec<ManufacturingError>, ManufacturingErrorFault> {
    let mechanism = assembly.experiment().task.built().mechanism.as_ref();
    let common = mechanism.map(|mechanism| mechanism.manufacturing_errors()).unwrap_or_default();
    manufacturing_errors(assembly.policy.space(), &assembly.built(params), &common, given)
}

/// Simulates the design in `params` as it should be built, and with every parameter off by its error to either side: `asked`
/// are episodes and the root seed of their starts. `watch` is told how many designs are done, of how many.
///
/// An error may put a parameter outside of the limits that the design was searched in.
pub fn tolerances(
    assembly: &Assembly,
    params: &[f32],
    errors: &[ManufacturingError],
    asked: (u64, u64),
    collector: &dyn Collector,
    watch: &mut dyn FnMut(usize, usize),
) -> Result<Sensitivities, EvaluateError> {
    let (spec, space) = (assembly.experiment(), assembly.policy.space());
    let built = assembly.built(params);
    let (mut done, all) = (0, 1 + 2 * built.len());
    let mut tell = || {
        done += 1;
        watch(done, all);
    };
    let nominal = Reference::new(collector, assembly, &built, params, asked)?;
    tell();
    let mut side = |i: usize, value: f64| -> Result<Side, EvaluateError> {
        let mut design = built.clone();
        design[i] = value;
        let (evaluation, change) = nominal.against(&design, params)?;
        tell();
        let success = evaluation.success.into_iter().next();
        Ok(Side { value, undiscounted_return: evaluation.undiscounted_return, success, change })
    };
    let units = space.groups().iter().flat_map(|group| std::iter::repeat_n(group.dimension.si(), group.count));
    let mut parameters = Vec::with_capacity(built.len());
    for (i, ((name, unit), error)) in space.names().into_iter().zip(units).zip(errors).enumerate() {
        let (minus, plus) = (side(i, built[i] - error.size)?, side(i, built[i] + error.size)?);
        let worst = minus.change.undiscounted_return.mean.min(plus.change.undiscounted_return.mean);
        parameters.push(Sensitivity {
            name,
            unit: unit.to_owned(),
            nominal: built[i],
            error: error.size,
            error_text: error.text.clone(),
            minus,
            plus,
            loss: (-worst).max(0.0),
        });
    }
    parameters.sort_by(|a, b| b.loss.total_cmp(&a.loss));
    Ok(Sensitivities {
        experiment: spec.name.clone(),
        method: spec.method.name().to_owned(),
        task: spec.task.name().to_owned(),
        seed: spec.seed,
        nominal: nominal.evaluation,
        parameters,
    })
}

impl Sensitivities {
    /// The picture: the parameters in their order, the costliest on top.
    pub fn plot(&self) -> Plot {
        let title = format!("tolerances: {} · {} · seed {}", self.experiment, self.method, self.seed);
        let rows: Vec<_> = self.parameters.iter().map(Sensitivity::row).collect();
        tornado_plot(&title, &rows, self.nominal.episodes)
    }

    /// Writes `tolerances.json`, `tolerances.svg` and `tolerances.png` into a folder, which is created where it is missing.
    pub fn write(&self, folder: &Path) -> Result<(), WorkshopError> {
        let mut json = serde_json::to_vec_pretty(self).map_err(|e| encode(TOLERANCES, &e))?;
        json.push(b'\n');
        writable(folder)?;
        let path = folder.join(TOLERANCES);
        files::replace(&Disk, &path, &json).map_err(|source| io_error("write", &path, source))?;
        let plot = self.plot();
        for name in PICTURES {
            write_plot(&folder.join(name), &plot)?;
        }
        Ok(())
    }
}

impl Sensitivity {
    /// As the picture has it.
    fn row(&self) -> TornadoRow<'_> {
        TornadoRow { name: &self.name, error: &self.error_text, sides: [&self.minus.change, &self.plus.change] }
    }
}
