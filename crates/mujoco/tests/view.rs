//! What is seen of a model.

#![allow(clippy::unwrap_used)]

use hwasp_core::{Form, Sight};
use hwasp_mujoco::engine::{Simulation, View};

fn sight(mjcf: &str) -> Sight {
    let sim = Simulation::from_mjcf(mjcf).unwrap();
    let start = sim.qpos().to_vec();
    View::new(sim).sight(&start)
}

#[test]
fn every_shape_is_seen_as_it_is() {
    let seen = sight(
        r#"<mujoco><asset><material name="red" rgba="1 0 0 0.5"/>
          <mesh name="dart" vertex="0 0 0  1 0 0  0 1 0  0 0 1  0.1 0.1 0.1"/>
          <hfield name="hills" nrow="2" ncol="3" size="2 1 0.5 0.1" elevation="0 0 0 0 0 1"/></asset>
        <worldbody>
          <geom type="plane" size="3 0 1"/> <geom type="hfield" hfield="hills" pos="9 0 0"/>
          <body pos="0 0 2"><freejoint/>
            <geom type="sphere" size="0.1"/> <geom type="ellipsoid" size="0.1 0.2 0.3"/> <geom type="box" size="0.1 0.2 0.3"/>
            <geom type="cylinder" size="0.1 0.4" material="red"/> <geom type="capsule" size="0.1 0.4" rgba="0 0 1 1" material="red"/>
            <geom type="mesh" mesh="dart"/> <geom type="box" size="1 1 1" group="3"/> <geom type="box" size="1 1 1" rgba="0 0 0 0"/>
          </body>
        </worldbody></mujoco>"#,
    );
    let forms: Vec<&Form> = seen.solids.iter().map(|solid| &solid.form).collect();
    let [plane, Form::Field(hills), sphere, ellipsoid, cuboid, cylinder, capsule, Form::Mesh(dart)] = forms[..] else {
        panic!("{forms:?}")
    };
    assert_eq!(plane, &Form::Plane([3.0, 0.0]));
    // The engine raises the lowest point to 0 and the highest to 1; a file has the row in the back first.
    assert_eq!(hills[0], [[-2.0, -1.0, 0.0], [0.0, -1.0, 0.0], [2.0, -1.0, 0.5]]);
    assert_eq!(hills[1][2], [2.0, 1.0, 0.0]);
    assert_eq!((sphere, ellipsoid), (&Form::Ellipsoid([0.1; 3]), &Form::Ellipsoid([0.1, 0.2, 0.3])));
    assert_eq!(cuboid, &Form::Box([0.1, 0.2, 0.3]));
    assert_eq!(cylinder, &Form::Cylinder { radius: 0.1, half_length: 0.4 });
    assert_eq!(capsule, &Form::Capsule { radius: 0.1, half_length: 0.4 });
    // The corners, without the point inside, and the faces between them.
    assert_eq!((dart.corners().len(), dart.faces().len()), (4, 4));
    let paints: Vec<([u8; 3], f32, bool)> = seen.solids.iter().map(|s| (s.colour, s.opacity, s.fixed)).collect();
    assert_eq!(paints[0], ([128; 3], 1.0, true));
    assert_eq!(paints[2], ([128; 3], 1.0, false));
    assert_eq!(&paints[5..7], [([255, 0, 0], 0.5, false), ([0, 0, 255], 1.0, false)]);
    assert_eq!(seen.solids[4].at, [0.0, 0.0, 2.0]);
}

/// Robots that were made for contacts alone have every geom in a group that viewers hide.
#[test]
fn what_only_touches_is_seen_where_there_is_nothing_else() {
    let seen = sight(
        r#"<mujoco><worldbody><geom type="plane" size="1 1 1"/><body><freejoint/>
        <geom size="0.1" group="3"/></body></worldbody></mujoco>"#,
    );
    assert_eq!(seen.solids.len(), 2);
}

/// A tendon from one site to another, parted by a pulley, and around a ball.
#[test]
fn tendons_are_cords() {
    let sim = Simulation::from_mjcf(CORD).unwrap();
    let start = sim.qpos().to_vec();
    let cords = View::new(sim).sight(&start).cords;
    let [straight, around] = &cords[..] else { panic!("{cords:?}") };
    assert_eq!(straight.parts, [vec![[0.0, 0.0, 1.0], [0.0, 0.0, 0.5]], vec![[0.3, 0.0, 1.0], [0.0, 0.0, 0.5]]]);
    assert_eq!(straight.colour, [0, 255, 0]);
    // Over the ball there are two points more, at its radius from its centre.
    assert_eq!(around.parts[0].len(), 4);
    let [x, y, z] = around.parts[0][1];
    assert!(((x - 2.0).hypot(y).hypot(z - 0.5) - 0.1).abs() < 1e-9, "{around:?}");
}

const CORD: &str = r#"<mujoco><worldbody>
    <site name="top" pos="0 0 1"/><site name="beside" pos="0.3 0 1"/>
    <body name="load" pos="0 0 0.5"><joint type="slide" axis="0 0 1"/><geom size="0.05"/><site name="load"/></body>
    <site name="left" pos="1.8 0 0.45"/><geom name="ball" size="0.1" pos="2 0 0.5"/><site name="right" pos="2.2 0 0.45"/>
    <site name="over" pos="2 0 0.7"/>
  </worldbody><tendon>
    <spatial name="straight" rgba="0 1 0 1"><site site="top"/><site site="load"/><pulley divisor="2"/>
      <site site="beside"/><site site="load"/></spatial>
    <spatial name="around"><site site="left"/><geom geom="ball" sidesite="over"/><site site="right"/></spatial>
  </tendon></mujoco>"#;
