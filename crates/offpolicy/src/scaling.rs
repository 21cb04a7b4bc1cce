//! What critics see, brought to the size of 1.

use hwasp_algos::{Exchange, Persist, StateError};
use hwasp_core::Policy;

use crate::config::ReplayConfig;
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
    pub(crate) context: Vec<Affine>,
    /// Commands and designs by their limits, efforts by twice the spread of their noise: a critic has to tell what the noise does
    /// from what the command does.
    pub(crate) action: Vec<Affine>,
    /// What critics say, 0 and 1, is this value and the first plus the second: mean and spread of the returns that were seen, or what
    /// [they](ReplayConfig::initial_value) [are told](ReplayConfig::value_scale). A critic that began at 0 whatever the returns are
    /// would take steps by the thousands to learn what every state is worth alike.
    pub(crate) value: (f64, f64),
    pub(crate) taken: bool,
}

impl Scaling {
    /// Before anything was seen.
    pub(crate) fn new(dims: Dims) -> Self {
        let one = Affine { center: 0.0, scale: 1.0 };
        Self {
            state: vec![one; dims.state],
            context: vec![one; dims.context],
            action: vec![one; dims.action],
            value: (0.0, 1.0),
            taken: false,
        }
    }

    /// That of what a replay holds.
    pub(crate) fn of<P: Policy>(replay: &Replay, (policy, params): (&P, &[f32]), settings: &ReplayConfig) -> Self {
        let dims = Dims::of(policy);
        let frames = replay.step_frames();
        let each = |row: &dyn Fn(usize) -> f32| -> Affine {
            let n = frames.clone().count() as f64;
            let mean = frames.clone().map(|i| f64::from(row(i))).sum::<f64>() / n;
            let square = frames.clone().map(|i| (f64::from(row(i)) - mean).powi(2)).sum::<f64>() / n;
            let std = square.sqrt() as f32;
            Affine { center: mean as f32, scale: if std > 1e-6 { std } else { 1.0 } }
        };
        let (limits, mut log_std) = (policy.action_limits(), vec![0.0; dims.action]);
        policy.log_std(params, 0.0, &mut log_std);
        let (mean, spread) = values(replay, settings.discount);
        Self {
            state: (0..dims.state).map(|s| each(&|i| replay.state(i)[s])).collect(),
            context: (0..dims.context).map(|c| each(&|i| replay.context(i)[c])).collect(),
            action: (0..dims.action)
                .map(|a| match limits[a] {
                    Some((lo, hi)) => Affine { center: 0.5 * (lo + hi), scale: 0.5 * (hi - lo) },
                    None => Affine { center: 0.0, scale: 2.0 * log_std[a].exp() },
                })
                .collect(),
            value: (settings.initial_value.unwrap_or(mean), settings.value_scale.unwrap_or(spread)),
            taken: true,
        }
    }
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
