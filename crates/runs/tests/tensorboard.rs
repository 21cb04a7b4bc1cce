//! Event files as a reader sees them: frames, fields, and the numbers of a training.

#![allow(clippy::unwrap_used)] // helpers of tests are tests too

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use hwasp_core::Serial;
use hwasp_runs::TensorBoard;
use hwasp_training::{Assembly, Event, MetricsRow, Observer, ObserverError, train};

fn empty(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("tensorboard").join(name);
    let _ = fs::remove_dir_all(&path);
    path
}

fn take<'a>(bytes: &mut &'a [u8], count: usize) -> &'a [u8] {
    let (taken, rest) = bytes.split_at(count);
    *bytes = rest;
    taken
}

fn masked(bytes: &[u8]) -> [u8; 4] {
    let crc = crc32c::crc32c(bytes);
    (crc.rotate_left(17).wrapping_add(0xa282_ead8)).to_le_bytes()
}

/// The data of every record, checksums looked at.
fn records(mut bytes: &[u8]) -> Vec<&[u8]> {
    let mut records = Vec::new();
    while !bytes.is_empty() {
        let length = take(&mut bytes, 8);
        assert_eq!(take(&mut bytes, 4), masked(length));
        let data = take(&mut bytes, u64::from_le_bytes(length.try_into().unwrap()) as usize);
        assert_eq!(take(&mut bytes, 4), masked(data));
        records.push(data);
    }
    records
}

fn varint(bytes: &mut &[u8]) -> u64 {
    (0..)
        .step_by(7)
        .scan(true, |more, shift| {
            let byte = more.then(|| take(bytes, 1)[0])?;
            *more = byte >= 0x80;
            Some(u64::from(byte & 0x7f) << shift)
        })
        .sum()
}

/// The fields of a message: number, and the bytes or the integer as eight bytes.
fn fields(mut bytes: &[u8]) -> Vec<(u64, Vec<u8>)> {
    let mut fields = Vec::new();
    while !bytes.is_empty() {
        let key = varint(&mut bytes);
        let value = match key & 7 {
            0 => varint(&mut bytes).to_le_bytes().to_vec(),
            1 => take(&mut bytes, 8).to_vec(),
            2 => {
                let length = varint(&mut bytes) as usize;
                take(&mut bytes, length).to_vec()
            }
            5 => take(&mut bytes, 4).to_vec(),
            other => panic!("wire type {other}"),
        };
        fields.push((key >> 3, value));
    }
    fields
}

/// The scalars of an event with its step.
fn scalars(event: &[u8]) -> (u64, Vec<(String, f32)>) {
    let event = fields(event);
    assert_eq!(event.iter().map(|field| field.0).collect::<Vec<_>>(), [1, 2, 5]);
    let time = f64::from_le_bytes(event[0].1[..].try_into().unwrap());
    assert!(time > 1.7e9, "{time}");
    let step = u64::from_le_bytes(event[1].1[..].try_into().unwrap());
    let values = fields(&event[2].1).into_iter().map(|(number, value)| {
        let [(1, tag), (2, number_of_tag)] = &fields(&value)[..] else { panic!("{number}: {value:?}") };
        (String::from_utf8(tag.clone()).unwrap(), f32::from_le_bytes(number_of_tag[..].try_into().unwrap()))
    });
    (step, values.collect())
}

/// Keeps the rows.
#[derive(Default)]
struct Rows(Vec<MetricsRow>);

impl Observer for Rows {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        if let Event::Iteration(row) = event {
            self.0.push(row.clone());
        }
        Ok(())
    }
}

#[test]
fn a_training_can_be_read_back() {
    let layers = hwasp_testing::layers("reach")
        .with_override("train.env_steps", "2400")
        .with_override("train.evaluation_episodes", "5");
    let assembly = Assembly::new(&hwasp_testing::resolve(layers, None).unwrap()).unwrap();
    let (mut board, mut rows) = (TensorBoard::create(&empty("training").join("deep")).unwrap(), Rows::default());
    let mut observers: Vec<&mut dyn Observer> = vec![&mut board, &mut rows];
    let trained = train(&assembly, &Serial, &mut observers, &AtomicBool::new(false)).unwrap();

    let name = board.path().file_name().unwrap().to_str().unwrap();
    let seconds = name.strip_prefix("events.out.tfevents.").unwrap().strip_suffix(".hwasp").unwrap();
    assert!(seconds.parse::<f64>().unwrap() > 1.7e9, "{name}");
    let file = fs::read(board.path()).unwrap();
    let records = records(&file);
    let first = fields(records[0]);
    assert_eq!((first.len(), &first[1]), (2, &(3, b"brain.Event:2".to_vec())));

    let mut expected: Vec<(u64, Vec<(&str, f64)>)> = Vec::new();
    for row in &rows.0 {
        let train = [
            ("train/return", row.undiscounted_return),
            ("train/discounted_return", row.discounted_return),
            ("train/episodes", row.episodes),
            ("train/episode_steps", row.episode_steps),
            ("noise/command", row.noise.command),
            ("noise/effort", row.noise.effort),
            ("train/kl", row.learner[0]),
            ("train/entropy", row.learner[1]),
            ("train/clip_fraction", row.learner[2]),
            ("train/grad_norm", row.learner[3]),
            ("train/epochs", row.learner[4]),
            ("train/value_loss", row.learner[5]),
            ("train/explained_variance", row.learner[6]),
            ("design/gear", row.design_totals[0]),
        ];
        expected.push((row.env_steps, train.to_vec()));
    }
    let evaluation = &trained.evaluation;
    let end = [
        ("evaluation/return", evaluation.undiscounted_return.mean),
        ("evaluation/discounted_return", evaluation.discounted_return.mean),
        ("evaluation/median_discounted_return", evaluation.median_discounted_return),
        ("evaluation/worst_discounted_return", evaluation.worst_discounted_return),
    ];
    expected.push((2400, end.to_vec()));
    let expected: Vec<(u64, Vec<(String, f32)>)> = expected
        .into_iter()
        .map(|(step, values)| (step, values.into_iter().map(|(tag, v)| (tag.to_owned(), v as f32)).collect()))
        .collect();
    assert_eq!(records[1..].iter().map(|event| scalars(event)).collect::<Vec<_>>(), expected);
    assert_eq!(expected.len(), 3);
}

/// What is not known is left out, and an event of nothing is not written.
#[test]
fn what_is_not_finite_is_left_out() {
    let mut board = TensorBoard::create(&empty("unknown")).unwrap();
    let totals = ["gear".to_owned()];
    let (learner, terms) = (&["kl", "entropy"], &["alive".to_owned()]);
    board.on(Event::Started { env_steps: 10, resumed: None, learner, terms, totals: &totals }).unwrap();
    let mut row = MetricsRow {
        iteration: 0,
        env_steps: 5,
        wall_s: 1.0,
        undiscounted_return: -1.5,
        learner: vec![f64::INFINITY, 0.5],
        terms: vec![7.0],
        design_totals: vec![f64::NEG_INFINITY],
        ..MetricsRow::default()
    };
    board.on(Event::Iteration(&row)).unwrap();
    (row.undiscounted_return, row.learner[1], row.terms[0]) = (f64::NAN, 1e300, f64::NAN);
    board.on(Event::Iteration(&row)).unwrap();
    let file = fs::read(board.path()).unwrap();
    let records = records(&file);
    assert_eq!(records.len(), 2);
    let known = [("train/return", -1.5), ("train/entropy", 0.5), ("reward/alive", 7.0)];
    assert_eq!(scalars(records[1]), (5, known.map(|(tag, value)| (tag.to_owned(), value)).to_vec()));
}

#[test]
fn a_folder_that_cannot_be_is_an_error() {
    let folder = empty("blocked");
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("file"), "").unwrap();
    let error = TensorBoard::create(&folder.join("file").join("inside")).unwrap_err().to_string();
    assert!(error.starts_with("cannot write ") && error.contains("inside"), "{error}");
}

/// What readers call a restart: from its step on, what older files have is dropped.
#[test]
fn a_resumed_training_says_where_it_goes_on() {
    let folder = empty("resumed");
    let first = TensorBoard::create(&folder).unwrap();
    let mut board = TensorBoard::create(&folder).unwrap();
    assert!(first.path() < board.path(), "files are read in the order of their names");
    board.on(Event::Started { env_steps: 10, resumed: Some(5), learner: &[], terms: &[], totals: &[] }).unwrap();
    let file = fs::read(board.path()).unwrap();
    let records = records(&file);
    assert_eq!(records.len(), 2);
    let start = fields(records[1]);
    assert_eq!(start[1], (2, 6_u64.to_le_bytes().to_vec()));
    assert_eq!((start[2].0, fields(&start[2].1)), (7, vec![(1, 1_u64.to_le_bytes().to_vec())]));
}

/// A training that was killed before its first checkpoint and resumed begins anew: nothing said so in its second file, and every
/// point of the first one was shown twice.
#[test]
fn a_training_that_begins_anew_drops_what_is_there() {
    let layers = hwasp_testing::layers("reach")
        .with_override("train.env_steps", "2400")
        .with_override("train.evaluation_episodes", "5");
    let assembly = Assembly::new(&hwasp_testing::resolve(layers, None).unwrap()).unwrap();
    let folder = empty("anew");
    let mut files = Vec::new();
    for _ in 0..2 {
        let mut board = TensorBoard::create(&folder).unwrap();
        train(&assembly, &Serial, &mut board, &AtomicBool::new(false)).unwrap();
        files.push(fs::read(board.path()).unwrap());
    }
    let [first, second] = [&files[0], &files[1]].map(|file| records(file));
    // The version, and where there is something to drop, where from: step 0. Then both have the same.
    let start = fields(second[1]);
    assert_eq!(start[1], (2, 0_u64.to_le_bytes().to_vec()));
    assert_eq!((start[2].0, fields(&start[2].1)), (7, vec![(1, 1_u64.to_le_bytes().to_vec())]));
    let values = |records: &[&[u8]]| records.iter().map(|event| scalars(event)).collect::<Vec<_>>();
    assert_eq!(values(&second[2..]), values(&first[1..]));
}
