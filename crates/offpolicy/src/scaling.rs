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
    pub(crate) context: Vec<Affine>,
    /// Commands and designs by their limits, efforts by what was seen of them.
    pub(crate) action: Vec<Affine>,
    /// Values are so many times what critics say: the root mean square of the returns that were seen.
    pub(crate) value: f64,
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
            value: 1.0,
            taken: false,
        }
    }

    /// That of what a replay holds.
    pub(crate) fn of(replay: &Replay, policy: &impl Policy, discount: f64) -> Self {
        let dims = Dims::of(policy);
        let frames = replay.step_frames();
        let each = |row: &dyn Fn(usize) -> f32| -> Affine {
            let n = frames.clone().count() as f64;
            let mean = frames.clone().map(|i| f64::from(row(i))).sum::<f64>() / n;
            let square = frames.clone().map(|i| (f64::from(row(i)) - mean).powi(2)).sum::<f64>() / n;
            let std = square.sqrt() as f32;
            Affine { center: mean as f32, scale: if std > 1e-6 { std } else { 1.0 } }
        };
        let returns = replay.returns(discount);
        let square = returns.iter().map(|r| r * r).sum::<f64>() / returns.len().max(1) as f64;
        let limits = policy.action_limits();
        Self {
            state: (0..dims.state).map(|s| each(&|i| replay.state(i)[s])).collect(),
            context: (0..dims.context).map(|c| each(&|i| replay.context(i)[c])).collect(),
            action: (0..dims.action)
                .map(|a| match limits[a] {
                    Some((lo, hi)) => Affine { center: 0.5 * (lo + hi), scale: 0.5 * (hi - lo) },
                    None => each(&|i| replay.action(i)[a]),
                })
                .collect(),
            value: if square > 0.0 { square.sqrt() } else { 1.0 },
            taken: true,
        }
    }
}

impl Persist for Scaling {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        let mut taken = u64::from(self.taken);
        with.number("taken", &mut taken)?;
        self.taken = taken != 0;
        with.number("value", &mut self.value)?;
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
