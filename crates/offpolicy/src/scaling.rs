//! What critics see, brought to the size of 1.

use hwasp_algos::{Exchange, Persist, StateError};
use hwasp_core::Policy;

use crate::replay::{Dims, Replay};

/// Centre and scale of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Affine {
    pub(crate) center: f32,
    pub(crate) scale: f32,
}

impl Affine {
    #[inline]
    pub(crate) fn apply(self, x: f32) -> f32 {
        (x - self.center) / self.scale
    }
}

/// Centre and scale of all that a critic sees beside the controller's input, and the size of values. It is taken once, of the
/// steps that are there before the first update, and stays: a critic that saw the same moment in another size would have to
/// learn it anew.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Scaling {
    pub(crate) state: Vec<Affine>,
    /// What critics see of the scaled state is this lower triangle times it, `[state × state]` row by row: of each number what those
    /// before it do not tell. An effort goes with the gap between two bodies, and a critic that sees the gap as a small difference of
    /// large positions takes the one for the other.
    pub(crate) mix: Vec<f32>,
    pub(crate) context: Vec<Affine>,
    /// Commands and designs by their limits, efforts by twice the spread of their noise: a critic has to tell what the noise does
    /// from what the command does.
    pub(crate) action: Vec<Affine>,
    /// What critics say, 0 and 1, is this value and the first plus the second: mean and spread of the returns that were seen. A critic
    /// that began at 0 would take steps by the thousands to learn what every state is worth alike.
    pub(crate) value: (f64, f64),
    pub(crate) taken: bool,
}

impl Scaling {
    /// Before anything was seen.
    pub(crate) fn new(dims: Dims) -> Self {
        let one = Affine { center: 0.0, scale: 1.0 };
        Self {
            state: vec![one; dims.state],
            mix: identity(dims.state),
            context: vec![one; dims.context],
            action: vec![one; dims.action],
            value: (0.0, 1.0),
            taken: false,
        }
    }

    /// That of what a replay holds.
    pub(crate) fn of<P: Policy>(replay: &Replay, (policy, params): (&P, &[f32]), discount: f64) -> Self {
        let dims = Dims::of(policy);
        let frames = replay.step_frames();
        let each = |row: &dyn Fn(usize) -> f32| -> Affine {
            let n = frames.clone().count() as f64;
            let mean = frames.clone().map(|i| f64::from(row(i))).sum::<f64>() / n;
            let square = frames.clone().map(|i| (f64::from(row(i)) - mean).powi(2)).sum::<f64>() / n;
            let std = square.sqrt() as f32;
            Affine { center: mean as f32, scale: if std > 1e-6 { std } else { 1.0 } }
        };
        let state: Vec<Affine> = (0..dims.state).map(|s| each(&|i| replay.state(i)[s])).collect();
        let scaled =
            frames.clone().map(|i| state.iter().zip(replay.state(i)).map(|(a, &x)| f64::from(a.apply(x))).collect());
        let mix = whitening(dims.state, &scaled.collect::<Vec<_>>());
        let (limits, mut log_std) = (policy.action_limits(), vec![0.0; dims.action]);
        policy.log_std(params, 0.0, &mut log_std);
        Self {
            state,
            mix,
            context: (0..dims.context).map(|c| each(&|i| replay.context(i)[c])).collect(),
            action: (0..dims.action)
                .map(|a| match limits[a] {
                    Some((lo, hi)) => Affine { center: 0.5 * (lo + hi), scale: 0.5 * (hi - lo) },
                    None => Affine { center: 0.0, scale: 2.0 * log_std[a].exp() },
                })
                .collect(),
            value: values(replay, discount),
            taken: true,
        }
    }
}

/// The least deviation that a number is taken to have beside those before it: less would be blown up, and what is later there
/// may vary more.
const LEAST_RESIDUAL: f64 = 0.2;

fn identity(size: usize) -> Vec<f32> {
    let mut matrix = vec![0.0; size * size];
    matrix.iter_mut().step_by(size + 1).for_each(|x| *x = 1.0);
    matrix
}

/// L⁻¹ of the correlations L·Lᵀ between the numbers of each row (Cholesky).
fn whitening(size: usize, rows: &[Vec<f64>]) -> Vec<f32> {
    let (mut lower, mut inverse) = (vec![0.0; size * size], vec![0.0; size * size]);
    for i in 0..size {
        for j in 0..=i {
            let product = rows.iter().map(|row| row[i] * row[j]).sum::<f64>() / rows.len().max(1) as f64;
            let told: f64 = (0..j).map(|k| lower[i * size + k] * lower[j * size + k]).sum();
            let left = product - told;
            lower[i * size + j] =
                if i == j { left.max(LEAST_RESIDUAL.powi(2)).sqrt() } else { left / lower[j * size + j] };
        }
        let own = lower[i * size + i];
        for j in 0..i {
            let told: f64 = (j..i).map(|k| lower[i * size + k] * inverse[k * size + j]).sum();
            inverse[i * size + j] = -told / own;
        }
        inverse[i * size + i] = 1.0 / own;
    }
    inverse.into_iter().map(|x| x as f32).collect()
}

/// Mean and spread of the returns of all steps. What follows a cut episode counts as the mean itself:
/// m = E[R] + E[γ^rest]·m.
fn values(replay: &Replay, discount: f64) -> (f64, f64) {
    let returns = replay.returns(discount);
    let n = returns.len().max(1) as f64;
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| returns.iter().map(of).sum::<f64>() / n;
    let (earned, rest) = (mean(&|r| r.0), mean(&|r| r.1));
    let center = earned / (1.0 - rest).max(1e-3);
    let spread = mean(&|r| (r.0 + r.1 * center - center).powi(2)).sqrt();
    (center, if spread > 1e-6 { spread } else { 1.0 })
}

impl Persist for Scaling {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        let mut taken = u64::from(self.taken);
        with.number("taken", &mut taken)?;
        self.taken = taken != 0;
        with.number("value_center", &mut self.value.0)?;
        with.number("value_scale", &mut self.value.1)?;
        with.vector("mix", &mut self.mix)?;
        for (name, all) in [("state", &mut self.state), ("context", &mut self.context), ("action", &mut self.action)] {
            let mut pairs: Vec<f32> = all.iter().flat_map(|affine| [affine.center, affine.scale]).collect();
            with.vector(name, &mut pairs)?;
            for (affine, pair) in all.iter_mut().zip(pairs.chunks_exact(2)) {
                *affine = Affine { center: pair[0], scale: pair[1] };
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// y = x + d with x = ±1 and d = ±0.5 by themselves: in units of their deviations the correlation is 1/√1.25, and what is left of
    /// y beside x is d.
    #[test]
    fn what_is_left_of_a_number_is_what_those_before_it_do_not_tell() {
        let y = |x: f64, d: f64| (x + d) / 1.25_f64.sqrt();
        let signs = [(1.0, 0.5), (1.0, -0.5), (-1.0, 0.5), (-1.0, -0.5)];
        let rows: Vec<Vec<f64>> = signs.iter().map(|&(x, d)| vec![x, y(x, d)]).collect();
        let mix = whitening(2, &rows);
        assert_eq!((mix[0], mix[1]), (1.0, 0.0));
        for (row, (_, d)) in rows.iter().zip(signs) {
            let seen = f64::from(mix[2]) * row[0] + f64::from(mix[3]) * row[1];
            assert!((seen - d / 0.5).abs() < 1e-6, "{seen} of {d}");
        }
        // What hardly differs is not blown up: a copy is seen as nothing.
        let copies: Vec<Vec<f64>> = [1.0, -1.0].map(|x| vec![x, x]).to_vec();
        let mix = whitening(2, &copies);
        assert_eq!(mix[2..], [-5.0, 5.0]);
        assert_eq!(whitening(2, &[]), [5.0, 0.0, 0.0, 5.0]);
    }
}
