//! What a comparison says: tables in three formats, and pictures.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use hwasp_plot::{Band, Curve, PlotOptions, XAxis, curves, write_plot};
use hwasp_runs::io_error;
use hwasp_runs::text::markdown;
use serde::{Deserialize, Serialize};

use crate::cell::CellResult;
use crate::error::CompareError;
use crate::figures::{Figure, MethodFigures, Pair, default_threshold};

/// The figures as JSON.
pub const COMPARISON: &str = "comparison.json";

/// The figures of all methods.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// The experiment.
    pub experiment: String,
    /// The training return whose steps are counted.
    pub threshold: f64,
    /// The methods, best evaluation first.
    pub methods: Vec<MethodFigures>,
    /// Every two methods, the one with the better evaluation first.
    pub improvement: Vec<Pair>,
}

impl Comparison {
    /// Summarises cells. Without a threshold it is nine tenths of the way from the worst first to the best last training
    /// return of all runs.
    pub fn new(experiment: &str, cells: &[CellResult], threshold: Option<f64>) -> Result<Self, CompareError> {
        let threshold = threshold.unwrap_or_else(|| default_threshold(cells));
        let mut groups: Vec<(&str, Vec<&CellResult>)> = Vec::new();
        for cell in cells {
            match groups.iter_mut().find(|(label, _)| *label == cell.label) {
                Some((_, group)) => group.push(cell),
                None => groups.push((&cell.label, vec![cell])),
            }
        }
        let mut methods = groups
            .iter()
            .map(|(label, cells)| MethodFigures::of(label, cells, threshold))
            .collect::<Result<Vec<_>, _>>()?;
        methods.sort_by(|a, b| b.evaluation.iqm.total_cmp(&a.evaluation.iqm));
        let pairs = (0..methods.len()).flat_map(|i| (i + 1..methods.len()).map(move |j| (i, j)));
        let improvement = pairs.map(|(i, j)| Pair::of(&methods[i], &methods[j])).collect::<Result<Vec<_>, _>>()?;
        Ok(Self { experiment: experiment.to_owned(), threshold, methods, improvement })
    }

    /// The tables as Markdown.
    pub fn markdown(&self) -> String {
        let mut text = format!("# {}\n\n", markdown(&self.experiment));
        let groups: Vec<&str> =
            self.methods.first().map_or(vec![], |m| m.design_totals.iter().map(|(g, _)| g.as_str()).collect());
        let _ = write!(text, "| method | seeds | evaluation | area under curve | steps to {:.1} |", self.threshold);
        for group in &groups {
            let _ = write!(text, " {group} | error |");
        }
        text.push_str(" steps | time |\n|---|---|---|---|---|");
        text.push_str(&"---|---|".repeat(groups.len()));
        text.push_str("---|---|\n");
        for m in &self.methods {
            let steps = m.threshold.median_env_steps.map_or("-".to_owned(), |steps| format!("{:.2}M", steps / 1e6));
            let _ = write!(
                text,
                "| {} | {} | {} | {} | {steps} ({} of {}) |",
                m.label,
                m.seeds,
                interval(&m.evaluation, 1),
                interval(&m.area_under_curve, 1),
                m.threshold.seeds,
                m.seeds
            );
            for group in &groups {
                let of = |list: &[(String, Figure)]| list.iter().find(|(g, _)| g == group).map(|(_, f)| *f);
                let totals = m.design_totals.iter().find(|(g, _)| g == group).map_or(&[][..], |(_, t)| t);
                let (low, high) =
                    totals.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &t| (l.min(t), h.max(t)));
                let error = of(&m.design_error).map_or("-".to_owned(), |f| interval(&f, 4));
                let _ = write!(text, " {low:.4} to {high:.4} | {error} |");
            }
            let failed = match m.failed_candidates {
                0 => String::new(),
                n => format!(", {n} candidates failed"),
            };
            let _ = writeln!(text, " {:.2}M{failed} | {:.1} s |", m.env_steps / 1e6, m.wall_s);
        }
        text.push_str(
            "\nInterquartile means over seeds with 95 % bootstrap intervals. *Evaluation*: discounted return of the deterministic\n\
             policy on held-out starts, on the hardware as built. *Area under curve*: mean discounted return of training over\n\
             the budget. *Steps to*: median real steps until the mean of the last 11 iterations reached that return. Design\n\
             totals are as built, lowest to highest seed; *error* is their distance from the known optimum. All steps are real\n\
             simulator steps, those of every candidate and every training inside a search included.\n",
        );
        if !self.improvement.is_empty() {
            text.push_str("\n| method | against | probability of improvement |\n|---|---|---|\n");
            for p in &self.improvement {
                let _ = writeln!(
                    text,
                    "| {} | {} | {:.2} [{:.2}, {:.2}] |",
                    p.method, p.other, p.probability, p.low, p.high
                );
            }
        }
        text
    }

    /// One line per method.
    pub fn csv(&self) -> String {
        let mut text = String::from(
            "method,seeds,evaluation,evaluation_low,evaluation_high,area_under_curve,area_low,area_high,threshold,\
             threshold_seeds,threshold_env_steps,env_steps,wall_s,failed_candidates\n",
        );
        for m in &self.methods {
            let steps = m.threshold.median_env_steps.map_or(String::new(), |steps| steps.to_string());
            // Labels hold what was typed: quoted, with quotes doubled.
            let _ = writeln!(
                text,
                "\"{}\",{},{},{},{},{},{},{},{},{},{steps},{},{},{}",
                m.label.replace('"', "\"\""),
                m.seeds,
                m.evaluation.iqm,
                m.evaluation.low,
                m.evaluation.high,
                m.area_under_curve.iqm,
                m.area_under_curve.low,
                m.area_under_curve.high,
                self.threshold,
                m.threshold.seeds,
                m.env_steps,
                m.wall_s,
                m.failed_candidates
            );
        }
        text
    }

    /// Writes `table.md`, `table.csv`, `comparison.json`, `curves.svg` and `time.svg` into a folder.
    pub fn write(&self, folder: &Path, cells: &[CellResult], options: &PlotOptions) -> Result<(), CompareError> {
        let write = |name: &str, text: String| {
            let path = folder.join(name);
            fs::write(&path, text).map_err(|source| io_error("write", &path, source))
        };
        write("table.md", self.markdown())?;
        write("table.csv", self.csv())?;
        // Figures are finite and keys are texts: this cannot fail.
        write(COMPARISON, serde_json::to_string_pretty(self).unwrap_or_default() + "\n")?;
        for (name, x_axis) in [("curves.svg", XAxis::EnvSteps), ("time.svg", XAxis::WallClock)] {
            let runs: Vec<Curve> =
                cells.iter().map(|cell| Curve::from_table(&cell.label, &cell.metrics, x_axis, 0)).collect();
            let options =
                PlotOptions { title: self.experiment.clone(), x_axis, band: Band::Bootstrap, ..options.clone() };
            write_plot(&folder.join(name), &curves(&runs, &options)?)?;
        }
        Ok(())
    }
}

fn interval(figure: &Figure, decimals: usize) -> String {
    let Figure { iqm, low, high } = figure;
    format!("{iqm:.decimals$} [{low:.decimals$}, {high:.decimals$}]")
}
