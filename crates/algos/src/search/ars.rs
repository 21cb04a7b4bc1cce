//! Augmented random search (Mania, Guy and Recht, "Simple random search provides a competitive approach to reinforcement
//! learning", 2018).

use hwasp_core::{Purpose, stream};
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

use crate::archive::{Exchange, Persist, StateError};

use super::{Search, SearchError, check_limits, failed_last, limits};

/// Settings of [`Ars`]: V1 with all directions, V1-t with the best of them. V2 and V2-t are the same search with a
/// [`StateFilter`](super::StateFilter) before the controller.
///
/// | name | symbol | default | purpose |
/// |---|---|---|---|
/// | `directions` | N | 32 | directions tried per generation, each both ways |
/// | `top` | b | 16 | the best of them, which count; N for V1 and V2 |
/// | `step_size` | α | 0.05 | length of a step, in units of the scores' standard deviation |
/// | `noise_std` | ν | 0.1 | how far candidates are from the centre, per parameter |
/// | `lower`, `upper` | | none | limits of the coordinates; infinite where there is none |
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ArsConfig {
    /// Directions tried per generation, N.
    pub directions: usize,
    /// The best of them, which count, b.
    pub top: usize,
    /// Length of a step, α.
    pub step_size: f64,
    /// How far candidates are from the centre, ν.
    pub noise_std: f64,
    /// Smallest value of each coordinate; may be `-∞`.
    pub lower: Option<Vec<f64>>,
    /// Largest value of each coordinate; may be `∞`.
    pub upper: Option<Vec<f64>>,
}

impl Default for ArsConfig {
    fn default() -> Self {
        Self { directions: 32, top: 16, step_size: 0.05, noise_std: 0.1, lower: None, upper: None }
    }
}

/// Random search along the best of N antithetic directions (algorithm 1). Candidates 2i and 2i + 1 are centre ± ν·δᵢ and
/// share their episodes. The directions are not kept: their streams give them again.
///
/// Where coordinates have limits, candidates and centre are moved inside them, and a step goes along what was tried,
/// (x⁺ - x⁻)/2ν in the place of δ: a coordinate that a limit stopped both ways at once was not tried and does not move.
#[derive(Clone, Debug, PartialEq)]
pub struct Ars {
    config: ArsConfig,
    seed: u64,
    /// The parameters, M.
    center: Vec<f64>,
    /// Generations told.
    generation: u64,
}

impl ArsConfig {
    /// Lower and upper limit of coordinate `i`.
    fn bound(&self, i: usize) -> (f64, f64) {
        limits(self.lower.as_deref(), self.upper.as_deref(), i)
    }
}

impl Ars {
    /// Starts from `center`; `seed` names the streams.
    pub fn new(config: ArsConfig, center: Vec<f64>, seed: u64) -> Result<Self, SearchError> {
        let whole = |name, value: usize, sound, limits| {
            if sound { Ok(()) } else { Err(SearchError::Setting { name, value: value as f64, limits }) }
        };
        whole("directions", config.directions, config.directions > 0, "at least 1")?;
        let top = (1..=config.directions).contains(&config.top);
        whole("top", config.top, top, "between 1 and the number of directions")?;
        for (name, value) in [("step_size", config.step_size), ("noise_std", config.noise_std)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(SearchError::Setting { name, value, limits: "a positive finite number" });
            }
        }
        check_limits(config.lower.as_deref(), config.upper.as_deref(), center.len())?;
        for (i, &value) in center.iter().enumerate() {
            let (lower, upper) = config.bound(i);
            if value < lower || value > upper {
                return Err(SearchError::Setting { name: "start", value, limits: "inside of the bounds" });
            }
        }
        Ok(Self { config, seed, center, generation: 0 })
    }

    /// δ of a direction of this generation.
    fn direction(&self, i: usize) -> impl Iterator<Item = f64> + use<> {
        let mut stream = stream(self.seed, Purpose::Search, self.generation, i as u64);
        (0..self.center.len()).map(move |_| StandardNormal.sample(&mut stream))
    }

    /// A point, each of its coordinates moved to the next one inside the limits.
    fn inside(&self, mut point: Vec<f64>) -> Vec<f64> {
        if self.config.lower.is_some() || self.config.upper.is_some() {
            for (i, x) in point.iter_mut().enumerate() {
                let (lower, upper) = self.config.bound(i);
                *x = x.clamp(lower, upper);
            }
        }
        point
    }

    /// The candidate so far from the centre along a direction.
    fn candidate(&self, i: usize, step: f64) -> Vec<f64> {
        self.inside(self.center.iter().zip(self.direction(i)).map(|(m, d)| m + step * d).collect())
    }

    /// A direction as it was tried, in units of ν: δ itself where no limit stopped a candidate.
    fn tried(&self, i: usize) -> Vec<f64> {
        let noise = self.config.noise_std;
        let pairs = self.candidate(i, noise).into_iter().zip(self.candidate(i, -noise));
        let moved = self.center.iter().zip(self.direction(i)).zip(pairs);
        let tried = moved.map(|((m, d), (plus, minus))| {
            let free = plus == m + noise * d && minus == m - noise * d;
            if free { d } else { (plus - minus) / (2.0 * noise) }
        });
        tried.collect()
    }
}

impl Search for Ars {
    fn dimension(&self) -> usize {
        self.center.len()
    }

    fn ask(&mut self) -> Vec<Vec<f64>> {
        let noise = self.config.noise_std;
        (0..self.config.directions).flat_map(|i| [self.candidate(i, noise), self.candidate(i, -noise)]).collect()
    }

    /// Algorithm 1, lines 6 and 7. A direction of which one way failed says nothing and is left out; so are all where the
    /// scores do not differ.
    fn tell(&mut self, scores: &[f64]) -> Result<(), SearchError> {
        let scores = failed_last(scores, 2 * self.config.directions, self.generation)?;
        let mut pairs: Vec<(usize, f64, f64)> =
            scores.chunks_exact(2).enumerate().map(|(i, pair)| (i, pair[0], pair[1])).collect();
        pairs.retain(|(_, plus, minus)| plus.is_finite() && minus.is_finite());
        // A stable sort: equal directions keep their order.
        pairs.sort_by(|a, b| b.1.max(b.2).total_cmp(&a.1.max(a.2)));
        pairs.truncate(self.config.top);
        let kept = || pairs.iter().flat_map(|&(_, plus, minus)| [plus, minus]);
        let count = (2 * pairs.len()).max(1) as f64;
        let mean = kept().sum::<f64>() / count;
        let std = (kept().map(|r| (r - mean).powi(2)).sum::<f64>() / count).sqrt();
        if std > 0.0 {
            let step = self.config.step_size / (pairs.len() as f64 * std);
            let mut center = self.center.clone();
            for &(i, plus, minus) in &pairs {
                for (m, d) in center.iter_mut().zip(self.tried(i)) {
                    *m += step * (plus - minus) * d;
                }
            }
            self.center = self.inside(center);
        }
        self.generation += 1;
        Ok(())
    }

    fn center(&self) -> Vec<f64> {
        self.center.clone()
    }

    fn generation(&self) -> u64 {
        self.generation
    }

    fn group(&self, candidate: usize) -> u64 {
        candidate as u64 / 2
    }
}

impl Persist for Ars {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        with.vector("center", &mut self.center)?;
        with.number("generation", &mut self.generation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn search(config: ArsConfig) -> Ars {
        Ars::new(config, vec![1.0, -2.0, 0.5], 7).unwrap()
    }

    /// -|x|², whose best is the origin.
    fn scores(candidates: &[Vec<f64>]) -> Vec<f64> {
        candidates.iter().map(|x| -x.iter().map(|x| x * x).sum::<f64>()).collect()
    }

    /// Two directions, one kept: M + α/(b·σ)·(r⁺ - r⁻)·δ with b = 1 and σ the deviation of r⁺ and r⁻, |r⁺ - r⁻|/2, so that
    /// the step is 2·α·δ towards the better of the two.
    #[test]
    fn one_update_by_hand() {
        let config = ArsConfig { directions: 2, top: 1, step_size: 0.3, ..ArsConfig::default() };
        let mut ars = search(config);
        let asked = ars.ask();
        let delta: Vec<f64> = (0..3).map(|j| (asked[2][j] - asked[3][j]) / 0.2).collect();
        for j in 0..3 {
            let middle = 0.5 * (asked[0][j] + asked[1][j]);
            assert!((middle - [1.0, -2.0, 0.5][j]).abs() < 1e-12, "candidates of a pair are opposite");
        }
        // The second direction has the best score, on its minus side.
        ars.tell(&[3.0, 4.0, 1.0, 9.0]).unwrap();
        for j in 0..3 {
            let wanted = [1.0, -2.0, 0.5][j] - 2.0 * 0.3 * delta[j];
            assert!((ars.center()[j] - wanted).abs() < 1e-12, "{} is not {wanted}", ars.center()[j]);
        }
        assert_eq!((ars.group(0), ars.group(1), ars.group(2)), (0, 0, 1));
    }

    /// A candidate beyond the limits was scored as the limit, but counted as what had been drawn: the centre went out of
    /// [0, 1], where both ways of a direction are the same design and only noise tells them apart, and never came back.
    #[test]
    fn what_a_limit_stopped_was_not_tried() {
        let (lower, upper) = (Some(vec![0.0, 0.0]), Some(vec![1.0, 1.0]));
        let config = ArsConfig { directions: 1, top: 1, step_size: 0.3, noise_std: 0.1, lower, upper };
        let start = [0.5, 1.0];
        let mut ars = Ars::new(config, start.to_vec(), 7).unwrap();
        for _ in 0..50 {
            let before = ars.center();
            let asked = ars.ask();
            assert!(asked.iter().flatten().all(|x| (0.0..=1.0).contains(x)), "{asked:?}");
            ars.tell(&[2.0, 1.0]).unwrap();
            // One direction and scores of 2 and 1: the step is 2·α along it, and the way tried is (x⁺ - x⁻)/2ν.
            for (j, (after, before)) in ars.center().into_iter().zip(before).enumerate() {
                let tried = (asked[0][j] - asked[1][j]) / 0.2;
                let wanted = (before + 2.0 * 0.3 * tried).clamp(0.0, 1.0);
                assert!((after - wanted).abs() < 1e-12, "coordinate {j}: {after} is not {wanted}");
            }
        }
    }

    /// A coordinate that both candidates of every direction have at the same limit stays where it is.
    #[test]
    fn a_coordinate_that_was_not_tried_does_not_move() {
        let (lower, upper) = (Some(vec![0.0, 0.5]), Some(vec![1.0, 0.5 + 1e-9]));
        let config = ArsConfig { lower, upper, ..ArsConfig::default() };
        let mut ars = Ars::new(config, vec![0.5; 2], 7).unwrap();
        let scores: Vec<f64> = ars.ask().iter().map(|x| x[0]).collect();
        ars.tell(&scores).unwrap();
        let [first, second] = ars.center()[..] else { panic!("two coordinates") };
        assert!(first > 0.5 && (second - 0.5).abs() <= 1e-9, "{first} and {second}");
    }

    /// Limits that nothing reaches change no bit.
    #[test]
    fn far_limits_change_nothing() {
        let (lower, upper) = (Some(vec![-1e9; 3]), Some(vec![1e9; 3]));
        let mut bounded = search(ArsConfig { lower, upper, ..ArsConfig::default() });
        let mut free = search(ArsConfig::default());
        for _ in 0..5 {
            let asked = free.ask();
            assert_eq!(bounded.ask(), asked);
            free.tell(&scores(&asked)).unwrap();
            bounded.tell(&scores(&asked)).unwrap();
        }
        assert_eq!(bounded.center(), free.center());
    }

    #[test]
    fn finds_the_best_of_a_quadratic() {
        let mut ars = search(ArsConfig { step_size: 0.02, noise_std: 0.02, ..ArsConfig::default() });
        for _ in 0..300 {
            let asked = ars.ask();
            ars.tell(&scores(&asked)).unwrap();
        }
        assert!(ars.center().iter().all(|x| x.abs() < 0.05), "{:?}", ars.center());
    }

    #[test]
    fn a_search_saved_between_ask_and_tell_goes_on_with_the_same_bits() {
        let mut whole = search(ArsConfig::default());
        let mut parts = whole.clone();
        for _ in 0..3 {
            let asked = whole.ask();
            whole.tell(&scores(&asked)).unwrap();
            let asked = parts.ask();
            let saved = parts.save().unwrap();
            parts = search(ArsConfig::default());
            parts.load(&saved).unwrap();
            assert_eq!(parts.ask(), asked);
            parts.tell(&scores(&asked)).unwrap();
        }
        assert_eq!(whole, parts);
    }

    /// A direction with a failed side is as if it had never been tried.
    #[test]
    fn failed_candidates_have_no_say() {
        let config = ArsConfig { directions: 3, top: 3, ..ArsConfig::default() };
        let told = |failed: f64, beside: f64| {
            let mut ars = search(config.clone());
            ars.tell(&[1.0, 2.0, failed, beside, 4.0, 3.0]).unwrap();
            ars.center()
        };
        assert_eq!(told(f64::NAN, 5.0), told(f64::NEG_INFINITY, -90.0));
        let mut ars = search(config);
        let before = ars.clone();
        assert!(matches!(ars.tell(&[f64::NAN; 6]), Err(SearchError::AllFailed { candidates: 6, generation: 0 })));
        assert!(matches!(ars.tell(&[0.0; 5]), Err(SearchError::Scores { found: 5, expected: 6 })));
        assert_eq!(ars, before);
    }

    #[test]
    fn settings_that_describe_no_search() {
        let refused = |config| Ars::new(config, vec![0.0], 1).unwrap_err().to_string();
        let base = ArsConfig::default();
        assert_eq!(
            refused(ArsConfig { top: 33, ..base.clone() }),
            "top = 33 is not between 1 and the number of directions"
        );
        let still = ArsConfig { noise_std: 0.0, ..base.clone() };
        assert_eq!(refused(still), "noise_std = 0 is not a positive finite number");
        let bounded = |lower: &[f64], upper: &[f64]| {
            refused(ArsConfig { lower: Some(lower.to_vec()), upper: Some(upper.to_vec()), ..base.clone() })
        };
        assert_eq!(bounded(&[-1.0; 2], &[1.0]), "lower = 2 is not as long as the mean");
        assert_eq!(bounded(&[1.0], &[-1.0]), "upper = -1 is not above the lower bound, at a finite distance");
        assert_eq!(bounded(&[0.5], &[1.0]), "start = 0 is not inside of the bounds");
    }
}
