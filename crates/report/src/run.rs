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
    /// How links lead from the page to the folder: empty where the page lies in it, else with a slash at its end.
    base: String,
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
    /// Reads a folder and checks that what it says fits together, for a page that will lie in the folder `page`.
    pub(super) fn open(path: &Path, page: &Path, catalogue: &Catalogue) -> Result<Self, RunError> {
        let spec = saved_experiment(path, &[], catalogue)?;
        let summary = saved_summary(path)?;
        same_run(&spec, (&summary.experiment, &summary.method, &summary.task, summary.seed), &path.join(SUMMARY))?;
        let (parts, tolerances) = (path.join(BUILD).join(PARTS), path.join(BUILD).join(TOLERANCES));
        let run = Self {
            path: path.to_owned(),
            base: way(page, path),
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

    /// The address of a file in the folder, as the page has it.
    pub(super) fn link(&self, file: &str) -> String {
        words::address(&format!("{}{file}", self.base))
    }

    /// Its folder as one types it into a shell.
    pub(super) fn typed_path(&self) -> String {
        words::quoted(&self.path.to_string_lossy())
    }
}

/// How one comes from one folder to another: up and down again, with a slash at its end; nothing where they are one.
fn way(from: &Path, to: &Path) -> String {
    // A page that is not written yet may be to lie in a folder that is not there yet: it is taken by its name.
    let whole = |path: &Path| std::fs::canonicalize(path).or_else(|_| std::path::absolute(path)).unwrap_or_default();
    let (from, to) = (whole(from), whole(to));
    let common = from.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    let up = from.components().skip(common).map(|_| "..".to_owned());
    let down = to.components().skip(common).map(|part| part.as_os_str().to_string_lossy().into_owned());
    up.chain(down).map(|part| part + "/").collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_lead_up_and_down_again() {
        let of = |from: &str, to: &str| way(Path::new(from), Path::new(to));
        assert_eq!(of("/nowhere/runs/one", "/nowhere/runs/one"), "");
        assert_eq!(of("/nowhere/pages", "/nowhere/runs/one"), "../runs/one/");
        assert_eq!(of("/nowhere/runs/one/pages", "/nowhere/runs/one"), "../");
    }
}
