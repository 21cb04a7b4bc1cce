//! What jobs of one run are kept under, so that whoever goes on with it finds them.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{SystemTime, UNIX_EPOCH};

use bytes::Bytes;
use futures_util::StreamExt;

use crate::message::{Class, StateNote, hash, unpack};
use crate::store::Store;
use crate::subjects;

/// The name of a run on the server.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunName(String);

impl RunName {
    /// Of what stays the same when a run is resumed.
    pub fn of(parts: &[String]) -> Self {
        let bytes: Vec<u8> = parts.iter().flat_map(|part| [part.as_bytes(), &[0]].concat()).collect();
        Self(hash(&bytes)[..16].to_owned())
    }

    /// Of something that nobody will go on with.
    pub fn once() -> Self {
        let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_nanos());
        Self::of(&[now.to_string(), std::process::id().to_string()])
    }

    /// As a word.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

/// The names of the jobs of a run whose answers are kept.
pub(super) async fn answered(store: &Store, run: &str) -> Result<BTreeSet<String>, String> {
    let data = store.data().await?;
    let mut subjects =
        data.info_with_subjects(subjects::said(run, "answer", "*")).await.map_err(|error| error.to_string())?;
    let mut names = BTreeSet::new();
    while let Some(subject) = subjects.next().await {
        let (subject, _) = subject.map_err(|error| error.to_string())?;
        names.extend(subject.rsplit('.').next().map(str::to_owned));
    }
    Ok(names)
}

/// Removes the jobs of a run, and has workers end those that they are at. `word`: what they are told.
pub(super) async fn end(store: &Store, identity: &str, run: &str, word: &'static [u8]) {
    if let Ok(jobs) = store.jobs().await {
        let _ = jobs.purge().filter(subjects::jobs(identity, run)).await;
    }
    let _ = store.client.publish(subjects::stop(run), Bytes::from_static(word)).await;
    let _ = store.client.flush().await;
}

/// Removes all that is kept of a run.
pub(super) async fn forget(store: &Store, identity: &str, run: &str) {
    // Somebody may be at what was asked for twice.
    end(store, identity, run, subjects::OVER).await;
    store.remove(subjects::data(run)).await;
}

/// Removes what is said of a job.
pub(super) async fn forget_job(store: &Store, run: &str, job: &str) {
    for what in ["answer", "news", "state"] {
        store.remove(subjects::said(run, what, job)).await;
    }
}

/// Removes the state of a job.
pub(super) async fn forget_state(store: &Store, run: &str, job: &str) {
    let notes = subjects::said(run, "state", job);
    if let Ok(Some(bytes)) = store.last(&notes).await
        && let Ok(note) = unpack::<StateNote>(&bytes)
    {
        store.drop(run, &note.state).await;
        store.remove(notes).await;
    }
}

/// Removes answers from before a number of the stream, and sets it to that of now.
pub(super) async fn settle(store: &Store, run: &str, mark: &AtomicU64) {
    let Ok(data) = store.data().await else { return };
    let Ok(info) = data.get_info().await else { return };
    let before = mark.swap(info.state.last_sequence, Ordering::Relaxed);
    if before > 0 {
        store.remove_before(&subjects::said(run, "answer", "*"), before).await;
        store.remove_before(&subjects::parts_of(run, Class::Iteration.word()), before).await;
    }
}
