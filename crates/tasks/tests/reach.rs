//! The reach task: arithmetic by hand, and that its best gear is best.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use hwasp_core::{Environment, Purpose, stream};
use hwasp_tasks::reach::{Gear, Reach, ReachSettings};

/// gear 0.5, command -0.8: v = -0.8·0.5·(1 - 0.25) = -0.3 m/s, so 0.1 s moves the point 0.03 m.
#[test]
fn one_step_by_hand() {
    let reach = Reach::new(ReachSettings::default()).unwrap();
    let mut robot = reach.robot(None);
    robot.reset(&mut stream(0, Purpose::TrainingReset, 0, 0));
    let (mut x, mut effort) = ([0.0], [0.0]);
    robot.state(&mut x);
    reach.law().effort(&[0.5], &[-0.8], &x, &mut effort);
    assert!((effort[0] + 0.3).abs() < 1e-15);
    let step = robot.step(&effort, &[-0.8]);
    let after = (x[0] - 0.03).max(-1.0);
    robot.observe(&mut x);
    assert!((x[0] - after).abs() < 1e-15);
    assert!((step.reward + (after - 0.25) * (after - 0.25) + 0.01 * 0.64).abs() < 1e-15);
}

/// Mean return of "as fast as needed, straight to the goal" over a few starts.
fn returns(reach: &Reach, gear: f64) -> f64 {
    let (law, mut robot) = (reach.law(), reach.robot(None));
    let (mut x, mut effort) = ([0.0], [0.0]);
    let mut total = 0.0;
    for episode in 0..50 {
        robot.reset(&mut stream(0, Purpose::EvaluationReset, 0, episode));
        loop {
            robot.observe(&mut x);
            let command = [((0.25 - x[0]) / 0.1).clamp(-1.0, 1.0)];
            law.effort(&[gear], &command, &x, &mut effort);
            let step = robot.step(&effort, &command);
            total += step.reward;
            if step.end.is_some() {
                break;
            }
        }
    }
    total / 50.0
}

#[test]
fn the_best_gear_is_in_the_middle() {
    let reach = Reach::new(ReachSettings::default()).unwrap();
    let best = returns(&reach, Gear::OPTIMUM);
    println!("{best} at the optimum, {} at 0.5, {} at 0.1", returns(&reach, 0.5), returns(&reach, 0.1));
    assert!(best > -4.0, "{best}");
    for (gear, loss) in [(0.9, 0.0), (1.1, 0.0), (0.5, 0.5), (1.5, 0.5), (0.1, 5.0), (1.9, 5.0)] {
        assert!(returns(&reach, gear) < best - loss, "gear {gear}: {} against {best}", returns(&reach, gear));
    }
}
