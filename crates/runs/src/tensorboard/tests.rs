//! The bytes, against those that TensorBoard's own writer gives (`scripts/tensorboard_peer.py --fixture`).

use super::*;

/// Version 2.21.0 wrote: the version at 1.5 s; then at 2.5 s and step 100 000 `train/return` = -0.25 and
/// `design/gear` = 1.
const THEIRS: &str = "1800000000000000a37f4b2209000000000000f83f1a0d627261696e2e4576656e743a322a28646c38\
    00000000000000a3797d5709000000000000044010a08d062a290a130a0c747261696e2f72657475726e15000080be0a120a0b64657369676e2f\
    67656172150000803f139cc571";

fn theirs() -> Vec<u8> {
    let digits: Vec<u32> = THEIRS.chars().filter_map(|c| c.to_digit(16)).collect();
    digits.chunks(2).map(|pair| (pair[0] << 4 | pair[1]) as u8).collect()
}

/// The value of CRC-32C for "123456789" is the usual check of implementations (RFC 3720 has others).
#[test]
fn the_checksum_is_crc32c_turned_and_shifted() {
    assert_eq!(crc32c::crc32c(b"123456789"), 0xe306_9283);
    // Turned right by 15 it is 0x2507c60d, and 0x2507c60d + 0xa282ead8 = 0xc78ab0e5.
    assert_eq!(masked_crc(b"123456789"), 0xc78a_b0e5);
}

#[test]
fn the_bytes_are_those_of_tensorboard() {
    let scalars = [("train/return", -0.25), ("train/kl", f64::NAN), ("design/gear", 1.0), ("design/huge", 1e300)];
    let event = summary(2.5, 100_000, scalars.into_iter()).expect("two of the scalars are finite");
    let ours = [record(&version(1.5)), record(&event)].concat();
    assert_eq!(ours, theirs());
}

#[test]
fn nothing_finite_is_no_event() {
    assert_eq!(summary(1.0, 5, [("train/kl", f64::NAN), ("train/return", f64::NEG_INFINITY)].into_iter()), None);
    assert_eq!(summary(1.0, 5, std::iter::empty()), None);
}

/// 300 is 10 and 0101100 in bits; 150 is the example of the protocol buffers' documentation.
#[test]
fn varints() {
    for (value, expected) in [
        (0, &[0][..]),
        (127, &[0x7f]),
        (128, &[0x80, 1]),
        (150, &[0x96, 1]),
        (300, &[0xac, 2]),
        (u64::MAX, &[255, 255, 255, 255, 255, 255, 255, 255, 255, 1]),
    ] {
        let mut out = Vec::new();
        varint(&mut out, value);
        assert_eq!(out, expected, "{value}");
    }
}

/// After a resume with the clock set back an hour, TensorBoard showed 1077 points of 1000 rows: readers take files in the order of
/// their names, and the newer file came first.
#[test]
fn a_clock_that_steps_back_leaves_files_and_times_in_order() {
    let folder = std::env::temp_dir().join(format!("hwasp-tensorboard-{}", std::process::id()));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    // Written by a clock that was a day ahead; and files of somebody else's, which say nothing.
    let ahead = now() + 86_400.0;
    let first = format!("{PREFIX}{ahead:.6}.hwasp");
    for name in [&first, "events.out.tfevents.9999999999.other", "events.out.tfevents.inf.hwasp", "notes"] {
        fs::write(folder.join(name), "").unwrap();
    }
    let mut board = TensorBoard::create(&folder).unwrap();
    let name = board.path().file_name().unwrap().to_str().unwrap().to_owned();
    assert!(name > first, "{name} after {first}");
    assert!(board.tick() > ahead);
    let third = TensorBoard::create(&folder).unwrap();
    assert!(third.path() > board.path());
    fs::remove_dir_all(&folder).unwrap();
}
