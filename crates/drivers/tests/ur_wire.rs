//! Frames of RTDE, in pieces and in nonsense.

use hwasp_drivers::ur::wire::{Body, Frame, Frames, LONGEST, WireError, kind};
use proptest::prelude::*;

/// All frames of a stream that comes in pieces of these sizes.
fn cut(stream: &[u8], sizes: &[usize]) -> Result<Vec<Frame>, WireError> {
    let (mut frames, mut found, mut at) = (Frames::default(), Vec::new(), 0);
    for size in sizes.iter().copied().chain([stream.len()]) {
        let end = (at + size).min(stream.len());
        frames.push(&stream[at..end]);
        at = end;
        while let Some(frame) = frames.take()? {
            found.push(frame);
        }
    }
    Ok(found)
}

proptest! {
    #[test]
    fn frames_come_back_however_the_stream_is_cut(
        sent in prop::collection::vec((any::<u8>(), prop::collection::vec(any::<u8>(), 0..300)), 0..10),
        sizes in prop::collection::vec(0_usize..40, 0..60),
    ) {
        let stream: Vec<u8> = sent.iter().flat_map(|(kind, body)| Frame::bytes(*kind, body).expect("short enough")).collect();
        let sent: Vec<Frame> = sent.into_iter().map(|(kind, body)| Frame { kind, body }).collect();
        prop_assert_eq!(cut(&stream, &sizes), Ok(sent));
    }

    #[test]
    fn any_bytes_are_frames_or_an_error(stream in prop::collection::vec(any::<u8>(), 0..600), sizes in prop::collection::vec(0_usize..90, 0..20)) {
        if let Ok(frames) = cut(&stream, &sizes) {
            let told: usize = frames.iter().map(|frame| frame.body.len() + 3).sum();
            prop_assert!(told <= stream.len());
        }
    }

    #[test]
    fn values_come_back_from_a_body(whole in any::<i32>(), word in any::<u32>(), real in any::<f64>(), six in any::<[f64; 6]>()) {
        let mut bytes = whole.to_be_bytes().to_vec();
        bytes.extend(word.to_be_bytes());
        bytes.extend(real.to_be_bytes());
        bytes.extend(six.iter().flat_map(|part| part.to_be_bytes()));
        let mut body = Body::new(&bytes);
        prop_assert_eq!(body.i32(), Ok(whole));
        prop_assert_eq!(body.u32(), Ok(word));
        prop_assert_eq!(body.f64().map(f64::to_bits), Ok(real.to_bits()));
        prop_assert_eq!(body.reals::<6>().map(|six| six.map(f64::to_bits)), Ok(six.map(f64::to_bits)));
        prop_assert_eq!(body.end(), Ok(()));
    }
}

/// The vendor's guide: a size with the head in it, big-endian, then the kind.
#[test]
fn a_frame_is_what_the_guide_says() {
    assert_eq!(Frame::bytes(kind::PROTOCOL, &2_u16.to_be_bytes()), Some(vec![0, 5, b'V', 0, 2]));
    assert_eq!(Frame::bytes(kind::START, &[]), Some(vec![0, 3, b'S']));
    assert!(Frame::bytes(kind::DATA, &vec![0; LONGEST]).is_some());
    assert_eq!(Frame::bytes(kind::DATA, &vec![0; LONGEST + 1]), None, "longer than a size can tell");
}

#[test]
fn what_is_no_frame_is_told() {
    assert_eq!(cut(&[0, 2, b'U'], &[]), Err(WireError::Size(2)));
    assert_eq!(cut(&[0, 9, b'U', 1], &[]), Ok(vec![]), "not yet all there");
    let mut body = Body::new(&[1, 2, 3]);
    assert_eq!(body.i32(), Err(WireError::Short { has: 3, needs: 4 }));
    assert_eq!(body.end(), Err(WireError::Long(3)));
    assert_eq!(Body::new(&[0xff]).text(), Err(WireError::Text));
}
