//! The hand as what is built of its law.

use std::any::Any;

use hwasp_problem::{AnyError, Mechanism, ModelFile, ModelFormat};

use super::{Drive, HandDescription, MjcfOptions, mjcf, urdf};

impl Mechanism for HandDescription {
    fn as_any(&self) -> &dyn Any {
        self
    }

    fn formats(&self) -> Vec<ModelFormat> {
        vec![ModelFormat::Mjcf, ModelFormat::Urdf]
    }

    /// The scene of the task with native tendons and springs, or links and joints.
    fn write(&self, format: ModelFormat, design: &[f64]) -> Result<Vec<ModelFile>, AnyError> {
        let design = design.try_into()?;
        let (name, text) = match format {
            ModelFormat::Mjcf => {
                let drive = Drive::NativeTendon { design };
                ("hand.xml", mjcf(self, &MjcfOptions { drive, ..MjcfOptions::default() })?)
            }
            ModelFormat::Urdf => ("hand.urdf", urdf(self, &design)?),
        };
        Ok(vec![ModelFile { name: name.to_owned(), contents: text.into_bytes() }])
    }

    /// Springs as they are sold, pulleys as they are printed, and half the way between two holes 15° apart.
    fn manufacturing_errors(&self) -> Vec<(String, String)> {
        [("radius", "0.1 mm"), ("stiffness", "5 %"), ("preload", "0.13 rad")]
            .map(|(quantity, error)| (quantity.to_owned(), error.to_owned()))
            .to_vec()
    }
}
