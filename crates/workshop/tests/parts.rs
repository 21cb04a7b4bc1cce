//! Parts: what is refused, that the nearest are found, and what the sheet says. What needs a simulation is in
//! `parts_worth.rs`.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use std::f64::consts::TAU;
use std::fmt::Write;

use hwasp_tasks::hand::{DESIGN_LEN, HandDescription, HandRange, PAPER_HWASP, PAPER_MINIMAL, SEARCHED, SMALL_CENTRE};
use hwasp_workshop::parts::{Bench, JointParts, Reason, SelectError, SpringCatalogue, TorsionSpring, select, unfit};

const HEADER: &str = "part,wire_mm,outer_mm,turns,leg_angle_deg,leg_mm";

fn chosen(
    design: &[f64; DESIGN_LEN],
    catalogue: &SpringCatalogue,
    bench: &Bench,
) -> Result<Vec<JointParts>, SelectError> {
    select(&HandDescription::default(), design, &HandRange::Large.bounds(), catalogue, bench)
}

fn catalogue(rows: &str) -> Result<SpringCatalogue, String> {
    SpringCatalogue::parse("mine.csv", format!("{HEADER}\n{rows}").as_bytes()).map_err(|error| error.to_string())
}

/// A spring that suits the bench as it is.
fn spring() -> TorsionSpring {
    TorsionSpring { wire: 0.0004, outer: 0.0053, turns: 8.25, leg: 0.010, modulus: 207e9, strength: 2.5e9 }
}

#[test]
fn each_limit_refuses() {
    let (angle, bench) = (3.0, Bench::default());
    assert_eq!(unfit(&spring(), angle, &bench), None);
    let stress = spring().stress(spring().rate() * angle);
    for (reason, narrower, just) in [
        (Reason::Wide, Bench { coil_room: 0.00529, ..bench.clone() }, Bench { coil_room: 0.0053, ..bench.clone() }),
        (
            Reason::Long,
            Bench { spring_room: 0.999 * spring().length_wound(angle), ..bench.clone() },
            Bench { spring_room: 1.001 * spring().length_wound(angle), ..bench.clone() },
        ),
        (
            Reason::Tight,
            Bench { axle: 1.001 * spring().inner_wound(angle) / 1.1, ..bench.clone() },
            Bench { axle: 0.999 * spring().inner_wound(angle) / 1.1, ..bench.clone() },
        ),
        (
            Reason::Stressed,
            Bench { stress_share: 0.999 * stress / 2.5e9, ..bench.clone() },
            Bench { stress_share: 1.001 * stress / 2.5e9, ..bench.clone() },
        ),
    ] {
        assert_eq!(unfit(&spring(), angle, &narrower), Some(reason));
        assert_eq!(unfit(&spring(), angle, &just), None, "{reason:?}");
        // Wound up less it may do; the width of a coil is that of the free spring.
        let relaxed = unfit(&spring(), 0.9 * angle, &narrower);
        assert_eq!(relaxed, (reason == Reason::Wide).then_some(reason));
    }
}

/// All springs and all holes, the torque compared at many angles: nothing that will do is nearer.
#[test]
fn the_nearest_parts_are_found() {
    let (catalogue, hand) = (SpringCatalogue::built_in().unwrap(), HandDescription::default());
    let fine = Bench { hole_pitch: 9f64.to_radians(), springs: 1, spring_room: 0.008, ..Bench::default() };
    for (design, bench) in [PAPER_HWASP, PAPER_MINIMAL, SEARCHED, SMALL_CENTRE]
        .into_iter()
        .flat_map(|design| [(design, Bench::default()), (design, fine.clone())])
    {
        for (kind, found) in chosen(&design, &catalogue, &bench).unwrap().iter().enumerate() {
            let (stiffness, preload) = (design[4 + kind], design[8 + kind]);
            let off = |k: f64, p: f64| {
                let at = |i: u32| 1.57 * f64::from(i) / 50.0;
                (0..=50).map(|i| (k * (at(i) + p) - stiffness * (at(i) + preload)).abs()).fold(0.0, f64::max)
            };
            let mut least = f64::INFINITY;
            for entry in &catalogue.springs {
                for hole in 0..bench.holes() {
                    let mut p = f64::from(hole) * bench.hole_pitch - entry.leg_angle;
                    while p < -1e-9 {
                        p += TAU;
                    }
                    let k = f64::from(bench.springs) * entry.spring.rate();
                    let within = (0.002..0.012).contains(&k) && (1e-6..4.0).contains(&p);
                    if within && unfit(&entry.spring, p + 1.57, &bench).is_none() {
                        least = least.min(off(k, p));
                    }
                }
            }
            assert!((found.torque_error - least).abs() < 1e-12, "{} {}: {least}", found.joint, found.torque_error);
            assert!((off(found.built.stiffness, found.built.preload) - least).abs() < 1e-12);
            // What is told of the spring is what the design has.
            assert!((found.built.stiffness - f64::from(bench.springs) * found.spring.rate).abs() < 1e-15);
            let turned = f64::from(found.spring.hole) * bench.hole_pitch - found.spring.leg_angle;
            assert!(
                (turned - found.built.preload).rem_euclid(TAU).min((found.built.preload - turned).rem_euclid(TAU))
                    < 1e-9
            );
            assert!(found.spring.stress_share <= bench.stress_share && found.spring.length_wound <= bench.spring_room);
            assert!(found.spring.inner_wound >= 1.1 * bench.axle);
            // Half a step of the groove, half a hole with a spring of a few per cent.
            assert!((found.built.radius - design[kind]).abs() <= 0.5 * bench.radius_step + 1e-12);
            assert_eq!(found.joints, if kind < 2 { 1 } else { 2 });
        }
    }
    assert_eq!(hand.joint.range[1], 1.57);
}

/// A radius on its limit goes to the next groove inside.
#[test]
fn grooves_stay_within_the_limits() {
    let (catalogue, bench) = (SpringCatalogue::built_in().unwrap(), Bench::default());
    let mut design = SMALL_CENTRE;
    (design[0], design[1]) = (0.012, 0.002);
    let found = chosen(&design, &catalogue, &bench).unwrap();
    assert!((found[0].built.radius - 0.01195).abs() < 1e-9 && (found[1].built.radius - 0.00205).abs() < 1e-9);
    assert!((found[0].pulley.groove_radius - 0.01175).abs() < 1e-9);
    let coarse = Bench { radius_step: 0.001, ..bench };
    let limits = HandRange::Small.bounds();
    let narrow = limits.map(|(lo, hi)| (0.5 * (lo + hi) - 0.1 * (hi - lo), 0.5 * (lo + hi) + 0.1 * (hi - lo)));
    let error = select(&HandDescription::default(), &SMALL_CENTRE, &narrow, &catalogue, &coarse).unwrap_err();
    assert!(matches!(error, SelectError::Pulley { joint: "thumb_proximal", .. }), "{error}");
}

#[test]
fn a_catalogue_without_a_spring_for_a_joint() {
    let rows = [
        "soft,0.20,4.4,8.25,90,10,",
        "long,0.40,4.8,16.25,90,10,",
        "wide,0.50,15,3.25,90,10,",
        "tight,0.40,3.6,6.25,90,10,",
        "stressed,0.40,5.8,8.25,90,10,400",
    ];
    let text = format!("{HEADER},strength_mpa\n{}", rows.join("\n"));
    let catalogue = SpringCatalogue::parse("mine.csv", text.as_bytes()).unwrap();
    let error = chosen(&PAPER_HWASP, &catalogue, &Bench::default()).unwrap_err();
    insta::assert_snapshot!(error);
}

#[test]
fn a_suppliers_file_is_read() {
    let text = "\u{feff}# my stock\nturns, part ,outer_mm,wire_mm,leg_mm,leg_angle_deg,modulus_gpa,strength_mpa\n\n\
                8.25,\"LTL, 12 \"\"L\"\"\",5.3,0.4,10,90,193,1900\n8.25,plain,5.3,0.4,10,360,,\n";
    let catalogue = SpringCatalogue::parse("stock.csv", text.as_bytes()).unwrap();
    let [steel, plain] = &catalogue.springs[..] else { panic!("{catalogue:?}") };
    assert_eq!((&*steel.part, steel.spring.modulus, steel.spring.strength), ("LTL, 12 \"L\"", 193e9, 1900e6));
    assert_eq!((plain.spring.modulus, plain.spring.turns, plain.leg_angle), (207e9, 8.25, TAU));
    assert!((plain.spring.strength / 2525e6 - 1.0).abs() < 1e-3);
    // A shear less stiff, and nothing else about it.
    assert!((steel.spring.rate() / plain.spring.rate() - 193.0 / 207.0).abs() < 1e-12);
}

#[test]
fn every_wrong_row_is_told_with_its_line() {
    let mut transcript = String::new();
    let rows = [
        "a,0.4,5.3,8.25,90,10",
        "a,0.4,5.3,8.25,90,10",
        "b,0.4 mm,5.3,8.25,90,10",
        "c,0.4,5.3,8.25,90",
        "# a remark",
        "d,0.4,5.3,,90,10",
        ",0.4,5.3,8.25,90,10",
        "e,4,5.3,8.25,90,10",
        "f,0.4,5.3,nan,90,10",
        "g,0.4,5.3,8.25,-90,10",
    ];
    transcript.push_str(&catalogue(&rows.join("\n")).unwrap_err());
    for text in [
        "",
        HEADER,
        "part;wire_mm;outer_mm;turns;leg_angle_deg;leg_mm\na;0,4;5;8;90;10\n",
        "part,wire_mm,outer_mm,turn,leg_angle_deg,leg_mm\n",
        "part,wire_mm,outer_mm,turns,leg_mm\n",
        "part,wire_mm,wire_mm,turns,leg_angle_deg,leg_mm\n",
        "part,wire_mm,outer_mm,turns,leg_angle_deg,leg_mm\n\u{0}",
    ] {
        let error = SpringCatalogue::parse("mine.csv", text.as_bytes()).unwrap_err();
        write!(transcript, "\n\n{text:?}\n{error}").unwrap();
    }
    let broken = SpringCatalogue::parse("mine.csv", b"part,wire_mm\n\xff\xfe,1\n").unwrap_err();
    write!(transcript, "\n\n{broken}").unwrap();
    let many = catalogue(&"x,1\n".repeat(50)).unwrap_err();
    assert!(many.contains("\n  and 30 more\n") && many.lines().count() == 23, "{many}");
    insta::assert_snapshot!(transcript);
}

#[test]
fn the_workshop_is_set_within_its_limits() {
    let mut bench = Bench::default();
    for given in
        ["axle=3 mm", "hole_pitch=\"10 deg\"", " springs = 1 ", "stress_share=0.5", "line=0.3mm", "coil_room=2 cm"]
    {
        bench.set(given).unwrap();
    }
    assert_eq!((bench.axle, bench.springs, bench.stress_share, bench.holes()), (0.003, 1, 0.5, 36));
    let before = bench.clone();
    let told = [
        "axle",
        "axel=3 mm",
        "axle=3",
        "axle=300 mm",
        "axle=nan mm",
        "springs=1.5",
        "hole_pitch=17 deg",
        "springs=2 N",
    ]
    .map(|given| bench.set(given).unwrap_err().to_string());
    assert_eq!(bench, before);
    insta::assert_snapshot!(told.join("\n"));
}
