//! Trained controllers.

use hwasp_core::{HardwarePolicy, Policy as _};
use hwasp_diff::Activation;
use hwasp_export::Deployed;
use numpy::{PyArray1, PyArray2, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use safetensors::SafeTensors;

use crate::error::{self, Wrong};

/// The deterministic controller on the design as built.
#[pyclass(frozen, module = "hwasp._hwasp")]
pub(crate) struct Policy {
    deployed: Deployed,
    /// The parameters of the whole policy by name, as `policy.safetensors` of a run has them.
    named: Vec<u8>,
}

impl Policy {
    pub(crate) fn new(deployed: Deployed, policy: &HardwarePolicy, params: &[f32]) -> PyResult<Self> {
        let named = hwasp_runs::write_policy(policy, params).map_err(Wrong::failed)?;
        debug_assert_eq!(params.len(), policy.param_count());
        Ok(Self { deployed, named })
    }
}

#[pymethods]
impl Policy {
    /// Commands at an observation (or a batch of them), SI.
    fn __call__<'py>(&self, py: Python<'py>, observation: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let observation = as_f32(py, observation)?;
        let observation = observation.as_array();
        let (env, shape) = (self.deployed.env(), observation.shape());
        let width = env.observation.len();
        if !matches!(shape, [n] | [_, n] if *n == width) {
            let message = format!(
                "observations have the shape {shape:?}; this policy sees ({width},), or a batch of them, (rows, {width})"
            );
            return Err(error::input(message));
        }
        if let Some(at) = observation.iter().position(|x| !x.is_finite()) {
            let name = &env.observation[at % width].name;
            return Err(error::input(format!("the observation {name} of row {} is no finite number", at / width)));
        }
        let values: Vec<f32> = observation.iter().copied().collect();
        let commands = py.detach(|| self.deployed.commands(&values));
        let commands = PyArray1::from_vec(py, commands);
        if shape.len() == 1 {
            return Ok(commands.into_any());
        }
        Ok(commands.reshape([shape[0], env.command.len()])?.into_any())
    }

    /// Every tensor of the policy by its name in `policy.safetensors`.
    fn state_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let tensors = SafeTensors::deserialize(&self.named).map_err(Wrong::failed)?;
        let named = PyDict::new(py);
        for (name, tensor) in tensors.iter() {
            let values = tensor.data().chunks_exact(4);
            let values = values.map(|bytes| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]));
            let array = PyArray1::from_iter(py, values).reshape(tensor.shape())?;
            named.set_item(name, array)?;
        }
        Ok(named)
    }

    /// The controller's layers, first to last: weight `[outputs, inputs]`, bias, and the name of what follows.
    fn layers<'py>(&self, py: Python<'py>) -> PyResult<Vec<Layer<'py>>> {
        let layer = |layer: hwasp_export::Layer<'_>| {
            let weight = PyArray1::from_slice(py, layer.weight).reshape([layer.inputs, layer.outputs])?;
            let activation = match layer.activation {
                Activation::Tanh => "tanh",
                Activation::Relu => "relu",
                Activation::Identity => "identity",
            };
            Ok((weight.transpose()?, PyArray1::from_slice(py, layer.bias), activation))
        };
        self.deployed.layers().into_iter().map(layer).collect()
    }

    /// Centre, scale and clip of what the controller sees: `clip((observation - centre)/scale, -clip, clip)`.
    fn normalizer<'py>(&self, py: Python<'py>) -> Normalizer<'py> {
        let normalizer = self.deployed.normalizer();
        let array = |values: &[f64]| PyArray1::from_slice(py, values);
        (array(normalizer.center()), array(normalizer.scale()), normalizer.clip())
    }

    #[getter]
    fn observations(&self) -> Vec<(String, &'static str)> {
        let ports = self.deployed.env().observation.iter();
        ports.map(|port| (port.name.clone(), port.dimension.si())).collect()
    }

    /// Name, unit and limits.
    #[getter]
    fn commands(&self) -> Vec<(String, &'static str, f64, f64)> {
        let ports = self.deployed.env().command.iter();
        ports.map(|port| (port.name.clone(), port.dimension.si(), port.lo, port.hi)).collect()
    }

    #[getter]
    fn time_step(&self) -> f64 {
        self.deployed.env().time_step
    }

    fn __repr__(&self) -> String {
        let env = self.deployed.env();
        format!("Policy({} observations to {} commands)", env.observation.len(), env.command.len())
    }
}

type Layer<'py> = (Bound<'py, PyArray2<f32>>, Bound<'py, PyArray1<f32>>, &'static str);
type Normalizer<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, Option<f64>);

/// Anything that numpy makes an array of numbers of.
fn as_f32<'py>(py: Python<'py>, value: &Bound<'py, PyAny>) -> PyResult<numpy::PyReadonlyArrayDyn<'py, f32>> {
    let array = PyModule::import(py, "numpy")?.call_method1("asarray", (value, "float32"));
    let array = array.map_err(|error| error::input(format!("this is no array of numbers: {error}")))?;
    Ok(array.cast_into::<PyArrayDyn<f32>>().map_err(PyErr::from)?.try_readonly()?)
}
