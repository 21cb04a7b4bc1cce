//! Packets of Dynamixel protocol 2.0, as a master writes and reads them.
//!
//! Ours, since the crates that there are cannot be given whatever a line may bring: `dynamixel2` 0.9.1 panics where a
//! length is below two, and takes 0xFF 0xFF 0xFF 0xFD, which a small negative speed before a position is, for not stuffed.

const HEADER: [u8; 4] = [0xFF, 0xFF, 0xFD, 0x00];
/// Header, identity, length.
const BEFORE_BODY: usize = 7;
const CHECKSUM: usize = 2;
/// Instruction, error and checksum: the shortest answer.
const LEAST: usize = 4;
const STATUS: u8 = 0x55;

/// CRC-16 with polynomial 0x8005, from zero, no bit order reversed; a bit at a time, as packets are short.
fn checksum(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0, |sum, &byte| {
        (0..8).fold(sum ^ (u16::from(byte) << 8), |sum, _| (sum << 1) ^ if sum >> 15 == 1 { 0x8005 } else { 0 })
    })
}

/// The packet of an instruction.
pub(super) fn instruction(id: u8, instruction: u8, parameters: &[u8]) -> Vec<u8> {
    let mut bytes = HEADER.to_vec();
    bytes.extend([id, 0, 0, instruction]);
    // How many bytes of what a body must not have, 0xFF 0xFF 0xFD, came last.
    let mut run = 0;
    for &byte in parameters {
        bytes.push(byte);
        run = match (byte, run) {
            (0xFF, _) => 2.min(run + 1),
            (0xFD, 2) => 3,
            _ => 0,
        };
        if run == 3 {
            bytes.push(0xFD);
            run = 0;
        }
    }
    let length = (bytes.len() - BEFORE_BODY + CHECKSUM) as u16;
    bytes[5..BEFORE_BODY].copy_from_slice(&length.to_le_bytes());
    let sum = checksum(&bytes);
    bytes.extend(sum.to_le_bytes());
    bytes
}

/// An answer whose checksum is right.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Status {
    pub(super) id: u8,
    /// The number of the error, and the alert bit.
    pub(super) error: u8,
    pub(super) data: Vec<u8>,
}

/// What was found among the bytes that arrived.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Found {
    /// Whole answers, in their order.
    pub(super) answers: Vec<Status>,
    /// Whether something came as a whole and with a wrong checksum.
    pub(super) broken: bool,
}

/// Looks for answers. Bytes that are none do no harm: a header may begin anywhere, and what begins with one may be noise.
pub(super) fn find(bytes: &[u8]) -> Found {
    let mut found = Found::default();
    let mut at = 0;
    while let Some(header) = bytes[at..].windows(HEADER.len()).position(|four| four == HEADER) {
        let start = at + header;
        // What is no answer may have one in it.
        at = start + 1;
        let packet = &bytes[start..];
        let Some(&[low, high]) = packet.get(5..BEFORE_BODY) else { break };
        let end = BEFORE_BODY + usize::from(u16::from_le_bytes([low, high]));
        let Some(packet) = packet.get(..end).filter(|packet| packet.len() >= BEFORE_BODY + LEAST) else { continue };
        let (checked, sum) = packet.split_at(end - CHECKSUM);
        if sum != checksum(checked).to_le_bytes() {
            found.broken = true;
            continue;
        }
        at = start + end;
        if checked[BEFORE_BODY] == STATUS {
            let [id, error] = [checked[4], checked[BEFORE_BODY + 1]];
            found.answers.push(Status { id, error, data: unstuffed(&checked[BEFORE_BODY + 2..]) });
        }
    }
    found
}

/// Parameters without the 0xFD after each 0xFF 0xFF 0xFD.
fn unstuffed(bytes: &[u8]) -> Vec<u8> {
    let mut data = Vec::with_capacity(bytes.len());
    let mut stuffed = false;
    for &byte in bytes {
        if std::mem::take(&mut stuffed) && byte == 0xFD {
            continue;
        }
        data.push(byte);
        stuffed = matches!(data[..], [.., 0xFF, 0xFF, 0xFD]);
    }
    data
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A device's answer, made apart from what is tried here: the checksum is the one of the protocol's description.
    const PING_ANSWER: [u8; 14] = [0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x07, 0x00, 0x55, 0x00, 0x06, 0x04, 0x26, 0x65, 0x5D];

    fn answer(error: u8, stuffed: &[u8]) -> Vec<u8> {
        let mut bytes = HEADER.to_vec();
        bytes.push(1);
        bytes.extend((stuffed.len() as u16 + 4).to_le_bytes());
        bytes.extend([STATUS, error]);
        bytes.extend(stuffed);
        let sum = checksum(&bytes);
        bytes.extend(sum.to_le_bytes());
        bytes
    }

    #[test]
    fn packets_of_the_description() {
        assert_eq!(instruction(1, 1, &[])[8..], [0x19, 0x4E]);
        assert_eq!(instruction(1, 2, &[0x84, 0, 4, 0])[12..], [0x1D, 0x15]);
        assert_eq!(instruction(1, 3, &[0x74, 0, 0, 2, 0, 0])[14..], [0xCA, 0x89]);
        let wanted = Status { id: 1, error: 0, data: vec![6, 4, 0x26] };
        assert_eq!(find(&PING_ANSWER), Found { answers: vec![wanted], broken: false });
    }

    #[test]
    fn headers_within_are_stuffed_and_unstuffed() {
        let stuffing: [(&[u8], &[u8]); 5] = [
            (&[0xFF, 0xFF, 0xFD], &[0xFF, 0xFF, 0xFD, 0xFD]),
            (&[0xFF, 0xFF, 0xFD, 0xFD], &[0xFF, 0xFF, 0xFD, 0xFD, 0xFD]),
            (&[0xFF, 0xFF, 0xFF, 0xFD, 0], &[0xFF, 0xFF, 0xFF, 0xFD, 0xFD, 0]),
            (&[0xFF, 0xFD, 0xFF, 0xFF], &[0xFF, 0xFD, 0xFF, 0xFF]),
            (&[0xFF, 0xFF, 0xFD, 0xFF, 0xFF, 0xFD], &[0xFF, 0xFF, 0xFD, 0xFD, 0xFF, 0xFF, 0xFD, 0xFD]),
        ];
        for (plain, stuffed) in stuffing {
            let written = instruction(1, 3, plain);
            assert_eq!(&written[8..written.len() - 2], stuffed);
            assert_eq!(usize::from(written[5]), stuffed.len() + 3);
            assert_eq!(find(&answer(0, stuffed)).answers[0].data, plain);
        }
    }

    #[test]
    fn answers_are_found_in_noise() {
        let mut bytes = vec![0x00, 0xFF, 0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x00, 0x00, 0x55, 0xFF, 0xFF];
        bytes.extend([0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x7F, 0x00]);
        bytes.extend(PING_ANSWER);
        let mut wrong = PING_ANSWER;
        wrong[9] ^= 1;
        bytes.extend(wrong);
        bytes.extend(answer(0x87, &[]));
        bytes.extend([0xFF, 0xFF, 0xFD, 0x00]);
        let Found { answers, broken } = find(&bytes);
        assert!(broken);
        let seen: Vec<_> = answers.iter().map(|answer| (answer.error, answer.data.len())).collect();
        assert_eq!(seen, [(0, 3), (0x87, 0)]);
    }

    /// Every beginning of everything: short lengths with right checksums, too.
    #[test]
    fn no_bytes_are_too_bad() {
        for length in 0..=5_u16 {
            for error in 0..3_usize {
                let mut bytes = HEADER.to_vec();
                bytes.push(1);
                bytes.extend(length.to_le_bytes());
                bytes.extend(vec![STATUS; error]);
                let sum = checksum(&bytes);
                bytes.extend(sum.to_le_bytes());
                for end in 0..=bytes.len() {
                    assert!(find(&bytes[..end]).answers.len() <= 1);
                }
            }
        }
    }
}
