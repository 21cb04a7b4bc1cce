//! The physics and the reward against arithmetic by hand and against known returns.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use hwasp_core::{Environment, Law, Plant, Purpose, stream};
use hwasp_tasks::mass_spring::{Coupling, Interface, MassSpring, MassSpringPlant, MassSpringSettings};

/// The sum of discounted rewards (discount 0.99) from the present state to the end, the motor giving `command`.
fn discounted(env: &mut dyn Environment, law: &Law, design: &[f64], command: f64) -> f64 {
    let mut state = [0.0; 4];
    let mut effort = vec![0.0; law.ports().effort.len()];
    let (mut total, mut weight) = (0.0, 1.0);
    loop {
        env.state(&mut state);
        law.effort(design, &[command], &state, &mut effort);
        let step = env.step(&effort, &[command]);
        total += weight * step.reward;
        weight *= 0.99;
        if step.end.is_some() {
            return total;
        }
    }
}

/// n equal parameters of this sum.
fn evenly(total: f64, count: usize) -> Vec<f64> {
    vec![total / count as f64; count]
}

fn close(found: f64, wanted: f64, tolerance: f64) {
    assert!((found - wanted).abs() <= tolerance, "{found} is not {wanted} ± {tolerance}");
}

/// y1 = 0.2, v1 = -0.5, K = 30, f = 2: effort 2 - 6 = -4 N, a = 9.8 - 4/0.2 = -10.2 m/s². In five steps of 2 ms
/// v = -0.5 - 10.2·0.01 = -0.602; y = 0.2 - 0.5·0.01 - 10.2·0.01²/2 = 0.19449 (a is held, so the five are exact as one).
#[test]
fn springs_by_hand() {
    let problem = MassSpring::stiffness(MassSpringSettings::default()).unwrap();
    let mut robot = problem.robot(None);
    robot.plant_mut().place(0.2, -0.5, 9.0);
    let (mut state, mut effort) = ([0.0; 4], [0.0]);
    robot.state(&mut state);
    assert_eq!(state, [0.2, -0.5, 0.2 + 0.1, -0.5], "a fixed bar ignores the gap");
    problem.law().effort(&evenly(30.0, 10), &[2.0], &state, &mut effort);
    close(effort[0], -4.0, 1e-12);
    let step = robot.step(&effort, &[2.0]);
    robot.state(&mut state);
    for (found, wanted) in state.iter().zip([0.194_49, -0.602, 0.294_49, -0.602]) {
        close(*found, wanted, 1e-12);
    }
    // error 10·0.09449 + 0.5·0.602 = 1.2459, F = 4, sigmoid(10·1.1459) = 0.9999894...
    let far = 1.0 / (1.0 + (-11.459_f64).exp());
    close(step.reward, -1.2459 - (4.0 + 6.0 * far), 1e-9);
}

/// y1 = 0.1, y2 = 0.25, v = 0.3, Σl = 0.1, f = 1: the interface pulls 100·0.05 = 5 N.
/// a1 = 9.8 + (5 - 2)/0.1 = 39.8; a2 = 9.8 + (-5 + 1)/0.1 = -30.2.
#[test]
fn free_masses_by_hand() {
    let problem = MassSpring::bar(MassSpringSettings::default(), Interface::Soft).unwrap();
    let mut robot = problem.robot(None);
    robot.plant_mut().place(0.1, 0.3, 0.15);
    let (mut state, mut effort) = ([0.0; 4], [0.0; 2]);
    robot.state(&mut state);
    problem.law().effort(&evenly(0.1, 10), &[1.0], &state, &mut effort);
    close(effort[0], 5.0, 1e-12);
    assert_eq!(effort[1], -effort[0]);
    // The damper: b/2·(v2 - v1) = 5·(0.7 - 0.3) N more.
    problem.law().effort(&evenly(0.1, 10), &[1.0], &[0.1, 0.3, 0.25, 0.7], &mut effort);
    close(effort[0], 7.0, 1e-12);
    robot.step(&[5.0, -5.0], &[1.0]);
    robot.state(&mut state);
    let wanted = [0.103 + 39.8 * 5e-5, 0.3 + 0.398, 0.253 - 30.2 * 5e-5, 0.3 - 0.302];
    for (found, wanted) in state.iter().zip(wanted) {
        close(*found, wanted, 1e-12);
    }
}

/// y1 = 0.1, v = 0.3, f = 1: a = 9.8 + (1 - 20·0.1)/0.2 = 4.8, and the length holds at once.
#[test]
fn a_given_bar_by_hand() {
    let mut plant = MassSpringPlant::new(&MassSpringSettings::default(), Coupling::GivenBar);
    plant.place(0.1, 0.3, 0.025);
    assert_eq!(plant.lower(), (0.125, 0.3));
    plant.advance(&[0.07], &[1.0]);
    let ((y1, v1), (y2, v2)) = (plant.upper(), plant.lower());
    close(y1, 0.103 + 4.8 * 5e-5, 1e-12);
    close(v1, 0.348, 1e-12);
    assert_eq!((y2, v2), (y1 + 0.07, v1));
}

#[test]
fn positions_and_speeds_are_limited_after_the_action() {
    let mut plant = MassSpringPlant::new(&MassSpringSettings::default(), Coupling::Free);
    plant.place(0.01, -1.9, 0.48);
    plant.advance(&[-100.0, 100.0], &[5.0]);
    assert_eq!((plant.upper(), plant.lower()), ((0.0, -2.0), (0.5, 2.0)));
}

#[test]
fn the_authors_effort_limit_is_on_every_force_and_on_no_length() {
    let settings = MassSpringSettings { effort_limit: Some(5.0), ..MassSpringSettings::default() };
    for (coupling, beyond, at) in
        [(Coupling::FixedBar(0.1), [-7.0, 0.0], [-5.0, 0.0]), (Coupling::Free, [7.0, -7.0], [5.0, -5.0])]
    {
        let run = |settings: &MassSpringSettings, effort: &[f64]| {
            let mut plant = MassSpringPlant::new(settings, coupling);
            plant.place(0.2, 0.0, 0.1);
            plant.advance(effort, &[1.0]);
            (plant.upper(), plant.lower())
        };
        assert_eq!(run(&settings, &beyond), run(&settings, &at));
        assert_ne!(run(&MassSpringSettings::default(), &beyond), run(&settings, &at));
    }
}

/// Known from dynamic programming on the same plant: -1113.6 ± 1.1 (2000 starts).
#[test]
fn motor_off_at_the_optimal_stiffness() {
    let problem = MassSpring::stiffness(MassSpringSettings::default()).unwrap();
    let (law, mut robot) = (problem.law(), problem.robot(None));
    let design = evenly(problem.optimum(), 10);
    let starts = 2000;
    let sum: f64 = (0..starts)
        .map(|i| {
            robot.reset(&mut stream(0, Purpose::EvaluationReset, 0, i));
            discounted(&mut robot, &law, &design, 0.0)
        })
        .sum();
    println!("motor off: {}", sum / starts as f64);
    close(sum / starts as f64, -1113.6, 4.0);
}

/// -10·sigmoid(-c·ε)·(1 - 0.99^1000)/0.01: the soft reward's resting value bounds every return.
#[test]
fn rest_at_the_goal() {
    let paper = MassSpringSettings::default;
    let springs = MassSpring::stiffness(paper()).unwrap();
    let rigid = MassSpring::bar(paper(), Interface::Rigid).unwrap();
    let soft = MassSpring::bar(paper(), Interface::Soft).unwrap();
    for (problem, y1, gap, wanted, tolerance) in [
        (springs, 0.1, 0.1, -268.93, 0.01),
        (rigid, 0.098, 0.102, -17.985, 0.001),
        (soft, 0.098, 0.102, -17.985, 0.001),
    ] {
        let mut robot = problem.robot(None);
        robot.plant_mut().place(y1, 0.0, gap);
        let found = discounted(&mut robot, &problem.law(), &evenly(problem.optimum(), 10), 0.0);
        println!("rest: {found}");
        close(found, wanted, tolerance);
        close(robot.plant().lower().0, 0.2, 1e-9);
    }
}

/// The hard reward at rest at the goal costs nothing at all.
#[test]
fn hard_rest_at_the_goal() {
    let problem = MassSpring::stiffness(MassSpringSettings::default().with_hard_reward()).unwrap();
    let mut robot = problem.robot(None);
    robot.plant_mut().place(0.1, 0.0, 0.1);
    close(discounted(&mut robot, &problem.law(), &evenly(19.6, 10), 0.0), 0.0, 1e-9);
}

/// At rest the softened bar is longer than its segments by m2·g/(k/2) = 9.8 mm: there, and only there, nothing moves.
#[test]
fn the_soft_interface_stretches() {
    let problem = MassSpring::bar(MassSpringSettings::default(), Interface::Soft).unwrap();
    close(problem.settings().interface_stretch(), 0.0098, 1e-15);
    let (law, mut robot) = (problem.law(), problem.robot(None));
    let mut moved = |gap: f64| {
        // (m1 + m2)·g/K = 0.098 m below the ceiling the spring carries both.
        robot.plant_mut().place(0.098, 0.0, gap);
        let (mut state, mut effort) = ([0.0; 4], [0.0; 2]);
        for _ in 0..10 {
            robot.state(&mut state);
            law.effort(&evenly(0.09, 10), &[0.0], &state, &mut effort);
            robot.step(&effort, &[0.0]);
        }
        robot.state(&mut state);
        (state[0] - 0.098).abs() + (state[2] - (0.098 + gap)).abs()
    };
    assert!(moved(0.0998) < 1e-12);
    assert!(moved(0.09) > 1e-3);
    assert!(moved(0.0996) > 1e-5);
}

/// With g = 0, no spring and no motor the momentum of the free masses stays what it is, whatever the interface does.
#[test]
fn the_interface_keeps_momentum() {
    let settings =
        MassSpringSettings { gravity: 0.0, spring_stiffness: f64::MIN_POSITIVE, ..MassSpringSettings::default() };
    let problem = MassSpring::bar(settings, Interface::Soft).unwrap();
    let (law, mut robot) = (problem.law(), problem.robot(None));
    robot.plant_mut().place(0.2, 0.01, 0.05);
    let (mut state, mut effort) = ([0.0; 4], [0.0; 2]);
    for _ in 0..100 {
        robot.state(&mut state);
        law.effort(&evenly(0.06, 10), &[0.0], &state, &mut effort);
        robot.step(&effort, &[0.0]);
        let ((_, v1), (_, v2)) = (robot.plant().upper(), robot.plant().lower());
        close(v1 + v2, 0.02, 1e-12);
    }
    robot.state(&mut state);
    close(state[2] - state[0], 0.06, 1e-3);
}

/// Holding the force for Δt = 10 ms feeds energy into a free swing: the map of one action has the determinant
/// 1 + (ωΔt)²/2 with ω² = K/m = 98, so 400 actions multiply the energy by 1.0049^400 = 7.07. Evaluated anew in each
/// simulation step, the force would make it 1.48.
#[test]
fn a_free_swing_gains_the_energy_of_the_scheme() {
    let problem = MassSpring::stiffness(MassSpringSettings::default()).unwrap();
    let (law, mut robot) = (problem.law(), problem.robot(None));
    // About the rest at 0.1 m.
    let energy = |(y, v): (f64, f64)| 0.5 * 0.2 * v * v + 0.5 * 19.6 * (y - 0.1) * (y - 0.1);
    robot.plant_mut().place(0.102, 0.0, 0.1);
    let before = energy(robot.plant().upper());
    let (mut state, mut effort) = ([0.0; 4], [0.0]);
    for _ in 0..400 {
        robot.state(&mut state);
        law.effort(&evenly(19.6, 10), &[0.0], &state, &mut effort);
        robot.step(&effort, &[0.0]);
    }
    close(energy(robot.plant().upper()) / before, 7.07, 0.7);
}

/// y1 ~ U(0, 0.5), v1 ~ U(-2, 2): over 2000 starts the ends are reached within 1 % and the means are within four standard
/// errors, 0.5/√12/√2000 = 0.0032 m and 4/√12/√2000 = 0.026 m/s.
#[test]
fn starts_fill_the_range() {
    for (problem, gap) in [
        (MassSpring::stiffness(MassSpringSettings::default()), 0.1),
        (MassSpring::bar(MassSpringSettings::default(), Interface::Soft), 0.025),
        (MassSpring::bar(MassSpringSettings::default(), Interface::Rigid), 0.025),
    ] {
        let mut robot = problem.unwrap().robot(None);
        let (mut positions, mut speeds) = (Vec::new(), Vec::new());
        for episode in 0..2000 {
            robot.reset(&mut stream(0, Purpose::TrainingReset, 0, episode));
            let ((y1, v1), (y2, v2)) = (robot.plant().upper(), robot.plant().lower());
            assert_eq!((y2, v2), (y1 + gap, v1));
            positions.push(y1);
            speeds.push(v1);
        }
        for (values, lo, hi, error) in [(positions, 0.0, 0.5, 0.0032), (speeds, -2.0, 2.0, 0.026)] {
            let (mean, margin) = (values.iter().sum::<f64>() / 2000.0, 0.01 * (hi - lo));
            close(mean, 0.5 * (lo + hi), 4.0 * error);
            close(values.iter().copied().fold(f64::INFINITY, f64::min), lo + 0.5 * margin, 0.5 * margin);
            close(values.iter().copied().fold(f64::NEG_INFINITY, f64::max), hi - 0.5 * margin, 0.5 * margin);
        }
    }
}
