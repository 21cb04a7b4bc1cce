//! The CSV file: a line for each step, SI, the task's world.

use std::io::{self, Write};

use super::{About, Output, text};
use crate::record::Step;

pub(super) struct CsvLog {
    output: Box<dyn Output>,
    seen: usize,
    commanded: usize,
}

/// The columns before and after those of the controller.
const FIRST: &str = "time_s,episode,phase,step,late_s";
const LAST: &str = "palm_x_m,palm_y_m,palm_z_m,target_x_m,target_y_m,target_z_m,speed_m_per_s,arm_clock_s,arm_age_s,arm_mode,arm_safety,\
                    wound_m,goal_m,travel_m,velocity_rad_per_s,current_a,torque_nm,voltage_v,temperature_c,motor_age_s,response";

impl CsvLog {
    pub(super) fn begin(mut output: Box<dyn Output>, about: &About) -> io::Result<Self> {
        write!(output, "{FIRST}")?;
        for name in &about.observation {
            write!(output, ",sees_{name}")?;
        }
        for name in &about.command {
            write!(output, ",says_{name}")?;
        }
        writeln!(output, ",{LAST}")?;
        Ok(Self { output, seen: about.observation.len(), commanded: about.command.len() })
    }

    pub(super) fn step(&mut self, step: &Step) -> io::Result<()> {
        let out = &mut self.output;
        write!(out, "{:.6},{},{},{},{:.6}", step.time, step.episode, step.phase, step.step, step.late)?;
        for &x in step.seen[..self.seen].iter().chain(&step.commanded[..self.commanded]) {
            number(out, x)?;
        }
        for &x in step.palm.iter().chain(&step.palm_target) {
            number(out, x)?;
        }
        number(out, step.tool_speed.iter().map(|x| x * x).sum::<f64>().sqrt())?;
        number(out, step.arm_clock)?;
        number(out, step.arm_age)?;
        write!(out, ",{},{}", text::mode(step.arm_mode), text::safety(step.arm_safety))?;
        let &Step { wound, goal, travel, velocity, current, torque, voltage, temperature, motor_age, .. } = step;
        for x in [wound, goal, travel, velocity, current, torque, voltage, temperature, motor_age] {
            number(out, x)?;
        }
        writeln!(out, ",\"{}\"", step.response)
    }

    pub(super) fn flush(&mut self) -> io::Result<()> {
        self.output.flush()
    }
}

/// A number; nothing where it is none.
fn number(out: &mut dyn Write, x: f64) -> io::Result<()> {
    if x.is_finite() { write!(out, ",{x:.6}") } else { write!(out, ",") }
}
