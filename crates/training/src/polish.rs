//! A training from its beginning to its end: the main stage, by gradients or by a search, and the polish of its controller
//! where the experiment asks for one.
//!
//! A polish is an ordinary training by gradients that begins with the trained controller: of an
//! [assembly](Assembly::polish) whose design is fixed as built, in the world where the result has to work, with a fresh
//! learner. Counters and clock go on.

use hwasp_algos::Archive;

use crate::assemble::{Assembly, MainStage};
use crate::checkpoint::Checkpoint;
use crate::error::TrainError;
use crate::gradient::{Gradient, gradient};
use crate::learned::{Learned, LoopContext};
use crate::search::{best_so_far, search};

/// Trains from the beginning, or from where it was interrupted in one of its stages.
pub(crate) fn learn(
    assembly: &Assembly,
    run: &mut LoopContext<'_>,
    from: Option<&Archive>,
) -> Result<Learned, TrainError> {
    if let Some(archive) = from
        && let Some(polish) = polish_at(assembly, archive)?
    {
        let state = Gradient::new(&polish, from)?;
        run.begin(&polish, &state.learned, true)?;
        return finish(&polish, state, run);
    }
    let main = assembly.main_stage();
    let by = if main.experiment().method.searches() { search } else { gradient };
    let mut learned = by(&main, run, from)?;
    if !assembly.polishes() {
        return Ok(learned);
    }
    let (params, env_steps) = (std::mem::take(&mut learned.params), learned.env_steps);
    let polish = assembly.polish(MainStage { params, env_steps })?;
    let mut state = Gradient::further(&polish, polish.init(), env_steps);
    state.learned = learned;
    finish(&polish, state, run)
}

/// Polishes to the end of the budget.
fn finish(polish: &Assembly, state: Gradient<'_>, run: &mut LoopContext<'_>) -> Result<Learned, TrainError> {
    let mut learned = state.follow(run)?;
    if polish.policy.controller_params(&learned.params) == polish.policy.controller_params(&polish.init()) {
        tracing::warn!(
            "the polish has not changed the controller: it had {} steps, and a learner that keeps experience waits for as many as its \
             warmup_steps; give it more by polish.share",
            learned.env_steps - polish.main_steps()
        );
    }
    learned.polish_steps = Some(learned.env_steps - polish.main_steps());
    learned.params = polish.whole(learned.params);
    Ok(learned)
}

/// The polish that goes on from a state; none where it is one of the main stage.
fn polish_at(assembly: &Assembly, archive: &Archive) -> Result<Option<Assembly>, TrainError> {
    Ok(assembly.main_at(archive)?.map(|main| assembly.polish(main)).transpose()?)
}

/// The training that goes on from a checkpoint: the main stage, or the polish.
pub fn stage_at(assembly: &Assembly, checkpoint: &Checkpoint) -> Result<Assembly, TrainError> {
    Ok(polish_at(assembly, &checkpoint.archive)?.unwrap_or_else(|| assembly.main_stage()))
}

/// The parameters that a training had come to: the learner's, or the best of a search.
pub fn params_at(assembly: &Assembly, checkpoint: &Checkpoint) -> Result<Vec<f32>, TrainError> {
    let (stage, archive) = (stage_at(assembly, checkpoint)?, &checkpoint.archive);
    if stage.experiment().method.searches() {
        return best_so_far(&stage, archive);
    }
    Ok(stage.whole(Gradient::new(&stage, Some(archive))?.params()))
}
