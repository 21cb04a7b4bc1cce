//! The report of one run.

use std::path::{Path, PathBuf};

use super::page::{KeyFigure, Page};
use super::sections::{curves, design, hand, law, outcome, overview, parts, provenance, tolerances};
use super::words::{decimal, duration, mean_interval, percent, rate_interval};
use super::{episode, words};
use crate::design::DesignReport;
use crate::metrics::MetricsTable;
use crate::parts::{PARTS, PartsList};
use crate::run_folder::{
    EXPERIMENT, Provenance, RunError, SUMMARY, encode, saved_json, saved_metrics, saved_provenance, saved_spec,
    saved_summary,
};
use crate::spec::Spec;
use crate::summary::Summary;
use crate::text::grouped;
use crate::tolerances::{Sensitivities, TOLERANCES};

/// Where parts and tolerances are, unless they were put elsewhere.
const BUILD: &str = "build";

/// Everything that a run folder says.
pub(super) struct Run {
    pub(super) path: PathBuf,
    pub(super) spec: Spec,
    /// The experiment as a file, every setting resolved.
    pub(super) experiment: String,
    pub(super) summary: Summary,
    pub(super) design: DesignReport,
    pub(super) metrics: MetricsTable,
    pub(super) provenance: Option<Provenance>,
    pub(super) parts: Option<PartsList>,
    pub(super) tolerances: Option<Sensitivities>,
}

impl Run {
    /// Reads a folder and checks that what it says fits together.
    pub(super) fn open(path: &Path) -> Result<Self, RunError> {
        let spec = saved_spec(path, &[])?;
        let summary = saved_summary(path)?;
        same_run(&spec, (&summary.experiment, &summary.method, &summary.task, summary.seed), &path.join(SUMMARY))?;
        let (parts, tolerances) = (path.join(BUILD).join(PARTS), path.join(BUILD).join(TOLERANCES));
        let run = Self {
            path: path.to_owned(),
            experiment: spec.to_toml().map_err(|e| encode(EXPERIMENT, &e))?,
            summary,
            design: DesignReport::open(path)?,
            metrics: saved_metrics(path)?,
            provenance: saved_provenance(path)?,
            parts: saved_json(&parts)?,
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

    /// The report.
    pub(super) fn page(&self) -> Result<Page, RunError> {
        let mut sections = vec![overview::section(self), episode::section(self)?, outcome::section(self)];
        sections.extend([curves::section(self), design::section(self)]);
        if let Some(hand) = &self.design.hand {
            sections.extend([hand::section(hand), parts::section(self)]);
        }
        sections.extend([tolerances::section(self), law::section(self), provenance::section(self)]);
        let (kind, lead) = ("Run", self.spec.description.clone());
        Ok(Page { title: self.title(), kind, lead, figures: self.key_figures(), sections })
    }

    fn key_figures(&self) -> Vec<KeyFigure> {
        let Summary { evaluation, env_steps, wall_s, .. } = &self.summary;
        let figure = |label: &str, value: String, note: String| KeyFigure { label: label.into(), value, note };
        let mut figures = Vec::new();
        if let Some(all) = evaluation.success.first() {
            let of = format!("{} of {}; 95 % interval {}", all.successes, all.episodes, rate_interval(all));
            figures.push(figure("Success", percent(all.rate()), of));
        }
        for group in self.design.groups.iter().filter(|group| group.group.optimum.is_some()) {
            let shown = crate::text::Shown::of(&group.group);
            let best =
                group.group.optimum.map_or(String::new(), |best| format!("best known {}", shown.with_unit(best)));
            let label = if group.position.len() == 1 { String::new() } else { "Total ".to_owned() };
            let label = label + &words::spaced(&group.name);
            figures.push(figure(&label, shown.with_unit(group.group.total_as_built), best));
        }
        let interval = format!("95 % interval {}", mean_interval(&evaluation.discounted_return, 1));
        figures.push(figure("Discounted return", decimal(evaluation.discounted_return.mean, 1), interval));
        let parameters: usize = self.design.groups.iter().map(|group| group.position.len()).sum();
        let of = if parameters == 1 { "number of the body" } else { "numbers of the body" };
        figures.push(figure("Designed", parameters.to_string(), of.into()));
        figures.push(figure("Simulator steps", grouped(*env_steps), format!("in {}", duration(*wall_s))));
        figures
    }
}

/// Whether a file is about the run that it lies with.
fn same_run(spec: &Spec, (name, method, task, seed): (&str, &str, &str, u64), file: &Path) -> Result<(), RunError> {
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
