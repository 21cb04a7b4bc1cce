//! Parts: what is refused, that the nearest are found, and what the sheet says. What needs a simulation is in
//! `parts_worth.rs`.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use std::f64::consts::TAU;
use std::fmt::Write;

use hwasp_core::{Dimension, parse_quantity};
use hwasp_settings::{Item, Kind, described, written};
use hwasp_tasks::hand::{DESIGN_LEN, HandDescription, HandRange, PAPER_HWASP, PAPER_MINIMAL, SEARCHED, SMALL_CENTRE};
use hwasp_workshop::parts::{
    JointParts, PartsList, Reason, SelectError, SpringCatalogue, TorsionSpring, Workshop, build_sheet, select, unfit,
};

const HEADER: &str = "part,wire_mm,outer_mm,turns,leg_angle_deg,leg_mm";

fn chosen(
    design: &[f64; DESIGN_LEN],
    catalogue: &SpringCatalogue,
    workshop: &Workshop,
) -> Result<[JointParts; 4], SelectError> {
    select(&HandDescription::default(), design, &HandRange::Large.bounds(), catalogue, workshop)
}

fn catalogue(rows: &str) -> Result<SpringCatalogue, String> {
    SpringCatalogue::parse("mine.csv", format!("{HEADER}\n{rows}").as_bytes()).map_err(|error| error.to_string())
}

/// A spring that suits the workshop as it is.
fn spring() -> TorsionSpring {
    TorsionSpring { wire: 0.0004, outer: 0.0053, turns: 8.25, leg: 0.010, modulus: 207e9, strength: 2.5e9 }
}

#[test]
fn each_limit_refuses() {
    let (angle, workshop) = (3.0, Workshop::default());
    assert_eq!(unfit(&spring(), angle, &workshop), None);
    let stress = spring().stress(spring().rate() * angle);
    for (reason, narrower, just) in [
        (
            Reason::Wide,
            Workshop { coil_room: 0.00529, ..workshop.clone() },
            Workshop { coil_room: 0.0053, ..workshop.clone() },
        ),
        (
            Reason::Long,
            Workshop { spring_room: 0.999 * spring().length_wound(angle), ..workshop.clone() },
            Workshop { spring_room: 1.001 * spring().length_wound(angle), ..workshop.clone() },
        ),
        (
            Reason::Tight,
            Workshop { axle: 1.001 * spring().inner_wound(angle) / 1.1, ..workshop.clone() },
            Workshop { axle: 0.999 * spring().inner_wound(angle) / 1.1, ..workshop.clone() },
        ),
        (
            Reason::Stressed,
            Workshop { stress_share: 0.999 * stress / 2.5e9, ..workshop.clone() },
            Workshop { stress_share: 1.001 * stress / 2.5e9, ..workshop.clone() },
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
    let fine = Workshop { hole_pitch: 9f64.to_radians(), springs: 1, spring_room: 0.008, ..Workshop::default() };
    for (design, workshop) in [PAPER_HWASP, PAPER_MINIMAL, SEARCHED, SMALL_CENTRE]
        .into_iter()
        .flat_map(|design| [(design, Workshop::default()), (design, fine.clone())])
    {
        for (kind, found) in chosen(&design, &catalogue, &workshop).unwrap().iter().enumerate() {
            let (stiffness, preload) = (design[4 + kind], design[8 + kind]);
            let off = |k: f64, p: f64| {
                let at = |i: u32| 1.57 * f64::from(i) / 50.0;
                (0..=50).map(|i| (k * (at(i) + p) - stiffness * (at(i) + preload)).abs()).fold(0.0, f64::max)
            };
            let mut least = f64::INFINITY;
            for entry in &catalogue.springs {
                for hole in 0..workshop.holes() {
                    let mut p = f64::from(hole) * workshop.hole_pitch - entry.leg_angle;
                    while p < -1e-9 {
                        p += TAU;
                    }
                    let k = f64::from(workshop.springs) * entry.spring.rate();
                    let within = (0.002..0.012).contains(&k) && (1e-6..4.0).contains(&p);
                    if within && unfit(&entry.spring, p + 1.57, &workshop).is_none() {
                        least = least.min(off(k, p));
                    }
                }
            }
            assert!((found.torque_error - least).abs() < 1e-12, "{} {}: {least}", found.joint, found.torque_error);
            assert!((off(found.built.stiffness, found.built.preload) - least).abs() < 1e-12);
            // What is told of the spring is what the design has.
            assert!((found.built.stiffness - f64::from(workshop.springs) * found.spring.rate).abs() < 1e-15);
            let turned = f64::from(found.spring.hole) * workshop.hole_pitch - found.spring.leg_angle;
            assert!(
                (turned - found.built.preload).rem_euclid(TAU).min((found.built.preload - turned).rem_euclid(TAU))
                    < 1e-9
            );
            assert!(
                found.spring.stress_share <= workshop.stress_share && found.spring.length_wound <= workshop.spring_room
            );
            assert!(found.spring.inner_wound >= 1.1 * workshop.axle);
            // Half a step of the groove, half a hole with a spring of a few per cent.
            assert!((found.built.radius - design[kind]).abs() <= 0.5 * workshop.radius_step + 1e-12);
            assert_eq!(found.joints, if kind < 2 { 1 } else { 2 });
        }
    }
    assert_eq!(hand.joint.range[1], 1.57);
}

/// A radius on its limit goes to the next groove inside.
#[test]
fn grooves_stay_within_the_limits() {
    let (catalogue, workshop) = (SpringCatalogue::built_in().unwrap(), Workshop::default());
    let mut design = SMALL_CENTRE;
    (design[0], design[1]) = (0.012, 0.002);
    let found = chosen(&design, &catalogue, &workshop).unwrap();
    assert!((found[0].built.radius - 0.01195).abs() < 1e-9 && (found[1].built.radius - 0.0023).abs() < 1e-9);
    // A groove of 2.05 mm would leave 0.75 mm around the hole for an axle of 2.5 mm.
    assert!((found[1].pulley.groove_radius - workshop.least_groove()).abs() < 1e-9);
    assert!((found[0].pulley.groove_radius - 0.01175).abs() < 1e-9);
    let coarse = Workshop { radius_step: 0.001, ..workshop };
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
    let error = chosen(&PAPER_HWASP, &catalogue, &Workshop::default()).unwrap_err();
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

/// A supplier's list with prices and stocks was refused, and so was told nothing of but its first further column.
#[test]
fn further_columns_are_ignored_and_told() {
    let rows = "a,0.4,5.3,8.25,90,10,1.20,300\n";
    let read = |more: &str| SpringCatalogue::parse("mine.csv", format!("{HEADER},{more}\n{rows}").as_bytes());
    let catalogue = read("price_eur,stock").unwrap();
    assert_eq!(
        (catalogue.springs.len(), &catalogue.ignored[..]),
        (1, &["price_eur".to_owned(), "stock".to_owned()][..])
    );
    assert_eq!(catalogue.remark().unwrap(), "columns of mine.csv that are not needed: `price_eur`, `stock`");
    assert_eq!(SpringCatalogue::built_in().unwrap().remark(), None);
    // A slip in a column that may be missing would change the springs without a word.
    let error = read("stock,modulus_gp").unwrap_err().to_string();
    assert!(
        error.contains("column `modulus_gp` is none of") && error.contains("did you mean `modulus_gpa`?"),
        "{error}"
    );
    // What is there already is no slip.
    assert_eq!(read("turn,parts").unwrap().ignored, ["turn", "parts"]);
}

/// A part called `T1 | <script>` broke the tables of parts.md, and a catalogue's name with a line break its text.
#[test]
fn names_of_parts_stay_in_their_cells() {
    let saved = concat!(env!("CARGO_MANIFEST_DIR"), "/../../results/z-grasp/build/parts.json");
    let mut list: PartsList = serde_json::from_str(&std::fs::read_to_string(saved).unwrap()).unwrap();
    list.catalogue.name = "mine\n# <b>\u{202e}.csv".into();
    for joint in &mut list.joints {
        joint.spring.part = "T1 | <script>\u{1b}[2J".into();
    }
    let sheet = build_sheet(&list);
    assert_eq!(sheet.matches("T1 \\| &lt;script>\u{fffd}[2J |").count(), 1 + list.joints.len(), "{sheet}");
    assert!(sheet.contains("of the catalogue mine\u{fffd}# &lt;b>\u{fffd}.csv ("), "{sheet}");
    let cells = |row: &str| row.replace("\\|", "").matches('|').count();
    for table in sheet.split("\n\n").filter(|block| block.starts_with('|')) {
        assert!(table.lines().all(|row| cells(row) == cells(table.lines().next().unwrap())), "{table}");
    }
}

/// Bench and print files had a description each, and docs/parts.md a third one. This table is the one description.
#[test]
fn the_table_of_the_workshop_is_its_description() {
    let docs = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/parts.md")).unwrap();
    let rows: Vec<String> = (described(&mut Workshop::default()).into_iter())
        .zip(written(&mut Workshop::default()).0)
        .map(|(field, (key, default))| {
            let (unit, to_si, dimension) = match field.kind {
                Kind::Quantity(Dimension::Length, _) => (" mm", 1e-3, Dimension::Length),
                Kind::Quantity(Dimension::Density, _) => (" kg/m^3", 1.0, Dimension::Density),
                Kind::Quantity(Dimension::Torque, _) => (" N·mm", 1e-3, Dimension::Torque),
                Kind::Quantity(dimension, _) => (" deg", 1f64.to_radians(), dimension),
                _ => ("", 1.0, Dimension::None),
            };
            let shown = |si: f64| (si / to_si * 1e9).round() / 1e9;
            let default = match default {
                Item::Text(text) => shown(parse_quantity(&text, dimension).unwrap()).to_string(),
                number => number.to_string(),
            };
            let limits = match field.kind {
                Kind::Quantity(_, [lo, hi]) => format!("{} to {}{unit}", shown(lo), shown(hi)),
                _ => field.limits,
            };
            format!("| `{key}` | {default}{unit} | {} | {limits} |", field.meaning)
        })
        .collect();
    assert!(docs.contains(&format!("|---|---|---|---|\n{}\n\n", rows.join("\n"))), "{}", rows.join("\n"));
}
