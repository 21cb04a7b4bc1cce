//! Makes the files and writes them.

use std::path::Path;

use hwasp_problem::ModelFormat;

use crate::error::ExportError;
use crate::file::ExportFile;
use crate::kind::Kind;
use crate::source::Source;
use crate::{controller, folder, onnx, printed, samples};

/// The most random observations that are written: files of some hundred MB.
pub const MOST_SAMPLES: u64 = 1_000_000;

/// Makes the files of some kinds, and of `samples` random observations if they are asked for, and writes them into `out`,
/// which is created where it is missing. Files of an earlier export of the same run are replaced; nothing else is.
/// Returns what was written.
pub fn export(
    source: &Source,
    kinds: &[Kind],
    samples: Option<u64>,
    out: &Path,
) -> Result<Vec<ExportFile>, ExportError> {
    let mut files: Vec<ExportFile> = Vec::new();
    for kind in kinds {
        for file in files_of(*kind, source)? {
            if files.iter().all(|other| other.name != file.name) {
                files.push(file);
            }
        }
    }
    if let Some(count) = samples {
        files.push(samples::samples(source.deployed()?, count as usize)?);
    }
    folder::write(out, source.spec(), &files)?;
    Ok(files)
}

/// The files of this kind. Every form of the controller has the contract beside it.
fn files_of(kind: Kind, source: &Source) -> Result<Vec<ExportFile>, ExportError> {
    match kind {
        Kind::Onnx => source.with_contract(onnx::models),
        Kind::Safetensors => {
            source.with_contract(|deployed, contract| Ok(vec![controller::safetensors(deployed, contract)?]))
        }
        Kind::Json => source.with_contract(|deployed, contract| Ok(vec![controller::json(deployed, contract)?])),
        Kind::Mjcf => source.model(kind, ModelFormat::Mjcf),
        Kind::Urdf => source.model(kind, ModelFormat::Urdf),
        Kind::Stl => Ok(printed::stl(source.hand(kind)?, source.chosen(kind)?)?),
        Kind::Scad => Ok(printed::scad_file(source.hand(kind)?, source.chosen(kind)?)?),
        Kind::Step => Ok(printed::step(source.hand(kind)?, source.chosen(kind)?)?),
        Kind::Package => Ok(printed::whole_package(source.hand(kind)?, source.chosen(kind)?)?),
    }
}
