//! The batch of an iteration that failed, beside the state before it.

use hwasp_algos::{Archive, Array};
use hwasp_core::Batch;

const OBS: &str = "batch.obs";

/// What was seen, done and earned in every step, and where episodes begin.
pub(crate) fn batch_arrays(batch: &Batch) -> Archive {
    let begin = batch.episodes.iter().map(|episode| episode.rows.start as u64).collect();
    [
        (OBS, Array::F32(batch.obs.clone())),
        ("batch.state", Array::F32(batch.state.clone())),
        ("batch.action", Array::F32(batch.action.clone())),
        ("batch.log_prob", Array::F32(batch.log_prob.clone())),
        ("batch.reward", Array::F64(batch.reward.clone())),
        ("batch.begin", Array::U64(begin)),
    ]
    .map(|(name, array)| (name.to_owned(), array))
    .into()
}

/// Whether there is one.
pub(crate) fn has_batch(archive: &Archive) -> bool {
    archive.contains_key(OBS)
}

/// Whether it has the bits of this one.
pub(crate) fn has_this_batch(archive: &Archive, batch: &Batch) -> bool {
    // Numbers that are none are what one looks for, and do not equal themselves.
    batch_arrays(batch)
        .iter()
        .all(|(name, array)| archive.get(name).is_some_and(|a| super::bytes(a) == super::bytes(array)))
}
