//! From a trained hand to parts that can be bought and made: pulleys, springs from a catalogue, holes for their legs. What
//! rounding to them costs, and the controller trained further on them.
//!
//! [`snap`] takes the nearest parts for a design. [`Snapped::judge`] simulates the design before and after, on the same held-out
//! episodes. A [`Tuning`] trains the controller further. A [`PartsList`] is what is written.

mod catalogue;
mod chosen;
mod list;
mod select;
mod sheet;
mod spring;
mod tune;
mod verdict;

use std::path::Path;

use crate::design::hand_of;
use crate::folder::writable;
pub use hwasp_fabrication::{Finding, SeatedSpring, Verdict, Workshop};
use hwasp_runs::files::{self, Disk};
use hwasp_runs::{RunError, encode, io_error};
use hwasp_tasks::hand::{DESIGN_LEN, HandDescription};
use hwasp_training::{AssembleError, Assembly, Collector, EvaluateError, Reference, TrainError};
use thiserror::Error;

pub use catalogue::{BUILT_IN, CatalogueFault, CatalogueSpring, SpringCatalogue, SpringCatalogueError};
pub use chosen::{ChosenParts, ChosenPartsError};
pub use list::{
    CatalogueNote, JointDesign, JointParts, PartsList, PartsWorth, PulleyPart, SnappedParameter, SpringPart, TunedWorth,
};
pub use select::{Reason, Rejected, SelectError, select, unfit};
pub use sheet::build_sheet;
pub use spring::{MUSIC_WIRE_MODULUS, TorsionSpring, music_wire_strength};
pub use tune::{Tuning, TuningFolder};
pub use verdict::verdict_of_run;

/// Where a run folder has its list, unless it was put elsewhere.
pub const BUILD: &str = "build";
/// The list as files and programs have it.
pub const PARTS: &str = "parts.json";
/// The list as a technician has it.
pub const SHEET: &str = "parts.md";
/// The run folder of the controller that was trained further.
pub const TUNED: &str = "tuned";

/// Why there is no list of parts.
#[derive(Debug, Error)]
pub enum PartsError {
    /// A problem without a hand.
    #[error(
        "{problem} has no pulleys and springs to be chosen\n  = hint: name a run of a hand: of z-grasp, or of 3d-grasp"
    )]
    NoHand {
        /// The problem.
        problem: String,
    },
    /// No parts will do.
    #[error(transparent)]
    Select(#[from] SelectError),
    /// A further training that is too short.
    #[error(
        "--fine-tune {env_steps} is less than one iteration of this run takes, {rows} steps\n  = hint: some ten iterations are needed to see a difference"
    )]
    ShortTuning {
        /// Steps asked for.
        env_steps: u64,
        /// Steps of an iteration.
        rows: u64,
    },
    /// A further training that cannot begin.
    #[error(transparent)]
    Tuning(#[from] Box<TrainError>),
    /// The hand on its parts cannot be put together.
    #[error(transparent)]
    Assemble(#[from] AssembleError),
    /// Its simulation failed.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
}

/// A trained design and the parts that come nearest to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapped {
    /// The parts of each kind of joint.
    pub joints: [JointParts; 4],
    /// As trained, SI.
    pub trained: [f64; DESIGN_LEN],
    /// As these parts make it, SI.
    pub built: [f64; DESIGN_LEN],
    catalogue: CatalogueNote,
    workshop: Workshop,
}

/// Chooses the parts that come nearest to the design in `params`.
pub fn snap(
    assembly: &Assembly,
    params: &[f32],
    catalogue: &SpringCatalogue,
    workshop: &Workshop,
) -> Result<Snapped, PartsError> {
    let hand = hand(assembly)?;
    let space = assembly.policy.space();
    let design = assembly.built(params);
    let trained = std::array::from_fn(|i| design[i]);
    let limits = std::array::from_fn(|i| space.bounds(i));
    let joints = select(&hand, &trained, &limits, catalogue, workshop)?;
    let built = list::design_of(&joints, |joint| joint.built);
    let catalogue = CatalogueNote { name: catalogue.name.clone(), springs: catalogue.springs.len() };
    Ok(Snapped { joints, trained, built, catalogue, workshop: workshop.clone() })
}

fn hand(assembly: &Assembly) -> Result<HandDescription, PartsError> {
    let experiment = assembly.experiment();
    let none = || PartsError::NoHand { problem: experiment.task.name().to_owned() };
    hand_of(experiment).cloned().ok_or_else(none)
}

/// The trained controller on the trained design and on its parts, and what comes later on the same episodes.
pub struct Judge<'a> {
    reference: Reference<'a>,
    built: [f64; DESIGN_LEN],
    worth: PartsWorth,
}

impl Snapped {
    /// Simulates the run's controller on the trained design and on the parts: so many episodes from starts of this seed.
    pub fn judge<'a>(
        &self,
        assembly: &'a Assembly,
        params: &[f32],
        asked: (u64, u64),
        collector: &'a dyn Collector,
    ) -> Result<Judge<'a>, PartsError> {
        let reference = Reference::new(collector, assembly, &self.trained, params, asked)?;
        let (snapped, snapping) = reference.against(&self.built, params)?;
        let worth = PartsWorth { trained: reference.evaluation.clone(), snapped, snapping, tuned: None };
        Ok(Judge { reference, built: self.built, worth })
    }

    /// The list.
    pub fn list(self, assembly: &Assembly, worth: PartsWorth) -> PartsList {
        let (spec, space) = (assembly.experiment(), assembly.policy.space());
        let parameter = |(i, name): (usize, String)| SnappedParameter {
            name,
            unit: space.groups()[i].dimension.si().to_owned(),
            trained: self.trained[i],
            built: self.built[i],
        };
        let verdict = hand_of(spec).map(|hand| verdict::verdict_on(hand, &self.joints, &self.workshop));
        PartsList {
            experiment: spec.name.clone(),
            method: spec.method.name().to_owned(),
            task: spec.task.name().to_owned(),
            seed: spec.seed,
            catalogue: self.catalogue,
            workshop: self.workshop,
            design: space.names().into_iter().enumerate().map(parameter).collect(),
            joints: self.joints.to_vec(),
            worth,
            verdict,
        }
    }
}

impl Judge<'_> {
    /// What is known so far.
    pub fn worth(&self) -> &PartsWorth {
        &self.worth
    }

    /// Simulates the tuned controller on the parts. `params`: those of the further training, whose run folder is `folder`.
    pub fn tuned(mut self, params: &[f32], folder: &str, env_steps: u64) -> Result<PartsWorth, PartsError> {
        // The controller comes first, as it does in the run.
        let (evaluation, change) = self.reference.against(&self.built, params)?;
        self.worth.tuned = Some(TunedWorth { folder: folder.to_owned(), env_steps, evaluation, change });
        Ok(self.worth)
    }
}

impl PartsList {
    /// Writes `parts.json` and `parts.md` into a folder, which is created where it is missing.
    pub fn write(&self, folder: &Path) -> Result<(), RunError> {
        let mut json = serde_json::to_vec_pretty(self).map_err(|e| encode(PARTS, &e))?;
        json.push(b'\n');
        writable(folder)?;
        for (name, contents) in [(PARTS, &json[..]), (SHEET, build_sheet(self).as_bytes())] {
            let path = folder.join(name);
            files::replace(&Disk, &path, contents).map_err(|source| io_error("write", &path, source))?;
        }
        Ok(())
    }
}
