//! Value functions of state and action, in pairs.

use hwasp_algos::{Adam, AdamConfig, Exchange, Persist, StateError};
use hwasp_core::{Purpose, stream};
use hwasp_diff::{Activation, Mlp};
use rand::RngExt;

/// A network with its target.
#[derive(Clone, Debug)]
pub(crate) struct Critic {
    pub(crate) params: Vec<f32>,
    /// What the targets are computed with: it follows slowly.
    pub(crate) target: Vec<f32>,
    pub(crate) adam: Adam,
}

/// Critics that judge the same and were born different.
#[derive(Clone, Debug)]
pub(crate) struct Critics {
    pub(crate) network: Mlp,
    pub(crate) each: [Critic; 2],
}

impl Critics {
    /// Of `width` inputs; near zero everywhere at first.
    pub(crate) fn new(width: usize, hidden: &[usize], layer_norm: bool, seed: u64) -> Self {
        let mut sizes = vec![width];
        sizes.extend(hidden);
        sizes.push(1);
        let network = Mlp::new(&sizes, Activation::Relu, Activation::Identity).with_layer_norm(layer_norm);
        let each = [0, 1].map(|i| {
            let mut weights = stream(seed, Purpose::Critic, 0, i);
            let params = network.init(0.1, || weights.random::<f64>());
            Critic { target: params.clone(), adam: Adam::new(AdamConfig::default(), params.len()), params }
        });
        Self { network, each }
    }
}

/// θ' ← (1 - τ)·θ' + τ·θ (Polyak averaging; Lillicrap et al. 2016, algorithm 1).
pub(crate) fn follow(target: &mut [f32], params: &[f32], tau: f64) {
    let tau = tau as f32;
    for (target, param) in target.iter_mut().zip(params) {
        *target += tau * (param - *target);
    }
}

impl Persist for Critic {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        with.vector("params", &mut self.params)?;
        with.vector("target", &mut self.target)?;
        with.part("adam", &mut self.adam)
    }
}

impl Persist for Critics {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        for (name, critic) in ["first", "second"].into_iter().zip(&mut self.each) {
            with.part(name, critic)?;
        }
        Ok(())
    }
}
