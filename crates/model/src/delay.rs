//! What is seen or done some steps later.

use std::collections::VecDeque;

use hwasp_settings::text::show;

/// Values of the last steps, the newest last.
#[derive(Debug, Default)]
pub(crate) struct Delay {
    pub(crate) steps: usize,
    kept: VecDeque<Vec<f64>>,
}

/// The most steps of a delay: each keeps its values.
const MOST: f64 = 1000.0;
/// The keys of `[task]` that say delays: of the observation, of the command.
pub(crate) const DELAYS: [&str; 2] = ["observation_delay", "command_delay"];

impl Delay {
    /// The steps of a delay in s.
    pub(crate) fn steps(time: f64, time_step: f64) -> Result<usize, String> {
        let steps = (time / time_step).round();
        if (0.0..=MOST).contains(&steps) {
            return Ok(steps as usize);
        }
        let most = show(MOST * time_step);
        Err(format!("a delay is 0 to {most} s, {MOST} steps, and this is {} s", show(time)))
    }

    pub(crate) fn begin(&mut self, steps: usize) {
        self.steps = steps;
        self.kept.clear();
    }

    /// Takes a value and gives the one of some steps before; the oldest that there is at the start.
    pub(crate) fn pass(&mut self, value: &mut [f64]) {
        if self.steps == 0 {
            return;
        }
        let mut newest =
            if self.kept.len() > self.steps { self.kept.pop_front().unwrap_or_default() } else { Vec::new() };
        newest.clear();
        newest.extend_from_slice(value);
        self.kept.push_back(newest);
        if let Some(oldest) = self.kept.front() {
            value.copy_from_slice(oldest);
        }
    }
}
