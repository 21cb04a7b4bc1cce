//! What is known about a run's design without a simulation.
//!
//! The experiment and `design.toml` of the run folder are enough. Neither policy nor physics are built, so programs without the
//! engine can read a hand, too.

mod hand;
mod judged;

use std::collections::BTreeMap;
use std::path::Path;

use hwasp_experiment::{Catalogue, Experiment, Group};
use hwasp_plot::{Plot, write_plot};
use hwasp_runs::files::read_limited;
use hwasp_runs::{DESIGN, DesignGroupSummary, LARGEST_SUMMARY, RunError, io_error, saved_experiment};
pub use hwasp_tasks::hand::{ClosingPoint, FreeClosing, PinchBand, PinchTension};
use hwasp_tasks::hand::{DESIGN_LEN, HandDescription};
use serde::Serialize;

pub use self::hand::{DigitPair, HandReport, JointReport, PinchReport};
pub use self::judged::{Grade, HandJudgements, Judgement};
use crate::error::WorkshopError;

/// A group of design parameters and where they lie.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GroupReport {
    /// Its name.
    pub name: String,
    /// Its values, as `design.toml` has them.
    #[serde(flatten)]
    pub group: DesignGroupSummary,
    /// Where each value, as trained, lies between its limits: 0 at the lower one, 1 at the upper.
    pub position: Vec<f64>,
}

/// The design of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DesignReport {
    /// The experiment.
    pub experiment: String,
    /// How learner, controller and hardware were composed.
    pub method: String,
    /// The problem.
    pub task: String,
    /// The root seed.
    pub seed: u64,
    /// The groups, in the order of the design.
    pub groups: Vec<GroupReport>,
    /// How far they are from their limits; none where nothing is designed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub judged: Option<Judgement>,
    /// What statics say of it, where it is a hand.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hand: Option<HandReport>,
}

impl DesignReport {
    /// Reads the design in a run folder. The files are taken for hostile: what is computed of them is checked first.
    pub fn open(path: &Path, catalogue: &Catalogue) -> Result<Self, RunError> {
        let spec = saved_experiment(path, &[], catalogue)?;
        let file = path.join(DESIGN);
        if !file.is_file() {
            return Err(RunError::Unfinished { path: path.to_owned(), file: DESIGN });
        }
        let decode = |message: String| RunError::Decode { path: file.clone(), message };
        let text = String::from_utf8(read_limited(&file, LARGEST_SUMMARY)?).map_err(|e| decode(e.to_string()))?;
        let design = toml::from_str(&text).map_err(|e| decode(format!("not a design: {}", e.message())))?;
        Self::new(&spec, design).map_err(decode)
    }

    /// The design of an experiment, by the names of its groups; the error says what is wrong with it.
    fn new(spec: &Experiment, mut design: BTreeMap<String, DesignGroupSummary>) -> Result<Self, String> {
        let mut groups = Vec::new();
        for wanted in spec.task.groups() {
            let name = wanted.name.clone();
            let group = design.remove(&name).ok_or_else(|| format!("{name} is missing"))?;
            check(&group, &wanted).map_err(|what| format!("{name}: {what}"))?;
            let position = group.values.iter().map(|value| (value - wanted.lo) / (wanted.hi - wanted.lo)).collect();
            groups.push(GroupReport { name, group, position });
        }
        if let Some(name) = design.keys().next() {
            return Err(format!("{name:?} is no group of {}", spec.task.name()));
        }
        let hand = match hand_of(spec) {
            Some(hand) => {
                // Twelve groups of one.
                let design: [f64; DESIGN_LEN] = std::array::from_fn(|i| groups[i].group.as_built[0]);
                Some(HandReport::new(hand, &design).map_err(|e| e.to_string())?)
            }
            None => None,
        };
        Ok(Self {
            experiment: spec.name.clone(),
            method: spec.method.name().to_owned(),
            task: spec.task.name().to_owned(),
            seed: spec.seed,
            judged: judged::limits(&groups),
            groups,
            hand,
        })
    }
}

/// The hand that an experiment is about, if it is about one: everything about it that is not designed.
pub fn hand_of(experiment: &Experiment) -> Option<&HandDescription> {
    experiment.task.built().mechanism.as_ref()?.as_any().downcast_ref()
}

/// Whether a group is what the experiment can have given.
fn check(group: &DesignGroupSummary, wanted: &Group) -> Result<(), String> {
    let (&Group { count, lo, hi, .. }, unit) = (wanted, wanted.dimension.si());
    if group.unit != unit {
        return Err(format!("the unit is {:?}, and the experiment has {unit:?}", group.unit));
    }
    if group.limits != [lo, hi] {
        return Err(format!("the limits are {:?}, and the experiment has {:?}", group.limits, [lo, hi]));
    }
    for (what, values) in [("values", &group.values), ("as_built", &group.as_built)] {
        if values.len() != count {
            return Err(format!("{what} has length {}, and the experiment has {count}", values.len()));
        }
    }
    // The logistic function's last bit.
    let slack = 1e-9 * (hi - lo);
    if let Some(value) = group.values.iter().find(|value| !(lo - slack..=hi + slack).contains(*value)) {
        return Err(format!("{value} is outside of the limits [{lo}, {hi}]"));
    }
    let others = [group.total, group.total_as_built].into_iter().chain(group.optimum);
    match group.as_built.iter().copied().chain(others).find(|value| !value.is_finite()) {
        Some(value) => Err(format!("{value} is no number of a design")),
        None => Ok(()),
    }
}

/// Writes the picture of free closing into a folder, which is created where it is missing: `closing.svg`, `closing.png`.
pub fn write_closing(folder: &Path, plot: &Plot) -> Result<(), WorkshopError> {
    std::fs::create_dir_all(folder).map_err(|source| io_error("create", folder, source))?;
    for name in ["closing.svg", "closing.png"] {
        write_plot(&folder.join(name), plot)?;
    }
    Ok(())
}
