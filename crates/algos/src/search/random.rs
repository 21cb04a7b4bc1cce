//! Random search: the floor that every other search has to beat (Bergstra and Bengio, "Random search for hyper-parameter
//! optimization", JMLR 2012).

use hwasp_core::{Purpose, stream};
use rand::RngExt;

use super::{Search, SearchError, check_unit, sound_or_failed};
use crate::archive::{Exchange, Persist, StateError};

/// Settings of [`RandomSearch`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RandomConfig {
    /// Candidates of a generation.
    pub popsize: usize,
}

impl Default for RandomConfig {
    fn default() -> Self {
        Self { popsize: 10 }
    }
}

/// Points of the unit cube, uniform and independent; the first is the start. It takes the best of them. The last generation
/// may be told in part, by the scores of its first candidates.
#[derive(Clone, Debug, PartialEq)]
pub struct RandomSearch {
    config: RandomConfig,
    seed: u64,
    /// The best candidate; the start before the first score.
    best: Vec<f64>,
    /// Its score; empty before the first.
    score: Vec<f64>,
    generation: u64,
}

impl RandomSearch {
    /// Begins at the candidate `start`; `seed` names the streams.
    ///
    /// # Errors
    /// [`SearchError::Setting`] where the start is outside of the unit cube, or a generation has no candidates.
    pub fn new(config: RandomConfig, start: Vec<f64>, seed: u64) -> Result<Self, SearchError> {
        check_unit(config.popsize, &start)?;
        Ok(Self { config, seed, best: start, score: Vec::new(), generation: 0 })
    }
}

impl Search for RandomSearch {
    fn dimension(&self) -> usize {
        self.best.len()
    }

    fn ask(&mut self) -> Vec<Vec<f64>> {
        let draw = |k: usize| {
            if self.generation == 0 && k == 0 {
                return self.best.clone();
            }
            let mut uniform = stream(self.seed, Purpose::Search, self.generation, k as u64);
            (0..self.best.len()).map(|_| uniform.random()).collect()
        };
        (0..self.config.popsize).map(draw).collect()
    }

    fn tell(&mut self, scores: &[f64]) -> Result<(), SearchError> {
        let scored = !self.score.is_empty();
        let scores = sound_or_failed(scores, self.config.popsize, self.generation, scored)?;
        let candidates = self.ask();
        for (candidate, score) in candidates.into_iter().zip(scores) {
            if let Some(score) = score
                && self.score.first().is_none_or(|&best| score > best)
            {
                (self.best, self.score) = (candidate, vec![score]);
            }
        }
        self.generation += 1;
        Ok(())
    }

    fn center(&self) -> Vec<f64> {
        self.best.clone()
    }

    fn generation(&self) -> u64 {
        self.generation
    }

    fn group(&self, _candidate: usize) -> u64 {
        0
    }
}

impl Persist for RandomSearch {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        with.vector("best", &mut self.best)?;
        with.series("score", &mut self.score)?;
        if self.score.len() > 1 {
            return Err(with.refuse("score", self.score.len() as f64, "one score or none"));
        }
        with.number("generation", &mut self.generation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn search(seed: u64) -> RandomSearch {
        RandomSearch::new(RandomConfig { popsize: 4 }, vec![0.25, 0.75], seed).unwrap()
    }

    #[test]
    fn takes_the_best_of_uniform_points() {
        let mut random = search(3);
        let first = random.ask();
        assert_eq!((first.len(), &first[0]), (4, &vec![0.25, 0.75]));
        random.tell(&[1.0, 3.0, f64::NAN, 2.0]).unwrap();
        assert_eq!(random.center(), first[1]);
        // A generation of fewer, and one that failed as a whole, change nothing that was better.
        random.tell(&[2.5]).unwrap();
        random.tell(&[f64::NAN, f64::NEG_INFINITY]).unwrap();
        assert_eq!((random.center(), random.generation()), (first[1].clone(), 3));
        let mut points = Vec::new();
        for _ in 0..500 {
            points.extend(random.ask());
            random.tell(&[0.0; 4]).unwrap();
        }
        assert!(points.iter().flatten().all(|x| (0.0..1.0).contains(x)));
        for i in 0..2 {
            let mean = points.iter().map(|p| p[i]).sum::<f64>() / 2000.0;
            assert!((mean - 0.5).abs() < 4.0 / (12.0 * 2000.0_f64).sqrt(), "{mean}");
        }
    }

    #[test]
    fn goes_on_from_what_was_saved() {
        let mut random = search(3);
        assert_eq!(random.ask(), random.ask());
        random.tell(&[1.0, 3.0, 0.0, 2.0]).unwrap();
        let mut again = search(3);
        again.load(&random.save().unwrap()).unwrap();
        assert_eq!(again, random);
        assert_eq!(again.ask(), random.ask());
        assert_ne!(again.ask(), search(4).ask());
    }

    #[test]
    fn refuses_what_is_no_generation() {
        let mut random = search(1);
        let before = random.clone();
        assert_eq!(random.tell(&[]), Err(SearchError::Scores { found: 0, expected: 4 }));
        assert_eq!(random.tell(&[0.0; 5]), Err(SearchError::Scores { found: 5, expected: 4 }));
        assert_eq!(random.tell(&[f64::NAN]), Err(SearchError::AllFailed { candidates: 1, generation: 0 }));
        assert_eq!(random, before);
        let refused =
            |popsize, start: f64| RandomSearch::new(RandomConfig { popsize }, vec![start], 1).unwrap_err().to_string();
        assert_eq!(refused(0, 0.5), "popsize = 0 is not at least 1");
        assert_eq!(refused(1, 1.5), "start = 1.5 is not within [0, 1]");
    }
}
