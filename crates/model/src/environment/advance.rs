//! What happens in a step.

use std::sync::Arc;

use super::ModelEnvironment;
use crate::columns::Column;
use crate::robot::{Robot, Target};

impl ModelEnvironment {
    /// Effort and command as the motors get them.
    pub(super) fn delay_told(&mut self) {
        if self.told.steps == 0 {
            return;
        }
        let efforts = self.effort.len();
        let mut both: Vec<f64> = self.effort.iter().chain(&self.command).copied().collect();
        self.told.pass(&mut both);
        self.effort.copy_from_slice(&both[..efforts]);
        self.command.copy_from_slice(&both[efforts..]);
    }

    /// Applies forces, controls and efforts, and lets time pass.
    pub(super) fn advance(&mut self) -> Result<(), String> {
        let robot = Arc::clone(&self.robot);
        if let (Some((formula, bodies)), true) = (&robot.forces, self.forces.is_some()) {
            self.draw(&formula.draws);
            if let Some(ready) = &mut self.forces {
                ready.run(formula, &self.values);
                if let Some(value) = ready.out.iter().find(|value| !value.is_finite()) {
                    return Err(format!("a force of [task.forces] is {value} N: see its formula"));
                }
                self.body.push(bodies, &ready.out);
            }
        }
        for (command, actuator) in self.command.iter().zip(&robot.direct) {
            if let Some(actuator) = actuator {
                self.body.control(*actuator, *command);
            }
        }
        if self.own_law {
            return self.advance_with_law(&robot);
        }
        let tendons = robot.targets.iter().any(|target| matches!(target, Target::Tendon(_)));
        if !tendons {
            self.body.apply(&robot.targets, &self.effort);
            return self.body.step(robot.frame_skip);
        }
        // A tension is held, and the arms at which it pulls change on the way.
        for _ in 0..robot.frame_skip {
            self.body.apply(&robot.targets, &self.effort);
            self.body.step(1)?;
        }
        Ok(())
    }

    /// The law at the rate of the physics: what holding it for a step hides is seen so.
    fn advance_with_law(&mut self, robot: &Robot) -> Result<(), String> {
        let derived = robot.states.iter().any(|&at| matches!(robot.columns[at], Column::Engine(r) if r.is_derived()));
        for _ in 0..robot.frame_skip {
            self.body.refresh(derived)?;
            self.body.read(&mut self.values);
            for (state, &at) in self.state.iter_mut().zip(&robot.states) {
                *state = self.values[at];
            }
            robot.law.effort(&self.design, &self.command, &self.state, &mut self.effort);
            self.body.apply(&robot.targets, &self.effort);
            self.body.step(1)?;
        }
        Ok(())
    }
}
