//! The object that the tests drop and edit, and a leg that they design.

#![allow(dead_code, reason = "each test binary uses its part")]

use hwasp_mujoco::engine::{FieldPath, Files, Shape, Simulation, Spec};

/// A mass of all objects, kg.
pub(crate) const MASS: f64 = 0.2;

/// One shape of each type, of different sizes.
pub(crate) const SHAPES: [Shape; 4] = [
    Shape::Sphere { radius: 0.05 },
    Shape::Box { half: [0.03, 0.04, 0.06] },
    Shape::Cylinder { radius: 0.04, half_length: 0.07 },
    Shape::Ellipsoid { radii: [0.05, 0.04, 0.07] },
];

/// An object above a floor and two posts, turned so that it lands on an edge. Options as the hand will have them.
pub(crate) fn scene(shape: Shape, mass: f64, friction: f64) -> String {
    let (kind, size) = match shape {
        Shape::Sphere { radius } => ("sphere", format!("{radius}")),
        Shape::Box { half: [x, y, z] } => ("box", format!("{x} {y} {z}")),
        Shape::Cylinder { radius, half_length } => ("cylinder", format!("{radius} {half_length}")),
        Shape::Ellipsoid { radii: [x, y, z] } => ("ellipsoid", format!("{x} {y} {z}")),
    };
    let [ix, iy, iz] = shape.inertia(mass);
    format!(
        r#"<mujoco>
  <option timestep="0.001" integrator="implicitfast" cone="elliptic" impratio="10" jacobian="dense" ccd_tolerance="1e-4"
          ccd_iterations="12" tolerance="1e-6"/>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 0.1"/>
    <geom name="left" type="capsule" size="0.02" fromto="-0.05 0 0 -0.15 0 0.3"/>
    <geom name="right" type="capsule" size="0.02" fromto="0.05 0 0 0.15 0 0.3"/>
    <body name="object" pos="0 0 0.2" euler="20 30 10">
      <freejoint name="free"/>
      <inertial pos="0 0 0" mass="{mass}" diaginertia="{ix} {iy} {iz}"/>
      <geom name="object" type="{kind}" size="{size}" friction="{friction} 0.005 0.0001"/>
    </body>
  </worldbody>
</mujoco>"#
    )
}

/// A simulation of [`scene`].
pub(crate) fn simulation(shape: Shape, mass: f64, friction: f64) -> Simulation {
    Simulation::from_mjcf(&scene(shape, mass, friction)).unwrap()
}

/// The bits of the state after each of 400 steps; the object lands in the first 200.
pub(crate) fn trajectory(simulation: &mut Simulation) -> Vec<u64> {
    let mut bits = Vec::new();
    for _ in 0..400 {
        simulation.step(1).unwrap();
        bits.extend(simulation.qpos().iter().chain(simulation.qvel()).map(|value| value.to_bits()));
    }
    bits
}

/// A planar leg with three joints that hops, about as large as Gymnasium's. Angles in degrees, sizes and places instead of
/// `fromto`, motors without names, textures, a geom that is only seen and has mass, and one whose body has an inertia.
pub(crate) const HOPPER: &str = r#"<mujoco model="leg">
  <compiler angle="degree" inertiafromgeom="auto"/>
  <option timestep="0.002" integrator="implicitfast"/>
  <default>
    <joint armature="0.5" damping="1"/>
    <geom friction="0.9" density="1000" material="skin"/>
    <motor ctrllimited="true" ctrlrange="-1 1"/>
  </default>
  <asset>
    <texture name="skin" type="cube" builtin="flat" mark="cross" width="64" height="64" rgb1="0.8 0.6 0.4"/>
    <texture name="tiles" type="2d" builtin="checker" width="200" height="200" rgb1="0 0 0" rgb2="1 1 1"/>
    <material name="skin" texture="skin"/>
    <material name="tiles" texture="tiles" texrepeat="60 60"/>
  </asset>
  <worldbody>
    <light pos="0 0 3"/>
    <geom name="floor" type="plane" size="20 20 0.1" material="tiles"/>
    <body name="torso" pos="0 0 1.3">
      <camera name="side" pos="0 -3 0" xyaxes="1 0 0 0 0 1"/>
      <joint name="rootx" type="slide" axis="1 0 0" armature="0" damping="0"/>
      <joint name="rootz" type="slide" axis="0 0 1" armature="0" damping="0"/>
      <joint name="rooty" type="hinge" axis="0 1 0" armature="0" damping="0"/>
      <geom name="torso" type="capsule" size="0.05 0.2"/>
      <geom name="badge" type="sphere" size="0.03" pos="0.05 0 0.1" contype="0" conaffinity="0"/>
      <body name="thigh" pos="0 0 -0.2">
        <joint name="hip" axis="0 -1 0" range="-150 0"/>
        <geom name="thigh" type="capsule" size="0.05 0.225" pos="0 0 -0.225"/>
        <body name="shin" pos="0 0 -0.45">
          <joint name="knee" axis="0 -1 0" range="-150 0" springref="-20" stiffness="3"/>
          <geom name="shin" type="capsule" size="0.04 0.25" pos="0 0 -0.25"/>
          <body name="foot" pos="0 0 -0.5" euler="0 5 0">
            <inertial pos="0.05 0 0" mass="0.7" diaginertia="0.001 0.002 0.002"/>
            <joint name="ankle" axis="0 -1 0" range="-45 45"/>
            <geom name="foot" type="capsule" size="0.05" fromto="-0.1 0 0 0.2 0 0"/>
            <geom name="sock" type="sphere" size="0.06" contype="0" conaffinity="0"/>
            <site name="toe" pos="0.2 0 0" size="0.01" euler="0 90 0"/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor joint="hip" gear="200"/>
    <motor joint="knee" gear="150"/>
    <position name="ankle" joint="ankle" kp="40" ctrlrange="-0.5 0.5"/>
  </actuator>
</mujoco>"#;

/// A set of files from texts.
pub(crate) fn files(texts: &[(&str, &str)]) -> Files {
    Files::new(texts.iter().map(|&(path, text)| (path, text.as_bytes()))).unwrap()
}

/// A specification of one text.
pub(crate) fn spec(text: &str) -> Spec {
    Spec::parse("model.xml", &files(&[("model.xml", text)])).unwrap()
}

/// A path, as a text has it.
pub(crate) fn path(text: &str) -> FieldPath {
    text.parse().unwrap()
}

/// The bits of the state after each of some steps with controls that move everything.
pub(crate) fn run(simulation: &mut Simulation, steps: u32) -> Vec<u64> {
    let mut bits = Vec::new();
    for step in 0..steps {
        for (index, control) in simulation.ctrl_mut().iter_mut().enumerate() {
            *control = 0.3 * f64::sin(0.1 * f64::from(step) + index as f64);
        }
        simulation.step(1).unwrap();
        bits.extend(simulation.qpos().iter().chain(simulation.qvel()).map(|value| value.to_bits()));
    }
    bits
}

/// A tetrahedron with edges of `size` m, as OBJ.
pub(crate) fn mesh(size: f64) -> String {
    format!("v 0 0 0\nv {size} 0 0\nv 0 {size} 0\nv 0 0 {size}\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
}
