//! Print files and the parts list describe one hand: numbers are read back from the files and held against the list.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use std::fs;
use std::path::{Path, PathBuf};

use hwasp_export::{Kind, Source, export};
use hwasp_testing::{catalogue, empty};
use hwasp_workshop::parts::{JointParts, PartsList, Workshop};

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../results").join(name)
}

/// Print files of a run in an empty folder, and the list that they were made for.
fn printed(run: &Path, folder: &str) -> (PathBuf, Option<PathBuf>) {
    let folder = empty(env!("CARGO_TARGET_TMPDIR"), folder);
    let source = Source::open(run, catalogue()).unwrap();
    export(&source, &[Kind::Stl, Kind::Scad], None, &folder).unwrap();
    (folder, source.printed_for().unwrap().list.clone())
}

fn list(path: &Path) -> PartsList {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

/// The triangles of an STL file, m.
fn triangles(file: &Path) -> Vec<[[f64; 3]; 3]> {
    let bytes = fs::read(file).unwrap();
    let number = |at: usize| 1e-3 * f64::from(f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()));
    let triangles = (bytes.len() - 84) / 50;
    let corner = |at: usize| [number(at), number(at + 4), number(at + 8)];
    // A normal of three numbers comes first.
    (0..triangles).map(|i| [12, 24, 36].map(|offset| corner(84 + 50 * i + offset))).collect()
}

fn away(corner: &[f64; 3]) -> f64 {
    corner[1].hypot(corner[2])
}

fn near(found: f64, wanted: f64, what: &str) {
    // Files have single precision in mm; straight sides stand for circles.
    assert!((found - wanted).abs() < 7e-6, "{what}: {found} m instead of {wanted} m");
}

/// `export --stl --scad` had a bore of 2.1 mm, a line of 0.6 mm, a groove of 6.51 mm and one spring pocket of 2.4 mm at a joint, and
/// the parts list of the same run an axle of 2.5 mm, a line of 0.4 mm, a groove of 6.6 mm and two springs of up to 3.17 mm.
#[test]
fn what_is_printed_fits_what_is_bought() {
    let run = shipped("z-grasp");
    let (folder, from) = printed(&run, "workshop-z-grasp");
    let path = run.join("build/parts.json");
    assert_eq!(from.as_deref(), Some(&*path));
    let list = list(&path);
    let Workshop { axle, print_clearance, line, .. } = list.workshop;
    for JointParts { joint, pulley, spring, .. } in &list.joints {
        let found_in = |what: &str| triangles(&folder.join(format!("{joint}_{what}.stl")));
        let found = found_in("pulley").concat();
        let bore = found.iter().map(away).fold(f64::INFINITY, f64::min);
        near(2.0 * bore, axle + 0.5 * print_clearance, &format!("bore of {joint}"));
        // Beyond the bore, at the edge of the groove, on the side without holes.
        let at_edge =
            |corner: &&[f64; 3]| (corner[0] - line - print_clearance).abs() < 1e-7 && away(corner) > 1.1 * bore;
        let groove = found.iter().filter(at_edge).map(away).fold(f64::INFINITY, f64::min);
        near(groove, pulley.groove_radius, &format!("groove of {joint}"));

        // A pocket on each side, for coil and legs.
        let radius = list.workshop.leg_circle(&spring.seated()) + 0.5 * spring.wire + print_clearance;
        assert!(2.0 * radius > spring.outer + print_clearance);
        let found = found_in("link");
        // Its side stands along the axle.
        let is_side = |corners: &&[[f64; 3]; 3]| corners.iter().all(|corner| (away(corner) - radius).abs() < 1e-7);
        let is_flat = |corners: &[[f64; 3]; 3]| corners.iter().all(|corner| corner[0] == corners[0][0]);
        for side in [1.0, -1.0] {
            let depths: Vec<f64> = (found.iter())
                .filter(|corners| side * corners[0][0] > 0.0 && is_side(corners) && !is_flat(corners))
                .flat_map(|corners| corners.map(|corner| side * corner[0]))
                .collect();
            let ends = [f64::min, f64::max].map(|end| depths.iter().copied().reduce(end).unwrap());
            near(ends[1] - ends[0], spring.length_wound + print_clearance, &format!("pocket of {joint}"));
        }
    }
    // Holes for the fixed legs of the distal joints, in the cheeks of the proximal links; 24 corners each, in several triangles.
    for (kind, length) in [(0, 0.050), (2, 0.050)] {
        let spring = list.joints[kind + 1].spring.seated();
        let found = triangles(&folder.join(format!("{}_link.stl", list.joints[kind].joint))).concat();
        let outside = found.iter().map(|corner| corner[0]).fold(0.0, f64::max);
        for (hole, side) in (0..24).flat_map(|hole| [(hole, 1.0), (hole, -1.0)]) {
            let (sin, cos) = (f64::from(hole) * 15f64.to_radians()).sin_cos();
            let circle = list.workshop.leg_circle(&spring);
            let at = [circle * sin, length + circle * cos];
            let around = |corner: &&[f64; 3]| {
                let off = (corner[1] - at[0]).hypot(corner[2] - at[1]);
                (corner[0] - side * outside).abs() < 1e-7 && (off - list.workshop.leg_hole(&spring)).abs() < 1e-7
            };
            assert!(found.iter().filter(around).count() >= 24, "hole {hole} of {}", list.joints[kind + 1].joint);
        }
    }

    // The parameters of the OpenSCAD file, in mm and rad.
    let text = fs::read_to_string(folder.join("hand.scad")).unwrap();
    let value = |name: &str| -> Vec<f64> {
        let line = text.lines().find_map(|line| line.strip_prefix(&format!("{name} = "))).unwrap();
        let numbers = line.split_once(';').unwrap().0.trim_matches(['[', ']']).split(", ");
        numbers.map(|number| number.parse().unwrap()).collect()
    };
    let joints = |of: fn(&JointParts) -> f64| list.joints.iter().map(of).collect::<Vec<f64>>();
    for (name, wanted) in [
        ("radius", joints(|joint| 1e3 * joint.built.radius)),
        ("stiffness", joints(|joint| 1e3 * joint.built.stiffness)),
        ("preload", joints(|joint| joint.built.preload)),
        ("spring_wire", joints(|joint| 1e3 * joint.spring.wire)),
        ("spring_outer", joints(|joint| 1e3 * joint.spring.outer)),
        ("spring_length", joints(|joint| 1e3 * joint.spring.length_wound)),
        ("axle", vec![1e3 * axle]),
        ("line", vec![1e3 * line]),
        ("springs", vec![f64::from(list.workshop.springs)]),
        ("hole_pitch", vec![list.workshop.hole_pitch.to_degrees()]),
        ("print_clearance", vec![1e3 * print_clearance]),
        ("wall", vec![1e3 * list.workshop.wall]),
    ] {
        let found = value(name);
        assert_eq!(found.len(), wanted.len(), "{name}");
        for (found, wanted) in found.iter().zip(&wanted) {
            assert!((found - wanted).abs() < 1e-6, "{name} = {found}, and parts.json has {wanted}");
        }
    }
}

/// The export of the further-trained run still had the line and the axle of the print files.
#[test]
fn a_run_trained_further_on_parts_is_printed_for_them() {
    let (folder, _) = printed(&shipped("z-grasp"), "workshop-trained");
    let (tuned, from) = printed(&shipped("z-grasp/build/tuned"), "workshop-tuned");
    assert!(from.unwrap().ends_with("z-grasp/build/parts.json"));
    for name in ["hand.scad", "palm.stl", "thumb_distal_link.stl", "finger_proximal_pulley.stl"] {
        assert_eq!(fs::read(folder.join(name)).unwrap(), fs::read(tuned.join(name)).unwrap(), "{name}");
    }
}

/// Where nobody chose parts, they are those that `hwasp parts` chooses by default.
#[test]
fn a_run_without_a_list_is_printed_for_the_nearest_parts() {
    let trained = copy("z-grasp", "workshop-copy", &["experiment.toml", "design.toml"]);
    let (folder, from) = printed(&trained, "workshop-nearest");
    assert_eq!(from, None);
    // The list of the shipped run may be of a workshop with other figures.
    let list = PartsList { workshop: Workshop::default(), ..list(&shipped("z-grasp/build/parts.json")) };
    let run = copy("z-grasp", "workshop-copy-listed", &["experiment.toml", "design.toml"]);
    fs::create_dir_all(run.join("build")).unwrap();
    fs::write(run.join("build/parts.json"), serde_json::to_vec(&list).unwrap()).unwrap();
    let (listed, from) = printed(&run, "workshop-listed");
    assert!(from.is_some());
    let text = |folder: &Path| fs::read_to_string(folder.join("hand.scad")).unwrap();
    assert_eq!(text(&folder), text(&listed));
}

#[test]
fn a_list_of_another_hand_is_refused() {
    let run = copy("z-grasp", "workshop-other", &["experiment.toml", "design.toml"]);
    let told = |change: fn(&mut PartsList)| {
        let mut list = list(&shipped("z-grasp/build/parts.json"));
        change(&mut list);
        fs::create_dir_all(run.join("build")).unwrap();
        fs::write(run.join("build/parts.json"), serde_json::to_vec(&list).unwrap()).unwrap();
        let source = Source::open(&run, catalogue()).unwrap();
        let error = export(&source, &[Kind::Stl], None, &run.join("export")).unwrap_err();
        error.to_string()
    };
    let error = told(|list| list.seed = 7);
    assert!(error.contains("seed 7") && error.contains("this run is z-grasp · hwasp · seed 2"), "{error}");
    assert!(error.contains("hint: `hwasp parts RUN`"), "{error}");
    let error = told(|list| list.design[3].trained = 0.005);
    assert!(error.contains("a hand whose finger_distal_radius is 0.005 m"), "{error}");
    let error = told(|list| list.joints.swap(0, 1));
    assert!(error.contains("is not about thumb_proximal, thumb_distal"), "{error}");
    let error = told(|list| list.workshop.hole_pitch = 1e-9);
    assert!(error.contains("bench.hole_pitch"), "{error}");
    let error = told(|list| list.joints[0].spring.count = 4);
    assert!(error.contains("has 4 springs at thumb_proximal"), "{error}");
    assert!(!run.join("export").exists());
}

/// Some files of a shipped run, in a folder of their own.
fn copy(run: &str, folder: &str, files: &[&str]) -> PathBuf {
    let folder = empty(env!("CARGO_TARGET_TMPDIR"), folder);
    fs::create_dir_all(&folder).unwrap();
    for name in files {
        fs::copy(shipped(run).join(name), folder.join(name)).unwrap();
    }
    folder
}

/// The package says of each row of the bill which step takes it, and names the springs of the parts list; STEP files are beside the STL.
#[test]
fn the_package_is_that_of_the_list() {
    let run = shipped("z-grasp");
    let folder = empty(env!("CARGO_TARGET_TMPDIR"), "workshop-package");
    let source = Source::open(&run, catalogue()).unwrap();
    let files = export(&source, &[Kind::Package, Kind::Step], None, &folder).unwrap();
    let list = list(&run.join("build/parts.json"));
    let bill = fs::read_to_string(folder.join("package/bill.csv")).unwrap();
    for JointParts { joint, spring, joints, .. } in &list.joints {
        let row = bill.lines().find(|row| row.starts_with(&format!("spring of {joint},"))).unwrap();
        assert!(row.starts_with(&format!("spring of {joint},{},bought,", joints * spring.count)), "{row}");
        assert!(row.contains(&spring.part), "{row}");
    }
    let assembly = fs::read_to_string(folder.join("package/assembly.md")).unwrap();
    for row in bill.lines().skip(1) {
        let name = row.trim_start_matches('"').split([',', '"']).next().unwrap();
        assert!(assembly.contains(name), "{name}");
    }
    assert!(assembly.contains(&format!("no. {} at thumb_distal", list.joints[1].spring.hole)));
    assert!(folder.join("palm.step").is_file() && folder.join("package/palm.svg").is_file());
    // The verdict of the package is that of the run.
    let verdict = source.verdict().unwrap();
    assert_eq!(fs::read_to_string(folder.join("package/verdict.txt")).unwrap(), format!("{verdict}\n"));
    assert_eq!(hwasp_workshop::parts::verdict_of_run(&run, catalogue()).unwrap(), Some(verdict));
    assert!(files.len() > 40);
}
