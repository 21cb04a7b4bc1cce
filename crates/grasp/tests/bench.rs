//! The bench in the grasping tasks: what is sensed, how late, and what the hand really does.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use hwasp_core::{Environment, Purpose, Robot, Stream, stream};
use hwasp_grasp::{Bench, Grasp, GraspSettings, GraspTask, Script, ShapeKind, Viewpoint};
use hwasp_tasks::grasp::{ObjectSensed, TravelSensed};
use hwasp_tasks::hand::{PalmMotion, SEARCHED, TendonHand, TendonHandSettings, names};
use rand::RngExt;

fn rng(episode: u64) -> Stream {
    stream(5, Purpose::Check, 0, episode)
}

/// A ball, a bench, and nothing that is drawn from noise.
fn silent(bench: Bench) -> GraspSettings {
    GraspSettings {
        shapes: vec![ShapeKind::Sphere],
        sensor_noise: [0.0; 2],
        actuation_noise: [0.0; 2],
        disturbance: [0.0; 2],
        bench,
        ..GraspSettings::default()
    }
}

fn started(settings: GraspSettings, progress: f64) -> Robot<GraspTask> {
    let mut robot = Grasp::new(settings).unwrap().robot(None);
    robot.set_progress(progress);
    robot.set_design(&SEARCHED);
    robot.reset(&mut rng(1));
    robot
}

fn seen(robot: &Robot<GraspTask>) -> [f64; 11] {
    let mut seen = [0.0; 11];
    robot.observe(&mut seen);
    seen
}

/// Observations of an episode of the script, the start first, with the object's true place and the motor's true torque.
fn watched(grasp: &Grasp) -> Vec<([f64; 11], [f64; 3], f64)> {
    let (mut robot, law, mut script) = (grasp.robot(None), grasp.law(), Script::default());
    robot.set_design(&SEARCHED);
    robot.reset(&mut rng(1));
    script.start(robot.plant());
    let transmission = &grasp.settings().hand.transmission;
    let most = transmission.spool_radius * transmission.tension_limit;
    let mut all = Vec::new();
    for _ in 0..500 {
        all.push((seen(&robot), robot.plant().object_position(), robot.plant().motor_torque()));
        let command = script.act(robot.plant(), &robot, most);
        let (mut state, mut effort) = ([0.0; 7], [0.0; 7]);
        robot.state(&mut state);
        law.effort(&SEARCHED, &command, &state, &mut effort);
        robot.step(&effort, &command);
    }
    all
}

/// Where the motor is at its limit, the encoder tells the travel at which the tendons pull with it; before, what was commanded.
#[test]
fn the_encoder_is_held_back_by_the_motors_limit() {
    let bench = Bench { travel_sensed: TravelSensed::Encoder, ..Bench::default() };
    for native in [false, true] {
        let settings = silent(bench.clone());
        let grasp = if native { Grasp::native(settings, &SEARCHED) } else { Grasp::new(settings) }.unwrap();
        let commanded = {
            let settings = silent(Bench::default());
            let grasp = if native { Grasp::native(settings, &SEARCHED) } else { Grasp::new(settings) }.unwrap();
            watched(&grasp)
        };
        let told = watched(&grasp);
        let most = 75.0 * 0.008;
        let mut held_back = 0;
        for ((told, _, torque), (commanded, ..)) in told.iter().zip(&commanded) {
            if *torque < 0.9 * most {
                assert!((told[9] - commanded[9]).abs() < 1e-12, "native {native}: {} at {torque} N·m", told[9]);
            } else {
                assert!(told[9] <= commanded[9] + 1e-12);
                held_back += usize::from(told[9] < commanded[9] - 1e-4);
            }
        }
        assert!(held_back > 10, "native {native}: {held_back}");
    }
}

/// The target is told beside the encoder, and goes on where that is held back.
#[test]
fn the_target_goes_on_where_the_encoder_is_held_back() {
    let bench = Bench { travel_sensed: TravelSensed::Both, ..Bench::default() };
    let grasp = Grasp::new(silent(bench)).unwrap();
    let (mut robot, law, mut seen) = (started(grasp.settings().clone(), 1.0), grasp.law(), [0.0; 12]);
    assert_eq!(robot.spec().observation.last().unwrap().name, "motor_travel_target");
    for t in 1..=220 {
        let (mut state, mut effort, command) = ([0.0; 7], [0.0; 7], [0.0, 0.0002]);
        robot.state(&mut state);
        law.effort(&SEARCHED, &command, &state, &mut effort);
        robot.step(&effort, &command);
        robot.observe(&mut seen);
        assert!((seen[11] - 0.0002 * f64::from(t)).abs() < 1e-12 && seen[9] < seen[11] + 1e-12, "step {t}: {seen:?}");
    }
    assert!(seen[9] < seen[11] - 0.005, "{seen:?}");
}

/// What is told late is what would have been told before; the start is told until then.
#[test]
fn delays_are_whole_steps() {
    let late = Bench { delay: [0.052; 2], ..Bench::default() };
    let (mut prompt, mut delayed) = (started(silent(Bench::default()), 1.0), started(silent(late), 1.0));
    let mut all = Vec::new();
    for t in 0..40 {
        all.push(seen(&prompt));
        assert_eq!(seen(&delayed), all[usize::saturating_sub(t, 5)], "step {t}");
        for robot in [&mut prompt, &mut delayed] {
            robot.step(&[0.01; 7], &[-0.001, 0.0001]);
        }
    }
    assert_ne!(all[30], all[35]);
}

/// A carried object goes along with the palm from the moment on when the torque is felt; a fixed one never does.
#[test]
fn objects_are_carried_once_they_are_felt() {
    for (sensed, viewpoint) in [ObjectSensed::Carried, ObjectSensed::Fixed]
        .into_iter()
        .flat_map(|sensed| [Viewpoint::World, Viewpoint::Palm].map(|viewpoint| (sensed, viewpoint)))
    {
        let bench = Bench { object_sensed: sensed, grasp_felt: 0.4, ..Bench::default() };
        let told = watched(&Grasp::new(GraspSettings { viewpoint, ..silent(bench) }).unwrap());
        let from_palm = |t: usize| match viewpoint {
            Viewpoint::World => told[t].0[5] - told[t].0[2],
            Viewpoint::Palm => told[t].0[5],
        };
        let start = told[0].1[2];
        let felt = told.iter().position(|(_, _, torque)| *torque >= 0.4).unwrap();
        for (t, (seen, ..)) in told.iter().enumerate() {
            if t < felt || sensed == ObjectSensed::Fixed {
                assert!((from_palm(t) + seen[2] - start).abs() < 1e-12, "step {t}");
            } else {
                assert!((from_palm(t) - from_palm(felt)).abs() < 1e-12, "step {t}");
            }
        }
        let (last, lifted, _) = told.last().unwrap();
        let error = (from_palm(told.len() - 1) + last[2] - lifted[2]).abs();
        assert_eq!(error < 0.02, sensed == ObjectSensed::Carried, "{error} m off the object that was lifted");
    }
}

/// The palm's target moves no faster than the arm, whatever the direction, and the arm comes after it.
#[test]
fn the_arm_has_its_speed_and_its_lag() {
    let path = |bench: Bench| {
        let mut robot = started(GraspSettings { palm: PalmMotion::Spatial, ..silent(bench) }, 1.0);
        let start = robot.plant().palm();
        let target = |robot: &Robot<GraspTask>| {
            let sim = robot.plant().simulation();
            names::PALM_ACTUATORS.map(|name| sim.ctrl()[sim.actuator(name).unwrap().index()])
        };
        (0..20)
            .map(|_| {
                robot.step(&[0.0; 7], &[0.002, -0.001, 0.002, 0.0]);
                let target = target(&robot);
                [0, 1, 2].map(|i| target[i] - start[i])
            })
            .collect::<Vec<_>>()
    };
    let slow = path(Bench { palm_speed: Some(0.1), ..Bench::default() });
    for (t, at) in slow.iter().enumerate() {
        let wanted = [2.0, -1.0, 2.0].map(|part| part / 3.0 * 0.001 * (t + 1) as f64);
        assert!(at.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-12), "step {t}: {at:?} is not {wanted:?}");
    }
    let left = (-0.01_f64 / 0.03).exp();
    let lagging = path(Bench { arm_lag: [0.03; 2], ..Bench::default() });
    let mut wanted = 0.0;
    for (t, at) in lagging.iter().enumerate() {
        let target = 0.002 * (t + 1) as f64;
        wanted = target - left * (target - wanted);
        assert!((at[0] - wanted).abs() < 1e-12, "step {t}: {} is not {wanted}", at[0]);
    }
}

/// With slack, and with another limit than its own, the law's torques become those of a law that knows both.
#[test]
fn slack_and_a_real_limit_change_the_torques() {
    let mut random = rng(4);
    for (slack, gain) in [(0.0, 0.7), (0.002, 1.0), (0.001, 1.3), (0.003, 0.8)] {
        let bench = Bench { slack: [slack; 2], limit_gain: [gain; 2], torque_gain: [0.5; 2], ..Bench::default() };
        let mut robot = started(silent(bench), 1.0);
        let mut transmission = GraspSettings::default().hand.transmission;
        let nominal = TendonHand::new(&transmission, &TendonHandSettings::default()).unwrap();
        transmission.tension_limit *= gain;
        let real = hwasp_core::Law::new(TendonHand::new(&transmission, &TendonHandSettings::default()).unwrap());
        let nominal = hwasp_core::Law::new(nominal);
        let (mut limited, mut wound) = (0, 0.0_f64);
        for t in 0..260 {
            let command = [0.0, 0.0002 * (0.8 + 0.2 * random.random::<f64>())];
            let (mut state, mut effort, mut wanted) = ([0.0; 7], [0.0; 7], [0.0; 7]);
            robot.state(&mut state);
            assert!((state[0] - (wound - slack)).abs() < 1e-12, "step {t}: {} wound", state[0]);
            nominal.effort(&SEARCHED, &command, &state, &mut effort);
            real.effort(&SEARCHED, &command, &state, &mut wanted);
            robot.step(&effort, &command);
            wound = (wound + command[1]).min(0.045); // all of the spool's travel
            let sim = robot.plant().simulation();
            for (name, wanted) in names::TORQUE_ACTUATORS.iter().zip(wanted) {
                let given = sim.ctrl()[sim.actuator(name).unwrap().index()];
                assert!((given - wanted).abs() < 1e-9, "step {t}, {name}: {given} is not {wanted} N·m");
            }
            assert!((robot.plant().motor_torque() - wanted[6]).abs() < 1e-9);
            assert!((seen(&robot)[10] - 0.5 * wanted[6]).abs() < 1e-9);
            limited += usize::from(wanted[6] > 0.999 * 0.008 * 75.0 * gain);
        }
        assert!(limited > 10 && limited < 250, "slack {slack}, limit {gain}: {limited} steps at the limit");
    }
}

/// Friction takes from what the tendons get, reads as torque while the spool winds, and the other way while it pays out.
#[test]
fn friction_is_felt_by_the_motor_and_not_by_the_tendons() {
    let (friction, radius) = (0.04, GraspSettings::default().hand.transmission.spool_radius);
    for native in [false, true] {
        let grasp = |bench| {
            let settings = silent(bench);
            if native { Grasp::native(settings, &SEARCHED) } else { Grasp::new(settings) }.unwrap()
        };
        let encoder = Bench { travel_sensed: TravelSensed::Encoder, ..Bench::default() };
        let rubbing = grasp(Bench { motor_friction: [friction; 2], ..encoder.clone() });
        let weaker = grasp(Bench { limit_gain: [1.0 - friction / radius / 75.0; 2], ..encoder });
        let mut limited = 0;
        let law = rubbing.law();
        let mut robots = [rubbing.robot(None), weaker.robot(None)];
        for robot in &mut robots {
            robot.set_design(&SEARCHED);
            robot.reset(&mut rng(1));
        }
        for t in 0..500 {
            let winds = t < 350;
            let command = [0.0, if winds { 1.5e-4 } else { -1.5e-4 }];
            for robot in &mut robots {
                let (mut state, mut effort) = ([0.0; 7], [0.0; 7]);
                robot.state(&mut state);
                law.effort(&SEARCHED, &command, &state, &mut effort);
                robot.step(&effort, &command);
            }
            let [torque, other] = robots.each_ref().map(|robot| seen(robot)[10]);
            let back = robots[0].plant().travel() > seen(&robots[0])[9] + 1e-12;
            let sign = if winds || back { 1.0 } else { -1.0 };
            assert!((torque - other - sign * friction).abs() < 1e-12, "native {native}, step {t}: {torque}, {other}");
            limited += usize::from(other > 0.999 * (radius * 75.0 - friction));
        }
        assert!((20..450).contains(&limited), "native {native}: {limited}");
    }
}

/// Spans grow from nothing, and evaluations have all of them.
#[test]
fn the_bench_comes_in_while_training_goes_on() {
    let bench = Bench { torque_gain: [0.5; 2], slack: [0.004; 2], growth: [0.2, 0.6], ..Bench::default() };
    for (progress, slack) in [(0.0, 0.0), (0.2, 0.0), (0.3, 0.001), (0.6, 0.004), (1.0, 0.004)] {
        let robot = started(silent(bench.clone()), progress);
        let mut state = [0.0; 7];
        robot.state(&mut state);
        assert!((state[0] + slack).abs() < 1e-15, "{progress}: {}", state[0]);
    }
}
