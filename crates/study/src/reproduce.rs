//! The paper's toy figures and table, as comparisons with the authors' settings.

use std::fmt::Write as _;

use hwasp_experiment::{Catalogue, load};
use hwasp_training::stats::Sample;

use crate::cell::CellResult;
use crate::contender::Contender;
use crate::error::CompareError;
use crate::figures::trailing;
use crate::grid::Grid;
use crate::outcome::Outcome;

/// A figure or table of the paper.
#[derive(Clone, Copy, Debug)]
pub struct PaperFigure {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it shows.
    pub about: &'static str,
    /// The experiments behind it.
    pub experiments: &'static [&'static str],
    /// The methods in it.
    methods: &'static [&'static str],
    /// What is known of it.
    published: &'static [Published],
}

/// A number that others have published or measured.
#[derive(Clone, Copy, Debug)]
struct Published {
    experiment: &'static str,
    method: &'static str,
    what: What,
    value: &'static str,
    source: &'static str,
}

/// What was measured.
#[derive(Clone, Copy, Debug)]
enum What {
    /// The total of the design group, as trained.
    Total,
    /// The mean discounted return of the last 11 iterations at so many real steps.
    ReturnAt(u64),
}

const ALL: &[&str] = &["hwasp", "minimal", "cmaes", "ars", "cmaes-rl"];
const PAPER: &str = "the paper, table 1";
const AUTHORS: &str = "the authors' code, lowest to highest seed";

macro_rules! published {
    ($($experiment:literal $method:literal $what:expr => $value:literal, $source:expr;)*) => {
        &[$(Published { experiment: $experiment, method: $method, what: $what, value: $value, source: $source }),*]
    };
}

/// The figures and tables that can be reproduced.
pub const FIGURES: &[PaperFigure] = &[
    PaperFigure {
        name: "fig3-10",
        about: "training curves of the mass-spring problem, ten springs (figure 3, left)",
        experiments: &["paper/mass-spring"],
        methods: ALL,
        published: published![
            "paper/mass-spring" "hwasp" What::ReturnAt(1_000_000) => "-632 to -569", AUTHORS;
            "paper/mass-spring" "hwasp" What::ReturnAt(4_000_000) => "-560 to -517", AUTHORS;
            "paper/mass-spring" "minimal" What::ReturnAt(1_000_000) => "-694 to -528", AUTHORS;
            "paper/mass-spring" "minimal" What::ReturnAt(4_000_000) => "-499 to -481", AUTHORS;
        ],
    },
    PaperFigure {
        name: "fig3-50",
        about: "the same with fifty springs (figure 3, right)",
        experiments: &["paper/mass-spring-50"],
        methods: ALL,
        published: &[],
    },
    PaperFigure {
        name: "figs-bar-10",
        about: "training curves of the bar-length problem, ten segments (appendix)",
        experiments: &["paper/bar-length"],
        methods: ALL,
        published: published![
            "paper/bar-length" "hwasp" What::ReturnAt(1_000_000) => "-676 to -534", AUTHORS;
            "paper/bar-length" "hwasp" What::ReturnAt(4_000_000) => "-314 to -294", AUTHORS;
            "paper/bar-length" "minimal" What::ReturnAt(1_000_000) => "-556 to -487", AUTHORS;
            "paper/bar-length" "minimal" What::ReturnAt(4_000_000) => "-206 to -199", AUTHORS;
        ],
    },
    PaperFigure {
        name: "figs-bar-50",
        about: "the same with fifty segments (appendix)",
        experiments: &["paper/bar-length-50"],
        methods: ALL,
        published: &[],
    },
    PaperFigure {
        name: "table1",
        about: "the total stiffness that is found, N/m (table 1 of the appendix; the optimum is 19.6)",
        experiments: &["paper/mass-spring", "paper/mass-spring-50"],
        methods: &["hwasp", "minimal"],
        published: published![
            "paper/mass-spring" "hwasp" What::Total => "19.9", PAPER;
            "paper/mass-spring" "minimal" What::Total => "18.7", PAPER;
            "paper/mass-spring-50" "hwasp" What::Total => "20.1", PAPER;
            "paper/mass-spring-50" "minimal" What::Total => "21.9", PAPER;
        ],
    },
];

impl PaperFigure {
    /// The figure of this name.
    pub fn find(name: &str) -> Option<&'static Self> {
        FIGURES.iter().find(|figure| figure.name == name)
    }

    /// The comparison behind one of its experiments: five seeds at the steps that the paper charged, in real ones; `quick`
    /// is two seeds at a fifth of them.
    pub fn grid(&self, experiment: &str, quick: bool, catalogue: &Catalogue) -> Result<Grid, CompareError> {
        let contenders = self.methods.iter().map(|method| {
            // The paper's curves end at 4e6 nominal steps, which are 8e6 real ones for PPO; searches have theirs in the file.
            let contender = Contender::parse(method)?;
            let budget = |full: u64| (if quick { full / 5 } else { full }).to_string();
            Ok(match *method {
                "hwasp" | "minimal" => contender.with("train.env_steps", &budget(8_000_000)),
                "cmaes" => contender.with("train.env_steps", &budget(12_800_000)),
                "ars" => contender.with("train.env_steps", &budget(4_000_000)),
                _ => {
                    let inner = contender.with("search.inner_env_steps", &budget(1_200_000));
                    inner.with("train.env_steps", &budget(48_000_000))
                }
            })
        });
        let contenders = contenders.collect::<Result<_, CompareError>>()?;
        Ok(Grid { layers: load(experiment, catalogue)?, contenders, seeds: 0..if quick { 2 } else { 5 } })
    }

    /// What was published beside what came out, as Markdown; empty where nothing is known.
    pub fn beside(&self, experiment: &str, outcome: &Outcome) -> String {
        let mut text = String::new();
        for known in self.published.iter().filter(|known| known.experiment == experiment) {
            let cells = outcome.finished.iter().filter(|c| c.label == known.method);
            let values: Vec<f64> = cells.clone().filter_map(|c| known.what.of(c)).collect();
            let missing = outcome.missing.iter().filter(|c| c.label == known.method).count();
            let of = format!("{} of {} seeds", values.len(), cells.count() + missing);
            let ours = match Sample::new(&values) {
                Ok(s) if values.len() == 1 => format!("{:.1} ({of})", s.mean()),
                Ok(s) => format!("{:.1} ({:.1} to {:.1}, {of})", s.interquartile_mean(), s.min(), s.max()),
                Err(_) => format!("not reached ({of})"),
            };
            let _ =
                writeln!(text, "| {} | {} | {} | {ours} | {} |", known.method, known.what, known.value, known.source);
        }
        if text.is_empty() {
            return text;
        }
        format!("| method | what | published | ours | source |\n|---|---|---|---|---|\n{text}")
    }
}

impl What {
    fn of(self, cell: &CellResult) -> Option<f64> {
        match self {
            Self::Total => cell.summary.design.values().next().map(|group| group.total),
            Self::ReturnAt(steps) => trailing(&cell.metrics).find(|(at, _)| *at >= steps).map(|(_, mean)| mean),
        }
    }
}

impl std::fmt::Display for What {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Total => f.write_str("total"),
            Self::ReturnAt(steps) => {
                write!(f, "discounted return of training at {} million real steps", steps / 1_000_000)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_figure_can_be_put_together() {
        let catalogue = hwasp_testing::catalogue();
        for figure in FIGURES {
            for experiment in figure.experiments {
                for quick in [false, true] {
                    let cells = figure
                        .grid(experiment, quick, catalogue)
                        .unwrap()
                        .cells(std::path::Path::new("nowhere"), catalogue)
                        .unwrap();
                    assert_eq!(cells.len(), figure.methods.len() * if quick { 2 } else { 5 });
                }
            }
            for known in figure.published {
                assert!(figure.experiments.contains(&known.experiment) && figure.methods.contains(&known.method));
            }
        }
    }
}
