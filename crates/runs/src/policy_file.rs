//! Trained parameters as safetensors: a format that cannot run code, read by every framework.

use hwasp_core::{HardwarePolicy, ParamKind, Policy};
use safetensors::SafeTensors;
use safetensors::tensor::Dtype;
use thiserror::Error;

use crate::tensors::{Piece, check_header, serialized};

/// The largest file that is read, in bytes: the largest controller there can be, and some.
pub(crate) const LARGEST_POLICY: u64 = 2 << 30;

/// Why a policy file is of no use.
#[derive(Debug, Error)]
pub enum PolicyFileError {
    /// It is not safetensors.
    #[error("not a policy in the safetensors format: {0}")]
    Format(#[from] safetensors::SafeTensorError),
    /// A tensor is missing, or has another shape or type than the experiment's policy.
    #[error("tensor `{name}` is {found}, and this experiment's policy has {needed}")]
    Tensor {
        /// Its name.
        name: String,
        /// What the file has.
        found: String,
        /// What it should have.
        needed: String,
    },
    /// A parameter is no number, or a scale is not positive.
    #[error("tensor `{name}` holds {value} at position {at}")]
    NotFinite {
        /// Its name.
        name: String,
        /// The value.
        value: f32,
        /// Where it is.
        at: usize,
    },
}

/// Running mean and deviation of the observations, SI, where the controller sees them so.
const CENTER: &str = "observation.center";
const SCALE: &str = "observation.scale";

/// The names and shapes of a policy's tensors, in the order of its parameter vector.
fn tensors(policy: &HardwarePolicy) -> Vec<(String, Vec<usize>)> {
    let mut names = Vec::new();
    for (layer, sizes) in policy.controller().sizes().windows(2).enumerate() {
        names.push((format!("controller.{layer}.weight"), sizes.to_vec()));
        names.push((format!("controller.{layer}.bias"), vec![sizes[1]]));
    }
    for group in policy.groups().iter().filter(|g| g.kind != ParamKind::Controller && !g.range.is_empty()) {
        // What is stored of the design is the unbounded stand-in of each free parameter; design.toml has the SI values.
        let name = if group.kind == ParamKind::Design { "design.logit" } else { group.kind.name() };
        if group.kind == ParamKind::Normalizer {
            let half = group.range.len() / 2;
            names.extend([CENTER, SCALE].map(|name| (name.to_owned(), vec![half])));
            continue;
        }
        names.push((name.to_owned(), vec![group.range.len()]));
    }
    names
}

/// The parameters as bytes of a safetensors file. Weights are `[in, out]`.
pub fn write_policy(policy: &HardwarePolicy, params: &[f32]) -> Result<Vec<u8>, PolicyFileError> {
    let mut rest = params;
    let pieces = tensors(policy).into_iter().map(|(name, shape)| {
        let (values, after) = rest.split_at(shape.iter().product());
        rest = after;
        Piece::f32(name, shape, values)
    });
    Ok(serialized(&pieces.collect::<Vec<_>>(), [("format", "hwasp-policy-1".to_owned())])?)
}

/// Reads the parameters of `policy` back. Bytes are taken for hostile: names, shapes, types and values are checked.
pub fn read_policy(policy: &HardwarePolicy, bytes: &[u8]) -> Result<Vec<f32>, PolicyFileError> {
    check_header(bytes)?;
    let file = SafeTensors::deserialize(bytes)?;
    let mut params = Vec::with_capacity(policy.param_count());
    for (name, shape) in tensors(policy) {
        let needed = format!("F32 {shape:?}");
        let tensor = file.tensor(&name).map_err(|_| PolicyFileError::Tensor {
            name: name.clone(),
            found: "missing".into(),
            needed: needed.clone(),
        })?;
        if tensor.dtype() != Dtype::F32 || tensor.shape() != shape {
            let found = format!("{:?} {:?}", tensor.dtype(), tensor.shape());
            return Err(PolicyFileError::Tensor { name, found, needed });
        }
        for (at, bytes) in tensor.data().chunks_exact(4).enumerate() {
            let value = f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
            // Nothing can be divided by a scale of zero.
            if !value.is_finite() || (name == SCALE && value <= 0.0) {
                return Err(PolicyFileError::NotFinite { name, value, at });
            }
            params.push(value);
        }
    }
    Ok(params)
}
