//! The parts that a hand is printed for: those of its list, or those that would be chosen.

use std::path::{Path, PathBuf};

use hwasp_experiment::{Experiment, Method};
use hwasp_fabrication::{SeatedSpring, Workshop};
use hwasp_runs::{RunError, saved_json};
use hwasp_settings::Faults;
use hwasp_tasks::hand::names::KINDS;
use hwasp_tasks::hand::{DESIGN_LEN, HandDescription};
use thiserror::Error;

use super::list::design_of;
use super::{
    BUILD, JointParts, PARTS, PartsList, SelectError, SnappedParameter, SpringCatalogue, SpringCatalogueError, select,
};

/// How far numbers of the same design may differ in files, as a share.
const LAST_DIGITS: f64 = 1e-9;

/// The parts of a run's hand and the workshop that they are for.
#[derive(Clone, Debug, PartialEq)]
pub struct ChosenParts {
    /// Those of each kind of joint.
    pub joints: [JointParts; 4],
    /// The workshop.
    pub workshop: Workshop,
    /// The list that they were read from; none where nobody had chosen any.
    pub list: Option<PathBuf>,
}

/// Why it is not known which parts a hand has.
#[derive(Debug, Error)]
pub enum ChosenPartsError {
    /// A list that cannot be read.
    #[error(transparent)]
    Read(#[from] RunError),
    /// A workshop that nobody has.
    #[error("{0}")]
    Workshop(#[from] Faults),
    /// A list of something else.
    #[error("{} {fault}\n  = hint: `hwasp parts RUN` chooses parts for this run anew", path.display())]
    Other {
        /// The list.
        path: PathBuf,
        /// What is wrong with it.
        fault: String,
    },
    /// There are none.
    #[error(transparent)]
    Select(#[from] SelectError),
    /// The catalogue that comes with the program, which a test reads.
    #[error(transparent)]
    Catalogue(#[from] SpringCatalogueError),
}

impl ChosenParts {
    /// Of the run in a folder, whose experiment and design (SI) these are: as `build/parts.json` there has them, or `parts.json`
    /// beside a run that was trained further on it; otherwise as `hwasp parts` chooses them, by default.
    pub fn of_run(
        run: &Path,
        experiment: &Experiment,
        hand: &HandDescription,
        design: &[f64; DESIGN_LEN],
    ) -> Result<Self, ChosenPartsError> {
        let own = run.join(BUILD).join(PARTS);
        if let Some(list) = saved_json::<PartsList>(&own)? {
            return Self::of_list(list, own, (experiment, false), (design, |it| it.trained));
        }
        if let Some((path, list)) = around(run, experiment)? {
            return Self::of_list(list, path, (experiment, true), (design, |it| it.built));
        }
        let workshop = Workshop::default();
        let groups = experiment.task.groups();
        let limits: Vec<(f64, f64)> = groups.iter().flat_map(|group| vec![(group.lo, group.hi); group.count]).collect();
        let limits = std::array::from_fn(|i| limits[i]);
        let joints = select(hand, design, &limits, &SpringCatalogue::built_in()?, &workshop)?;
        Ok(Self { joints, workshop, list: None })
    }

    /// Those of a list, which has to be about this experiment and this design; `tuned`: whether the
    /// experiment is a further training on it, which has a method of its own.
    fn of_list(
        list: PartsList,
        path: PathBuf,
        (experiment, tuned): (&Experiment, bool),
        (design, listed): (&[f64; DESIGN_LEN], fn(&SnappedParameter) -> f64),
    ) -> Result<Self, ChosenPartsError> {
        list.workshop.check(&path.display().to_string())?;
        let other = |fault: String| ChosenPartsError::Other { path: path.clone(), fault };
        let told =
            |name: &str, method: &str, seed: u64, task: &str| format!("{name} · {method} · seed {seed} ({task})");
        let there = told(&list.experiment, &list.method, list.seed, &list.task);
        let method = if tuned { &list.method } else { experiment.method.name() };
        let here = told(&experiment.name, method, experiment.seed, experiment.task.name());
        if there != here {
            return Err(other(format!("is about {there}, and this run is {here}")));
        }
        if list.design.len() != DESIGN_LEN {
            return Err(other(format!("has {} design parameters, and a hand has {DESIGN_LEN}", list.design.len())));
        }
        for (parameter, &here) in list.design.iter().zip(design) {
            let there = listed(parameter);
            if (there - here).abs() > LAST_DIGITS * here.abs().max(LAST_DIGITS) {
                let (name, unit) = (&parameter.name, &parameter.unit);
                let fault = format!("is about a hand whose {name} is {there} {unit}, and here it is {here} {unit}");
                return Err(other(fault.replace("  ", " ").trim_end().to_owned()));
            }
        }
        let joints = <[JointParts; 4]>::try_from(list.joints).ok();
        let is_ordered = |joints: &[JointParts; 4]| joints.iter().map(|joint| joint.joint.as_str()).eq(KINDS);
        let joints = joints.filter(is_ordered).ok_or_else(|| other(format!("is not about {}", KINDS.join(", "))))?;
        if let Some(joint) = joints.iter().find(|joint| joint.spring.count != list.workshop.springs) {
            let (name, count, springs) = (&joint.joint, joint.spring.count, list.workshop.springs);
            return Err(other(format!("has {count} springs at {name}, and its workshop {springs}")));
        }
        Ok(Self { joints, workshop: list.workshop, list: Some(path) })
    }

    /// The design that they make, SI.
    pub fn design(&self) -> [f64; DESIGN_LEN] {
        design_of(&self.joints, |joint| joint.built)
    }

    /// The springs of each kind of joint as they have to be made room for.
    pub fn springs(&self) -> [SeatedSpring; 4] {
        self.joints.each_ref().map(|joint| joint.spring.seated())
    }
}

/// The list that a run lies beside as its further training.
fn around(run: &Path, experiment: &Experiment) -> Result<Option<(PathBuf, PartsList)>, ChosenPartsError> {
    if experiment.method != Method::Fixed {
        return Ok(None);
    }
    // A folder may be called `.`.
    let Ok(whole) = run.canonicalize() else { return Ok(None) };
    let (Some(above), Some(name)) = (whole.parent(), whole.file_name()) else { return Ok(None) };
    let path = above.join(PARTS);
    let list = saved_json::<PartsList>(&path)?;
    let is_ours = |list: &PartsList| list.worth.tuned.as_ref().is_some_and(|tuned| name == tuned.folder.as_str());
    Ok(list.filter(is_ours).map(|list| (path, list)))
}
