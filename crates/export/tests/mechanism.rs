//! The mechanism of a trained hand as files: what is written is the hand that was evaluated.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use std::fs;
use std::path::{Path, PathBuf};

use hwasp_export::{ExportError, Kind, Source, export};
use hwasp_grasp::{Grasp, settings_of};
use hwasp_problem::World;
use hwasp_testing::{catalogue, empty, small};
use hwasp_training::Assembly;
use hwasp_workshop::design::DesignReport;
use resvg::usvg::roxmltree::{Document, Node};

const MECHANISM: [Kind; 6] = [Kind::Mjcf, Kind::Urdf, Kind::Stl, Kind::Scad, Kind::Step, Kind::Package];

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../results").join(name)
}

/// Exports of a shipped run, into an empty folder.
fn exported(run: &str, kinds: &[Kind], folder: &str) -> PathBuf {
    let folder = empty(env!("CARGO_TARGET_TMPDIR"), folder);
    export(&Source::open(&shipped(run), catalogue()).unwrap(), kinds, None, &folder).unwrap();
    folder
}

fn design(run: &str) -> Vec<f64> {
    DesignReport::open(&shipped(run), catalogue()).unwrap().groups.iter().map(|group| group.group.as_built[0]).collect()
}

fn number(node: Node<'_, '_>, key: &str) -> f64 {
    node.attribute(key).unwrap().parse().unwrap()
}

/// The world of a model that was written, in place of the run's own.
fn world_of(assembly: &Assembly, model: &str) -> World {
    let settings = settings_of(assembly.experiment().task.settings().unwrap());
    let grasp = Grasp::native_from(settings, model).unwrap();
    World::shared(grasp.law(), grasp.shared()).with_horizon(assembly.experiment().task.horizon)
}

/// Loads the file anew and grasps with it: the same episodes come out the same. All 400 of them with `HWASP_EXHAUSTIVE=1`.
#[test]
fn the_written_model_grasps_as_the_run_does() {
    use hwasp_core::Threads;
    use hwasp_runs::SavedRun;
    use hwasp_training::{evaluate_in, evaluate_native};

    let episodes = if std::env::var_os("HWASP_EXHAUSTIVE").is_some() { 400 } else { 32 };
    let saved = SavedRun::open(&shipped("z-grasp"), catalogue()).unwrap();
    let (params, seed) = (saved.params().unwrap(), saved.assembly().experiment().train.evaluation_seed);
    let executor = Threads::new(2).unwrap();
    let native = evaluate_native(saved.assembly(), &params, (episodes, seed), &executor).unwrap();

    let file = exported("z-grasp", &[Kind::Mjcf], "mechanism-mjcf").join("hand.xml");
    let world = world_of(saved.assembly(), &fs::read_to_string(&file).unwrap());
    let written =
        evaluate_in(saved.assembly(), &world, &design("z-grasp"), &params, (episodes, seed), &executor).unwrap();
    assert_eq!(written, native);
    assert!(written.success[0].rate() > 0.9, "{:?}", written.success[0]);

    // It is the file that is simulated: with pulleys of a tenth of the size the hand does not close.
    let weak = fs::read_to_string(&file).unwrap().replace("coef=\"0.0", "coef=\"0.00");
    let world = world_of(saved.assembly(), &weak);
    let weak = evaluate_in(saved.assembly(), &world, &design("z-grasp"), &params, (8, seed), &executor).unwrap();
    assert!(weak.success[0].rate() < 0.5, "{:?}", weak.success[0]);
}

#[test]
fn springs_and_pulleys_of_the_model_are_those_of_the_design() {
    for run in ["z-grasp", "3d-grasp"] {
        let folder = exported(run, &MECHANISM, &format!("mechanism-{run}"));
        let text = fs::read_to_string(folder.join("hand.xml")).unwrap();
        let model = Document::parse(&text).unwrap();
        let design = design(run);
        let joint = |name| model.descendants().find(|n| n.has_tag_name("joint") && n.attribute("name") == Some(name));
        for (name, kind) in [("thumb_proximal", 0), ("thumb_distal", 1), ("finger1_proximal", 2), ("finger2_distal", 3)]
        {
            let spring = joint(name).unwrap();
            assert_eq!(number(spring, "stiffness"), design[4 + kind], "{name}");
            assert_eq!(number(spring, "springref"), -design[8 + kind], "{name}");
            let pulley = model.descendants().find(|n| n.attribute("joint") == Some(name)).unwrap();
            assert_eq!(number(pulley, "coef"), design[kind], "{name}");
        }
        // Every mesh that the links name is there, and an STL file of the length that it says.
        let text = fs::read_to_string(folder.join("hand.urdf")).unwrap();
        let links = Document::parse(&text).unwrap();
        let meshes: Vec<Node<'_, '_>> = links.descendants().filter(|n| n.has_tag_name("mesh")).collect();
        assert_eq!(meshes.len(), 19);
        for mesh in meshes {
            let bytes = fs::read(folder.join(mesh.attribute("filename").unwrap())).unwrap();
            let triangles = u32::from_le_bytes(bytes[80..84].try_into().unwrap()) as usize;
            assert_eq!((bytes.len(), mesh.attribute("scale")), (84 + 50 * triangles, Some("0.001 0.001 0.001")));
        }
    }
}

#[test]
fn a_run_without_a_hand_has_no_mechanism() {
    let folder = empty(env!("CARGO_TARGET_TMPDIR"), "mechanism-reach");
    let spec = small("hwasp", &[]);
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("experiment.toml"), spec.to_toml().unwrap()).unwrap();
    let source = Source::open(&folder, catalogue()).unwrap();
    for kind in MECHANISM {
        assert!(!kind.is_of(source.spec()));
        let error = export(&source, &[kind], None, &folder.join("export")).unwrap_err();
        assert!(matches!(error, ExportError::NoMechanism { ref problem, .. } if problem == "reach"), "{error}");
        assert!(error.to_string().starts_with(&format!("runs of reach are not written as {}: they are", kind.name())));
    }
    assert!(Kind::Onnx.is_of(source.spec()) && !folder.join("export").exists());
    assert!(Kind::ALL.iter().all(|kind| kind.is_of(Source::open(&shipped("z-grasp"), catalogue()).unwrap().spec())));
}
