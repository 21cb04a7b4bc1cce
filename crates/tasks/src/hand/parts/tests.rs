use std::f64::consts::PI;

use proptest::prelude::*;

use super::super::space::{HandRange, PAPER_HWASP, SEARCHED, SMALL_CENTRE};
use super::*;

fn made(design: &[f64; DESIGN_LEN]) -> Vec<Part> {
    parts(&HandDescription::default(), design, &Stock::default()).unwrap()
}

fn find<'p>(parts: &'p [Part], name: &str) -> &'p Mesh {
    &parts.iter().find(|part| part.name == name).unwrap().mesh
}

#[test]
fn the_parts_of_known_designs_are_solids() {
    for design in [PAPER_HWASP, SMALL_CENTRE, SEARCHED] {
        let parts = made(&design);
        assert_eq!(parts.iter().map(|part| part.count).sum::<usize>(), 1 + 6 + 6);
        for Part { name, mesh, .. } in &parts {
            assert_eq!(mesh.check(), Ok(()), "{name}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Anything that the large range allows, its corners included.
    #[test]
    fn the_parts_of_any_design_are_solids(at in prop::array::uniform12(prop_oneof![Just(0.0), Just(1.0), 0.0..1.0])) {
        let bounds = HandRange::Large.bounds();
        let design = std::array::from_fn(|i| bounds[i].0 + at[i] * (bounds[i].1 - bounds[i].0));
        let made = parts(&HandDescription::default(), &design, &Stock::default()).map(|_| ());
        prop_assert!(made.is_ok(), "{design:?}: {made:?}");
    }
}

/// The groove's bottom is half of a line below the design's radius, but for the 5 µm by which a polygon is inside of its circle.
#[test]
fn the_line_runs_at_the_radius_of_the_design() {
    let (stock, parts) = (Stock::default(), made(&SEARCHED));
    for (kind, name) in PULLEY_PARTS.iter().enumerate() {
        // On the side without holes.
        let inside_groove = |corner: &[f64; 3]| (corner[0] - stock.groove()).abs() < 1e-12;
        let mut distances: Vec<f64> = find(&parts, name)
            .triangles()
            .flatten()
            .filter(inside_groove)
            .map(|[_, y, z]| y.hypot(z))
            .filter(|&distance| distance > SEARCHED[kind] - stock.line_diameter)
            .collect();
        distances.sort_by(f64::total_cmp);
        let bottom = SEARCHED[kind] - 0.5 * stock.line_diameter;
        assert!((distances[0] - bottom).abs() < 5e-6, "{name}: {} of {bottom}", distances[0]);
        let rim = distances[distances.len() - 1];
        assert!(rim > SEARCHED[kind] + 0.5 * stock.line_diameter, "{name}: the line stands out of {rim}");
    }
}

/// Two flanges and a groove, less the bore, by hand.
#[test]
fn a_proximal_pulley_has_the_volume_of_its_discs() {
    let (stock, radius) = (Stock::default(), 0.010);
    let mut design = SMALL_CENTRE;
    design[0] = radius;
    let volume = find(&made(&design), "thumb_proximal_pulley").volume();
    // 10 mm and 0.5 + 0.4; 10 less 0.3; 2 and 0.1 across.
    let (rim, bottom, bore) = (0.0109, 0.0097, 0.00105);
    let wanted = PI * (0.0036 * rim * rim + 0.0016 * bottom * bottom - 0.0052 * bore * bore);
    assert!((volume / wanted - 1.0).abs() < 1e-3, "{volume} of {wanted}");
    assert_eq!((stock.rim(radius), stock.bore()), (rim, bore));
}

/// Parts lie in the boxes of the shapes that the simulation has, so that the palm and links that are built touch nothing that
/// those do not.
#[test]
fn links_fill_the_boxes_of_their_capsules() {
    let hand = HandDescription::default();
    let parts = made(&SEARCHED);
    for (name, link) in [
        ("thumb_proximal_link", &hand.thumb.proximal),
        ("thumb_distal_link", &hand.thumb.distal),
        ("finger_proximal_link", &hand.fingers[0].proximal),
        ("finger_distal_link", &hand.fingers[0].distal),
    ] {
        let [low, high] = find(&parts, name).bounds();
        // The stop of a proximal link stands 1.2 mm beyond.
        let end = if name.contains("proximal") { link.length + 0.0132 } else { link.length + link.radius };
        let wanted = [-0.011, -link.radius, -link.radius, 0.011, link.radius, end];
        for (bound, wanted) in low.iter().chain(&high).zip(wanted) {
            assert!((bound - wanted).abs() < 1e-5, "{name}: {low:?} to {high:?}");
        }
    }
    let [low, high] = find(&parts, "palm").bounds();
    // The lugs are round, of straight sides.
    assert!((low[2] + Stock::default().lug()).abs() < 1e-5 && (high[2] - 0.020).abs() < 1e-9);
    assert!((high[0] - 0.037).abs() < 1e-9 && high[1] < 0.052);
}

/// The hole for the fixed leg is the one for the moving leg, turned back by the preload.
#[test]
fn springs_are_wound_by_the_preload() {
    let stock = Stock::default();
    for (preload, [y, z]) in
        [(0.0, [0.0, 1.0]), (PI / 2.0, [1.0, 0.0]), (PI, [0.0, -1.0]), (4.0, [4f64.sin(), 4f64.cos()])]
    {
        let leg = link::fixed_leg(preload, &stock);
        let wanted = [y, z].map(|c| c * stock.leg_circle());
        assert!((leg[0] - wanted[0]).abs() < 1e-15 && (leg[1] - wanted[1]).abs() < 1e-15, "{preload}: {leg:?}");
    }
}

#[test]
fn what_cannot_be_built_is_refused() {
    let refused = |change: fn(&mut HandDescription, &mut [f64; DESIGN_LEN], &mut Stock)| {
        let (mut hand, mut design, mut stock) = (HandDescription::default(), SEARCHED, Stock::default());
        change(&mut hand, &mut design, &mut stock);
        parts(&hand, &design, &stock).map(|_| ()).unwrap_err().to_string()
    };
    assert_eq!(
        refused(|_, design, _| design[3] = 0.0015),
        "finger_distal_radius = 0.0015 m is outside of [0.00195, 0.012]; choose it between them"
    );
    assert!(refused(|_, design, _| design[0] = 0.0125).starts_with("thumb_proximal_radius = 0.0125 m"));
    assert!(
        refused(|_, design, stock| (design[3], stock.shaft_diameter) = (0.003, 0.005)).contains("[0.00345, 0.012]")
    );
    assert!(refused(|_, _, stock| stock.spring_diameter = 0.004).starts_with("stock.spring_diameter = 0.004 m"));
    assert!(refused(|_, _, stock| stock.wall = f64::NAN).starts_with("stock.wall = NaN m"));
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
    assert!(refused(|hand, _, _| hand.joint.rest_angle = 1.2).starts_with("joint.rest_angle = 1.2 rad"));
}
