//! Robots that can be made and would not train: loops that are open, springs that shake, and what their parts are called.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use common::{experiment, resolved, robot};

/// Two rods beside each other, whose ends a constraint joins.
const BARS: &str = r#"<mujoco>
  <option gravity="0 0 0"/>
  <worldbody>
    <body name="left">
      <joint name="left" axis="0 -1 0"/>
      <geom type="capsule" size="0.01 0.1" pos="0 0 -0.1" contype="0"/>
      <site name="left" pos="0 0 -0.2"/>
    </body>
    <body name="right" pos="0.1 0 0">
      <joint name="right" axis="0 -1 0"/>
      <geom type="capsule" size="0.01 0.1" pos="0 0 -0.1" contype="0"/>
      <site name="right" pos="0 0 -0.2"/>
    </body>
  </worldbody>
  <equality><connect name="tip" site1="left" site2="right"/></equality>
  <actuator><motor name="left" joint="left" ctrlrange="-1 1"/></actuator>
</mujoco>"#;

/// A loop that is open at the start passed, and snapped together in the first steps.
#[test]
fn open_loops_are_faults() {
    let closed = "\"joint.left.pos\" = \"asin(0.05 / length)\"\n\"joint.right.pos\" = \"-asin(0.05 / length)\"\n";
    let design = "[task.design]\nlength = { limits = [\"0.15 m\", \"0.25 m\"], sets = [\"site.left.pos.z = -length\", \
                  \"site.right.pos.z = -length\"] }\n";
    for (text, said) in [
        (String::new(), "task.model: the connect constraint `tip` of the model is open at the start, by 0.1000 m"),
        ("[task.start]\n\"joint.left.pos\" = 0.2\n".to_owned(), "task.start: the connect constraint `tip`"),
        // The middle is closed, the corners are not.
        (format!("[task.start]\n{}{design}", closed.replace("length", "(0.2 m)")), "by 0.0250 m with length = 0.1500"),
        (
            format!("[task.start]\n{}{}", closed.replace("length)", "length) + 0 * sqrt(length - 0.16)"), design),
            "an episode would start at NaN: see the formulas of [task.start] with length = 0.1500",
        ),
    ] {
        let faults = resolved(BARS, &text).unwrap_err();
        assert!(faults.faults().len() == 1 && faults.to_string().contains(said), "{faults}");
    }
    resolved(BARS, &format!("[task.start]\n{closed}{design}")).unwrap();
    // What is drawn about the closed pose opens no loop in its middle.
    resolved(BARS, &format!("[task.start]\n{}", closed.replace("length)", "0.2) + uniform(-0.1, 0.1)"))).unwrap();
    resolved(&BARS.replace("<connect", "<connect active=\"false\""), "").unwrap();
}

/// A load of 2 kg on a slide and a rod on a hinge.
const BENCH: &str = r#"<mujoco>
  <option timestep="0.01" gravity="0 0 0"/>
  <worldbody>
    <body>
      <joint name="slide" type="slide" axis="1 0 0" damping="DAMPING"/>
      <geom type="box" size="0.1 0.1 0.1" mass="2"/>
    </body>
    <body pos="0 1 0">
      <joint name="left hinge" type="hinge" axis="0 1 0"/>
      <geom type="capsule" size="0.02 0.25" mass="1"/>
    </body>
  </worldbody>
  <actuator><motor name="push" joint="slide" ctrlrange="-9 9"/><motor name="turn" joint="left hinge" ctrlrange="-9 9"/></actuator>
</mujoco>"#;

/// A spring of 100 N/m that is held for 20 ms drives 2 kg with 1 N·s/m: swings grow by e in 4 s, and nobody was told.
#[test]
fn springs_that_shake_are_doubted() {
    let text = "frame_skip = 2\n[task.law]\n\"joint.slide\" = \"-k * joint.slide.pos - 0.2 N*s/m * joint.slide.vel\"\n\
                [task.design]\nk = { limits = [0, \"200 N/m\"] }\n";
    let doubts = |damping: &str, text: &str| {
        let experiment = experiment(&BENCH.replace("DAMPING", damping), text);
        experiment.task.built().mechanism.as_ref().unwrap().doubts()
    };
    let told = doubts("0", text);
    let [doubt] = &told[..] else { panic!("{told:?}") };
    assert!(doubt.contains("spring on joint.slide has 100.000 N/m") && doubt.contains("by 1.000 N*s/m"), "{doubt}");
    assert!(doubt.contains("damping is 0.200") && doubt.contains("in about 5.00 s"), "{doubt}");
    assert_eq!(doubts("0.9", text), [""; 0]);
    // Swings that grow by e in 13 s are none to warn of.
    assert_eq!(doubts("0", &text.replace("frame_skip = 2\n", "")), [""; 0]);
    assert_eq!(doubts("0", "[task.law]\n\"joint.slide\" = \"command.push * 1 N\"\n"), [""; 0]);
    // It is so: the amplitude grows.
    let mut robot = robot(
        &BENCH.replace("DAMPING", "0"),
        &format!("observe = [\"joint.slide.pos\"]\n{text}[task.start]\n\"joint.slide.pos\" = 0.1\n"),
    );
    common::begin(&mut *robot, 0);
    let law = |at: f64, speed: f64| -100.0 * at - 0.2 * speed;
    let (mut last, mut most, mut state) = (0.1, 0.0_f64, [0.0; 2]);
    for step in 0..500 {
        robot.state(&mut state);
        robot.step(&[law(state[0], state[1])], &[0.0; 2]);
        last = common::seen(&*robot)[0];
        if step > 400 {
            most = most.max(last.abs());
        }
    }
    assert!(most > 0.2, "{last} {most}");
}

/// Elements of a group went by their number, without a unit: `clip(joint.*.vel, -10, 10) [0]`.
#[test]
fn observations_are_called_by_what_they_read() {
    let text = "observe = [\"clip(joint.*.vel, -10, 10)\", \"goal - joint.*.pos\", \"sum(joint.*.pos^2)\", \"joint.*.pos[1:] * 2\", \
                \"sensor.* * 1\", \"diff(joint.*.pos) / dt\"]\n[task.random]\ngoal = \"uniform(0, 1)\"\n";
    let model = BENCH.replace("DAMPING", "0").replace(
        "</mujoco>",
        "<sensor><jointpos name=\"place\" joint=\"slide\"/><subtreecom name=\"centre\" body=\"world\"/></sensor></mujoco>",
    );
    let robot = robot(&model, text);
    let found: Vec<String> =
        robot.spec().observation.iter().map(|port| format!("{} | {}", port.name, port.dimension.si())).collect();
    let wanted = [
        "clip(joint.slide.vel, -10, 10) | m/s",
        "clip(joint.left hinge.vel, -10, 10) | rad/s",
        "goal - joint.slide.pos | m",
        "goal - joint.left hinge.pos | rad",
        "sum(joint.*.pos^2) | ",
        "joint.left hinge.pos * 2 | rad",
        "sensor.place * 1 | m",
        "sensor.centre[0] * 1 | m",
        "sensor.centre[1] * 1 | m",
        "sensor.centre[2] * 1 | m",
    ];
    assert_eq!(found[..wanted.len()], wanted);
}

/// `base = "fixed"` was not heeded where the model's file frees its base.
#[test]
fn a_base_that_is_free_is_not_fixed() {
    let free = "<mujoco><worldbody><body name=\"trunk\"><freejoint name=\"root\"/><geom size=\"0.1\"/><body><joint name=\"hip\"/>\
                <geom size=\"0.1\"/></body></body></worldbody><actuator><motor name=\"hip\" joint=\"hip\" ctrlrange=\"-1 1\"/></actuator></mujoco>";
    let fault = |model: &str| resolved(model, "base = \"fixed\"\n").map(|_| ()).map_err(|faults| faults.to_string());
    let told = fault(free).unwrap_err();
    assert!(told.contains("task.base: \"fixed\" does not hold what joint.root of the model frees"), "{told}");
    fault(&BENCH.replace("DAMPING", "0")).unwrap();
    resolved(free, "base = \"as-model\"\n").unwrap();
}
