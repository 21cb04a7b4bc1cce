//! How far loops are open.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use hwasp_mujoco::engine::Simulation;

/// Two rods beside each other, whose ends a constraint joins.
fn rods(equality: &str) -> Simulation {
    let rod = |name: &str, x: f64| {
        format!(
            "<body name=\"{name}\" pos=\"{x} 0 0\"><joint name=\"{name}\" axis=\"0 1 0\"/><geom size=\"0.01\" mass=\"1\"/>\
             <site name=\"{name}\" pos=\"0 0 -0.5\"/></body>"
        )
    };
    let slide = "<body name=\"sled\"><joint name=\"sled\" type=\"slide\"/><geom size=\"0.01\" mass=\"1\"/></body>";
    let text = format!(
        "<mujoco><worldbody>{}{}{slide}</worldbody><equality>{equality}</equality></mujoco>",
        rod("left", 0.0),
        rod("right", 0.1)
    );
    Simulation::from_mjcf(&text).unwrap()
}

#[test]
fn distances_and_angles_are_those_of_the_state() {
    for (equality, kind, distance, angle) in [
        ("<connect name=\"loop\" site1=\"left\" site2=\"right\"/>", "connect", 0.1, 0.0),
        ("<connect name=\"loop\" body1=\"left\" body2=\"right\" anchor=\"0 0 -0.5\"/>", "connect", 0.0, 0.0),
        ("<weld name=\"loop\" site1=\"left\" site2=\"right\"/>", "weld", 0.1, 0.0),
        ("<joint name=\"loop\" joint1=\"left\" joint2=\"right\" polycoef=\"0.2 1 0 0 0\"/>", "joint", 0.0, 0.2),
        ("<joint name=\"loop\" joint1=\"sled\" polycoef=\"0.3 0 0 0 0\"/>", "joint", 0.3, 0.0),
    ] {
        let mut rods = rods(equality);
        rods.forward().unwrap();
        let [gap] = &rods.gaps()[..] else { panic!("{equality}: {:?}", rods.gaps()) };
        assert_eq!((gap.name.as_deref(), gap.index, gap.kind), (Some("loop"), 0, kind));
        assert!((gap.distance - distance).abs() < 1e-9 && (gap.angle - angle).abs() < 1e-9, "{equality}: {gap:?}");
    }
}

/// Both rods turn by 0.4 rad, one the other way.
#[test]
fn a_weld_measures_the_turning_whatever_its_weight() {
    for scale in [1.0, 0.3] {
        let weld = format!("<weld site1=\"left\" site2=\"right\" torquescale=\"{scale}\"/>");
        let mut rods = rods(&weld);
        rods.qpos_mut()[..2].copy_from_slice(&[0.4, -0.4]);
        rods.forward().unwrap();
        let [gap] = &rods.gaps()[..] else { panic!("{:?}", rods.gaps()) };
        assert!((gap.angle - 0.8).abs() < 1e-9, "{scale}: {gap:?}");
        assert!((gap.distance - (0.1 + 0.4_f64.sin())).abs() < 1e-9, "{gap:?}");
    }
}

#[test]
fn what_is_switched_off_or_pulls_only_has_no_gap() {
    let mut rods = rods("<connect site1=\"left\" site2=\"right\" active=\"false\"/>");
    rods.forward().unwrap();
    assert_eq!(rods.gaps(), []);
}
