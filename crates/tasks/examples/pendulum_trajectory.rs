//! The pendulum under given commands, number by number: what `scripts/pendulum_peer.py` compares with Gymnasium.
//!
//! A line of two numbers on standard input puts the rod at an angle (rad) and a speed (rad/s). A line of one number is a
//! command (N·m), and is answered with the angle, the speed and the reward of its step. The gear is 1.
//!
//! ```sh
//! printf '3.0 0.5\n2.0\n-1.0\n' | cargo run -p hwasp-tasks --example pendulum_trajectory
//! ```

use std::error::Error;
use std::io::{BufRead, Write};

use hwasp_core::Environment;
use hwasp_tasks::pendulum::{MOTOR_LIMIT, Pendulum, PendulumSettings, Transmission};

fn main() -> Result<(), Box<dyn Error>> {
    let pendulum = Pendulum::new(&PendulumSettings::default())?;
    let (law, mut robot) = (pendulum.law(), pendulum.robot(None));
    let mut out = std::io::stdout().lock();
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        let numbers = line.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>()?;
        match numbers[..] {
            [angle, speed] => robot.plant_mut().place(angle, speed),
            [command] => {
                let mut effort = [0.0];
                let command = [command.clamp(-MOTOR_LIMIT, MOTOR_LIMIT)];
                law.effort(&[Transmission::CLASSIC], &command, &[], &mut effort);
                let step = robot.step(&effort, &command);
                let (angle, speed) = robot.plant().at();
                writeln!(out, "{angle:?} {speed:?} {:?}", step.reward)?;
            }
            _ => return Err(format!("`{line}` is neither a start of two numbers nor a command").into()),
        }
    }
    Ok(())
}
