//! How thick walls are, measured in the meshes: through every part between every two heights, and along its layers.

use super::*;

/// "At least 0.6 mm" was 0.41 to 0.44 mm beyond the hole that the line of a distal pulley ends in: the flange stood twice a clearance
/// beyond it, and not a wall. So every wall of every part is measured.
#[test]
fn every_wall_is_as_thick_as_the_workshop_says() {
    let workshop = Workshop::default();
    assert!(workshop.wall >= LEAST_WALL);
    let mut wide = SEARCHED;
    // At limits, and where the channel comes near the window.
    wide[..4].copy_from_slice(&[0.012, 0.0024, 0.0092, 0.0091]);
    let mut edge = SEARCHED;
    edge[..4].copy_from_slice(&[0.0105, 0.0112, 0.0024, 0.012]);
    let large = [SeatedSpring { wire: 0.6e-3, outer: 0.014, length: 0.006 }; 4];
    let mut least = f64::INFINITY;
    for (design, springs) in [(PAPER_HWASP, SPRINGS), (wide, SPRINGS), (edge, SPRINGS), (wide, large)] {
        for part in parts(&HandDescription::default(), &design, &springs, &workshop).unwrap() {
            let wall = part.thinnest_wall();
            let at = wall.at.map(|at| (1e5 * at).round() / 100.0);
            assert!(wall.thickness > workshop.wall - 1e-6, "{}: {} m at {at:?} mm", part.name, wall.thickness);
            least = least.min(wall.thickness);
        }
    }
    // Some are just so thick, which shows that they are measured.
    assert!(least < 1.01 * workshop.wall, "{least}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]

    /// The same of anything that the large range allows.
    #[test]
    fn every_wall_of_any_design_is_thick_enough(at in prop::array::uniform4(0.0..1.0)) {
        let workshop = Workshop::default();
        let mut design = PAPER_HWASP;
        for (radius, at) in design.iter_mut().zip(at) {
            *radius = 0.0024 + 0.0096 * at;
        }
        for part in parts(&HandDescription::default(), &design, &SPRINGS, &workshop).unwrap() {
            let wall = part.thinnest_wall();
            prop_assert!(wall.thickness > workshop.wall - 1e-6, "{}: {wall:?} of {:?}", part.name, &design[..4]);
        }
    }
}

/// The coupon has the walls that it tries, and every one of them can be printed.
#[test]
fn the_coupon_is_a_plate_with_the_thinnest_wall() {
    let workshop = Workshop::default();
    let coupon = coupon(&SPRINGS, &workshop).unwrap();
    assert_eq!(coupon.mesh.check(), Ok(()));
    let wall = coupon.thinnest_wall();
    assert!((wall.thickness - workshop.wall).abs() < 1e-6, "{wall:?}");
    let [low, high] = coupon.mesh.bounds();
    assert!((high[0] - low[0] - 0.064).abs() < 1e-9 && (high[2] - 0.009).abs() < 1e-9);
}
