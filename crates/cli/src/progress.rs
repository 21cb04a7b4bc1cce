//! Progress: a bar on a terminal, a line now and then elsewhere.

use std::io::IsTerminal;

use hwasp_lab::{Assembly, Event, Observer, ObserverError};
use indicatif::{ProgressBar, ProgressStyle};

/// Lines per training where there is no terminal.
const LINES: u64 = 20;

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
            terminal: std::io::stderr().is_terminal(),
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
            self.bar = ProgressBar::new(env_steps);
            let style = "{bar:32.cyan/dim} {percent:>3}%  {msg}  {per_sec}  {eta} left";
            // The template is a constant; should it ever be wrong, the plain bar will do.
            if let Ok(style) = ProgressStyle::with_template(style) {
                let per_sec = |state: &indicatif::ProgressState, out: &mut dyn std::fmt::Write| {
                    let _ = write!(out, "{:.0}k steps/s", state.per_sec() / 1e3);
                };
                self.bar.set_style(style.with_key("per_sec", per_sec));
            }
        }
    }

    fn iteration(&mut self, row: &hwasp_lab::metrics::MetricsRow) {
        let design: Vec<String> = self
            .names
            .iter()
            .zip(&row.design_totals)
            .zip(&self.units)
            .map(|((name, total), unit)| format!("{name} {total:.4} {unit}").trim_end().to_owned())
            .collect();
        let message = format!("return {:.1}  {}", row.discounted_return, design.join("  "));
        if self.terminal {
            self.bar.set_position(row.env_steps.min(self.env_steps));
            self.bar.set_message(message);
            return;
        }
        let due = row.env_steps * LINES / self.env_steps;
        if due > self.lines {
            self.lines = due;
            let rate = row.env_steps as f64 / row.wall_s.max(1e-9) / 1e3;
            eprintln!("{:>10} of {} steps  {message}  {rate:.0}k steps/s", row.env_steps, self.env_steps);
        }
    }
}

impl Observer for Progress {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        match event {
            Event::Started { env_steps, totals } => self.start(env_steps, totals),
            Event::Iteration(row) => self.iteration(row),
            Event::Evaluating => self.bar.set_message("evaluating"),
            Event::Evaluated(_) => self.finish(),
        }
        Ok(())
    }
}
