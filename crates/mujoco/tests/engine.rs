//! The engine is found when a program of this crate starts; with a wrong path of the linker this test does not even run.

use hwasp_mujoco::engine::Simulation;

#[test]
fn the_engine_is_there() {
    let mut simulation =
        Simulation::from_mjcf("<mujoco><worldbody><body><freejoint/><geom size='0.1'/></body></worldbody></mujoco>")
            .unwrap();
    simulation.step(1).unwrap();
    assert!(simulation.qvel()[2] < 0.0, "it falls");
}
