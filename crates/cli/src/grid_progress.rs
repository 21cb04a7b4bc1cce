//! Progress of a comparison: a line per cell that is at work, and how long all of it will take.

use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use hwasp_study::Watch;
use hwasp_training::{Event, TrainError};
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

use crate::log::has_terminal;
use crate::output::remark;
use crate::progress::duration;

const CELL: &str = "{percent:>3}% {bar:20.cyan/dim} {wide_msg}";
const ALL: &str = "{percent:>3}% {bar:20.green/dim} {wide_msg}";

/// Shows where a grid stands.
pub(crate) struct GridProgress {
    quiet: bool,
    terminal: bool,
    threads: usize,
    began: Instant,
    bars: MultiProgress,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    cells: Vec<CellState>,
    all: Option<ProgressBar>,
}

struct CellState {
    label: String,
    budget: u64,
    env_steps: u64,
    /// Seconds of its own, as far as it is.
    wall_s: f64,
    /// Trained, or there already.
    done: bool,
    bar: Option<ProgressBar>,
}

impl GridProgress {
    pub(crate) fn new(quiet: bool, threads: usize) -> Self {
        Self {
            quiet,
            terminal: has_terminal(),
            threads,
            began: Instant::now(),
            bars: MultiProgress::new(),
            state: Mutex::default(),
        }
    }

    /// Clears what is shown.
    pub(crate) fn finish(&self) {
        // What cannot be cleared stays on the terminal and does no harm.
        let _ = self.bars.clear();
    }

    fn with<R>(&self, work: impl FnOnce(&mut State) -> R) -> R {
        work(&mut self.state.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Counts a cell as done, and says what it is called.
    fn done(&self, cell: usize) -> String {
        self.with(|state| {
            let cell = &mut state.cells[cell];
            cell.done = true;
            if let Some(bar) = cell.bar.take() {
                bar.finish_and_clear();
            }
            cell.label.clone()
        })
    }

    fn bar(&self, length: u64, template: &str) -> ProgressBar {
        let bar = self.bars.add(ProgressBar::new(length.max(1)));
        // The templates are constants; should they ever be wrong, the plain bar will do.
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar
    }
}

impl State {
    /// Cells that are done, and seconds left: methods differ in speed, so each cell that has not begun is taken to need
    /// what those of its method did, or the mean of all.
    fn outlook(&self, threads: usize) -> (usize, Option<f64>) {
        let begun: Vec<&CellState> = self.cells.iter().filter(|c| c.env_steps > 0 && c.wall_s > 0.0).collect();
        let whole = |c: &CellState| c.wall_s * c.budget as f64 / c.env_steps as f64;
        let mean =
            |of: &[&CellState]| (!of.is_empty()).then(|| of.iter().map(|c| whole(c)).sum::<f64>() / of.len() as f64);
        let method = |c: &CellState| c.label.split(" seed ").next().unwrap_or_default().to_owned();
        let left = self.cells.iter().filter(|c| !c.done).map(|c| {
            let alike: Vec<&CellState> = begun.iter().copied().filter(|b| method(b) == method(c)).collect();
            mean(&alike).or_else(|| mean(&begun)).map(|whole| (whole - c.wall_s).max(0.0))
        });
        let left = left.sum::<Option<f64>>().map(|seconds| seconds / threads as f64);
        (self.cells.iter().filter(|c| c.done).count(), left)
    }
}

impl Watch for GridProgress {
    fn grid(&self, cells: &[(String, u64, bool)]) {
        self.with(|state| {
            state.cells = cells
                .iter()
                .map(|(label, budget, old)| CellState {
                    label: label.clone(),
                    budget: *budget,
                    env_steps: 0,
                    wall_s: 0.0,
                    done: *old,
                    bar: None,
                })
                .collect();
            let old = cells.iter().filter(|cell| cell.2).count();
            if self.quiet {
                return;
            }
            if self.terminal {
                state.all = Some(self.bar(cells.len() as u64, ALL));
            } else {
                let there = if old > 0 { format!(", {old} of them there already") } else { String::new() };
                remark(&format!("{} cells{there}", cells.len()));
            }
        });
    }

    fn cell(&self, cell: usize, event: Event<'_>) {
        self.with(|state| {
            match event {
                Event::Started { .. } if self.terminal && !self.quiet => {
                    state.cells[cell].bar = Some(self.bar(state.cells[cell].budget, CELL));
                }
                Event::Iteration(row) => {
                    let c = &mut state.cells[cell];
                    (c.env_steps, c.wall_s) = (row.env_steps, row.wall_s);
                    if let Some(bar) = &c.bar {
                        bar.set_position(row.env_steps.min(c.budget));
                        bar.set_message(format!("{}  discounted return {:.1}", c.label, row.discounted_return));
                    }
                }
                Event::Evaluated(evaluation) => {
                    let c = &mut state.cells[cell];
                    c.done = true;
                    if let Some(bar) = c.bar.take() {
                        bar.finish_and_clear();
                    }
                    let told = format!(
                        "{}: discounted return {:.1} in {}",
                        c.label,
                        evaluation.discounted_return.mean,
                        duration(c.wall_s)
                    );
                    let (done, left) = state.outlook(self.threads);
                    let left = left.map_or(String::new(), |left| format!(", about {} left", duration(left)));
                    if !self.quiet && !self.terminal {
                        remark(&format!("{done} of {} cells  {told}{left}", state.cells.len()));
                    }
                }
                _ => {}
            }
            if let Some(all) = &state.all {
                let (done, left) = state.outlook(self.threads);
                let left = left.map_or(String::new(), |left| format!(", about {} left", duration(left)));
                all.set_position(done as u64);
                let since = duration(self.began.elapsed().as_secs_f64());
                all.set_message(format!("{done} of {} cells after {since}{left}", state.cells.len()));
            }
        });
    }

    fn failed(&self, cell: usize, error: &TrainError) {
        // Told even where nothing else is: there are no figures of it.
        tracing::error!("{} failed: {error}", self.done(cell));
    }

    fn failed_before(&self, cell: usize, reason: &str) {
        tracing::error!("{} failed before, and is not repeated: {reason}", self.done(cell));
    }

    fn waiting(&self, cell: usize, owner: &str) {
        let label = self.with(|state| state.cells[cell].label.clone());
        if !self.quiet {
            remark(&format!("{label} is trained by process {owner}: waiting for it"));
        }
    }

    fn joined(&self, cell: usize) {
        let label = self.done(cell);
        if !self.quiet {
            remark(&format!("{label}: taken from the other process"));
        }
    }
}
