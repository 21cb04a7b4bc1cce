//! Runs to export from.

use std::cell::OnceCell;
use std::path::{Path, PathBuf};

use hwasp_experiment::{Catalogue, Experiment};
use hwasp_problem::{ModelFile, ModelFormat};
use hwasp_runs::{DESIGN, RunError, saved_experiment};
use hwasp_tasks::hand::HandDescription;
use hwasp_workshop::design::{DesignReport, hand_of};
use hwasp_workshop::parts::{ChosenParts, Verdict};

use crate::contract::Contract;
use crate::deployed::Deployed;
use crate::error::ExportError;
use crate::file::ExportFile;
use crate::kind::Kind;

/// A run to export from. What a kind does not need is not read: the experiment is there at once, the trained policy when it
/// is asked for.
pub struct Source {
    path: PathBuf,
    spec: Experiment,
    deployed: OnceCell<Deployed>,
    chosen: OnceCell<ChosenParts>,
}

impl Source {
    /// Opens a run folder.
    pub fn open(path: &Path, catalogue: &Catalogue) -> Result<Self, RunError> {
        let (path, spec) = (path.to_owned(), saved_experiment(path, &[], catalogue)?);
        Ok(Self { path, spec, deployed: OnceCell::new(), chosen: OnceCell::new() })
    }

    /// Its experiment.
    pub fn spec(&self) -> &Experiment {
        &self.spec
    }

    /// The trained controller on the hardware as built.
    pub(crate) fn deployed(&self) -> Result<&Deployed, ExportError> {
        if let Some(deployed) = self.deployed.get() {
            return Ok(deployed);
        }
        let deployed = Deployed::open(&self.path, self.spec.catalogue())?;
        Ok(self.deployed.get_or_init(|| deployed))
    }

    /// Files of the controller, and its contract.
    pub(crate) fn with_contract(
        &self,
        make: impl FnOnce(&Deployed, &Contract) -> Result<Vec<ExportFile>, ExportError>,
    ) -> Result<Vec<ExportFile>, ExportError> {
        let deployed = self.deployed()?;
        let contract = Contract::new(deployed);
        let mut files = make(deployed, &contract)?;
        files.push(contract.file()?);
        Ok(files)
    }

    /// The parts that print files were made for, once any were.
    pub fn printed_for(&self) -> Option<&ChosenParts> {
        self.chosen.get()
    }

    /// Whether the hand that print files were made for can be built, and why; once any were made.
    pub fn verdict(&self) -> Option<Verdict> {
        Some(self.printed_for()?.verdict(hand_of(&self.spec)?))
    }

    /// The parts of the mechanism, to be written as `kind`: the run's list where there is one.
    pub(crate) fn chosen(&self, kind: Kind) -> Result<&ChosenParts, ExportError> {
        if let Some(chosen) = self.chosen.get() {
            return Ok(chosen);
        }
        let design = self.design()?;
        let design = std::array::from_fn(|i| design[i]);
        let chosen = ChosenParts::of_run(&self.path, &self.spec, self.hand(kind)?, &design)?;
        Ok(self.chosen.get_or_init(|| chosen))
    }

    /// The hand, whose parts are to be written as `kind`.
    pub(crate) fn hand(&self, kind: Kind) -> Result<&HandDescription, ExportError> {
        hand_of(&self.spec).ok_or_else(|| self.none(kind))
    }

    /// The mechanism with the design as it was trained, as `kind`.
    pub(crate) fn model(&self, kind: Kind, format: ModelFormat) -> Result<Vec<ExportFile>, ExportError> {
        let mechanism = self.spec.task.built().mechanism.as_ref().filter(|_| kind.is_of(&self.spec));
        let mechanism = mechanism.ok_or_else(|| self.none(kind))?;
        let files = mechanism.write(format, &self.design()?).map_err(ExportError::Mechanism)?;
        Ok(files.into_iter().map(|ModelFile { name, contents }| ExportFile { name, contents }).collect())
    }

    fn none(&self, kind: Kind) -> ExportError {
        let kinds = Kind::ALL.iter().filter(|kind| kind.is_of(&self.spec)).map(|kind| kind.name()).collect();
        ExportError::NoMechanism { kind: kind.name(), problem: self.spec.task.name().to_owned(), kinds }
    }

    /// The design as built, SI.
    fn design(&self) -> Result<Vec<f64>, ExportError> {
        if !self.path.join(DESIGN).is_file() {
            // Of a training that did not come to its end.
            return Ok(self.deployed()?.design.clone());
        }
        let report = DesignReport::open(&self.path, self.spec.catalogue())?;
        Ok(report.groups.into_iter().flat_map(|group| group.group.as_built).collect())
    }
}
