//! `hwasp init` with a model: what it writes is sound, and trains.

use std::fs;
use std::path::Path;

use crate::sandbox::Sandbox;

/// A training that takes a moment.
const SHORT: &str = "--env-steps 2400 --set train.steps_per_iteration=1200 --set train.evaluation_episodes=2 --set \
                     ppo.epochs=1 --quiet";

/// Two legs of two links, as URDF says it: limits of effort, no motors, no floor.
const WALKER: &str = r#"<robot name="walker">
  <link name="trunk"><inertial><mass value="4"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><box size="0.3 0.2 0.1"/></geometry></collision></link>
  <link name="left"><inertial><mass value="1"/><origin xyz="0 0 -0.2"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin xyz="0 0 -0.4"/><geometry><sphere radius="0.05"/></geometry></collision></link>
  <link name="right"><inertial><mass value="1"/><origin xyz="0 0 -0.2"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin xyz="0 0 -0.4"/><geometry><sphere radius="0.05"/></geometry></collision></link>
  <joint name="left hip" type="revolute"><parent link="trunk"/><child link="left"/><origin xyz="0 0.1 0"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="30" velocity="5"/></joint>
  <joint name="right hip" type="continuous"><parent link="trunk"/><child link="right"/><origin xyz="0 -0.1 0"/><axis xyz="0 1 0"/></joint>
</robot>"#;

/// A gripper without names that reaches for a box: two unnamed motors of one joint, a servo, a tendon and a motor on a site.
const GRIPPER: &str = r#"<mujoco>
  <worldbody>
    <geom type="plane" size="1 1 0.1"/>
    <body pos="0 0 0.5">
      <joint type="slide" axis="0 0 1" range="-0.4 0.1"/>
      <geom type="box" size="0.05 0.05 0.02"/>
      <site name="a &quot;palm&quot;"/>
      <body name="left finger" pos="0.04 0 -0.02">
        <joint name="left-finger" type="hinge" axis="0 1 0" range="-30 30"/>
        <geom type="capsule" fromto="0 0 0 0 0 -0.08" size="0.008"/>
        <site name="tip" pos="0 0 -0.08"/>
      </body>
      <body pos="-0.04 0 -0.02">
        <joint name="right" type="hinge" axis="0 1 0"/>
        <geom type="capsule" fromto="0 0 0 0 0 -0.08" size="0.008"/>
      </body>
    </body>
    <body name="box" pos="0 0 0.03">
      <freejoint/>
      <geom type="box" size="0.03 0.03 0.03"/>
    </body>
  </worldbody>
  <tendon><fixed name="cord"><joint joint="left-finger" coef="0.02"/><joint joint="right" coef="-0.02"/></fixed></tendon>
  <actuator>
    <motor joint="left-finger" ctrllimited="true" ctrlrange="-2 3"/>
    <motor joint="left-finger" gear="0.5"/>
    <position joint="right" kp="5"/>
    <motor tendon="cord" ctrlrange="0 20"/>
    <motor site="a &quot;palm&quot;" gear="0 0 1 0 0 0"/>
  </actuator>
</mujoco>"#;

/// A cart with a pole: the pole has no motor.
const CART: &str = r#"<mujoco>
  <worldbody>
    <body name="cart">
      <joint name="rail" type="slide" axis="1 0 0" range="-1 1"/>
      <geom type="box" size="0.1 0.1 0.1"/>
      <body name="pole">
        <joint name="pole" type="hinge" axis="0 1 0" ref="10"/>
        <geom type="capsule" fromto="0 0 0 0 0 0.6" size="0.03"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor name="rail" joint="rail" ctrllimited="true" ctrlrange="-3 3" gear="100"/></actuator>
</mujoco>"#;

/// A body with four propellers.
const DRONE: &str = r#"<mujoco>
  <option timestep="0.01"/>
  <worldbody>
    <geom type="plane" size="1 1 0.1"/>
    <body name="frame" pos="0 0 1">
      <freejoint/>
      <geom type="box" size="0.1 0.1 0.02" mass="1"/>
      <site name="a" pos="0.1 0 0"/><site name="b" pos="-0.1 0 0"/>
    </body>
  </worldbody>
  <actuator>
    <motor name="a" site="a" gear="0 0 1 0 0 0" ctrllimited="true" ctrlrange="0 10"/>
    <motor name="b" site="b" gear="0 0 1 0 0 0" ctrllimited="true" ctrlrange="0 10"/>
  </actuator>
</mujoco>"#;

/// The models of the repository and those above, each with what its experiment has to say.
fn models() -> Vec<(&'static str, String, &'static [&'static str])> {
    let robots = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../experiments/robots");
    let read = |name: &str| fs::read_to_string(robots.join(name)).unwrap();
    vec![
        (
            "hopper.xml",
            read("hopper.xml"),
            &[
                "forward = \"diff(joint.rootx.pos) / dt\"",
                "frame_skip = 10 ",
                "ends = \"body.torso.pos.z < 0.62 m\"",
                "observe = [\"joint.*.pos[1:]\", ",
            ],
        ),
        ("arm.xml", read("arm.xml"), &["goal = \"uniform(-0.8, 0.8)\"", "frame_skip = 4 ", "mean((command / 8)^2)"]),
        (
            "walker.urdf",
            WALKER.to_owned(),
            &[
                "base = \"free\"",
                "floor = true",
                "\"left hip\" = { limits = [-1, 1], gear = 30 }",
                "\"joint.root.pos.z\" = \"0.4",
                "diff(joint.root.pos.x)",
                "# 'joint.\"left hip\"' = '-stiffness * (joint.\"left hip\".pos - rest)'",
            ],
        ),
        (
            "gripper.xml",
            GRIPPER.to_owned(),
            &[
                "near = \"-norm(body.box.pos - site.tip.pos)\"",
                "lifted = \"10 * clip(body.box.pos.z - 0.03 m, 0, 0.2)\"",
                "\"actuator_1\" = { limits = [-1, 1] }",
                "sets = [\"actuator.#0.gear = gear\"]",
                "#   joint.#0 ",
            ],
        ),
        // Of the repository's gripper, one motor pulls two fingers; the bars of the leg are closed by a constraint.
        ("five_bar.xml", read("five_bar.xml"), &[]),
        ("tendon_gripper.xml", read("gripper.xml"), &[]),
        ("cart.xml", CART.to_owned(), &["stay = \"exp(-sum((joint.*.pos - [0, 0.1745])^2))\""]),
        ("drone.xml", DRONE.to_owned(), &["stay = \"exp(-sum((joint.*.pos - [0, 0, 1, 1, 0, 0, 0])^2))\""]),
    ]
}

/// Takes the comments of the design away.
fn uncommented(text: &str) -> String {
    let (before, rest) = text.split_once("# [task.law]\n").expect("there is a design");
    let (design, after) = rest.split_once("\n\n").expect("it has an end");
    let design: Vec<&str> = design.lines().map(|line| line.trim_start_matches('#').trim_start()).collect();
    format!("{before}[task.law]\n{}\n\n{after}", design.join("\n"))
}

#[test]
fn what_is_written_for_a_model_is_sound_and_trains() {
    let sandbox = Sandbox::new("begun");
    for (file, model, says) in models() {
        sandbox.write(file, model);
        let name = file.split('.').next().unwrap();
        for line in [
            format!("init {file}"),
            format!("check {name}.toml"),
            format!("train {name}.toml --out {name} {SHORT}"),
            format!("check {name}.toml --method cmaes"),
            format!("check {name}.toml --method ars"),
        ] {
            let output = sandbox.run(&line);
            assert!(output.status.success(), "{line}\n{}", String::from_utf8_lossy(&output.stderr));
        }
        let text = String::from_utf8(sandbox.read(&format!("{name}.toml"))).unwrap();
        for said in says {
            assert!(text.contains(said), "{file} lacks {said}:\n{text}");
        }
        if name == "drone" {
            continue; // it has no joint for a spring
        }
        sandbox.write("designed.toml", uncommented(&text));
        for line in ["check designed.toml".to_owned(), format!("train designed.toml --out {name}-designed {SHORT}")] {
            let output = sandbox.run(&line);
            assert!(output.status.success(), "{file}: {line}\n{}", String::from_utf8_lossy(&output.stderr));
        }
        let design = String::from_utf8(sandbox.read(&format!("{name}-designed/design.toml"))).unwrap();
        assert!(design.contains("[stiffness]") && design.contains("[rest]"), "{design}");
    }
}

#[test]
fn the_experiment_of_a_model_as_a_text() {
    let sandbox = Sandbox::new("begun-text");
    let robots = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../experiments/robots");
    fs::create_dir(sandbox.path("models")).unwrap();
    fs::copy(robots.join("hopper.xml"), sandbox.path("models/hopper.xml")).unwrap();
    insta::assert_snapshot!(sandbox.transcript(&["init models/hopper.xml --out mine.toml --name my-hopper"]));
    insta::assert_snapshot!("the_experiment", String::from_utf8(sandbox.read("mine.toml")).unwrap());
}
