//! The package of a hand: bill, assembly, drawings, STEP files, and the verdict.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use std::collections::BTreeSet;
use std::path::Path;

use hwasp_fabrication::{
    FittedSpring, MASS_SHARE, Origin, SeatedSpring, Workshop, bill, link_bodies, package, parts, step_files, steps,
    unmatched, verdict,
};
use hwasp_tasks::hand::{DESIGN_LEN, HandDescription, PAPER_HWASP, SEARCHED, SMALL_CENTRE};
use roxmltree::Document;

fn springs(stress_share: f64) -> [FittedSpring; 4] {
    [(0.38e-3, 5.26e-3, 2.60e-3), (0.36e-3, 6.72e-3, 2.45e-3), (0.45e-3, 6.90e-3, 3.17e-3), (0.38e-3, 6.76e-3, 3.07e-3)]
        .map(|(wire, outer, length)| FittedSpring {
            part: format!("T{wire}"),
            seated: SeatedSpring { wire, outer, length },
            stress_share,
        })
}

fn judged(design: &[f64; DESIGN_LEN], share: f64, workshop: &Workshop) -> hwasp_fabrication::Verdict {
    verdict(&HandDescription::default(), design, &springs(share), workshop)
}

/// Why it is not: what is not good.
fn faults(verdict: &hwasp_fabrication::Verdict) -> Vec<&str> {
    verdict.findings.iter().filter(|finding| !finding.good).map(|finding| finding.what.as_str()).collect()
}

#[test]
fn the_papers_hand_can_be_built_and_a_drooping_one_cannot() {
    let workshop = Workshop::default();
    let good = judged(&PAPER_HWASP, 0.74, &workshop);
    assert!(good.buildable, "{good}");
    assert!(good.to_string().starts_with("buildable\n  ok  droop: "), "{good}");
    assert!(good.droop.iter().all(|joint| joint.margin() > workshop.droop_margin));

    let mut weak = PAPER_HWASP;
    weak[8] = 0.5;
    let droops = judged(&weak, 0.74, &workshop);
    assert!(!droops.buildable);
    assert_eq!(faults(&droops), ["droop"]);
    assert!(droops.to_string().contains("thumb_proximal falls shut at 0.00, 0.00 rad"), "{droops}");

    let stressed = judged(&PAPER_HWASP, 0.83, &workshop);
    assert_eq!(faults(&stressed), ["springs"]);
    assert!(stressed.to_string().contains("83 %"), "{stressed}");
    assert_eq!(faults(&judged(&PAPER_HWASP, 0.7, &Workshop { wall: 0.6e-3, ..Workshop::default() })), ["walls"]);
    // Brass, full from side to side.
    let heavy = Workshop { density: 8500.0, shell: 5e-3, ..Workshop::default() };
    assert!(faults(&judged(&PAPER_HWASP, 0.7, &heavy)).contains(&"masses"));
    let mut small = PAPER_HWASP;
    small[3] = 0.002;
    let none = judged(&small, 0.7, &workshop);
    assert_eq!(faults(&none), ["parts"]);
    assert!(none.to_string().contains("finger_distal_radius = 0.002 m is outside of"), "{none}");
}

/// Printed links with all that moves with them weigh what is simulated, at an infill that slicers have.
#[test]
fn links_weigh_what_is_simulated() {
    let (hand, workshop) = (HandDescription::default(), Workshop::default());
    let seated = springs(0.7).map(|spring| spring.seated);
    for design in [PAPER_HWASP, SEARCHED, SMALL_CENTRE] {
        let made = parts(&hand, &design, &seated, &workshop).unwrap();
        for body in link_bodies(&hand, &made, &seated, &workshop) {
            assert!(body.off().abs() < MASS_SHARE, "{body:?}");
            assert!((0.05..0.5).contains(&body.infill), "{body:?}");
            // Printed full it weighs by its mesh, and the more the fuller.
            let part = made.iter().find(|part| part.name.contains("link") && part.mesh.volume() > 0.0).unwrap();
            let filling = part.filling(workshop.density, workshop.shell);
            assert_eq!(filling.filled(1.0).mass, workshop.density * part.mesh.volume());
            assert!(filling.filled(0.2).mass < filling.filled(0.6).mass);
        }
    }
}

#[test]
fn the_assembly_names_every_row_of_the_bill_once() {
    let (hand, workshop) = (HandDescription::default(), Workshop::default());
    let bill = bill(&hand, &PAPER_HWASP, &springs(0.7), &workshop).unwrap();
    let mut steps = steps(&workshop, &[1, 2, 3, 4]);
    assert_eq!(unmatched(&steps, &bill), Vec::<String>::new());
    let names: BTreeSet<&str> = bill.items.iter().map(|item| item.name.as_str()).collect();
    assert_eq!(names.len(), bill.items.len());
    for part in parts(&hand, &PAPER_HWASP, &springs(0.7).map(|spring| spring.seated), &workshop).unwrap() {
        assert_eq!(bill.find(part.name).unwrap().count, part.count);
    }
    // What is missing, doubled or unknown is told.
    let taken = steps[1].takes.pop().unwrap();
    steps[2].takes.push("motor".to_owned());
    steps[3].takes.push("magnet".to_owned());
    let told = unmatched(&steps, &bill);
    assert_eq!(told.len(), 3, "{told:?}");
    assert!(told.contains(&format!("{taken} is in 0 steps")) && told.contains(&"motor is in 2 steps".to_owned()));
}

/// A table that spreadsheets read: as many fields in every row, masses and times of what is printed.
#[test]
fn the_bill_is_a_table() {
    let bill = bill(&HandDescription::default(), &PAPER_HWASP, &springs(0.7), &Workshop::default()).unwrap();
    let text = bill.csv();
    assert_eq!(text.lines().count(), bill.items.len() + 1);
    for (line, item) in text.lines().skip(1).zip(&bill.items) {
        let commas = line.split('"').step_by(2).map(|outside| outside.matches(',').count()).sum::<usize>();
        assert_eq!(commas, 7, "{line}");
        let printed = item.origin() == Origin::Printed;
        assert_eq!(line.contains(",printed,"), printed, "{line}");
        assert!(!printed || (item.mass.unwrap() > 1e-4 && item.printing.unwrap().time > 20.0), "{line}");
    }
    let mass: f64 = bill.items.iter().filter_map(|item| Some(item.mass? * item.count as f64)).sum();
    assert!((0.25..0.6).contains(&mass), "{mass} kg");
}

#[test]
fn drawings_are_svg_with_the_parts_sizes() {
    let (hand, workshop) = (HandDescription::default(), Workshop::default());
    let files = package(&hand, &PAPER_HWASP, &springs(0.7), &workshop, &[0, 1, 2, 3]).unwrap();
    let text = |name: &str| {
        let file = files.iter().find(|file| file.name == name).unwrap_or_else(|| panic!("{name} is missing"));
        String::from_utf8(file.contents.clone()).unwrap()
    };
    let is_drawing = |name: &str| Path::new(name).extension().is_some_and(|extension| extension == "svg");
    for file in files.iter().filter(|file| is_drawing(&file.name)) {
        let text = std::str::from_utf8(&file.contents).unwrap();
        let document = Document::parse(text).unwrap();
        assert!(document.descendants().filter(|node| node.has_tag_name("text")).count() > 1, "{}", file.name);
        assert!(!text.contains("NaN") && !text.contains("\"inf"), "{}", file.name);
        assert!(text.len() < 4_000_000, "{}: {} bytes", file.name, text.len());
    }
    let link = text("finger_distal_link.svg");
    for wanted in ["x 23.6", "y 24.0", "z 64.0", "⌀ 2.60   0.00, 0.00"] {
        assert!(link.contains(wanted), "{wanted}");
    }
    let plate = text("flange_plate.svg");
    // Four M6 and a pin on a circle of 50 mm.
    for wanted in ["⌀ 6.60   17.68, 17.68", "⌀ 6.60   -17.68, 17.68", "⌀ 6.05   0.00, 25.00"] {
        assert!(plate.contains(wanted), "{wanted}");
    }
    let sheet = text("assembly.md");
    for number in 1..=10 {
        let name = format!("step_{number:02}.svg");
        assert!(sheet.contains(&format!("]({name})")) && files.iter().any(|file| file.name == name));
    }
    assert!(text("verdict.txt").starts_with("buildable"));
}

/// Every name that a STEP file speaks of is defined, once, and every edge is that of two faces.
#[test]
fn step_files_are_closed_solids() {
    let files = step_files(&HandDescription::default(), &PAPER_HWASP, &springs(0.7), &Workshop::default()).unwrap();
    assert_eq!(files.len(), 16);
    for file in files {
        let text = String::from_utf8(file.contents).unwrap();
        let data = text.split_once("DATA;\n").unwrap().1.split_once("ENDSEC;").unwrap().0;
        let number = |text: &str| text.split(|c: char| !c.is_ascii_digit()).next().unwrap().parse::<usize>().unwrap();
        let (mut edges, mut used) = (0, 0);
        for (index, line) in data.lines().enumerate() {
            assert_eq!(number(&line[1..]), index + 1, "{}", file.name);
            let refers = line.split('#').skip(2);
            assert!(refers.map(number).all(|refers| refers <= index + 1), "{}: {line}", file.name);
            edges += usize::from(line.contains("=EDGE_CURVE("));
            used += usize::from(line.contains("=ORIENTED_EDGE("));
        }
        assert_eq!(used, 2 * edges, "{}", file.name);
        assert_eq!(data.matches("MANIFOLD_SOLID_BREP").count(), 1);
    }
}
