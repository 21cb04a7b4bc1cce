//! How the problems look in films: what is drawn is where the state has it, shows the design, and changes no episode.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use hwasp_core::{Environment, Form, Law, MakeEnvironment, Purpose, Sight, stream};
use hwasp_tasks::mass_spring::{Interface, MassSpring, MassSpringSettings};
use hwasp_tasks::pendulum::{Pendulum, PendulumSettings};
use hwasp_tasks::reach::{Reach, ReachSettings};

/// An episode under a fixed command, with what is seen of each moment where somebody looks, and the bits of its states.
fn episode(make: &dyn MakeEnvironment, law: &Law, design: &[f64], looks: bool) -> (Vec<Sight>, Vec<u64>) {
    let mut env = make.make(Some(40));
    let (width, efforts) = (env.spec().state.len(), env.spec().effort.len());
    env.set_design(design);
    env.reset(&mut stream(0, Purpose::EvaluationReset, 0, 3));
    let (mut state, mut effort, mut sights, mut bits) = (vec![0.0; width], vec![0.0; efforts], vec![], vec![]);
    loop {
        sights.extend(looks.then(|| env.look().unwrap()));
        env.state(&mut state);
        bits.extend(state.iter().map(|x| x.to_bits()));
        law.effort(design, &[0.7], &state, &mut effort);
        let step = env.step(&effort, &[0.7]);
        bits.push(step.reward.to_bits());
        if step.end.is_some() {
            return (sights, bits);
        }
    }
}

/// A film has the same solids and cords at every moment; only what moves changes its place.
fn check(make: &dyn MakeEnvironment, law: &Law, design: &[f64]) -> Vec<Sight> {
    let (sights, looked) = episode(make, law, design, true);
    assert_eq!(looked, episode(make, law, design, false).1, "looking changed the episode");
    let first = &sights[0];
    for sight in &sights {
        assert_eq!((sight.solids.len(), sight.cords.len()), (first.solids.len(), first.cords.len()));
        assert!(sight.solids.iter().zip(&first.solids).all(|(now, then)| !then.fixed || now == then));
        let places = sight.solids.iter().flat_map(|solid| solid.at.iter().chain(solid.axes.iter().flatten()));
        let ways = sight.cords.iter().flat_map(|cord| cord.parts.iter().flatten().flatten());
        assert!(places.chain(ways).all(|x| x.is_finite()) && !sight.told.is_empty() && !sight.about.is_empty());
    }
    sights
}

fn moving(sight: &Sight) -> Vec<[f64; 3]> {
    sight.solids.iter().filter(|solid| !solid.fixed).map(|solid| solid.at).collect()
}

/// How far a spring goes to one side.
fn half_width(sight: &Sight, cord: usize) -> f64 {
    let points = &sight.cords[cord].parts[0];
    (points[1][0] - points[0][0]).abs()
}

#[test]
fn springs_hang_and_are_wide_where_they_are_stiff() {
    let problem = MassSpring::stiffness(MassSpringSettings { count: 3, ..Default::default() }).unwrap();
    let sights = check(&problem, &problem.law(), &[0.0, 5.0, 20.0]);
    assert_eq!(sights[0].about, "3 springs, 25.0 N/m together");
    for sight in &sights {
        let [upper, lower, bar] = moving(sight)[..] else { panic!("{sight:?}") };
        assert!((upper[2] - lower[2] - 0.1).abs() < 1e-12 && (bar[2] - 0.5 * (upper[2] + lower[2])).abs() < 1e-12);
        // The string and three springs, as long as the mass is low.
        assert_eq!(sight.cords.len(), 4);
        let ends = &sight.cords[3].parts[0];
        assert!((ends[0][2] - ends.last().unwrap()[2] + upper[2]).abs() < 1e-12);
        let [none, soft, stiff] = [1, 2, 3].map(|cord| half_width(sight, cord));
        assert!(none == 0.0 && (stiff / soft - 2.0).abs() < 1e-9, "{soft} {stiff}");
    }
}

/// Springs of which each drawn one stands for several.
#[test]
fn many_springs_are_drawn_as_some() {
    let problem = MassSpring::stiffness(MassSpringSettings { count: 24, ..Default::default() }).unwrap();
    let sights = check(&problem, &problem.law(), &[1.0; 24]);
    assert_eq!((sights[0].cords.len(), sights[0].about.as_str()), (11, "24 springs, 24.0 N/m together"));
    // A world that nobody told a design can be looked at, too.
    assert_eq!(problem.make(None).look().unwrap().cords.len(), 1);
}

#[test]
fn the_bar_has_its_segments() {
    for interface in [Interface::Rigid, Interface::Soft] {
        let settings = MassSpringSettings { count: 2, ..Default::default() };
        let problem = MassSpring::bar(settings, interface).unwrap();
        let sights = check(&problem, &problem.law(), &[0.03, 0.06]);
        assert_eq!(sights[0].about, "a bar of 90.0 mm");
        for sight in &sights {
            let [upper, lower, first, second] = moving(sight)[..] else { panic!("{sight:?}") };
            let long = upper[2] - lower[2];
            assert!((upper[2] - first[2] - long / 6.0).abs() < 1e-12);
            assert!((second[2] - lower[2] - long / 3.0).abs() < 1e-12);
        }
    }
}

#[test]
fn the_rod_turns_and_its_wheels_are_as_the_torques() {
    let problem = Pendulum::new(&PendulumSettings::default()).unwrap();
    let mut robot = problem.robot(None);
    robot.set_design(&[2.0]);
    // A quarter of a turn counter-clockwise: to the left.
    robot.plant_mut().place(std::f64::consts::FRAC_PI_2, 0.0);
    let sight = robot.look().unwrap();
    let rod = sight.solids.iter().find(|solid| matches!(solid.form, Form::Capsule { radius, .. } if radius > 0.05));
    let at = rod.unwrap().at;
    assert!((at[0] + 0.5).abs() < 1e-12 && at[2].abs() < 1e-12, "{at:?}");
    let wheels: Vec<f64> = sight
        .solids
        .iter()
        .filter(|solid| !solid.fixed)
        .filter_map(|solid| if let Form::Cylinder { radius, .. } = solid.form { Some(radius) } else { None })
        .collect();
    assert!(wheels.len() == 2 && (wheels[0] / wheels[1] - 2.0).abs() < 1e-12, "{wheels:?}");
    assert_eq!((sight.about.as_str(), sight.told.as_str()), ("gear 2.00", "90° from upright"));
    check(&problem, &problem.law(), &[0.5]);
}

#[test]
fn the_carriage_is_where_the_point_is() {
    let problem = Reach::new(ReachSettings::default()).unwrap();
    let sights = check(&problem, &problem.law(), &[1.5]);
    let (_, bits) = episode(&problem, &problem.law(), &[1.5], false);
    // Of each step x and reward.
    for (sight, x) in sights.iter().zip(bits.iter().step_by(2)) {
        assert_eq!(moving(sight)[0][0].to_bits(), *x);
    }
    assert_eq!(sights[0].about, "gear 1.50");
}
