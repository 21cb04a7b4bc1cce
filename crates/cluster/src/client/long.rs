//! Jobs that go on from a state: candidates, and whole trainings.

use hwasp_training::collect::{CollectError, ExperimentText};

use super::ask::{Asker, Need};
use crate::message::{Class, Job, Payload, Task};

/// A job about an experiment, and what it needs. `from`: the packed state that it goes on from, if there is one.
pub(super) async fn job(
    asker: &Asker,
    text: &ExperimentText,
    from: Option<Vec<u8>>,
    task: impl FnOnce(Option<Payload>) -> Task,
) -> Result<(Job, Vec<Need>), CollectError> {
    let (experiment, need) = asker.experiment(text).await?;
    let (from, state) = match from {
        Some(bytes) => asker.put(Class::Run, bytes).await.map(|(payload, need)| (Some(payload), need))?,
        None => (None, None),
    };
    Ok((asker.job(experiment, task(from))?, std::iter::once(need).chain(state).collect()))
}
