//! What a design can grasp with a controller written by hand, before anything is learned: success by shape, with the law's
//! torques and with MuJoCo's own tendons, and the mean return.
//!
//!     scripted_grasp [EPISODES]        of each shape; default 5

#![allow(clippy::print_stdout)] // a program

use std::error::Error;
use std::fmt::Write;

use hwasp_core::{Environment, Purpose, Robot, stream};
use hwasp_grasp::{Grasp, GraspSettings, GraspTask, Script, ShapeKind};
use hwasp_tasks::hand::{PAPER_HWASP, PAPER_MINIMAL, SEARCHED, SMALL_CENTRE};

/// Successes and mean return of some episodes.
fn run(robot: &mut Robot<GraspTask>, grasp: &Grasp, design: &[f64], episodes: u64) -> (u64, f64) {
    let (mut successes, mut total) = (0, 0.0);
    for episode in 0..episodes {
        total += Script::default().play(robot, grasp, design, &mut stream(1, Purpose::Check, 0, episode)).0;
        successes += u64::from(robot.outcome().is_some_and(|outcome| outcome.success));
    }
    (successes, total / episodes as f64)
}

fn main() -> Result<(), Box<dyn Error>> {
    let episodes = std::env::args().nth(1).map_or(Ok(5), |n| n.parse::<u64>())?;
    println!("{:32} {:>8} {:>8} {:>8} {:>9} {:>10}", "success, %", "sphere", "box", "cylinder", "ellipsoid", "return");
    let designs = [
        ("centre of the small range", SMALL_CENTRE),
        ("searched", SEARCHED),
        ("paper's HWasP", PAPER_HWASP),
        ("paper's Minimal", PAPER_MINIMAL),
    ];
    for limit in [75.0, 163.0] {
        for (name, design) in designs {
            for native in [false, true] {
                let mut line = format!("{:32}", format!("{name}, {limit} N{}", if native { ", tendons" } else { "" }));
                let mut returns = 0.0;
                for &(_, kind) in ShapeKind::ALL {
                    let mut settings = GraspSettings { shapes: vec![kind], ..GraspSettings::default() };
                    settings.hand.transmission.tension_limit = limit;
                    let grasp = if native { Grasp::native(settings, &design)? } else { Grasp::new(settings)? };
                    let (successes, mean) = run(&mut grasp.robot(None), &grasp, &design, episodes);
                    write!(line, " {:8.0}", 100.0 * successes as f64 / episodes as f64)?;
                    returns += 0.25 * mean;
                }
                println!("{line}  {returns:9.1}");
            }
        }
    }
    Ok(())
}
