//! The mechanism of a hand with the design of a run: as a simulation, as links and joints, and as parts to print.
//!
//! Of a finished run `experiment.toml` and `design.toml` are enough; neither the engine nor the policy is asked. What is simulated
//! is the design as it was trained; what is printed is the design that its parts make.

use hwasp_tasks::hand::{DESIGN_LEN, Drive, HandDescription, HandError, MjcfOptions, mjcf, parts, scad, urdf};
use hwasp_workshop::parts::ChosenParts;

use crate::file::ExportFile;

/// A hand and its design, SI.
pub(super) struct Mechanism {
    pub(super) hand: HandDescription,
    pub(super) design: [f64; DESIGN_LEN],
}

impl Mechanism {
    /// Of the twelve parameters as built, SI.
    pub(super) fn new(hand: HandDescription, design: &[f64]) -> Self {
        Self { hand, design: std::array::from_fn(|i| design[i]) }
    }

    /// The scene of the task with MuJoCo's own tendons and springs.
    pub(super) fn mjcf(&self) -> Result<Vec<ExportFile>, HandError> {
        let drive = Drive::NativeTendon { design: self.design };
        Ok(vec![text("hand.xml", mjcf(&self.hand, &MjcfOptions { drive, ..MjcfOptions::default() })?)])
    }

    /// Links and joints.
    pub(super) fn urdf(&self) -> Result<Vec<ExportFile>, HandError> {
        Ok(vec![text("hand.urdf", urdf(&self.hand, &self.design)?)])
    }

    /// What is printed about the parts that were chosen.
    pub(super) fn stl(&self, chosen: &ChosenParts) -> Result<Vec<ExportFile>, HandError> {
        let parts = parts(&self.hand, &chosen.design(), &chosen.springs(), &chosen.workshop)?;
        let file = |part: hwasp_tasks::hand::Part| ExportFile {
            name: format!("{}.stl", part.name),
            contents: part.mesh.stl(part.name),
        };
        Ok(parts.into_iter().map(file).collect())
    }

    /// The same with its parameters.
    pub(super) fn scad(&self, chosen: &ChosenParts) -> Result<Vec<ExportFile>, HandError> {
        Ok(vec![text("hand.scad", scad(&self.hand, &chosen.design(), &chosen.springs(), &chosen.workshop)?)])
    }
}

fn text(name: &str, contents: String) -> ExportFile {
    ExportFile { name: name.to_owned(), contents: contents.into_bytes() }
}
