//! Which checkpoints are kept, and which one is found.

use hwasp_algos::Array;

use super::*;
use crate::files::Disk;

fn checkpoint(iteration: u64, worth: Option<f64>) -> Checkpoint {
    let archive = [("learner.params".to_owned(), Array::F32(vec![1.5]))].into();
    Checkpoint { iteration, env_steps: 1000 * iteration, training_return: worth, archive }
}

#[test]
fn the_last_three_and_the_best_are_kept() {
    let run = std::env::temp_dir().join(format!("hwasp-store-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&run);
    let mut store = CheckpointStore::new(&run, Arc::new(Disk), "abc".into());
    assert!(store.newest().unwrap().checkpoint.is_none());
    for (iteration, worth) in [(1, -5.0), (2, 4.0), (10, 3.0), (11, 2.0), (100, 1.0)] {
        store.write(&checkpoint(iteration, Some(worth))).unwrap();
    }
    let names = |run: &std::path::Path| {
        let entries = std::fs::read_dir(run.join("checkpoints")).unwrap();
        let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    };
    let three = ["iteration-00000010.safetensors", "iteration-00000011.safetensors", "iteration-00000100.safetensors"];
    assert_eq!(names(&run), [&["best.safetensors"][..], &three].concat());
    let best = std::fs::read(run.join("checkpoints/best.safetensors")).unwrap();
    assert_eq!(decode(&best, "abc").unwrap().iteration, 2);
    // Another process knows what the best was worth.
    let mut again = CheckpointStore::new(&run, Arc::new(Disk), "abc".into());
    again.write(&checkpoint(101, Some(3.5))).unwrap();
    let best = std::fs::read(run.join("checkpoints/best.safetensors")).unwrap();
    assert_eq!(decode(&best, "abc").unwrap().iteration, 2);

    // A damaged one is passed over and set aside; one of another experiment is not.
    std::fs::write(run.join("checkpoints/iteration-00000101.safetensors"), "nothing").unwrap();
    let found = again.newest().unwrap();
    assert_eq!((found.checkpoint.as_ref().unwrap().iteration, found.damaged.len()), (100, 1));
    again.set_aside(&found).unwrap();
    assert!(names(&run).contains(&"iteration-00000101.damaged".to_owned()));
    assert!(again.newest().unwrap().damaged.is_empty());
    let other = CheckpointStore::new(&run, Arc::new(Disk), "other".into());
    assert!(matches!(other.newest(), Err(RunError::Checkpoint { .. })));
    for name in three {
        let _ = std::fs::write(run.join("checkpoints").join(name), "nothing");
    }
    // The best one is as good as any.
    let found = again.newest().unwrap();
    assert_eq!((found.checkpoint.unwrap().iteration, found.damaged.len()), (2, 3));
    std::fs::write(run.join("checkpoints/best.safetensors"), "nothing").unwrap();
    assert!(again.newest().is_err(), "all are damaged");
    again.remove_all().unwrap();
    assert_eq!(names(&run), ["iteration-00000101.damaged"]);
    std::fs::remove_dir_all(&run).unwrap();
}
