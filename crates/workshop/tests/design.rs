//! What is said of a design without simulating it.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use std::path::Path;

use hwasp_tasks::hand::{HandDescription, PAPER_HWASP, SMALL_CENTRE};
use hwasp_workshop::design::{DesignReport, HandReport};
use resvg::usvg::roxmltree;

/// The joints' weights are those computed by hand (7.8 and 1.7 N·mm at a finger); the spring has 6.1 N·mm/rad · 1.9 rad.
#[test]
fn the_papers_hand() {
    let report = HandReport::new(&HandDescription::default(), &PAPER_HWASP).unwrap();
    let finger = &report.joints[2];
    assert_eq!(
        (finger.joint, finger.design, finger.paper_hwasp),
        ("finger_proximal", [0.003, 0.0061, 1.9], finger.design)
    );
    assert!((finger.weight - 7.8e-3).abs() < 1e-4 && (finger.margin - (11.59e-3 - 7.8e-3)).abs() < 1e-4, "{finger:?}");
    assert!(report.stays_open.thumb && report.stays_open.finger);
    assert!((report.pulley_ratio.finger - 3.0 / 2.6).abs() < 1e-12);
    let band = report.pinches[0].band.unwrap();
    assert!((band.lo - 2.43).abs() < 0.006 && (report.pinches[0].width - 0.04).abs() < 1e-12);
    // At 4 mm of travel, as computed apart from this code.
    let point = report.closing[4];
    assert!((point.travel - 0.004).abs() < 1e-12 && (point.thumb.tension - 1.38).abs() < 0.006, "{point:?}");
    assert!(report.spends_its_tension && (report.closing.last().unwrap().total_tension - 75.0).abs() < 1e-9);
}

#[test]
fn a_hand_that_droops_is_told() {
    let mut weak = SMALL_CENTRE;
    weak[8] = 0.5; // 3 N·mm at the thumb's proximal joint
    let report = HandReport::new(&HandDescription::default(), &weak).unwrap();
    assert!(!report.stays_open.thumb && report.stays_open.finger && report.joints[0].margin < 0.0);
}

#[test]
fn trained_hands_are_read_without_the_engine() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../results/z-grasp");
    let report = DesignReport::open(&folder, hwasp_testing::catalogue()).unwrap();
    assert_eq!((report.groups.len(), report.groups[11].name.as_str()), (12, "finger_distal_preload"));
    assert!(report.groups.iter().all(|group| (0.0..=1.0).contains(&group.position[0])));
    let svg = report.hand.unwrap().closing_plot("").svg;
    let document = roxmltree::Document::parse(&svg).unwrap();
    let lines = document.descendants().filter(|node| node.tag_name().name() == "polyline");
    // Two joints of thumb and finger; the tensions of both and of all.
    assert_eq!(lines.count(), 7);
    for text in ["joint angle (deg)", "tension (N)", "the motor's limit", "75"] {
        assert!(document.descendants().any(|node| node.text() == Some(text)), "no `{text}`:\n{svg}");
    }
}
