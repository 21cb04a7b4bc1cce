//! Functions and the library in experiments, and numbers that follow training by the name `progress`.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use common::seen;
use hwasp_core::{Purpose, stream};
use hwasp_experiment::{Experiment, Faults};

/// A load of 2 kg on a slide, and a hinge beside it, without gravity.
const BENCH: &str = r#"<mujoco>
  <option timestep="0.01" gravity="0 0 0"/>
  <worldbody>
    <body name="load">
      <joint name="slide" type="slide" axis="1 0 0"/>
      <geom name="load" type="box" size="0.1 0.1 0.1" mass="2"/>
    </body>
    <body name="rod" pos="0 1 0">
      <joint name="hinge" type="hinge" axis="0 1 0"/>
      <geom type="capsule" size="0.02 0.25" mass="1"/>
    </body>
  </worldbody>
  <actuator><motor name="push" joint="slide" ctrlrange="-9 9"/><motor name="turn" joint="hinge" ctrlrange="-9 9"/></actuator>
</mujoco>"#;

fn resolved(text: &str) -> Result<Experiment, Faults> {
    common::resolved(BENCH, text)
}

fn experiment(text: &str) -> Experiment {
    common::experiment(BENCH, text)
}

/// Functions in every place: of the user, which read what is there, and of the library.
#[test]
fn functions_are_formulas() {
    let text = |law: &str, inertia: &str, start: &str, reward: &str, define: &str| {
        format!(
            "observe = [\"qvel\"]\nset = [\"joint.hinge.armature = {inertia}\"]\n[task.reward]\nheat = \"{reward}\"\n\
             [task.start]\n\"joint.hinge.pos\" = \"{start}\"\n[task.law]\n\"joint.hinge\" = \"{law}\"\n\
             [task.design]\nstiffness = {{ limits = [\"1 N*m/rad\", \"3 N*m/rad\"] }}\n[task.define]\n{define}"
        )
    };
    let by_hand = experiment(&text(
        "clip(5 * command.turn, -4 - 0.4 N*m*s/rad * joint.hinge.vel, 4 - 0.4 N*m*s/rad * joint.hinge.vel) - stiffness * (joint.hinge.pos - 0.1 rad)",
        "2 + 3e-4 * 50^2",
        "2 * 0.1 + 0.3 * 0.2",
        "-(0.3 * (command.turn / 0.05)^2)",
        "rest = \"0.1 rad\"\n",
    ));
    let by_name = experiment(&text(
        "dc_motor(gear_torque(command.turn, 5), joint.hinge.vel, 4 N*m, 10 rad/s) + spring(joint.hinge.pos)",
        "2 + reflected_inertia(3e-4, 50)",
        "mixed(0.1, 0.2)",
        "-copper_loss(command.turn, 0.05, 0.3)",
        "rest = \"0.1 rad\"\n\"spring(angle: rad)\" = \"-pull(angle, rest)\"\n\
         \"pull(angle, rest)\" = \"stiffness * (angle - rest)\"\n\"mixed(a, b)\" = \"2 * a + 0.3 * b\"\n",
    ));
    let worlds = [&by_hand, &by_name].map(|experiment| &experiment.task.built().deployment);
    for (design, command, state) in [([1.5], [0.0, 0.3], [0.4, -0.2]), ([2.5], [0.0, -9.0], [-0.4, 3.0])] {
        let efforts = worlds.map(|world| {
            let mut effort = [0.0];
            world.law.effort(&design, &command, &state, &mut effort);
            effort[0]
        });
        assert!((efforts[0] - efforts[1]).abs() < 1e-12, "{efforts:?}");
    }
    let episodes = worlds.map(|world| {
        let mut robot = world.make.make(None);
        robot.reset(&mut stream(0, Purpose::EvaluationReset, 0, 0));
        let rewards: Vec<f64> = (0..5).map(|i| robot.step(&[0.1], &[1.0, f64::from(i)]).reward).collect();
        assert_eq!(robot.fault(), None);
        (rewards, seen(&*robot))
    });
    assert_eq!(episodes[0].1, episodes[1].1);
    assert!(episodes[0].0.iter().zip(&episodes[1].0).all(|(a, b)| (a - b).abs() < 1e-9), "{episodes:?}");
    // What is written is read back.
    let written = by_name.to_toml().unwrap();
    let again = common::from(&written, by_name.files(), None);
    assert_eq!(again.unwrap(), by_name);
}

/// A user's definitions go before the library's, and names of either do not reach into the other.
#[test]
fn the_library_takes_no_name() {
    let law = |define: &str, law: &str| {
        let text = format!(
            "observe = [\"time\"]\n[task.law]\n\"joint.hinge\" = \"{law}\"\n[task.define]\n{define}\
             [task.design]\nratio = {{ limits = [1, 3] }}\ntorque = {{ limits = [1, 3] }}\n"
        );
        let mut effort = [0.0];
        experiment(&text).task.built().deployment.law.effort(&[3.0, 2.0], &[0.0, 0.5], &[], &mut effort);
        effort[0]
    };
    // A parameter and a definition that are called as a law or as its arguments are.
    assert_eq!(law("gear_torque = 7\n", "gear_torque(command.turn, ratio) + 0 * torque * gear_torque"), 1.5);
    assert_eq!(law("\"gear_torque(a, b)\" = \"a + b + torque\"\n", "gear_torque(command.turn, ratio)"), 5.5);
}

/// The robot as it is when so much of training is done: what it sees after a step, and the reward of that step.
fn at(text: &str, progress: Option<f64>) -> (Vec<f64>, f64) {
    let mut robot = experiment(text).task.built().training.make.make(None);
    if let Some(progress) = progress {
        robot.set_progress(progress);
    }
    robot.reset(&mut stream(0, Purpose::EvaluationReset, 0, 0));
    let reward = robot.step(&[], &[1.0, 0.0]).reward;
    assert_eq!(robot.fault(), None, "{text}");
    (seen(&*robot), reward)
}

/// Keys of `[task]`, and what is observed at some progress.
type Case = (&'static str, fn(f64) -> f64);

/// Every number may follow training, and is that of its end where nobody says how much is done.
#[test]
fn curricula_by_progress() {
    let speed = 0.01 / 2.0; // of 1 N on 2 kg after 10 ms
    let cases: [Case; 7] = [
        // Fields of the model.
        ("observe = [\"joint.slide.vel\"]\nset = [\"geom.load.mass = 2 + 2 * progress\"]\n", |p| {
            0.01 / (2.0 + 2.0 * p)
        }),
        // Noise of a sensor.
        ("observe = [\"time + progress * normal(5, 0)\"]\n", |p| 0.01 + 5.0 * p),
        // Delays, of whole steps.
        ("observe = [\"time\"]\nobservation_delay = \"progress * 10 ms\"\n", |p| if p < 0.5 { 0.01 } else { 0.0 }),
        // Pushes.
        ("observe = [\"joint.slide.vel\"]\n[task.forces]\n\"body.load\" = \"[progress * 3, 0, 0]\"\n", |p| {
            0.005 * (1.0 + 3.0 * p)
        }),
        // Where an episode starts.
        ("observe = [\"joint.hinge.pos\"]\n[task.start]\n\"joint.hinge.pos\" = \"0.1 + 0.4 * progress\"\n", |p| {
            0.1 + 0.4 * p
        }),
        // What is seen by name; and what is a success.
        ("observe = [\"progress\"]\nsuccess = \"progress > 2\"\nends = \"progress > 2\"\n", |p| p),
        // A definition.
        ("observe = [\"hard\"]\n[task.define]\nhard = \"clip(2 * progress - 1, 0, 1)\"\n", |p| {
            (2.0 * p - 1.0).clamp(0.0, 1.0)
        }),
    ];
    for (text, wanted) in cases {
        for progress in [Some(0.0), Some(0.25), Some(0.75), Some(1.0), None] {
            let (found, wanted) = (at(text, progress).0[0], wanted(progress.unwrap_or(1.0)));
            assert!((found - wanted).abs() < 1e-12, "{text} at {progress:?}: {found}, not {wanted}");
        }
    }
    // Quantities that are drawn: from a range that widens.
    // A draw by definitions, one of which is a function, and a definition by the draw.
    let text = "observe = [\"seen\"]\n[task.random]\nload = \"widening(1)\"\n[task.define]\nlate = \"progress\"\n\
                \"widening(most)\" = \"uniform(1 - late, most)\"\nseen = \"load + 0 * command.push\"\n";
    let load = |progress| at(text, progress).0[0];
    let drawn = load(None);
    assert!(drawn > 0.0 && drawn < 1.0, "{drawn}");
    for progress in [0.0, 0.5, 1.0] {
        assert!((load(Some(progress)) - 1.0 + progress * (1.0 - drawn)).abs() < 1e-12);
    }
    for (progress, wanted) in [(0.25, 1.0), (0.75, 2.0)] {
        // The first of two commands acts for one step, or for both.
        let text = "observe = [\"joint.slide.vel\"]\ncommand_delay = \"progress * 10 ms\"\n";
        let mut robot = experiment(text).task.built().training.make.make(None);
        robot.set_progress(progress);
        robot.reset(&mut stream(0, Purpose::EvaluationReset, 0, 0));
        robot.step(&[], &[1.0, 0.0]);
        robot.step(&[], &[0.0, 0.0]);
        assert!((seen(&*robot)[0] - wanted * speed).abs() < 1e-12, "{progress}");
    }
    // Weights of rewards.
    let text =
        "observe = [\"time\"]\n[task.reward]\nspeed = \"joint.slide.vel\"\nheat = \"-progress * command.push^2\"\n";
    for progress in [0.0, 0.5, 1.0] {
        assert!((at(text, Some(progress)).1 - (speed - progress)).abs() < 1e-12);
    }
    assert!((at(text, None).1 - (speed - 1.0)).abs() < 1e-12);
}

/// A draw has as many components as its arguments; where they have one, it is the same for all that it goes with.
#[test]
fn noise_is_for_each_component_of_what_is_drawn() {
    let text = "observe = [\"normal(qpos, 1)\", \"qpos + normal(0, 1)\", \"normal(qpos, progress)\"]\n[task.start]\n\
                \"qpos\" = \"[0, 0]\"\n";
    let (seen, _) = at(text, Some(0.0));
    let place = [seen[4], seen[5]];
    assert!(((seen[0] - place[0]) - (seen[1] - place[1])).abs() > 1e-6, "{seen:?}");
    assert!(((seen[2] - place[0]) - (seen[3] - place[1])).abs() < 1e-12, "{seen:?}");
}

/// A model that cannot be made as training begins is told before it does.
#[test]
fn the_beginning_is_checked() {
    let faults =
        resolved("observe = [\"time\"]\nset = [\"geom.load.mass = progress * 2 - 1\"]\n").unwrap_err().to_string();
    assert!(faults.contains("the model cannot be made"), "{faults}");
    resolved("observe = [\"time\"]\nset = [\"geom.load.mass = progress + 1\"]\n").unwrap();
}
