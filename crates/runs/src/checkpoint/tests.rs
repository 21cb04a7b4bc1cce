//! Files that come back with all bits, and files of which nothing is believed.

use super::*;

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
    let bytes = encode(&written, "abc", Some("what went wrong")).unwrap();
    let read = decode(&bytes, "abc").unwrap();
    assert_eq!(read, written);
    let Some(Array::F32(params)) = read.archive.get("learner.params") else { panic!("{read:?}") };
    assert!(params[1].is_sign_negative());
    let header = Header::read(&bytes).unwrap();
    assert_eq!((header.iteration, header.fault.as_deref()), (7, Some("what went wrong")));
    // The same state gives the same file.
    assert_eq!(encode(&written, "abc", Some("what went wrong")).unwrap(), bytes);
}

#[test]
fn every_changed_byte_and_every_missing_end_is_noticed() {
    let bytes = encode(&checkpoint(7, None), "abc", None).unwrap();
    for at in 0..bytes.len() {
        let mut changed = bytes.clone();
        changed[at] ^= 1 << (at % 8);
        // JSON may be written in several ways that mean the same; what it means has to be the same then.
        if let Ok(read) = decode(&changed, "abc") {
            assert_eq!(read, checkpoint(7, None), "byte {at}");
        }
        assert!(decode(&bytes[..at], "abc").is_err(), "cut at {at}");
    }
}

#[test]
fn what_is_no_checkpoint_of_this_experiment_is_refused_by_name() {
    let told = |bytes: &[u8], experiment| decode(bytes, experiment).unwrap_err().to_string();
    let bytes = encode(&checkpoint(7, None), "abc", None).unwrap();
    assert!(told(&bytes, "other").starts_with("it belongs to another experiment"));
    assert!(told(b"", "abc").contains("damaged"));
    let header = |change: fn(&mut Header), tensor: Dtype| {
        let mut header = Header { version: FORMAT_VERSION, hwasp_version: "9.9.9".into(), ..Header::default() };
        change(&mut header);
        let data = [0; 8];
        let view = TensorView::new(tensor, vec![8 / tensor.bitsize().div_ceil(8)], &data).unwrap();
        header.checksum = checksum(&header, [("a", tensor, &data[..])].into_iter()).unwrap();
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
