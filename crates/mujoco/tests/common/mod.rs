//! The object that the tests drop and edit.

#![allow(dead_code, reason = "each test binary uses its part")]

use hwasp_mujoco::engine::{Shape, Simulation};

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
