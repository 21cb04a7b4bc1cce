//! The trained hands under `results/` open with this program and grasp.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use std::path::Path;

use hwasp_core::Threads;
use hwasp_runs::SavedRun;
use hwasp_training::{evaluate, evaluate_native};

#[test]
fn trained_hands_grasp() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../results");
    let mut seen = 0;
    for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap).filter(|entry| entry.path().is_dir()) {
        let saved = SavedRun::open(&entry.path(), hwasp_testing::catalogue()).unwrap();
        let params = saved.params().unwrap();
        let summary = saved.summary().unwrap();
        let executor = Threads::new(2).unwrap();
        for native in [false, true] {
            let evaluate = if native { evaluate_native } else { evaluate };
            let success = evaluate(saved.assembly(), &params, (24, 3), &executor).unwrap().success;
            let (rate, promised) = (success[0].rate(), summary.evaluation.success[0].rate());
            let least = if entry.file_name() == "z-grasp" { 0.95 } else { 0.6 };
            // 24 episodes have a standard error of up to a tenth.
            assert!(promised > least && rate > promised - 0.25, "{}: {rate} of {promised}", entry.path().display());
        }
        seen += 1;
    }
    assert!(seen >= 1, "results/ has no trained hand");
}
