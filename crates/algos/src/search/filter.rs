//! The state filter of ARS V2.

use hwasp_core::Moments;

use crate::archive::{Exchange, Persist, StateError};

/// Running mean and deviation of what the controller sees (Mania et al. 2018, section 3.2): ARS V2 centres and scales its
/// input by them. Not seen by the search itself: it is folded into the first layer of every candidate.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StateFilter {
    seen: Moments,
}

impl StateFilter {
    /// For observations of `dim` components. It changes nothing until it has seen some.
    pub fn new(dim: usize) -> Self {
        Self { seen: Moments::new(dim) }
    }

    /// One for the same observations that has seen none.
    pub fn blank(&self) -> Self {
        Self::new(self.seen.mean.len())
    }

    /// Takes in observations, row by row.
    pub fn update(&mut self, obs: &[f32]) {
        let dim = self.seen.mean.len();
        let mut part = Moments::new(dim);
        part.count = (obs.len() / dim.max(1)) as f64;
        if part.count == 0.0 {
            return;
        }
        for j in 0..dim {
            let column = || obs.iter().skip(j).step_by(dim).map(|&o| f64::from(o));
            let mean = column().sum::<f64>() / part.count;
            part.mean[j] = mean;
            part.squares[j] = column().map(|o| (o - mean).powi(2)).sum();
        }
        self.seen.merge(&part);
    }

    /// Takes in what another one has seen.
    pub fn join(&mut self, other: &Self) {
        self.seen.merge(&other.seen);
    }

    /// Rewrites the first layer of a perceptron (weights `[dim × width]` row by row, then biases `[width]`, at the front
    /// of `params`), so that it does to an observation o what it did to (o - mean)/std. Components that never changed
    /// are only centred.
    pub fn fold(&self, params: &mut [f32], width: usize) {
        if self.seen.count < 2.0 {
            return;
        }
        let (weights, biases) = params.split_at_mut(self.seen.mean.len() * width);
        for ((row, mean), variance) in weights.chunks_exact_mut(width).zip(&self.seen.mean).zip(self.seen.variances()) {
            let std = if variance > 1e-12 { variance.sqrt() } else { 1.0 };
            for (weight, bias) in row.iter_mut().zip(&mut *biases) {
                let scaled = f64::from(*weight) / std;
                *weight = scaled as f32;
                *bias = (f64::from(*bias) - scaled * mean) as f32;
            }
        }
    }
}

impl Persist for StateFilter {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        self.seen.exchange(with)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_give_what_the_whole_gives() {
        let obs: Vec<f32> = (0..60).map(|i| (i * 37 % 41) as f32 / 7.0).collect();
        let mut whole = StateFilter::new(2);
        whole.update(&obs);
        let mut parts = StateFilter::new(2);
        for chunk in [&obs[..6], &obs[6..50], &[], &obs[50..]] {
            parts.update(chunk);
        }
        let column: Vec<f64> = obs.iter().step_by(2).map(|&o| f64::from(o)).collect();
        let mean = column.iter().sum::<f64>() / 30.0;
        let squares: f64 = column.iter().map(|o| (o - mean).powi(2)).sum();
        let mut joined = StateFilter::new(2);
        for chunk in [&obs[..6], &[], &obs[6..]] {
            let mut part = StateFilter::new(2);
            part.update(chunk);
            joined.join(&part);
        }
        for filter in [&whole, &parts, &joined] {
            assert!((filter.seen.mean[0] - mean).abs() < 1e-12);
            assert!((filter.seen.squares[0] - squares).abs() < 1e-9);
        }
    }

    #[test]
    fn a_folded_layer_does_to_an_observation_what_it_did_to_the_filtered_one() {
        let mut filter = StateFilter::new(2);
        filter.update(&[1.0, 4.0, 3.0, 4.0]); // means 2 and 4, deviations 1 and none
        let params = [0.5, -1.0, 2.0, 0.25, 0.1, 0.2]; // two inputs, width two
        let mut folded = params;
        filter.fold(&mut folded, 2);
        let layer = |p: &[f32; 6], o: [f32; 2]| [o[0] * p[0] + o[1] * p[2] + p[4], o[0] * p[1] + o[1] * p[3] + p[5]];
        let (seen, filtered) = ([5.0, 4.5], [3.0, 0.5]);
        let (a, b) = (layer(&folded, seen), layer(&params, filtered));
        assert!((a[0] - b[0]).abs() < 1e-6 && (a[1] - b[1]).abs() < 1e-6, "{a:?} against {b:?}");
        let mut untouched = params;
        StateFilter::new(2).fold(&mut untouched, 2);
        assert_eq!(untouched, params);
    }
}
