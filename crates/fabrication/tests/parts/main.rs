//! The printed parts of a hand, measured in their meshes.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod walls;

use std::f64::consts::PI;

use hwasp_fabrication::{LEAST_WALL, Mesh, Part, SeatedSpring, Workshop, coupon, parts};
use hwasp_tasks::hand::{DESIGN_LEN, HandDescription, HandRange, PAPER_HWASP, SEARCHED, SMALL_CENTRE};
use proptest::prelude::*;

/// Those of the shipped hand.
const SPRINGS: [SeatedSpring; 4] = [
    SeatedSpring { wire: 0.38e-3, outer: 5.26e-3, length: 2.60e-3 },
    SeatedSpring { wire: 0.36e-3, outer: 6.72e-3, length: 2.45e-3 },
    SeatedSpring { wire: 0.45e-3, outer: 6.90e-3, length: 3.17e-3 },
    SeatedSpring { wire: 0.38e-3, outer: 6.76e-3, length: 3.07e-3 },
];

fn made(design: &[f64; DESIGN_LEN]) -> Vec<Part> {
    parts(&HandDescription::default(), design, &SPRINGS, &Workshop::default()).unwrap()
}

const LINKS: [&str; 4] = ["thumb_proximal_link", "thumb_distal_link", "finger_proximal_link", "finger_distal_link"];
const PULLEYS: [&str; 4] =
    ["thumb_proximal_pulley", "thumb_distal_pulley", "finger_proximal_pulley", "finger_distal_pulley"];

fn find<'p>(parts: &'p [Part], name: &str) -> &'p Mesh {
    &parts.iter().find(|part| part.name == name).unwrap().mesh
}

#[test]
fn the_parts_of_known_designs_are_solids() {
    for design in [PAPER_HWASP, SMALL_CENTRE, SEARCHED] {
        let parts = made(&design);
        assert_eq!(parts.iter().map(|part| part.count).sum::<usize>(), 1 + 6 + 6 + 6);
        for Part { name, mesh, .. } in &parts {
            assert_eq!(mesh.check(), Ok(()), "{name}");
        }
    }
}

/// Designs that random ones came to: triangles of two were lower than 10 nm, of the third 4 edges were open.
#[test]
fn the_parts_of_designs_with_a_corner_on_an_edge_are_solids() {
    let workshop = Workshop { springs: 1, ..Workshop::default() };
    let spring = SeatedSpring { wire: 0.0003, outer: 0.004, length: 0.002 };
    for (place, radius) in
        [(3, 0.003_929_652_534_914_504), (1, 0.007_129_489_464_727_618), (3, 0.010_734_799_594_249_823)]
    {
        let mut design = [0.0024, 0.0024, 0.0024, 0.0024, 0.002, 0.002, 0.002, 0.002, 0.0, 0.0, 0.0, 0.0];
        design[place] = radius;
        parts(&HandDescription::default(), &design, &[spring; 4], &workshop).unwrap();
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// Anything that the large range allows and a groove can be made for, its corners included, with springs as large as there is
    /// room for or small ones, on both sides or on one.
    #[test]
    fn the_parts_of_any_design_are_solids(
        at in prop::array::uniform12(prop_oneof![Just(0.0), Just(1.0), 0.0..1.0]),
        springs in 1..=2_u32,
        size in prop_oneof![Just(0.0), Just(1.0), 0.0..1.0],
    ) {
        let workshop = Workshop { springs, ..Workshop::default() };
        let spring = SeatedSpring { wire: 0.0003 + 0.0003 * size, outer: 0.004 + 0.01 * size, length: 0.002 + 0.004 * size };
        let bounds = HandRange::Large.bounds();
        let mut design: [f64; DESIGN_LEN] = std::array::from_fn(|i| bounds[i].0 + at[i] * (bounds[i].1 - bounds[i].0));
        for radius in &mut design[..4] {
            *radius = radius.max(workshop.least_groove() + 0.5 * workshop.line);
        }
        let made = parts(&HandDescription::default(), &design, &[spring; 4], &workshop).map(|_| ());
        prop_assert!(made.is_ok(), "{design:?}: {made:?}");
    }
}

/// The groove's bottom is half of a line below the design's radius, but for the 5 µm by which a polygon is inside of its circle.
#[test]
fn the_line_runs_at_the_radius_of_the_design() {
    let (workshop, parts) = (Workshop::default(), made(&SEARCHED));
    // Half of its width: two turns of line side by side.
    let groove = workshop.line + workshop.print_clearance;
    for (kind, name) in PULLEYS.iter().enumerate() {
        // On the side without holes.
        let inside_groove = |corner: &[f64; 3]| (corner[0] - groove).abs() < 1e-12;
        let mut distances: Vec<f64> = find(&parts, name)
            .triangles()
            .flatten()
            .filter(inside_groove)
            .map(|[_, y, z]| y.hypot(z))
            .filter(|&distance| distance > SEARCHED[kind] - workshop.line)
            .collect();
        distances.sort_by(f64::total_cmp);
        let bottom = SEARCHED[kind] - 0.5 * workshop.line;
        assert!((distances[0] - bottom).abs() < 5e-6, "{name}: {} of {bottom}", distances[0]);
        let rim = distances[distances.len() - 1];
        assert!(rim > SEARCHED[kind] + 0.5 * workshop.line, "{name}: the line stands out of {rim}");
    }
}

/// Two flanges and a groove, less the bore, by hand.
#[test]
fn a_proximal_pulley_has_the_volume_of_its_discs() {
    let mut design = SMALL_CENTRE;
    design[0] = 0.010;
    let volume = find(&made(&design), "thumb_proximal_pulley").volume();
    // 10 mm and 0.4 + 0.8; 10 less 0.2; 2.5 and 0.1 across.
    let (rim, bottom, bore) = (0.0112, 0.0098, 0.0013);
    let wanted = PI * (0.002 * rim * rim + 0.0012 * bottom * bottom - 0.0032 * bore * bore);
    assert!((volume / wanted - 1.0).abs() < 2e-3, "{volume} of {wanted}");
}

/// Parts lie in the boxes of the shapes that the simulation has, so that the palm and links that are built touch nothing that
/// those do not.
#[test]
fn links_fill_the_boxes_of_their_capsules() {
    let (hand, workshop) = (HandDescription::default(), Workshop::default());
    let parts = made(&SEARCHED);
    for (name, link) in [
        ("thumb_proximal_link", &hand.thumb.proximal),
        ("thumb_distal_link", &hand.thumb.distal),
        ("finger_proximal_link", &hand.fingers[0].proximal),
        ("finger_distal_link", &hand.fingers[0].distal),
    ] {
        let [low, high] = find(&parts, name).bounds();
        // The stop of a proximal link stands 1.5 mm beyond: a line's hole, a wall and 0.3 mm beyond the largest pulley.
        let end = link.length + if name.contains("proximal") { 0.0135 } else { link.radius };
        let wanted = [-0.0118, -link.radius, -link.radius, 0.0118, link.radius, end];
        for (bound, wanted) in low.iter().chain(&high).zip(wanted) {
            assert!((bound - wanted).abs() < 1.2e-5, "{name}: {low:?} to {high:?}");
        }
    }
    let [low, high] = find(&parts, "palm").bounds();
    // The lugs are round, of straight sides.
    let leg = |spring| workshop.leg_circle(spring) + workshop.leg_hole(spring);
    let lug = SPRINGS.iter().map(leg).fold(0.0, f64::max) + 4.0 * workshop.wall;
    assert!((low[2] + lug).abs() < 1e-5 && (high[2] - 0.020).abs() < 1e-9);
    assert!((high[0] - 0.037).abs() < 1e-9 && high[1] < 0.052);
}

/// Print files had one pocket of a fixed size, for one spring, where the shopping sheet had two springs of other sizes.
#[test]
fn pockets_hold_the_chosen_springs_on_both_sides() {
    let (workshop, printed) = (Workshop::default(), made(&SEARCHED));
    for (spring, name) in SPRINGS.iter().zip(LINKS) {
        let radius = workshop.leg_circle(spring) + 0.5 * spring.wire + workshop.print_clearance;
        assert!(radius > 0.5 * spring.outer + workshop.print_clearance, "coil and legs fit into it");
        for side in [1.0, -1.0] {
            // The floor of a pocket, which opens 9 mm from the middle: corners on its circle.
            let floor = side * (0.009 - spring.length - workshop.print_clearance);
            let on_circle = |corner: &[f64; 3]| {
                (corner[0] - floor).abs() < 1e-9 && (corner[1].hypot(corner[2]) - radius).abs() < 1e-9
            };
            let corners = find(&printed, name).triangles().flatten().filter(on_circle).count();
            assert!(corners >= 96, "{name}: {corners} corners at {floor}");
        }
    }
    // One spring leaves the other side whole.
    let one = Workshop { springs: 1, ..workshop };
    let single = parts(&HandDescription::default(), &SEARCHED, &SPRINGS, &one).unwrap();
    assert!(find(&single, LINKS[0]).volume() > 1.005 * find(&printed, LINKS[0]).volume());
}

#[test]
fn what_cannot_be_built_is_refused() {
    let refused = |change: fn(&mut HandDescription, &mut [f64; DESIGN_LEN], &mut Workshop)| {
        let (mut hand, mut design, mut workshop) = (HandDescription::default(), SEARCHED, Workshop::default());
        change(&mut hand, &mut design, &mut workshop);
        parts(&hand, &design, &SPRINGS, &workshop).map(|_| ()).unwrap_err().to_string()
    };
    let told = refused(|_, design, _| design[3] = 0.0015);
    assert!(told.starts_with("finger_distal_radius = 0.0015 m is outside of [0.00229"), "{told}");
    assert!(refused(|_, design, _| design[0] = 0.0125).starts_with("thumb_proximal_radius = 0.0125 m"));
    let told = refused(|_, design, workshop| (design[3], workshop.axle) = (0.003, 0.005));
    assert!(told.contains("[0.00354"), "{told}");
    let told = refused(|_, _, workshop| workshop.spring_room = 0.008);
    assert!(told.starts_with("a joint of thumb.proximal, from cheek to cheek, takes 27.60 mm"), "{told}");
    assert!(told.contains("this hand has 24.00 mm") && told.contains("`spring_room`"), "{told}");
    let told = refused(|_, _, workshop| workshop.hole_pitch = 5f64.to_radians());
    assert!(
        told.starts_with("what is around an axle of thumb.proximal takes") && told.contains("hole_pitch"),
        "{told}"
    );
    let told = refused(|_, _, workshop| workshop.spring_room = 0.003);
    assert!(told.starts_with("a spring of finger_proximal that is so long takes 3.17 mm"), "{told}");
    assert!(
        refused(|hand, _, _| {
            let link = &mut hand.thumb.distal;
            (link.length, link.centre) = (0.010, 0.005);
        })
        .starts_with("thumb.distal.length = 0.01 m")
    );
    assert!(refused(|hand, _, _| hand.fingers[0].base[0] = -0.010).contains("finger1.base[0] - finger2.base[0]"));
    assert!(
        refused(|hand, _, _| hand.fingers[1].proximal.mass = 0.02).contains("the two fingers have different links")
    );
    assert!(refused(|hand, _, _| hand.palm.half_size[2] = 0.005).starts_with("palm.half_size[2] = 0.005 m"));
    assert!(refused(|hand, _, _| hand.palm.half_size[0] = 0.030).starts_with("palm.half_size[0] = 0.03 m"));
    assert!(
        refused(|hand, _, _| hand.transmission.spool_radius = 0.004).starts_with("transmission.spool_radius = 0.004 m")
    );
    assert!(refused(|_, _, workshop| workshop.pad = 0.0035).starts_with("the pad of thumb.proximal takes 3.50 mm"));
    assert!(refused(|hand, _, _| hand.joint.rest_angle = 1.2).starts_with("joint.rest_angle = 1.2 rad"));
    let broken = SeatedSpring { wire: f64::NAN, ..SPRINGS[0] };
    let error = parts(&HandDescription::default(), &SEARCHED, &[broken; 4], &Workshop::default()).unwrap_err();
    assert!(error.to_string().starts_with("thumb_proximal spring wire = NaN m"), "{error}");
}
