//! Bayesian optimisation: a Gaussian process learns what scores to expect, and the next candidates are where it expects most
//! improvement (Mockus 1975; Jones, Schonlau and Welch 1998; Snoek, Larochelle and Adams 2012, "Practical Bayesian optimization of
//! machine learning algorithms").

mod fit;
mod hypercube;
mod improvement;
mod kernel;
mod minimise;
mod model;
mod posterior;
#[cfg(test)]
mod tests;

use hwasp_core::{Purpose, stream};

use self::hypercube::hypercube;
use self::model::Model;
use super::{Search, SearchError, check_unit, sound_or_failed};
use crate::archive::{Exchange, Persist, StateError};

/// The score of a failed candidate in the state.
const FAILED: f64 = f64::MIN;
/// Scores beyond this would overflow in squares.
const LARGEST: f64 = 1e150;
/// The most points that a saved state may have: each factorisation of a model of so many takes seconds.
const MOST_POINTS: usize = 2000;

/// Settings of [`Bo`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BoConfig {
    /// Candidates of a generation: they are chosen together, each as if the scores of those before it were as expected.
    pub popsize: usize,
    /// Candidates that fill the space before the model chooses, rounded up to whole generations; 0: 2n + 2 for n coordinates.
    pub initial_points: usize,
}

impl Default for BoConfig {
    fn default() -> Self {
        Self { popsize: 4, initial_points: 0 }
    }
}

/// Bayesian optimisation over the unit cube, for few candidates whose scores are costly and noisy.
///
/// The first generations are the start and a Latin hypercube. After that, a Gaussian process is fitted to all scores; its noise is
/// fitted too. The candidates of a generation have the most expected improvement over the best mean at a point tried. One is chosen after
/// the other, and each believes that those before it scored their mean (the kriging believer of Ginsbourger, Le Riche and Carraro
/// 2010). A failed candidate counts as the worst score there was, and has no say in the fit.
///
/// The state is points and scores: the model follows from them. The last generation may be told in part, by the scores of its first
/// candidates.
pub struct Bo {
    config: BoConfig,
    seed: u64,
    start: Vec<f64>,
    /// Candidates told.
    points: Vec<Vec<f64>>,
    /// Their scores, [`FAILED`] where they failed.
    scores: Vec<f64>,
    generation: u64,
    /// What the scores say; none before the first.
    model: Option<Model>,
    /// The generation at hand, once it was asked for: follows from the state.
    asked: Option<Vec<Vec<f64>>>,
}

impl Bo {
    /// Begins at the candidate `start`; `seed` names the streams.
    ///
    /// # Errors
    /// [`SearchError::Setting`] where the start is outside of the unit cube, or a generation has no candidates.
    pub fn new(config: BoConfig, start: Vec<f64>, seed: u64) -> Result<Self, SearchError> {
        check_unit(config.popsize, &start)?;
        let (points, scores) = (Vec::new(), Vec::new());
        Ok(Self { config, seed, start, points, scores, generation: 0, model: None, asked: None })
    }

    /// Generations that fill the space.
    fn first_generations(&self) -> usize {
        let points =
            if self.config.initial_points == 0 { 2 * self.start.len() + 2 } else { self.config.initial_points };
        points.div_ceil(self.config.popsize)
    }

    fn choose(&self) -> Vec<Vec<f64>> {
        let (popsize, first) = (self.config.popsize, self.first_generations());
        let generation = usize::try_from(self.generation).unwrap_or(usize::MAX);
        match &self.model {
            Some(model) if generation >= first => {
                let stream = |candidate| stream(self.seed, Purpose::Acquisition, self.generation, candidate as u64);
                model.candidates(&self.points, popsize, stream)
            }
            _ => {
                let mut stream = stream(self.seed, Purpose::FirstPoints, 0, 0);
                let mut points = vec![self.start.clone()];
                points.extend(hypercube(&self.start, first * popsize - 1, &mut stream));
                points.into_iter().skip(generation * popsize).take(popsize).collect()
            }
        }
    }

    fn refit(&mut self) {
        self.asked = None;
        self.model = Model::new(&self.points, &self.scores, FAILED);
    }
}

impl Search for Bo {
    fn dimension(&self) -> usize {
        self.start.len()
    }

    fn ask(&mut self) -> Vec<Vec<f64>> {
        let asked = self.asked.take().unwrap_or_else(|| self.choose());
        self.asked.insert(asked).clone()
    }

    fn tell(&mut self, scores: &[f64]) -> Result<(), SearchError> {
        let scores = sound_or_failed(scores, self.config.popsize, self.generation, self.model.is_some())?;
        let asked = self.ask();
        self.points.extend(asked.into_iter().take(scores.len()));
        self.scores.extend(scores.into_iter().map(|s| s.map_or(FAILED, |s| s.clamp(-LARGEST, LARGEST))));
        self.generation += 1;
        self.refit();
        Ok(())
    }

    /// The point tried whose mean is best.
    fn center(&self) -> Vec<f64> {
        self.model.as_ref().map_or(&self.start, |model| &self.points[model.best]).clone()
    }

    fn generation(&self) -> u64 {
        self.generation
    }

    fn group(&self, _candidate: usize) -> u64 {
        0
    }
}

impl Persist for Bo {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        with.number("generation", &mut self.generation)?;
        with.series("scores", &mut self.scores)?;
        let (n, popsize) = (self.start.len(), self.config.popsize as u64);
        let count = self.scores.len() as u64;
        if !(self.generation..=self.generation.saturating_mul(popsize)).contains(&count) || count > MOST_POINTS as u64 {
            return Err(with.refuse(
                "scores",
                count as f64,
                "as many as the generations have candidates, at most 2000",
            ));
        }
        let mut points = if with.loads() { vec![0.0; n * self.scores.len()] } else { self.points.concat() };
        with.vector("points", &mut points)?;
        if let Some(&x) = points.iter().find(|x| !(0.0..=1.0).contains(*x)) {
            return Err(with.refuse("points", x, "within [0, 1]"));
        }
        if with.loads() {
            self.points = points.chunks_exact(n).map(<[f64]>::to_vec).collect();
            self.scores.iter_mut().filter(|s| **s != FAILED).for_each(|s| *s = s.clamp(-LARGEST, LARGEST));
            self.refit();
        }
        Ok(())
    }
}
