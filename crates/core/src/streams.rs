//! Named random streams from one root seed.
//!
//! A stream is `ChaCha8` whose 256-bit key *is* the name: root seed, purpose, iteration and episode, 64 bits each. Two
//! different names give independent streams, the same name gives the same numbers on every machine and in any order of
//! execution, and nothing has to be saved to resume but the counters.

use rand::SeedableRng;

/// The generator behind every random number of a run.
pub type Stream = rand_chacha::ChaCha8Rng;

/// What the numbers of a stream are for. The discriminants are part of a run's identity: never renumber them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u64)]
pub enum Purpose {
    /// Initial controller weights.
    Weights = 1,
    /// Initial design.
    Design = 2,
    /// Start state and domain randomisation of training episodes.
    TrainingReset = 3,
    /// Action noise of training episodes.
    TrainingNoise = 4,
    /// The order of rows in minibatches, and the rows of TRPO's curvature.
    Minibatches = 5,
    /// Initial weights of the value baseline.
    Baseline = 6,
    /// Start states of evaluation episodes, held out from training.
    EvaluationReset = 7,
    /// Action noise of evaluation episodes, where it is asked for.
    EvaluationNoise = 8,
    /// Environment checks.
    Check = 9,
    /// Candidates of a search: the iteration is the generation, the episode the candidate.
    Search = 10,
    /// Root seeds of the trainings inside of a search.
    InnerSeed = 11,
    /// Observations at which exported controllers are compared.
    Samples = 12,
    /// Rows that an off-policy learner draws from its replay, and the noise of its actions there.
    Replay = 13,
    /// Initial weights of critics.
    Critic = 14,
    /// Points that fill the space before a Bayesian search chooses.
    FirstPoints = 15,
    /// Where a Bayesian search looks for the most improvement: the iteration is the generation, the episode the candidate.
    Acquisition = 16,
}

/// The stream of this name.
pub fn stream(root: u64, purpose: Purpose, iteration: u64, episode: u64) -> Stream {
    let mut key = [0u8; 32];
    for (chunk, word) in key.chunks_exact_mut(8).zip([root, purpose as u64, iteration, episode]) {
        chunk.copy_from_slice(&word.to_le_bytes());
    }
    Stream::from_seed(key)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;

    #[test]
    fn every_part_of_the_name_matters() {
        let first = |r, p, i, e| stream(r, p, i, e).next_u64();
        let base = first(1, Purpose::TrainingReset, 0, 0);
        assert_eq!(base, first(1, Purpose::TrainingReset, 0, 0));
        for other in [
            first(2, Purpose::TrainingReset, 0, 0),
            first(1, Purpose::TrainingNoise, 0, 0),
            first(1, Purpose::TrainingReset, 1, 0),
            first(1, Purpose::TrainingReset, 0, 1),
        ] {
            assert_ne!(base, other);
        }
    }

    /// Guards the portability of runs: a new version of the generator must not change old results unnoticed.
    #[test]
    fn the_numbers_are_pinned() {
        let mut s = stream(7, Purpose::TrainingNoise, 3, 11);
        assert_eq!([s.next_u64(), s.next_u64()], [8_672_921_177_313_967_166, 6_031_042_127_702_893_425]);
    }
}
