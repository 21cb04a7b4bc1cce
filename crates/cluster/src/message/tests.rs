use std::sync::Arc;

use hwasp_core::{Batch, End, Episode, EpisodeKind, EpisodeResult, Episodes, Moments, Outcome, RolloutError};
use hwasp_testing::small;
use hwasp_training::collect::Stage;
use hwasp_training::{Assembly, train};

use super::*;

fn sent<T: Serialize + DeserializeOwned>(value: &T) -> T {
    unpack(&pack(value).unwrap()).unwrap()
}

/// Numbers that are none, and fields that are not there.
#[test]
fn answers_come_back_to_the_bit() {
    let fault = RolloutError { seed: 1, iteration: 2, episode: 3, step: 4, what: "it left the world".into() };
    let batch = Batch {
        obs: vec![f32::INFINITY, -0.0, 1e-45],
        state: vec![f32::NEG_INFINITY],
        action: vec![f32::MIN_POSITIVE],
        log_prob: vec![0.1],
        reward: vec![f64::MAX],
        episodes: vec![Episode {
            rows: 0..1,
            end: End::Truncated,
            cut: true,
            last_obs: vec![0.1],
            last_state: vec![],
            context: vec![2.0],
            log_prob: -1.5,
            outcome: Some(Outcome { success: true, kind: Arc::from("sphere") }),
            terms: vec![0.25, -1.0],
        }],
        faults: vec![fault.clone()],
        observed: vec![Moments::default()],
    };
    let content: Content = Ok(Answer::Rows(batch));
    assert_eq!(sent(&content), content);
    let result = EpisodeResult {
        discounted_return: f64::NEG_INFINITY,
        undiscounted_return: 1.0,
        steps: 7,
        end: End::Terminated,
        ended_by: Some(Arc::from("fallen")),
        outcome: None,
        terms: vec![],
    };
    let content: Content = Ok(Answer::Results(vec![Ok(result), Err(fault)]));
    assert_eq!(sent(&content), content);
    let not_a_number = sent(&Params(vec![f32::from_bits(0x7fc0_1234)])).0;
    assert_eq!(not_a_number[0].to_bits(), 0x7fc0_1234);
}

/// A whole training with its evaluation, whose form in JSON leaves fields out.
#[test]
fn a_training_comes_back_to_the_bit() {
    let assembly = Assembly::new(&small("hwasp", &[])).unwrap();
    let trained = train(&assembly, &hwasp_core::Serial, &mut (), &std::sync::atomic::AtomicBool::new(false)).unwrap();
    let TrainingAnswer::Trained(back) = sent(&TrainingAnswer::Trained(Box::new(trained.clone()))) else { panic!() };
    assert_eq!(*back, trained);
    let text = ExperimentText::of(assembly.experiment()).unwrap();
    assert_eq!(sent(&Named(text.clone())).0, text);
}

/// What comes from elsewhere may be anything.
#[test]
fn what_is_no_message_is_refused() {
    for bytes in [&b""[..], b"hello", &[0xff; 200], &[0, 0, 0, 0]] {
        assert!(unpack::<Job>(bytes).is_err());
    }
    // It claims to be four gigabytes.
    let mut bomb = u32::MAX.to_le_bytes().to_vec();
    bomb.extend(lz4_flex::compress(&[0; 1000]));
    let why = unpack::<Params>(&bomb).err().unwrap();
    assert!(why.contains("more than"), "{why}");
    let job = pack(&(Payload::Here(vec![1, 2, 3]), 7_u64)).unwrap();
    assert!(unpack::<Job>(&job[..job.len() - 1]).is_err());
}

fn block(indices: std::ops::Range<u64>) -> Task {
    let episodes = Episodes { seed: 1, iteration: 2, indices, progress: 0.5, kind: EpisodeKind::Training };
    Task::Rows(Block { stage: Stage::Training, params: Payload::Here(vec![1]), episodes, steps: None, lanes: None })
}

/// Whoever goes on with a run asks for the same names; where a training stands is no part of its name.
#[test]
fn jobs_are_named_after_what_they_ask_for() {
    let kept = Kept { class: Class::Run, hash: "a".into(), bytes: 1 };
    let name = |task: &Task| task.name("me", &kept).unwrap();
    assert_eq!(name(&block(0..4)), name(&block(0..4)));
    assert_ne!(name(&block(0..4)), name(&block(4..8)));
    assert_ne!(name(&block(0..4)), block(0..4).name("other", &kept).unwrap());
    let from = Some(Payload::Here(vec![1, 2]));
    assert_eq!(name(&Task::Training { from: None }), name(&Task::Training { from: from.clone() }));
    let candidate = |from| Task::Candidate { design: vec![1.0], seed: 2, env_steps: 3, from };
    assert_eq!(name(&candidate(None)), name(&candidate(from)));
}
