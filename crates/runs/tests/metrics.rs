//! `metrics.csv`: every number comes back with its bits, and no file, however hostile, does worse than an error.

#![allow(clippy::unwrap_used)]

use hwasp_core::NoiseSizes;
use hwasp_runs::metrics::{Columns, FIXED_COLUMNS, LONGEST_LINE, MetricsError, MetricsTable, MetricsWriter};
use hwasp_training::MetricsRow;

fn row(iteration: u64, values: [f64; 9]) -> MetricsRow {
    MetricsRow {
        iteration,
        env_steps: 4000 * (iteration + 1),
        wall_s: values[0],
        discounted_return: values[1],
        undiscounted_return: values[2],
        episodes: values[1],
        episode_steps: values[2],
        noise: NoiseSizes { command: values[3], effort: values[4], design: values[5] },
        learner: values[3..6].to_vec(),
        terms: values[6..7].to_vec(),
        design_totals: values[7..].to_vec(),
    }
}

/// Of a learner.
const LEARNER: [&str; 3] = ["kl", "entropy", "grad.norm"];

fn names(names: &[&str]) -> Vec<String> {
    names.iter().map(|&name| name.to_owned()).collect()
}

/// A table of these columns.
fn table(learner: &[&str], terms: &[&str], totals: &[&str]) -> Result<MetricsWriter<Vec<u8>>, MetricsError> {
    MetricsWriter::new(Vec::new(), Columns { learner, terms: &names(terms), totals: &names(totals) })
}

fn written(rows: &[MetricsRow]) -> Vec<u8> {
    let mut writer = table(&LEARNER, &["forward"], &["stiffness_total", "length_total"]).unwrap();
    for row in rows {
        writer.append(row).unwrap();
    }
    writer.into_inner()
}

fn header() -> String {
    format!("{},learner.kl,learner.entropy,learner.grad.norm,stiffness_total\n", FIXED_COLUMNS.join(","))
}

fn read(text: impl AsRef<[u8]>) -> Result<MetricsTable, MetricsError> {
    MetricsTable::read(text.as_ref())
}

/// `-NaN` was read with its sign, which is not written.
#[test]
fn there_is_but_one_kind_of_unknown() {
    let table = read(header() + "0,1,-NaN,nan,+NaN,NaN,-nan,nan,NaN,-NaN,nan,nan,0,1\n").unwrap();
    assert!(bits(&table.rows[0])[..10].iter().all(|&b| b == f64::NAN.to_bits()));
}

/// The message for a body under a good header.
fn message(body: &str) -> String {
    read(header() + body).unwrap_err().to_string()
}

fn bits(row: &MetricsRow) -> Vec<u64> {
    row.values().map(f64::to_bits).collect()
}

#[test]
fn numbers_come_back_with_their_bits() {
    let hard = [0.1 + 0.2, -1.0 / 3.0, 1e300, 5e-324, -0.0, f64::MAX, -2e-308, 0.64, 19.6];
    let odd =
        [f64::INFINITY, f64::NEG_INFINITY, f64::MIN_POSITIVE, 1e-7, 123_456_789.0, f64::MIN, 1.5, 0.0, 2f64.powi(60)];
    let rows = [row(0, hard), row(1, odd), row(u64::MAX / 4001 - 2, hard)];
    let table = read(written(&rows)).unwrap();
    assert_eq!(table.learner, LEARNER);
    assert_eq!(table.terms, ["forward"]);
    assert_eq!(table.design_totals, ["stiffness_total", "length_total"]);
    assert_eq!(table.metric("entropy").unwrap().collect::<Vec<_>>(), [-0.0, 123_456_789.0, -0.0]);
    assert_eq!(table.unfinished_line, None);
    assert_eq!(table.rows.len(), 3);
    for (got, expected) in table.rows.iter().zip(&rows) {
        assert_eq!((got.iteration, got.env_steps), (expected.iteration, expected.env_steps));
        assert_eq!(bits(got), bits(expected));
    }
}

#[test]
fn the_text_is_plain_and_short() {
    let text = String::from_utf8(written(&[row(0, [0.5, -1125.53, -10_811.25, f64::NAN, 3.0, 0.8, 12.5, 65.5, 1e-9])]))
        .unwrap();
    assert_eq!(
        text,
        "iteration,env_steps,wall_s,discounted_return,return,episodes,episode_steps,noise.command,noise.effort,noise.design,\
         learner.kl,learner.entropy,learner.grad.norm,reward.forward,stiffness_total,length_total\n\
         0,4000,0.5,-1125.53,-10811.25,-1125.53,-10811.25,NaN,3.0,0.8,NaN,3.0,0.8,12.5,65.5,1e-9\n"
    );
    assert!(read(text).unwrap().rows[0].learner[0].is_nan());
}

#[test]
fn a_table_can_be_continued() {
    let (terms, totals) = (names(&["forward"]), names(&["stiffness_total", "length_total"]));
    let columns = Columns { learner: &LEARNER, terms: &terms, totals: &totals };
    let mut writer = MetricsWriter::resume(written(&[row(0, [0.0; 9])]), columns).unwrap();
    writer.append(&row(1, [1.0; 9])).unwrap();
    assert_eq!(writer.into_inner(), written(&[row(0, [0.0; 9]), row(1, [1.0; 9])]));
}

/// A run that was killed in the middle of a row must not lend the plot a number cut short.
#[test]
fn an_unfinished_line_is_left_out_and_reported() {
    let mut text = written(&[row(0, [1.0; 9]), row(1, [12.5; 9])]);
    text.truncate(text.len() - 2);
    let table = read(text).unwrap();
    assert_eq!((table.rows.len(), table.unfinished_line), (1, Some(3)));
}

#[test]
fn line_ends_and_marks_of_other_programs_are_read() {
    let table = read(format!("\u{feff}{}\r\n0,4000,1,2,3,4,5,6,7,8\r\n", FIXED_COLUMNS.join(","))).unwrap();
    assert_eq!((table.rows.len(), table.rows[0].undiscounted_return), (1, 3.0));
}

#[test]
fn faults_are_named_with_their_line() {
    let good = "0,4000,1,2,3,4,5,6,7,8,9,10,11,12\n";
    assert_eq!(message(&format!("{good}1,8000,1,2\n")), "line 3 has 4 fields, the header has 14");
    assert_eq!(message("0,4000,1,2,3,4,5,6,7,8,9,10,11,12,13\n"), "line 2 has 15 fields, the header has 14");
    assert_eq!(message("\n"), "line 2 has 1 fields, the header has 14");
    assert_eq!(
        message("0,-1,1,2,3,4,5,6,7,8,9,10,11,12\n"),
        "line 2: `-1` in column `env_steps` is not a whole number from 0"
    );
    assert_eq!(
        message("0,4000,1,fast,3,4,5,6,7,8,9,10,11,12\n"),
        "line 2: `fast` in column `discounted_return` is not a number"
    );
    assert_eq!(message("0,4000,1,2,3,4,5,6,7,8,9,10,11,\n"), "line 2: `` in column `stiffness_total` is not a number");
    assert_eq!(
        message(&format!("{good}1,3999,1,2,3,4,5,6,7,8,9,10,11,12\n")),
        "line 3: env_steps falls from 4000 to 3999; a table holds one run, in order"
    );
}

#[test]
fn what_is_no_metrics_table_is_refused() {
    let of = |text: &[u8]| read(text).unwrap_err();
    assert!(of(b"").to_string().starts_with("line 1 is not a header of metrics: column 1 is ``"));
    let other = of(b"iteration,env_steps,discounted_return\n").to_string();
    assert!(other.contains("column 3 is `discounted_return`, expected `wall_s`"), "{other}");
    assert!(matches!(of(&[0xff, 0xfe, b'\n']), MetricsError::Text { line: 1 }));
    assert!(matches!(of(&vec![b'x'; 10 * LONGEST_LINE]), MetricsError::Long { line: 1 }));
    // Escapes must not reach a terminal, nor a whole file an error message.
    let escape = message(&format!("0,4000,\u{1b}[31m{},2,3,4,5,6,7,8,9,10,11,12\n", "x".repeat(4000)));
    assert!(!escape.contains('\u{1b}') && escape.len() < 200, "{escape}");
}

#[test]
fn a_row_without_end_does_not_fill_the_memory() {
    let endless = std::io::Read::chain(std::io::Cursor::new(header()), std::io::repeat(b'1'));
    assert!(matches!(MetricsTable::read(endless), Err(MetricsError::Long { line: 2 })));
}

#[test]
fn rows_without_end_are_refused() {
    struct Rows(u64);
    impl std::io::Read for Rows {
        fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
            let row = b"0,0,0,0,0,0,0,0,0,0\n";
            let count = buffer.len().min(1 << 16) / row.len();
            assert!(count > 0 && self.0 < 10_000_000, "the reader does not stop");
            for place in buffer.chunks_exact_mut(row.len()).take(count) {
                place.copy_from_slice(row);
            }
            self.0 += count as u64;
            Ok(count * row.len())
        }
    }
    let endless = std::io::Read::chain(std::io::Cursor::new(FIXED_COLUMNS.join(",") + "\n"), Rows(0));
    assert!(matches!(MetricsTable::read(endless), Err(MetricsError::Rows)));
}

#[test]
fn names_that_break_a_header_are_refused() {
    let long = "x".repeat(65);
    for name in ["", "a,b", "a\nb", "\"a\"", "return", "episodes", "entropy", "learner.kl", "reward.alive", " a", &long]
    {
        assert!(matches!(table(&[], &[], &[name]), Err(MetricsError::Name { .. })), "{name}");
        let text = format!("{},{name}\n", FIXED_COLUMNS.join(","));
        assert!(["a,b", "learner.kl", "reward.alive"].contains(&name) || read(text).is_err(), "{name}");
    }
    for name in ["", "a,b", "a\nb", " a", &long] {
        assert!(matches!(table(&[name], &[], &[]), Err(MetricsError::Name { .. })), "{name}");
        assert!(matches!(table(&[], &[name], &[]), Err(MetricsError::Name { .. })), "{name}");
    }
    assert!(matches!(table(&["return"], &[], &[]), Err(MetricsError::Name { .. })));
    assert!(matches!(table(&[], &[], &["a", "a"]), Err(MetricsError::Name { .. })));
    let many: Vec<String> = (0..65).map(|i| format!("total_{i}")).collect();
    let many: Vec<&str> = many.iter().map(String::as_str).collect();
    let error = |table: Result<MetricsWriter<Vec<u8>>, MetricsError>| table.unwrap_err().to_string();
    assert_eq!(error(table(&[], &[], &many)), "65 design totals are more than 64");
    assert_eq!(error(table(&many[..33], &[], &[])), "33 metrics of a learner are more than 32");
    assert_eq!(error(table(&[], &many[..33], &[])), "33 terms of a reward are more than 32");
    // The longest header that there can be is no longer than a line may be.
    let long: Vec<String> = (0..64).map(|i| format!("{i:0>64}")).collect();
    let long: Vec<&str> = long.iter().map(String::as_str).collect();
    let widest = table(&long[..32], &long[..32], &long).unwrap().into_inner();
    assert_eq!(read(widest).unwrap().design_totals.len(), 64);
}

#[test]
fn a_row_of_another_table_is_not_written() {
    let mut writer = table(&LEARNER, &[], &["stiffness_total"]).unwrap();
    assert!(matches!(writer.append(&row(0, [0.0; 9])), Err(MetricsError::Fields { found: 16, expected: 14, .. })));
    assert_eq!(String::from_utf8(writer.into_inner()).unwrap(), header());
}

/// Every table had `kl`, `entropy` and `step_fraction`, whatever had learned: PPO a share of a step that it does not know, and a
/// search three columns of nothing.
#[test]
fn tables_of_earlier_versions_are_read() {
    let text =
        "iteration,env_steps,wall_s,discounted_return,return,kl,entropy,step_fraction,gear\n0,1200,1,2,3,4,5,6,7\n";
    let table = read(text).unwrap();
    assert_eq!(
        (&*table.learner, &*table.design_totals),
        (&["kl", "entropy", "step_fraction"].map(String::from)[..], &["gear".to_owned()][..])
    );
    assert_eq!((&*table.rows[0].learner, &*table.rows[0].design_totals), (&[4.0, 5.0, 6.0][..], &[7.0][..]));
    assert_eq!(table.metric("kl").unwrap().collect::<Vec<_>>(), [4.0]);
    assert!(table.metric("grad_norm").is_none());
    let row = &table.rows[0];
    assert!(row.episodes.is_nan() && row.episode_steps.is_nan() && row.noise.command.is_nan());
}

/// What an earlier version wrote, with the learner's own names: between `return` and `learner.kl` there was nothing.
#[test]
fn tables_without_lengths_of_episodes_are_read() {
    let text = "iteration,env_steps,wall_s,discounted_return,return,learner.kl,reward.place,gear\n0,1200,1,2,3,4,5,6\n";
    let table = read(text).unwrap();
    let row = &table.rows[0];
    assert_eq!(
        (row.undiscounted_return, &*row.learner, &*row.terms, &*row.design_totals),
        (3.0, &[4.0][..], &[5.0][..], &[6.0][..])
    );
    assert!(row.episodes.is_nan() && row.episode_steps.is_nan() && row.noise.design.is_nan());
    let half = "iteration,env_steps,wall_s,discounted_return,return,episodes,gear\n";
    let error = read(half).unwrap_err().to_string();
    assert!(error.contains("column 7 is `gear`, expected `episode_steps`"), "{error}");
}

/// What a search writes has no column of a learner.
#[test]
fn a_search_has_no_metrics_of_a_learner() {
    let writer = table(&[], &[], &["gear"]).unwrap();
    assert_eq!(String::from_utf8(writer.into_inner()).unwrap(), format!("{},gear\n", FIXED_COLUMNS.join(",")));
}
