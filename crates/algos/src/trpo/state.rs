//! What a training needs to go on.

use std::sync::Arc;

use hwasp_core::Policy;
use serde::{Deserialize, Serialize};

use super::{Trpo, TrpoSettings};
use crate::baseline::BaselineState;
use crate::learner::LearnError;

/// All that [`Trpo`] has learned. With settings, policy and seed it goes on to the same bits; progress and iteration are
/// the caller's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrpoState {
    /// The policy's parameters.
    pub params: Vec<f32>,
    /// The value baseline.
    pub baseline: BaselineState,
    /// Updates so far that took no step.
    pub rejected: u64,
}

impl<P: Policy> Trpo<P> {
    /// What it has learned.
    pub fn state(&self) -> TrpoState {
        TrpoState { params: self.params.clone(), baseline: self.baseline.state(), rejected: self.rejected }
    }

    /// Goes on from a saved state, with the bits of a training that was never interrupted.
    ///
    /// # Errors
    /// [`LearnError::State`] or [`LearnError::Baseline`] where the state is not one of this policy and these settings.
    pub fn resume(settings: &TrpoSettings, policy: Arc<P>, state: TrpoState, seed: u64) -> Result<Self, LearnError> {
        LearnError::check_length("parameters", state.params.len(), policy.param_count())?;
        let mut trpo = Self::new(settings, policy, state.params, seed);
        trpo.baseline.restore(state.baseline)?;
        trpo.rejected = state.rejected;
        Ok(trpo)
    }
}
