//! Formulas and models as nobody means them: what comes is the same every time, and what is no number is told by name.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use common::seen;
use hwasp_core::{End, Environment, Purpose, stream};
use hwasp_experiment::{Experiment, Faults};
use hwasp_problem::ModelFormat;

/// A load on a slide, behind a plate that is only seen, in two shapes.
const SLED: &str = r#"<mujoco>
  <option timestep="0.01" gravity="0 0 0"/>
  <worldbody>
    <body name="sled">
      <joint name="slide" type="slide" axis="1 0 0"/>
      <geom name="plate" type="box" size="0.2 0.2 0.01" mass="0" contype="0" conaffinity="0"/>
      <geom name="front" type="box" size="0.1 0.1 0.1" pos="0.5 0 0" mass="1"/>
      <geom name="back" type="box" size="0.1 0.1 0.1" pos="-0.5 0 0" mass="2"/>
    </body>
  </worldbody>
  <actuator><motor name="push" joint="slide" gear="10" ctrlrange="-1 1"/></actuator>
  <keyframe><key name="driven" ctrl="1"/></keyframe>
</mujoco>"#;

fn resolved(text: &str) -> Result<Experiment, Faults> {
    common::resolved(SLED, text)
}

fn robot(text: &str) -> Box<dyn Environment> {
    common::robot(SLED, text)
}

/// An environment that has lived shows what a new one does.
#[test]
fn an_episode_knows_nothing_of_the_one_before() {
    let deep = (0..6).fold("time".to_owned(), |inner, _| format!("previous({inner})"));
    let text =
        format!("observe = [\"previous(joint.slide.pos + normal(0, 1))\", \"diff(normal(0, 1))\", \"{deep}\"]\n");
    let episode = |robot: &mut dyn Environment, number| {
        robot.reset(&mut stream(0, Purpose::EvaluationReset, 0, number));
        let mut all = seen(robot);
        for _ in 0..9 {
            robot.step(&[], &[1.0]);
            all.extend(seen(robot));
        }
        assert_eq!(robot.fault(), None);
        all
    };
    let mut lived = robot(&text);
    episode(&mut *lived, 0);
    let found = episode(&mut *lived, 1);
    assert_eq!(found, episode(&mut *robot(&text), 1));
    // The innermost of six is the time of six steps ago.
    let late: Vec<f64> = found.chunks_exact(3).map(|row| row[2]).collect();
    assert_eq!(late[..7], [0.0; 7]);
    assert!((late[9] - 0.03).abs() < 1e-12, "{late:?}");
}

#[test]
fn what_is_no_number_is_told_by_name() {
    for (text, wanted) in [
        ("observe = [\"1 / (step - 2)\"]\n", "the observation `1 / (step - 2)` is inf after 2 steps"),
        ("observe = [\"1e38 * 100 * step\"]\n", "the observation `1e38 * 100 * step` is"),
        ("observe = [\"time\"]\nends = \"log(1 - step) > 0\"\n", ""),
        ("observe = [\"time\"]\nends = \"log(1 - step)\"\n", "`ends` is -inf after 1 steps"),
        ("observe = [\"time\"]\nsuccess = \"log(1 - step)\"\n", "`success` is -inf after 1 steps"),
        ("observe = [\"time\"]\n[task.reward]\nodd = \"log(1 - step)\"\n", "the reward `odd` is -inf after 1 steps"),
    ] {
        let mut robot = robot(text);
        robot.reset(&mut stream(0, Purpose::EvaluationReset, 0, 0));
        let ended = (0..3).find_map(|_| robot.step(&[], &[0.0]).end);
        let fault = robot.fault().unwrap_or_default();
        assert!(fault.starts_with(wanted), "{text}: {fault}");
        assert_eq!(ended, (!wanted.is_empty()).then_some(End::Faulted), "{text}");
    }
}

/// A number means the geom that the file counts so, whether what is only seen is left out or not.
#[test]
fn numbers_are_those_of_the_file() {
    let pushed = |field: &str| {
        let mut robot = robot(&format!("observe = [\"joint.slide.vel\"]\nset = [\"{field} = 9\"]\n"));
        robot.reset(&mut stream(0, Purpose::EvaluationReset, 0, 0));
        robot.step(&[], &[1.0]);
        seen(&*robot)[0]
    };
    // 10 N for 0.01 s.
    for (field, mass) in
        [("geom.front.mass", 11.0), ("geom.#1.mass", 11.0), ("geom.back.mass", 10.0), ("geom.#2.mass", 10.0)]
    {
        assert!((pushed(field) - 0.1 / mass).abs() < 1e-9, "{field}: {}", pushed(field));
    }
}

/// Nobody commands the motor: the law drives the joint.
#[test]
fn a_motor_that_nobody_commands_rests() {
    let law = "[task.law]\n\"joint.slide\" = \"0 N * command.push\"\n";
    let mut robot = robot(&format!("keyframe = \"driven\"\nobserve = [\"actuator.push.force\"]\n{law}"));
    robot.reset(&mut stream(0, Purpose::EvaluationReset, 0, 0));
    for _ in 0..3 {
        robot.step(&[0.0], &[1.0]);
        assert_eq!(seen(&*robot), [0.0]);
    }
}

#[test]
fn fields_that_cannot_be_set_so() {
    for (set, wanted) in [
        ("\"geom.front.mass = 1\", \"geom.front.mass = 2\"", "this field is set twice"),
        ("\"option.timestep = 0.001\"", "the time step is that of the model's file"),
    ] {
        let faults = resolved(&format!("observe = [\"time\"]\nset = [{set}]\n")).unwrap_err().to_string();
        assert!(faults.contains(wanted), "{faults}");
    }
}

/// A field that is drawn is another one in every episode, with no table of random quantities.
#[test]
fn a_field_is_drawn_for_each_episode() {
    let mut robot = robot("observe = [\"joint.slide.vel\"]\nset = [\"geom.front.mass = uniform(2, 4)\"]\n");
    let mut masses = (0..20).map(|number| {
        robot.reset(&mut stream(0, Purpose::EvaluationReset, 0, number));
        robot.step(&[], &[1.0]);
        0.1 / seen(&*robot)[0] - 2.0
    });
    let (least, most) = masses
        .try_fold((4.0_f64, 2.0_f64), |(least, most), mass| {
            (2.0..4.0).contains(&mass).then_some((least.min(mass), most.max(mass)))
        })
        .unwrap();
    assert!(least < 2.5 && most > 3.5, "from {least} to {most}");
}

/// What is drawn is written in its middle.
#[test]
fn a_drawn_field_is_written_in_its_middle() {
    for draw in ["normal(3, 0.1)", "uniform(2, 4)"] {
        let experiment = resolved(&format!("observe = [\"time\"]\nset = [\"geom.front.mass = {draw}\"]\n")).unwrap();
        let mechanism = experiment.task.built().mechanism.clone().unwrap();
        let files = mechanism.write(ModelFormat::Mjcf, &[]).unwrap();
        let text = String::from_utf8(files[0].contents.clone()).unwrap();
        let front = text.lines().find(|line| line.contains("\"front\"")).unwrap();
        assert!(front.contains("mass=\"3\""), "{draw}: {front}");
    }
}

/// Definitions in reverse order were read again and again, until there were too many operations, which was told of another key.
#[test]
fn definitions_stand_in_any_order() {
    // Long enough that to read each for each would not end.
    let long = "0 * joint.slide.pos + ".repeat(20);
    let define: Vec<String> = (0..400).map(|i| format!("d{i:03} = \"{long}d{:03} + 1\"", i + 1)).collect();
    let text = format!("observe = [\"d000\"]\n[task.define]\n{}\nd400 = 7\n", define.join("\n"));
    let mut robot = robot(&text);
    robot.reset(&mut stream(0, Purpose::EvaluationReset, 0, 0));
    assert_eq!(seen(&*robot), [407.0]);
}

/// What is drawn where the limits are not in order was drawn between them all the same.
#[test]
fn draws_that_cannot_be_are_faults() {
    for (text, said) in [
        ("uniform(2, 1)", "the lower limit 2 is above the upper one, 1"),
        ("uniform([0, 2], [1, 1])", "the lower limit 2 is above the upper one, 1"),
        ("log_uniform(-3, -1)", "the limit -3 has no logarithm"),
        ("normal(0, -1)", "the standard deviation -1 is negative"),
    ] {
        let faults = resolved(&format!("[task.random]\nload = \"{text}\"\n")).unwrap_err();
        let fault = &faults.faults()[0];
        assert!(fault.message.contains(said) && fault.line == Some(6), "{fault}");
    }
    for text in ["uniform(1, 1 - late)", "log_uniform(-late, 1)", "normal(0, -late)"] {
        let keys = format!("[task.random]\nlate = \"uniform(0.5, 1)\"\nload = \"{text}\"\n");
        let mut robot = robot(&keys);
        robot.reset(&mut stream(0, Purpose::EvaluationReset, 0, 0));
        assert_eq!(robot.step(&[], &[0.0]).end, Some(End::Faulted), "{text}");
        assert!(robot.fault().unwrap().starts_with("`load[0]` of [task.random] is NaN"), "{:?}", robot.fault());
    }
    let sound = "[task.random]\nlate = \"uniform(0.5, 1)\"\nload = \"uniform(1, 1 + late)\"\n";
    let mut robot = robot(sound);
    robot.reset(&mut stream(0, Purpose::EvaluationReset, 0, 0));
    assert_eq!(robot.fault(), None);
}

/// Delays that are drawn were taken, and then blamed on the physics of every episode; of constant ones no line was told.
#[test]
fn delays_are_within_their_limits() {
    for (keys, said) in [
        (
            "observation_delay = \"-1 s\"\n",
            "task.observation_delay: a delay is 0 to 10 s, 1000 steps, and this is -1 s",
        ),
        ("command_delay = \"11 s\"\n", "task.command_delay: a delay is 0 to 10 s, 1000 steps, and this is 11 s"),
        ("command_delay = \"uniform(-0.02, 0.02) * 1 s\"\n", "task.command_delay: a delay is 0 to 10 s"),
        ("observation_delay = \"late\"\n[task.random]\nlate = \"normal(20 ms, 10 ms)\"\n", "and this is -"),
        (
            "command_delay = \"late\"\n[task.design]\nlate = { limits = [\"0 s\", \"20 s\"] }\n",
            "20 s with late = 20.0000",
        ),
        ("command_delay = \"10 s / progress\"\n", "and this is inf s"),
    ] {
        let faults = resolved(keys).unwrap_err();
        let [fault] = faults.faults() else { panic!("{faults}") };
        assert!(fault.message.contains(said) && fault.line == Some(5) && fault.excerpt.is_some(), "{fault}");
    }
    resolved("observation_delay = \"max(normal(20 ms, 10 ms), 0 s)\"\n").unwrap();
}

/// Each fault is told once, and hides none of the others: those of the design hid those of the law, a definition was told again by
/// whoever named it, and a term of the reward with a bad name hid what the design does.
#[test]
fn every_fault_is_told_once() {
    let told = |text: &str| -> Vec<String> {
        let faults = resolved(text).unwrap_err();
        faults.faults().iter().map(|fault| fault.key.clone()).collect()
    };
    for (text, keys) in [
        (
            "observe = [\"a + time\", \"b\"]\n[task.reward]\nt = \"a\"\n[task.define]\na = \"joint.slid.pos\"\nb = \"2 * a\"\n",
            &["task.define.a"][..],
        ),
        (
            "observe = [\"f(1)\"]\n[task.law]\n\"joint.slide\" = \"2 * k + hidden\"\n[task.start]\n\"joint.slid.pos\" = 0\n\
             [task.design]\nk = { limits = [2, 1] }\n[task.define]\n\"f(x)\" = \"sqr(x)\"\n",
            &["task.law.joint.slide", "task.start.joint.slid.pos", "task.design.k.limits", "task.define.f(x)"],
        ),
        ("[task.law]\n\"joint.slide\" = \"k * 1 N\"\n[task.design]\nk = { initial = 1 }\n", &["task.design.k"]),
        (
            "set = [\"geom.front.mass = k\"]\n[task.reward]\n\"how far\" = 1\n[task.design]\nk = { limits = [-1, 1] }\n",
            &["task.reward.how far", "task.design"],
        ),
        (
            "[task.random]\nload = \"late\"\n[task.define]\nlate = \"2 * later\"\nlater = \"1 +\"\n",
            &["task.define.later"],
        ),
        ("[task.random]\nload = \"late\"\n[task.define]\nlate = \"command.push\"\n", &["task.random.load"]),
        ("[task.random]\nload = \"late\"\n[task.define]\nlate = \"load\"\n", &["task.random.load"]),
        (
            "observe = [\"a\", \"d\"]\n[task.define]\na = \"b\"\nb = \"c\"\nc = \"b\"\nd = \"d\"\n",
            &["task.define.b", "task.define.d"],
        ),
        ("observe = [\"effort.joint.slid\"]\n[task.law]\n\"joint.slid\" = 1\n", &["task.law.joint.slid"]),
    ] {
        assert_eq!(told(text), keys, "{text}{}", resolved(text).unwrap_err());
    }
}
