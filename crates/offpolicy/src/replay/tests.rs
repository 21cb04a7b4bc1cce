use hwasp_core::{Episode, Purpose, stream};
use proptest::prelude::*;

use super::*;

const DIMS: Dims = Dims { obs: 1, design: 0, state: 1, context: 1, action: 1 };

/// Episodes of these lengths and ends; every number tells its step, counted from `first`.
fn batch(first: usize, episodes: &[(usize, End)]) -> Batch {
    let mut batch = Batch::default();
    for &(steps, end) in episodes {
        let begin = batch.rows();
        for _ in 0..steps {
            let number = (first + batch.rows()) as f32;
            batch.obs.push(number);
            batch.state.push(10.0 * number);
            batch.action.push(100.0 * number);
            batch.log_prob.push(0.0);
            batch.reward.push(f64::from(number));
        }
        let last = (first + batch.rows()) as f32 - 0.5;
        batch.episodes.push(Episode {
            rows: begin..batch.rows(),
            end,
            cut: false,
            last_obs: vec![last],
            last_state: vec![10.0 * last],
            context: vec![-1.0],
            log_prob: 0.0,
            outcome: None,
            terms: vec![],
        });
    }
    batch
}

fn all(replay: &mut Replay) -> hwasp_algos::Archive {
    replay.save().unwrap()
}

/// Steps of 1, 2, 3, 4 with a discount of 1/2: 1 + 2/2 = 2 from the first, and the value of the third is worth a quarter.
#[test]
fn n_steps_by_hand() {
    let mut replay = Replay::new(DIMS, 20);
    replay.push(&batch(1, &[(4, End::Truncated), (1, End::Terminated)]), &[None]);
    assert_eq!(replay.steps(), 5);
    assert_eq!(replay.ahead(0, 1, 0.5), Ahead { frame: 1, reward: 1.0, discount: 0.5 });
    assert_eq!(replay.ahead(0, 2, 0.5), Ahead { frame: 2, reward: 2.0, discount: 0.25 });
    // Past the end: 3 + 4/2 and the value of the moment after the fourth, which no reward follows.
    assert_eq!(replay.ahead(2, 5, 0.5), Ahead { frame: 4, reward: 5.0, discount: 0.25 });
    assert_eq!(replay.obs(4), [4.5]);
    // What is over for good is worth nothing more.
    assert_eq!(replay.ahead(5, 3, 0.5), Ahead { frame: 6, reward: 5.0, discount: 0.0 });
    // From the newest step to the oldest: 5, then 4, 3 + 4/2, 2 + 5/2, 1 + 4.5/2.
    let returns = [(5.0, 0.0), (4.0, 0.5), (5.0, 0.25), (4.5, 0.125), (3.25, 0.0625)];
    assert_eq!(replay.returns(0.5), returns);
}

/// Episodes of 3 and 2 steps in a ring of 9: the third writes over the first one's beginning, whose rest has no start.
#[test]
fn starts_are_where_episodes_began() {
    let mut replay = Replay::new(DIMS, 9);
    replay.push(&batch(1, &[(3, End::Truncated), (2, End::Terminated)]), &[None]);
    assert_eq!(replay.starts(), [0, 4]);
    replay.push(&batch(6, &[(3, End::Truncated)]), &[None]);
    assert_eq!(replay.starts(), [4, 7]);
    replay.empty();
    assert_eq!((replay.starts().len(), replay.steps()), (0, 0));
}

/// Episodes that earned 1 + 2 + 3, 4 and, left halfway, 5 + 6; then 7 + 8 in a ring of 12, which overwrites the beginning of the first.
#[test]
fn the_latest_whole_episodes() {
    let mut replay = Replay::new(DIMS, 12);
    let mut first = batch(1, &[(3, End::Truncated), (1, End::Terminated), (2, End::Truncated)]);
    first.episodes[2].cut = true;
    replay.push(&first, &[None]);
    assert_eq!(replay.latest(9), [(4, 4.0), (0, 6.0)]);
    assert_eq!(replay.latest(1), [(4, 4.0)]);
    replay.push(&batch(7, &[(2, End::Truncated)]), &[None]);
    assert_eq!(replay.latest(9), [(9, 15.0), (4, 4.0)], "a full ring may have lost a beginning");
    replay.push(&batch(9, &[(2, End::Truncated)]), &[None]);
    assert_eq!(replay.latest(9), [(0, 19.0), (9, 15.0), (4, 4.0)]);
    replay.empty();
    assert_eq!(replay.latest(9), []);
}

/// The world saw the command at its limit, and the critic has to see what the world saw.
#[test]
fn actions_are_kept_within_their_limits() {
    let mut replay = Replay::new(DIMS, 20);
    replay.push(&batch(1, &[(3, End::Truncated)]), &[Some((150.0, 250.0))]);
    assert_eq!((replay.action(0), replay.action(1), replay.action(2)), (&[150.0][..], &[200.0][..], &[250.0][..]));
}

#[test]
fn a_saved_replay_that_fits_no_other_is_refused() {
    let mut replay = Replay::new(DIMS, 20);
    replay.push(&batch(1, &[(4, End::Truncated)]), &[None]);
    let archive = all(&mut replay);
    for (capacity, told) in [
        (4, "`reward` of the saved state is 5, which is not at most what the replay holds"),
        (5, "`head` of the saved state is 5, which is not behind the end of an episode"),
    ] {
        let error = Replay::new(DIMS, capacity).load(&archive).unwrap_err().to_string();
        assert_eq!(error, told);
    }
}

proptest! {
    /// The ring against a list of all that was ever pushed: the newest frames, in their order; and a push that is taken back
    /// leaves nothing behind.
    #[test]
    fn the_ring_holds_the_newest_frames(
        lengths in prop::collection::vec((1..6_usize, any::<bool>()), 1..12),
        capacity in 8..20_usize,
        seed in 0..100_u64,
    ) {
        let mut replay = Replay::new(DIMS, capacity);
        let mut list = Vec::new();
        let mut first = 0;
        for &(steps, over) in &lengths {
            let end = if over { End::Terminated } else { End::Truncated };
            let batch = batch(first, &[(steps, end)]);
            let before = all(&mut replay);
            let undo = replay.push(&batch, &[None]);
            let after = all(&mut replay);
            replay.take_back(&undo);
            prop_assert_eq!(&all(&mut replay), &before);
            replay.push(&batch, &[None]);
            prop_assert_eq!(&all(&mut replay), &after);
            let mut loaded = Replay::new(DIMS, capacity);
            loaded.load(&after).unwrap();
            prop_assert_eq!(&all(&mut loaded), &after);
            list.extend(batch.obs.iter().map(|&number| (number, true)));
            list.push((batch.episodes[0].last_obs[0], false));
            first += steps;
            let newest = &list[list.len().saturating_sub(capacity)..];
            let count = replay.frames();
            prop_assert_eq!(count, newest.len());
            let oldest = if count < capacity { 0 } else { replay.head };
            for (k, &(number, step)) in newest.iter().enumerate() {
                let at = (oldest + k) % count;
                prop_assert_eq!((replay.obs(at)[0], replay.mark[at] == Mark::Step), (number, step));
            }
            prop_assert_eq!(replay.steps(), newest.iter().filter(|(_, step)| *step).count());
            if replay.steps() > 0 {
                let drawn = replay.draw(&mut stream(seed, Purpose::Replay, 0, 0));
                prop_assert!(replay.mark[drawn] == Mark::Step);
            }
        }
    }
}
