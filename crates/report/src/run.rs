//! The report of one run.

use std::path::{Path, PathBuf};

use hwasp_experiment::{Catalogue, EXPERIMENT, Experiment};
use hwasp_runs::metrics::MetricsTable;
use hwasp_runs::{
    Provenance, RunError, SUMMARY, Summary, encode, saved_experiment, saved_json, saved_metrics, saved_provenance,
    saved_summary,
};
use hwasp_workshop::design::DesignReport;
use hwasp_workshop::parts::{PARTS, PartsList, Verdict, verdict_of_run};
use hwasp_workshop::tolerances::{Sensitivities, TOLERANCES};

use crate::words;

/// Where parts and tolerances are, unless they were put elsewhere.
const BUILD: &str = "build";

/// Everything that a run folder says.
pub(super) struct Run {
    pub(super) path: PathBuf,
    pub(super) spec: Experiment,
    /// The experiment as a file, every setting resolved.
    pub(super) experiment: String,
    pub(super) summary: Summary,
    pub(super) design: DesignReport,
    pub(super) metrics: MetricsTable,
    pub(super) provenance: Option<Provenance>,
    pub(super) parts: Option<PartsList>,
    /// Whether its hand can be built, if it is one.
    pub(super) verdict: Option<Verdict>,
    pub(super) tolerances: Option<Sensitivities>,
}

impl Run {
    /// Reads a folder and checks that what it says fits together.
    pub(super) fn open(path: &Path, catalogue: &Catalogue) -> Result<Self, RunError> {
        let spec = saved_experiment(path, &[], catalogue)?;
        let summary = saved_summary(path)?;
        same_run(&spec, (&summary.experiment, &summary.method, &summary.task, summary.seed), &path.join(SUMMARY))?;
        let (parts, tolerances) = (path.join(BUILD).join(PARTS), path.join(BUILD).join(TOLERANCES));
        let run = Self {
            path: path.to_owned(),
            experiment: spec.to_toml().map_err(|e| encode(EXPERIMENT, &e))?,
            summary,
            design: DesignReport::open(path, catalogue)?,
            metrics: saved_metrics(path)?,
            provenance: saved_provenance(path)?,
            parts: saved_json(&parts)?,
            verdict: verdict_of_run(path, catalogue)?,
            tolerances: saved_json(&tolerances)?,
            spec,
        };
        if let Some(list) = &run.parts {
            same_run(&run.spec, (&list.experiment, &list.method, &list.task, list.seed), &parts)?;
        }
        if let Some(list) = &run.tolerances {
            same_run(&run.spec, (&list.experiment, &list.method, &list.task, list.seed), &tolerances)?;
        }
        Ok(run)
    }

    /// Experiment, method and seed.
    pub(super) fn title(&self) -> String {
        format!("{} · {} · seed {}", self.spec.name, self.spec.method.name(), self.spec.seed)
    }

    /// Its folder as one types it into a shell.
    pub(super) fn typed_path(&self) -> String {
        words::quoted(&self.path.to_string_lossy())
    }
}

/// Whether a file is about the run that it lies with.
fn same_run(
    spec: &Experiment,
    (name, method, task, seed): (&str, &str, &str, u64),
    file: &Path,
) -> Result<(), RunError> {
    let run = (spec.name.as_str(), spec.method.name(), spec.task.name(), spec.seed);
    if (name, method, task, seed) == run {
        return Ok(());
    }
    let message = format!(
        "it is about {name} · {method} · seed {seed} ({task}), and the experiment here is {} · {} · seed {} ({})",
        run.0, run.1, run.3, run.2
    );
    Err(RunError::Decode { path: file.to_owned(), message })
}
