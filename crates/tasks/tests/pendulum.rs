//! The pendulum: arithmetic by hand, and the numbers of Gymnasium's.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use std::f64::consts::PI;

use hwasp_core::{Environment, Initial, Purpose, Step, stream};
use hwasp_tasks::pendulum::{MAX_SPEED, Pendulum, PendulumError, PendulumSettings, SwingUp, Transmission};

fn robot() -> (Pendulum, hwasp_core::Robot<SwingUp>) {
    let pendulum = Pendulum::new(&PendulumSettings::default()).unwrap();
    let robot = pendulum.robot(None);
    (pendulum, robot)
}

/// One command through the gear.
fn step(pendulum: &Pendulum, robot: &mut hwasp_core::Robot<SwingUp>, gear: f64, command: f64) -> Step {
    let (mut state, mut torque) = ([0.0; 2], [0.0]);
    robot.state(&mut state);
    let command = [command.clamp(-2.0, 2.0)];
    pendulum.law().effort(&[gear], &command, &state, &mut torque);
    robot.step(&torque, &command)
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-14
}

/// From θ = π/2 at 1 rad/s with a gear of 1.5 and the command 1: torque 1.5 N·m, so θ'' = 15·1 + 3·1.5 = 19.5 rad/s² and
/// the speed becomes 1 + 19.5·0.05 = 1.975 rad/s, the angle π/2 + 1.975·0.05. The reward counts what was before.
///
/// Then with the command -2: torque -3 N·m, θ'' = 15·sin θ - 9.
#[test]
fn two_steps_by_hand() {
    let (pendulum, mut robot) = robot();
    robot.plant_mut().place(0.5 * PI, 1.0);
    let first = step(&pendulum, &mut robot, 1.5, 1.0);
    let (angle, speed) = robot.plant().at();
    assert!(near(speed, 1.975) && near(angle, 0.5 * PI + 0.098_75), "{angle} {speed}");
    assert!(near(first.reward, -(0.25 * PI * PI + 0.1 + 0.001 * 2.25)), "{first:?}");

    let second = step(&pendulum, &mut robot, 1.5, -2.0);
    let wanted = 1.975 + (15.0 * 0.098_75_f64.cos() - 9.0) * 0.05;
    let (after, speed) = robot.plant().at();
    assert!(near(speed, wanted) && near(after, angle + 0.05 * wanted), "{after} {speed}");
    assert!(near(second.reward, -(angle * angle + 0.1 * 1.975 * 1.975 + 0.001 * 9.0)), "{second:?}");

    let mut seen = [0.0; 3];
    robot.observe(&mut seen);
    assert_eq!(seen, [after.cos(), after.sin(), speed]);
}

/// 7.9 rad/s and θ'' = 15 + 6 rad/s² would be 8.95 rad/s. The angle moves with the limited speed.
#[test]
fn the_speed_has_a_limit() {
    let (pendulum, mut robot) = robot();
    for sign in [1.0, -1.0] {
        robot.plant_mut().place(sign * 0.5 * PI, sign * 7.9);
        step(&pendulum, &mut robot, Transmission::CLASSIC, sign * 2.0);
        let (angle, speed) = robot.plant().at();
        assert!(speed == sign * MAX_SPEED && near(angle, sign * (0.5 * PI + 0.4)), "{angle} {speed}");
    }
}

/// An effort that a noisy law asks for is cut to what the largest gear gives, in the motion and in the price.
#[test]
fn the_torque_has_a_limit() {
    let of = |torque: f64| {
        let (_, mut robot) = robot();
        robot.plant_mut().place(0.3, 0.2);
        (robot.step(&[torque], &[0.0]).reward, robot.plant().at())
    };
    assert_eq!(of(4.0), of(50.0));
    assert_eq!(of(-4.0), of(-50.0));
    assert_ne!(of(3.9), of(4.0));
}

/// Full turns count for nothing, and straight down is π away on either side.
#[test]
fn the_angle_is_counted_from_upright() {
    let (pendulum, mut robot) = robot();
    let mut price = |angle| {
        robot.plant_mut().place(angle, 0.0);
        -step(&pendulum, &mut robot, Transmission::CLASSIC, 0.0).reward
    };
    for (angle, away) in [(0.0, 0.0), (2.0 * PI, 0.0), (6.0 * PI + 1.0, 1.0), (-5.0, 2.0 * PI - 5.0), (3.0 * PI, PI)] {
        assert!((price(angle) - away * away).abs() < 1e-12, "{angle}: {}", price(angle));
    }
}

/// `scripts/pendulum_peer.py --fixture` wrote the numbers: command, and angle, speed and reward after its step. Commands
/// beyond the motor's limits are among them.
#[test]
fn gymnasium_has_the_same_numbers() {
    let (pendulum, mut robot) = robot();
    let rows: Vec<Vec<f64>> = include_str!("pendulum/gymnasium.txt")
        .lines()
        .map(|line| line.split(' ').map(|number| number.parse().unwrap()).collect())
        .collect();
    assert_eq!(rows.len(), 51);
    assert!(rows.iter().any(|row| row[0].abs() > 2.0));
    robot.plant_mut().place(rows[0][1], rows[0][2]);
    for (i, row) in rows.iter().enumerate().skip(1) {
        let reward = step(&pendulum, &mut robot, Transmission::CLASSIC, row[0]).reward;
        let (angle, speed) = robot.plant().at();
        for (ours, theirs) in [angle, speed, reward].iter().zip(&row[1..]) {
            assert!((ours - theirs).abs() < 1e-12, "step {i}: {ours} is not {theirs}");
        }
    }
}

#[test]
fn starts_fill_their_range() {
    let (_, mut robot) = robot();
    let mut most = (0.0_f64, 0.0_f64);
    for episode in 0..2000 {
        robot.reset(&mut stream(0, Purpose::EvaluationReset, 0, episode));
        let (angle, speed) = robot.plant().at();
        assert!(angle.abs() <= PI && speed.abs() <= 1.0);
        most = (most.0.max(angle.abs()), most.1.max(speed.abs()));
    }
    assert!(most.0 > 3.13 && most.1 > 0.995, "{most:?}");
}

#[test]
fn impossible_settings_are_refused() {
    let base = PendulumSettings::default;
    assert_eq!(Pendulum::new(&PendulumSettings { horizon: 0, ..base() }).unwrap_err(), PendulumError::Horizon);
    for gear in [0.5, 2.0, f64::NAN] {
        let settings = PendulumSettings { initial: Initial::Value(gear), ..base() };
        assert!(matches!(Pendulum::new(&settings), Err(PendulumError::Design(_))), "{gear}");
    }
}
