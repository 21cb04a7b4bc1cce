//! Progress: a bar on a terminal, a line now and then elsewhere.

use std::time::Instant;

use hwasp_runs::text::{grouped, quantity};
use hwasp_training::{Assembly, Event, MetricsRow, Observer, ObserverError};
use indicatif::{ProgressBar, ProgressStyle};

use crate::log::{PROGRESS, has_terminal};

/// Lines per training where there is no terminal.
const LINES: u64 = 20;

/// Totals of the design that a line has room for; `metrics.csv` has all.
const MOST_TOTALS: usize = 3;

/// The message takes what the bar leaves of the line and is cut there: a bar that wraps cannot be redrawn.
const TEMPLATE: &str = "{percent:>3}% {bar:20.cyan/dim} {wide_msg}";

/// Shows where a training stands.
pub(crate) struct Progress {
    bar: ProgressBar,
    terminal: bool,
    units: Vec<String>,
    env_steps: u64,
    names: Vec<String>,
    lines: u64,
}

impl Progress {
    pub(crate) fn new(assembly: &Assembly) -> Self {
        let groups = assembly.policy.space().groups();
        Self {
            bar: ProgressBar::hidden(),
            terminal: has_terminal(),
            units: groups.iter().map(|g| g.dimension.si().to_owned()).collect(),
            env_steps: 1,
            names: Vec::new(),
            lines: 0,
        }
    }

    /// Clears the bar.
    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }

    fn start(&mut self, env_steps: u64, totals: &[String]) {
        self.env_steps = env_steps.max(1);
        self.names = totals.to_vec();
        if self.terminal {
            self.bar = styled(self.env_steps);
        }
    }

    fn iteration(&mut self, row: &MetricsRow) {
        let rate = row.env_steps as f64 / row.wall_s.max(1e-9);
        let totals = self.names.iter().zip(&row.design_totals).zip(&self.units);
        let mut design: Vec<String> = totals
            .take(MOST_TOTALS)
            .map(|((name, total), unit)| format!("{name} {}", quantity(*total, unit)))
            .collect();
        if self.names.len() > MOST_TOTALS {
            design.push("…".to_owned());
        }
        // What matters most comes first: a narrow terminal shows no more than that.
        let worth = match row.undiscounted_return {
            // Where steps are counted, an iteration may be over before any episode is.
            none if none.is_nan() => "no return".to_owned(),
            mean => format!("return {mean:.1} (discounted {:.1})", row.discounted_return),
        };
        let message = format!("{worth}  {}  {}", design.join("  "), per_second(rate));
        if self.terminal {
            let left = self.env_steps.saturating_sub(row.env_steps) as f64 / rate;
            self.bar.set_position(row.env_steps.min(self.env_steps));
            self.bar.set_message(format!("{message}  {} left", duration(left)));
        }
        let due = row.env_steps.min(self.env_steps) * LINES / self.env_steps;
        if due > self.lines {
            self.lines = due;
            let total = grouped(self.env_steps);
            let steps = format!("{:>width$} of {total} steps", grouped(row.env_steps), width = total.len());
            tracing::info!(target: PROGRESS, "{steps}  {message}");
        }
    }
}

/// A rate such as `968k steps/s` or `412 steps/s`.
fn per_second(rate: f64) -> String {
    if rate >= 1e4 { format!("{:.0}k steps/s", rate / 1e3) } else { format!("{rate:.0} steps/s") }
}

/// Counts pieces of work: a bar on a terminal, a line for each elsewhere.
pub(crate) struct Counter {
    what: &'static str,
    began: Instant,
    bar: Option<ProgressBar>,
}

impl Counter {
    /// `what`: such as `designs simulated`.
    pub(crate) fn new(what: &'static str) -> Self {
        Self { what, began: Instant::now(), bar: None }
    }

    /// So many are done, at least one, of so many.
    pub(crate) fn tell(&mut self, done: usize, all: usize) {
        let left = self.began.elapsed().as_secs_f64() * (all - done) as f64 / done as f64;
        let message = format!("{done} of {all} {}, {} left", self.what, duration(left));
        if has_terminal() {
            let bar = self.bar.get_or_insert_with(|| styled(all as u64));
            bar.set_position(done as u64);
            bar.set_message(message.clone());
        }
        tracing::info!(target: PROGRESS, "{message}");
    }

    /// Clears the bar.
    pub(crate) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn styled(length: u64) -> ProgressBar {
    let bar = ProgressBar::new(length);
    // The template is a constant; should it ever be wrong, the plain bar will do.
    if let Ok(style) = ProgressStyle::with_template(TEMPLATE) {
        bar.set_style(style);
    }
    bar
}

/// A time such as `42 s`, `3 min 5 s` or `2 h 10 min`.
pub(crate) fn duration(seconds: f64) -> String {
    let s = seconds.ceil() as u64;
    match s {
        0..60 => format!("{s} s"),
        60..3600 => format!("{} min {} s", s / 60, s % 60),
        _ => format!("{} h {} min", s / 3600, s % 3600 / 60),
    }
}

impl Observer for Progress {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        match event {
            Event::Started { env_steps, totals, .. } => self.start(env_steps, totals),
            Event::Iteration(row) => self.iteration(row),
            Event::Evaluating => {
                self.bar.set_message("evaluating the design on held-out starts");
                self.bar.tick();
            }
            Event::Evaluated(_) => self.finish(),
            Event::Checkpoint(_) | Event::Failed(_) => {}
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A training of 412 steps a second was told as `0k steps/s`.
    #[test]
    fn slow_trainings_tell_their_rate() {
        assert_eq!(
            [412.4, 9_999.0, 10_400.0, 968_180.0].map(per_second),
            ["412 steps/s", "9999 steps/s", "10k steps/s", "968k steps/s"]
        );
    }
}
