//! Methods that search: over controller and design at once, or over the design with a training inside.

mod generation;
mod space;
mod state;

use hwasp_algos::Archive;
use hwasp_core::NoiseSizes;

use self::generation::{Generation, Scoring};
use self::space::SearchSpace;
use self::state::{Scored, State};
use crate::assemble::{Assembly, FINAL_EPISODES};
use crate::error::TrainError;
use crate::learned::{Learned, LoopContext};
use crate::observer::Event;
use crate::returns::{Ended, Returns};

/// Searches until the budget holds no further generation, or no part of one, from the beginning or from where a search was
/// interrupted.
pub(crate) fn search(
    assembly: &Assembly,
    run: &mut LoopContext<'_>,
    from: Option<&Archive>,
) -> Result<Learned, TrainError> {
    let space = SearchSpace::new(assembly);
    let mut state = space.state(from)?;
    run.begin(assembly, &state.learned, from.is_some())?;
    while state.search.stopped().is_none() {
        let mut candidates = state.search.ask();
        candidates.truncate(assembly.affordable(candidates.len(), state.learned.env_steps));
        if candidates.is_empty() {
            break;
        }
        let scored = Generation { space: &space, candidates: &candidates }.score(&mut state, run)?;
        tell(&space, &mut state, scored, run)?;
        if run.observer.due() {
            run.observer.on(Event::Checkpoint(&state.checkpoint(run.clock)?))?;
        }
    }
    // What is left to do, an evaluation, may be long.
    run.observer.on(Event::Checkpoint(&state.checkpoint(run.clock)?))?;
    outcome(space, state, run)
}

/// The parameters of the best candidate that an interrupted search had found; those of the start where none was scored.
pub(crate) fn best_so_far(assembly: &Assembly, from: &Archive) -> Result<Vec<f32>, TrainError> {
    let space = SearchSpace::new(assembly);
    let best = space.state(Some(from))?.best;
    Ok(best.map_or(space.start, |(_, params)| params))
}

/// Goes on to the next generation.
fn tell(
    space: &SearchSpace<'_>,
    state: &mut State,
    scored: Vec<Scored>,
    run: &mut LoopContext<'_>,
) -> Result<(), TrainError> {
    let generation = state.search.generation();
    let learned = &mut state.learned;
    learned.env_steps += scored.iter().map(|s| s.env_steps).sum::<u64>();
    learned.discarded_episodes += scored.iter().map(|s| s.discarded_episodes).sum::<u64>();
    if let Some(filter) = &mut state.filter {
        for seen in scored.iter().filter_map(|candidate| candidate.seen.as_ref()) {
            filter.join(seen);
        }
    }
    // A last generation may be one candidate alone.
    let may_fail = space.assembly.experiment().method.divides_generations() && state.best.is_some();
    learned.failed_candidates += note_failures(learned, &scored, generation, may_fail)?;
    let scores: Vec<f64> = scored.iter().map(|s| space.score(s)).collect();
    state.search.tell(&scores)?;
    let sound: Vec<&Returns> = scored.iter().filter_map(|candidate| candidate.returns.as_ref()).collect();
    let returns = (!sound.is_empty()).then(|| Returns::mean(&sound));
    // Of a candidate's training the episodes are not counted.
    let spec = space.assembly.experiment();
    let each = if spec.method.trains_inside() { f64::NAN } else { spec.search.episodes as f64 };
    let episodes = each * sound.len() as f64;
    let steps: u64 = scored.iter().filter(|candidate| candidate.returns.is_some()).map(|sound| sound.env_steps).sum();
    let ended = Ended { episodes, steps: steps as f64 / episodes, returns };
    for (candidate, score) in scored.into_iter().zip(scores) {
        if state.best.as_ref().is_none_or(|(most, _)| score > *most) {
            state.best = Some((score, candidate.params));
        }
    }
    let policy = &space.assembly.policy;
    let totals = policy.space().totals(&policy.design(&space.params(&state.search.center())));
    Ok(learned.record(ended, (Vec::new(), NoiseSizes::default()), totals, run)?)
}

/// How many candidates failed. The first of a search is kept and warned of; where all of a generation failed and they may not, it
/// is the error.
fn note_failures(learned: &mut Learned, scored: &[Scored], generation: u64, may_fail: bool) -> Result<u64, TrainError> {
    let failures: Vec<_> = scored.iter().enumerate().filter_map(|(i, s)| Some((i, s.failure()?))).collect();
    let Some((candidate, first)) = failures.first() else { return Ok(0) };
    if failures.len() == scored.len() && !may_fail {
        let alike = failures.iter().filter(|(_, failure)| failure.cause == first.cause).count();
        let (candidates, first) = (scored.len(), first.text.clone());
        return Err(TrainError::AllFailed { candidates, generation, alike, first });
    }
    if learned.first_failure.is_none() {
        let text = &first.text;
        tracing::warn!(
            "candidate {candidate} of generation {generation} failed and ranks last: {text}; the search goes on, and the \
             summary counts those that fail"
        );
        learned.first_failure = Some(text.clone());
    }
    Ok(failures.len() as u64)
}

/// What a search came to: the best candidate, whose controller was trained for it; or the better of that and the last
/// centre, on the same fresh episodes.
fn outcome(space: SearchSpace<'_>, state: State, run: &LoopContext<'_>) -> Result<Learned, TrainError> {
    let State { search, filter, best, mut learned, .. } = state;
    learned.params = match best {
        None => space.start,
        Some((_, best)) if space.assembly.experiment().method.trains_inside() => best,
        Some((_, best)) => {
            // It is chosen for what comes after training: as everything is at its end.
            let scoring = Scoring { space: &space, experiment: &run.experiment, progress: 1.0, seen: None };
            let judge = |params| scoring.score(run.collector, params, search.generation(), 0..FINAL_EPISODES as u64);
            let (center, best) = (judge(space.acting(&search.center(), filter.as_ref()))?, judge(best)?);
            for scored in [&center, &best] {
                learned.env_steps += scored.env_steps;
                learned.discarded_episodes += scored.discarded_episodes;
            }
            if space.score(&best) > space.score(&center) { best.params } else { center.params }
        }
    };
    Ok(learned)
}
