//! What a model has.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use hwasp_mujoco::engine::{Drive, JointType, Quantity, Simulation, TendonPath};

const MODEL: &str = r#"<mujoco>
  <option timestep="0.004" gravity="0 0 -3"/>
  <worldbody>
    <camera name="side" pos="0 -3 1"/>
    <geom name="floor" type="plane" size="1 1 1"/>
    <site name="anchor" pos="0 0 1"/>
    <body name="base" pos="0 0 1">
      <freejoint name="root"/>
      <geom type="box" size="0.1 0.1 0.1" mass="2"/>
      <body name="arm">
        <joint name="hinge" axis="0 1 0" range="-30 60"/>
        <geom name="arm" type="capsule" size="0.02" fromto="0 0 0 0 0 -0.4" mass="1" contype="0" conaffinity="0"/>
        <site name="tip" pos="0 0 -0.4"/>
        <body>
          <joint type="slide" axis="0 0 1" range="0 0.1"/>
          <geom size="0.01" mass="0.5"/>
        </body>
      </body>
      <body name="head"><joint name="neck" type="ball"/><geom size="0.05" mass="0.25"/></body>
    </body>
  </worldbody>
  <tendon>
    <fixed name="cable"><joint joint="hinge" coef="0.03"/></fixed>
    <spatial name="rope" range="0.1 2"><site site="anchor"/><site site="tip"/></spatial>
  </tendon>
  <actuator>
    <motor joint="hinge" gear="5" ctrlrange="-1 2" forcerange="-9 9"/>
    <general name="muscle" tendon="cable" dyntype="filter" dynprm="0.1"/>
    <motor name="jet" site="tip" gear="0 0 1 0 0 0"/>
    <adhesion name="glue" body="head" ctrlrange="0 1"/>
    <pid name="servo" joint="hinge" kp="3"/>
    <motor name="last" tendon="rope"/>
  </actuator>
  <sensor>
    <jointpos name="angle" joint="hinge"/>
    <framepos name="place" objtype="site" objname="tip"/>
    <framequat objtype="body" objname="arm"/>
    <gyro name="gyro" site="tip"/>
    <actuatorfrc name="force" actuator="jet"/>
    <touch name="touch" site="tip"/>
    <tendonpos name="length" tendon="rope"/>
    <clock name="clock"/>
    <subtreecom name="com" body="base"/>
  </sensor>
  <keyframe><key name="up" time="3"/><key/></keyframe>
</mujoco>"#;

#[test]
fn everything_is_listed_in_its_order() {
    let inventory = Simulation::from_mjcf(MODEL).unwrap().inventory();
    let bodies: Vec<_> = inventory.bodies.iter().map(|body| (body.name.as_deref(), body.mass)).collect();
    assert_eq!(
        bodies,
        [(Some("world"), 0.0), (Some("base"), 2.0), (Some("arm"), 1.0), (None, 0.5), (Some("head"), 0.25)]
    );
    assert_eq!(inventory.bodies[0].parent, None);
    assert_eq!(inventory.bodies[3].parent, Some(inventory.bodies[2].id));
    assert_eq!(inventory.bodies[1].subtree_mass, 3.75);

    let joints: Vec<_> = inventory.joints.iter().map(|joint| (joint.name.as_deref(), joint.kind)).collect();
    assert_eq!(
        joints,
        [
            (Some("root"), JointType::Free),
            (Some("hinge"), JointType::Hinge),
            (None, JointType::Slide),
            (Some("neck"), JointType::Ball)
        ]
    );
    let [root, hinge, slide, neck] = &inventory.joints[..] else { panic!("{joints:?}") };
    assert_eq!((root.range, neck.range, slide.range), (None, None, Some([0.0, 0.1])));
    assert!(hinge.range.is_some_and(|[low, high]| (low + 30_f64.to_radians()).abs() < 1e-15 && high > 1.0));
    assert_eq!(hinge.body, inventory.bodies[2].id);
    assert_eq!((neck.address.qpos.clone(), neck.address.dof.clone()), (9..13, 8..11));

    let geoms: Vec<_> = inventory.geoms.iter().map(|geom| (geom.name.as_deref(), geom.shape, geom.collides)).collect();
    assert_eq!(geoms[..3], [(Some("floor"), "plane", true), (None, "box", true), (Some("arm"), "capsule", false)]);
    assert_eq!(inventory.sites.iter().map(|site| site.name.as_deref().unwrap()).collect::<Vec<_>>(), ["anchor", "tip"]);
    assert_eq!(inventory.sites[1].body, inventory.bodies[2].id);
    assert_eq!(inventory.cameras[0].0.as_deref(), Some("side"));
    assert_eq!(inventory.keyframes.iter().map(|(name, _)| name.as_deref()).collect::<Vec<_>>(), [Some("up"), None]);
    assert_eq!((inventory.nq, inventory.nv, inventory.nu, inventory.na), (13, 11, 7, 1));
    assert_eq!((inventory.timestep, inventory.gravity), (0.004, [0.0, 0.0, -3.0]));
}

/// One of the actuators has two controls, so the others do not stand at their index.
#[test]
fn actuators_say_what_they_drive() {
    let simulation = Simulation::from_mjcf(MODEL).unwrap();
    let inventory = simulation.inventory();
    let [motor, muscle, jet, glue, servo, last] = &inventory.actuators[..] else { panic!("{:?}", inventory.actuators) };
    let hinge = Drive::Joint(1, Some("hinge".to_owned()));
    assert_eq!((motor.name.as_deref(), &motor.drives, motor.gear), (None, &hinge, 5.0));
    assert_eq!((motor.control_range, motor.force_range), (Some([-1.0, 2.0]), Some([-9.0, 9.0])));
    assert_eq!(muscle.drives, Drive::Tendon(simulation.tendon("cable").unwrap(), Some("cable".to_owned())));
    assert_eq!((muscle.control_range, muscle.activations.clone()), (None, 0..1));
    assert_eq!(jet.drives, Drive::Site(simulation.site("tip").unwrap(), Some("tip".to_owned())));
    assert_eq!(glue.drives, Drive::Other("body"));
    assert_eq!((servo.controls.clone(), last.controls.clone()), (4..6, 6..7));
    assert!(motor.activations.is_empty());
}

#[test]
fn tendons_and_sensors_say_what_they_are() {
    let simulation = Simulation::from_mjcf(MODEL).unwrap();
    let inventory = simulation.inventory();
    assert_eq!(inventory.tendons[0].path, TendonPath::Fixed(vec![(1, 0.03)]));
    assert_eq!((&inventory.tendons[1].path, inventory.tendons[1].range), (&TendonPath::Spatial, Some([0.1, 2.0])));
    let sensors: Vec<_> =
        inventory.sensors.iter().map(|sensor| (sensor.kind, sensor.values.clone(), sensor.quantity)).collect();
    assert_eq!(
        sensors,
        [
            ("jointpos", 0..1, Quantity::Angle),
            ("framepos", 1..4, Quantity::Length),
            ("framequat", 4..8, Quantity::Number),
            ("gyro", 8..11, Quantity::AngularVelocity),
            ("actuatorfrc", 11..12, Quantity::Mixed),
            ("touch", 12..13, Quantity::Force),
            ("tendonpos", 13..14, Quantity::Length),
            ("clock", 14..15, Quantity::Time),
            ("subtreecom", 15..18, Quantity::Length),
        ]
    );
    assert_eq!(simulation.sensordata().len(), 18);
    assert_eq!(Quantity::AngularVelocity.unit(), "rad/s");
}

#[test]
fn an_empty_model_has_a_world() {
    let inventory = Simulation::from_mjcf("<mujoco/>").unwrap().inventory();
    assert_eq!((inventory.bodies.len(), inventory.joints.len(), inventory.nq), (1, 0, 0));
}
