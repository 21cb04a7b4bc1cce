//! The picture that belongs to a run.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use hwasp_core::Serial;
use hwasp_plot::curves_svg;
use hwasp_runs::{Keeping, Provenance, RunFolder};
use hwasp_training::{Assembly, train};

#[test]
fn a_finished_run_has_its_curves() {
    let settings = [("train.env_steps", "8000"), ("train.evaluation_episodes", "3")];
    let layers = settings.iter().fold(hwasp_testing::layers("bar-length"), |layers, (k, v)| layers.with_override(k, v));
    let assembly = Assembly::new(&hwasp_testing::resolve(layers, Some("hwasp")).unwrap()).unwrap();
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("run-with-curves");
    let _ = fs::remove_dir_all(&path);
    let provenance = Provenance::new(vec!["test".into()], 1, 0);
    let mut folder = RunFolder::create(&path, assembly.experiment(), &provenance, Keeping::default()).unwrap();
    let trained = train(&assembly, &Serial, &mut folder, &AtomicBool::new(false)).unwrap();
    folder.finish(&assembly, &trained, &curves_svg).unwrap();
    let svg = fs::read_to_string(path.join("curves.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("total length") && svg.trim_end().ends_with("</svg>"));
}
