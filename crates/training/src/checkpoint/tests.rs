//! Files that come back with all bits, and files of which nothing is believed.

use std::sync::Arc;

use super::*;
use crate::files::Disk;
use crate::run_folder::RunError;

fn checkpoint(iteration: u64, worth: Option<f64>) -> Checkpoint {
    let archive = [
        ("learner.params", Array::F32(vec![1.5, -0.0, f32::MIN_POSITIVE])),
        ("loop.recent", Array::F64(vec![])),
        ("loop.steps", Array::U64(vec![u64::MAX])),
    ];
    Checkpoint {
        iteration,
        env_steps: 1000 * iteration,
        training_return: worth,
        archive: archive.map(|(name, array)| (name.to_owned(), array)).into(),
    }
}

#[test]
fn a_file_gives_back_every_bit() {
    let written = checkpoint(7, Some(-3.25));
    let bytes = written.encode("abc", Some("what went wrong")).unwrap();
    let read = Checkpoint::decode(&bytes, "abc").unwrap();
    assert_eq!(read, written);
    let Some(Array::F32(params)) = read.archive.get("learner.params") else { panic!("{read:?}") };
    assert!(params[1].is_sign_negative());
    let header = Header::read(&bytes).unwrap();
    assert_eq!((header.iteration, header.fault.as_deref()), (7, Some("what went wrong")));
    // The same state gives the same file.
    assert_eq!(written.encode("abc", Some("what went wrong")).unwrap(), bytes);
}

#[test]
fn every_changed_byte_and_every_missing_end_is_noticed() {
    let bytes = checkpoint(7, None).encode("abc", None).unwrap();
    for at in 0..bytes.len() {
        let mut changed = bytes.clone();
        changed[at] ^= 1 << (at % 8);
        // JSON may be written in several ways that mean the same; what it means has to be the same then.
        if let Ok(read) = Checkpoint::decode(&changed, "abc") {
            assert_eq!(read, checkpoint(7, None), "byte {at}");
        }
        assert!(Checkpoint::decode(&bytes[..at], "abc").is_err(), "cut at {at}");
    }
}

#[test]
fn what_is_no_checkpoint_of_this_experiment_is_refused_by_name() {
    let told = |bytes: &[u8], experiment| Checkpoint::decode(bytes, experiment).unwrap_err().to_string();
    let bytes = checkpoint(7, None).encode("abc", None).unwrap();
    assert!(told(&bytes, "other").starts_with("it belongs to another experiment"));
    assert!(told(b"", "abc").contains("damaged"));
    let header = |change: fn(&mut Header), tensor: Dtype| {
        let mut header = Header { version: FORMAT_VERSION, hwasp_version: "9.9.9".into(), ..Header::default() };
        change(&mut header);
        let data = [0; 8];
        let view = TensorView::new(tensor, vec![8 / tensor.bitsize().div_ceil(8)], &data).unwrap();
        header.checksum = checksum(&header, [("a", tensor, &data[..])].into_iter());
        let text = serde_json::to_string(&header).unwrap();
        serialize([("a", view)], Some(HashMap::from([(KEY.to_owned(), text)]))).unwrap()
    };
    assert_eq!(told(&header(|_| {}, Dtype::I32), ""), "its array `a` is I32 [2], which is no array of a checkpoint");
    let newer = told(&header(|h| h.version = 2, Dtype::F32), "");
    assert!(newer.contains("version 2 (written by hwasp 9.9.9)"), "{newer}");
    assert!(told(&header(|h| h.version = 0, Dtype::F32), "").contains("version 0"));
    let plain = serialize([("a", TensorView::new(Dtype::F32, vec![0], &[]).unwrap())], None).unwrap();
    assert!(told(&plain, "").contains("hwasp_checkpoint"));
    let text = HashMap::from([(KEY.to_owned(), "{}".to_owned())]);
    let empty = serialize([("a", TensorView::new(Dtype::F32, vec![0], &[]).unwrap())], Some(text)).unwrap();
    assert!(told(&empty, "").starts_with("its header cannot be read: missing field"));
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
    assert_eq!(Checkpoint::decode(&best, "abc").unwrap().iteration, 2);
    // Another process knows what the best was worth.
    let mut again = CheckpointStore::new(&run, Arc::new(Disk), "abc".into());
    again.write(&checkpoint(101, Some(3.5))).unwrap();
    let best = std::fs::read(run.join("checkpoints/best.safetensors")).unwrap();
    assert_eq!(Checkpoint::decode(&best, "abc").unwrap().iteration, 2);

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
