//! A controller by hand: down, wind, lift. It tells what a design can do before anything is learned.

use hwasp_core::{End, Environment, Robot, Stream};

use crate::grasp::Grasp;
use crate::plant::GraspPlant;
use crate::task::GraspTask;

/// How deep the palm goes and when it lifts. Defaults found by experiment.
#[derive(Clone, Debug)]
pub struct Script {
    /// The least height of the palm above the floor while grasping, m: below it the closing tips hit the floor.
    pub lowest: f64,
    /// How far the palm stays above the object's top, m.
    pub above: f64,
    /// Lift by so much, m.
    pub lift: f64,
    /// The tension, as a share of the motor's limit, at which it lifts.
    pub enough: f64,
    /// Winding steps before it lifts, at least and at most.
    pub winding: [usize; 2],
    /// The height the palm is sent to, m.
    target: f64,
    wound: usize,
    lifting: bool,
}

impl Default for Script {
    fn default() -> Self {
        Self {
            lowest: 0.100,
            above: 0.005,
            lift: 0.170,
            enough: 0.97,
            winding: [20, 200],
            target: 0.0,
            wound: 0,
            lifting: false,
        }
    }
}

impl Script {
    /// Plays one episode of `grasp` on the hand of this `design` (SI); returns the sum of its rewards and how it ended.
    /// The outcome is the robot's.
    pub fn play(
        &mut self,
        robot: &mut Robot<GraspTask>,
        grasp: &Grasp,
        design: &[f64],
        rng: &mut Stream,
    ) -> (f64, End) {
        let (law, transmission) = (grasp.law(), &grasp.settings().hand.transmission);
        let most = transmission.spool_radius * transmission.tension_limit;
        let (mut state, mut effort, mut total) = ([0.0; 7], [0.0; 7], 0.0);
        robot.set_design(design);
        robot.reset(rng);
        self.start(robot.plant());
        loop {
            let command = self.act(robot.plant(), robot, most);
            robot.state(&mut state);
            law.effort(design, &command, &state, &mut effort);
            let step = robot.step(&effort, &command);
            total += step.reward;
            if let Some(end) = step.end {
                return (total, end);
            }
        }
    }

    /// Starts an episode on a plant that was just reset.
    pub fn start(&mut self, plant: &GraspPlant) {
        (self.target, self.wound, self.lifting) = (plant.palm()[2], 0, false);
    }

    /// The palm's vertical motion and the motor's, m, both within their limits; `most` is the motor's torque limit, N·m.
    pub fn act(&mut self, plant: &GraspPlant, environment: &dyn Environment, most: f64) -> [f64; 2] {
        let limits = &environment.spec().command;
        let (palm, motor) = (limits[limits.len() - 2].hi, limits[limits.len() - 1].hi);
        let grasp = (plant.object().bounding_box()[2] + self.above).max(self.lowest);
        let tension = plant.motor_torque() / most;
        let goal = if self.lifting { grasp + self.lift } else { grasp };
        let down = (goal - self.target).clamp(-palm, palm);
        let there = !self.lifting && down.abs() < 1e-9;
        let wind = if self.lifting { tension < 0.999 } else { there };
        if there {
            self.wound += 1;
            self.lifting = (tension >= self.enough && self.wound > self.winding[0]) || self.wound > self.winding[1];
        }
        self.target += down;
        [down, if wind { motor } else { 0.0 }]
    }
}
