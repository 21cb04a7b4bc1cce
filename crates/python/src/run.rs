//! Runs: what a training left on the disk.

use std::path::PathBuf;
use std::sync::Arc;

use hwasp_core::{Executor, Serial, Threads};
use hwasp_export::{Deployed, Kind, Source, export};
use hwasp_runs::metrics::{FIXED_COLUMNS, LEARNER, TERM};
use hwasp_runs::{SUMMARY, SavedRun};
use hwasp_session::What;
use hwasp_training::{Assembly, EvaluateError, evaluate, evaluate_native};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::catalogue::catalogue;
use crate::environment::Raised;
use crate::error::Wrong;
use crate::experiment::Experiment;
use crate::log;
use crate::policy::Policy;
use crate::training::{asked, attended, sound_threads, train};
use crate::value::{plain, text, toml_value};

/// A run folder: its experiment, design, policy, curves and figures.
#[pyclass(frozen, module = "hwasp._hwasp")]
pub(crate) struct Run {
    path: PathBuf,
    saved: Arc<SavedRun>,
}

impl Run {
    fn trained(&self) -> Result<Vec<f32>, Wrong> {
        self.saved.params().map_err(Wrong::input)
    }
}

#[pymethods]
impl Run {
    #[staticmethod]
    fn open(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        log::begin();
        let saved = py.detach(|| -> Result<SavedRun, Wrong> {
            if path.is_dir() {
                return SavedRun::open(&path, &catalogue()).map_err(Wrong::input);
            }
            let what = if path.exists() { "is not a folder" } else { "does not exist" };
            Err(Wrong::input(format!("{} {what}; name a run folder, as train() writes one", path.display())))
        })?;
        Ok(Self { path, saved: Arc::new(saved) })
    }

    #[getter]
    fn path(&self) -> PathBuf {
        self.path.clone()
    }

    /// Whether the training came to its end.
    #[getter]
    fn finished(&self) -> bool {
        self.path.join(SUMMARY).is_file()
    }

    #[getter]
    fn experiment(&self, py: Python<'_>) -> PyResult<Experiment> {
        let file = self.path.join(hwasp_experiment::EXPERIMENT);
        let layers = py.detach(|| hwasp_experiment::load(&file.to_string_lossy(), &catalogue()));
        Ok(Experiment::of(layers.map_err(Wrong::input)?))
    }

    /// The groups of the design: unit, limits, values as trained and as built.
    fn groups<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (params, assembly) = (py.detach(|| self.trained())?, self.saved.assembly());
        let (trained, built) = (assembly.policy.design(&params), assembly.built(&params));
        let groups = PyDict::new(py);
        let mut at = 0;
        for (i, group) in assembly.policy.space().groups().iter().enumerate() {
            let told = PyDict::new(py);
            let places = at..at + group.count;
            told.set_item("unit", group.dimension.si())?;
            told.set_item("limits", (group.lo, group.hi))?;
            told.set_item("values", PyArray1::from_slice(py, &trained[places.clone()]))?;
            told.set_item("as_built", PyArray1::from_slice(py, &built[places.clone()]))?;
            told.set_item("optimum", assembly.worlds.optimum.get(i).copied().flatten())?;
            groups.set_item(&group.name, told)?;
            at = places.end;
        }
        Ok(groups)
    }

    /// The learning curve: arrays by the names of the columns.
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let table = py.detach(|| self.saved.metrics()).map_err(Wrong::input)?;
        let columns = PyDict::new(py);
        let rows = &table.rows;
        columns.set_item(FIXED_COLUMNS[0], PyArray1::from_iter(py, rows.iter().map(|row| row.iteration)))?;
        columns.set_item(FIXED_COLUMNS[1], PyArray1::from_iter(py, rows.iter().map(|row| row.env_steps)))?;
        let fixed = FIXED_COLUMNS[2..].iter().map(|&name| name.to_owned());
        let learner = table.learner.iter().map(|name| format!("{LEARNER}{name}"));
        let terms = table.terms.iter().map(|name| format!("{TERM}{name}"));
        for (i, name) in fixed.chain(learner).chain(terms).chain(table.design_totals.iter().cloned()).enumerate() {
            let values = rows.iter().map(|row| row.values().nth(i).unwrap_or(f64::NAN));
            columns.set_item(name, PyArray1::from_iter(py, values))?;
        }
        Ok(columns)
    }

    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        plain(py, &self.saved.summary().map_err(Wrong::input)?)
    }

    /// The trained parameters of the whole policy, as one vector.
    #[getter]
    fn params<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let params = py.detach(|| self.trained())?;
        Ok(PyArray1::from_vec(py, params))
    }

    #[getter]
    fn policy(&self, py: Python<'_>) -> PyResult<Policy> {
        let params = py.detach(|| self.trained())?;
        let deployed = py.detach(|| Deployed::new(self.saved.assembly(), &params)).map_err(Wrong::input)?;
        Policy::new(deployed, &self.saved.assembly().policy, &params)
    }

    #[pyo3(signature = (*, episodes, seed, settings, native, threads))]
    fn evaluation<'py>(
        &self,
        py: Python<'py>,
        episodes: Option<u64>,
        seed: Option<u64>,
        settings: Option<&Bound<'py, PyDict>>,
        native: bool,
        threads: usize,
    ) -> PyResult<Bound<'py, PyAny>> {
        let assigned = |(key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
            Ok(format!("{}={}", text(&key, "the name of a setting")?, toml_value(&value)?))
        };
        let settings = settings.into_iter().flatten().map(assigned).collect::<PyResult<Vec<String>>>()?;
        let raised = Raised::of(self.saved.assembly().experiment().task.name());
        let path = self.path.clone();
        let evaluation = attended(py, None, &raised, move || -> Result<_, Wrong> {
            let executor = executor(threads)?;
            let catalogue = catalogue();
            let saved = SavedRun::open_with(&path, &settings, &catalogue).map_err(Wrong::input)?;
            let params = saved.params().map_err(Wrong::input)?;
            let assembly: &Assembly = saved.assembly();
            let train = &assembly.experiment().train;
            let episodes = episodes.unwrap_or(train.evaluation_episodes as u64);
            if episodes == 0 || episodes > MOST_EPISODES {
                return Err(Wrong::input(format!("episodes = {episodes}; it is from 1 to {MOST_EPISODES}")));
            }
            let asked = (episodes, seed.unwrap_or(train.evaluation_seed));
            let evaluated = if native {
                evaluate_native(assembly, &params, asked, &*executor)
            } else {
                evaluate(assembly, &params, asked, &*executor)
            };
            evaluated.map_err(|error| match error {
                EvaluateError::Assemble(error) => Wrong::input(error),
                error => Wrong::failed(error),
            })
        });
        plain(py, &evaluation??)
    }

    #[pyo3(signature = (out, kinds, samples))]
    fn exported(
        &self,
        py: Python<'_>,
        out: Option<PathBuf>,
        kinds: Vec<String>,
        samples: Option<u64>,
    ) -> PyResult<Vec<PathBuf>> {
        let (path, raised) = (self.path.clone(), Raised::of(self.saved.assembly().experiment().task.name()));
        let files = attended(py, None, &raised, move || -> Result<_, Wrong> {
            let source = Source::open(&path, &catalogue()).map_err(Wrong::input)?;
            let named = |name: &String| {
                let known = Kind::ALL.into_iter().find(|kind| kind.name() == name);
                known.ok_or_else(|| {
                    let all = Kind::ALL.map(Kind::name).join(", ");
                    Wrong::input(format!("`{name}` is nothing that can be exported; that can be {all}"))
                })
            };
            let kinds = if kinds.is_empty() {
                Kind::ALL.into_iter().filter(|kind| kind.is_of(source.spec())).collect()
            } else {
                kinds.iter().map(named).collect::<Result<Vec<_>, _>>()?
            };
            let out = out.unwrap_or_else(|| path.join("export"));
            let files = export(&source, &kinds, samples, &out).map_err(Wrong::input)?;
            Ok(files.into_iter().map(|file| out.join(file.name)).collect())
        })??;
        Ok(files)
    }

    /// The report as one HTML page.
    fn html(&self, py: Python<'_>) -> PyResult<String> {
        let (path, raised) = (self.path.clone(), Raised::of(self.saved.assembly().experiment().task.name()));
        let page = attended(py, None, &raised, move || hwasp_report::report(&path, &catalogue()).map_err(Wrong::input));
        Ok(page??)
    }

    #[pyo3(signature = (*, threads, checkpoint_every, tensorboard, watch))]
    fn resumed(
        &self,
        py: Python<'_>,
        threads: usize,
        checkpoint_every: f64,
        tensorboard: bool,
        watch: Option<Py<PyAny>>,
    ) -> PyResult<PathBuf> {
        train(py, asked(py, What::Resume(self.path.clone()), threads, checkpoint_every, tensorboard)?, watch)
    }
}

/// The most episodes of an evaluation.
const MOST_EPISODES: u64 = 1_000_000_000;

/// So many threads.
fn executor(threads: usize) -> Result<Box<dyn Executor>, Wrong> {
    match sound_threads(threads)?.get() {
        1 => Ok(Box::new(Serial)),
        threads => Ok(Box::new(Threads::new(threads).map_err(Wrong::failed)?)),
    }
}
