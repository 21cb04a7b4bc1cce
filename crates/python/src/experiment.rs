//! Experiments.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use hwasp_cli::checked;
use hwasp_experiment::{Layers, load, resolve};
use hwasp_session::What;
use hwasp_settings::{Folder, Value};
use hwasp_training::Assembly;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::catalogue::catalogue;
use crate::environment::Raised;
use crate::error::Wrong;
use crate::log;
use crate::training::{asked, attended, train};
use crate::value::{kind, plain, text, toml_value};

/// An experiment: what is trained, in which world, by what learner. It never changes: `set` gives another one.
#[pyclass(frozen, module = "hwasp._hwasp")]
#[derive(Clone)]
pub(crate) struct Experiment {
    layers: Layers,
}

impl Experiment {
    /// With every setting in its place.
    pub(crate) fn resolved(&self) -> Result<hwasp_experiment::Experiment, Wrong> {
        resolve(self.layers.clone(), None, &catalogue()).map_err(Wrong::input)
    }

    /// Ready to run.
    pub(crate) fn assembly(&self) -> Result<Assembly, Wrong> {
        Assembly::new(&self.resolved()?).map_err(Wrong::input)
    }

    pub(crate) fn layers(&self) -> &Layers {
        &self.layers
    }

    pub(crate) fn of(layers: Layers) -> Self {
        Self { layers }
    }
}

#[pymethods]
impl Experiment {
    #[staticmethod]
    fn load(py: Python<'_>, what: &Bound<'_, PyAny>) -> PyResult<Self> {
        log::begin();
        if let Ok(experiment) = what.cast::<Self>() {
            return Ok(experiment.get().clone());
        }
        if what.is_instance_of::<PyDict>() {
            let text = toml::to_string(&toml_value(what)?).map_err(Wrong::failed)?;
            let layers = Layers::from_text("experiment", &text).map_err(Wrong::input)?;
            return Ok(Self::of(layers.with_folder(Folder::Disk(".".into()))));
        }
        let name = if what.is_instance_of::<PyString>() { Ok(what.clone()) } else { what.call_method0("__fspath__") };
        let name = name.map_err(|_| {
            PyTypeError::new_err(format!("an experiment is a name, a path or a dict, not {}", kind(what)))
        })?;
        let name = text(&name, "a path")?;
        Ok(Self::of(py.detach(|| load(&name, &catalogue())).map_err(Wrong::input)?))
    }

    #[pyo3(signature = (settings = None, /, **more))]
    fn set(&self, settings: Option<&Bound<'_, PyDict>>, more: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let mut layers = self.layers.clone();
        for table in [settings, more].into_iter().flatten() {
            for (key, value) in table {
                let (key, value) = (text(&key, "the name of a setting")?, toml_value(&value)?);
                layers = layers.with_override(&key, &value.to_string());
            }
        }
        Ok(Self::of(layers))
    }

    fn check(&self, py: Python<'_>) -> PyResult<String> {
        let assembly = py.detach(|| self.assembly())?;
        let raised = Raised::of(assembly.experiment().task.name());
        Ok(attended(py, None, &raised, move || -> Result<String, Wrong> {
            Ok(checked(assembly.experiment(), &assembly)?)
        })??)
    }

    /// Where the file itself says that the design sits, which no other method changes; none where the method decides.
    fn placement(&self) -> Option<String> {
        let table = self.layers.overridden("");
        let Value::Table(design) = &table.get("design")?.node.value else { return None };
        match &design.get("placement")?.node.value {
            Value::Text(text) => Some(text.clone()),
            _ => None,
        }
    }

    #[getter]
    fn name(&self, py: Python<'_>) -> PyResult<String> {
        Ok(py.detach(|| self.resolved())?.name)
    }

    #[getter]
    fn method(&self, py: Python<'_>) -> PyResult<&'static str> {
        Ok(py.detach(|| self.resolved())?.method.name())
    }

    #[getter]
    fn seed(&self, py: Python<'_>) -> PyResult<u64> {
        Ok(py.detach(|| self.resolved())?.seed)
    }

    fn to_toml(&self, py: Python<'_>) -> PyResult<String> {
        Ok(py.detach(|| -> Result<String, Wrong> { self.resolved()?.to_toml().map_err(Wrong::failed) })?)
    }

    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let table: toml::Table = toml::from_str(&self.to_toml(py)?).map_err(Wrong::failed)?;
        plain(py, &table)
    }

    /// All that it takes to have it again elsewhere: every setting as TOML, and the files that it names.
    fn packed(&self, py: Python<'_>) -> PyResult<(String, BTreeMap<String, Vec<u8>>)> {
        Ok(py.detach(|| -> Result<_, Wrong> {
            let spec = self.resolved()?;
            let files = spec.files().iter().map(|(path, bytes)| (path.clone(), bytes.to_vec())).collect();
            Ok((spec.to_toml().map_err(Wrong::failed)?, files))
        })?)
    }

    #[staticmethod]
    fn unpacked(text: &str, files: BTreeMap<String, Vec<u8>>) -> PyResult<Self> {
        log::begin();
        let layers = Layers::from_text("experiment", text).map_err(Wrong::input)?;
        let files = files.into_iter().map(|(path, bytes)| (path, Arc::from(bytes))).collect();
        Ok(Self::of(layers.with_folder(Folder::Sent(Arc::new(files)))))
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        match py.detach(|| self.resolved()) {
            Ok(spec) => format!("Experiment({}, {}, seed {})", spec.name, spec.method.name(), spec.seed),
            Err(_) => "Experiment(with faults: check() tells them)".to_owned(),
        }
    }

    #[pyo3(signature = (*, out, learned, threads, checkpoint_every, tensorboard, watch))]
    #[allow(clippy::too_many_arguments, reason = "the names are Python's keywords")]
    fn train(
        &self,
        py: Python<'_>,
        out: Option<PathBuf>,
        learned: Vec<PathBuf>,
        threads: usize,
        checkpoint_every: f64,
        tensorboard: bool,
        watch: Option<Py<PyAny>>,
    ) -> PyResult<PathBuf> {
        let what = What::Anew { layers: self.layers.clone(), method: None, learned, out };
        train(py, asked(py, what, threads, checkpoint_every, tensorboard)?, watch)
    }
}
