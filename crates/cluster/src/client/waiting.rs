//! Who waits for which answer.

use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard};

use tokio::sync::oneshot;

use crate::message::Envelope;

type Senders = HashMap<String, Vec<oneshot::Sender<Envelope>>>;

/// Those who wait, by the names of jobs.
#[derive(Default)]
pub(super) struct Waiting(Mutex<Senders>);

impl Waiting {
    fn lock(&self) -> MutexGuard<'_, Senders> {
        self.0.lock().expect("nothing panics while the list is locked")
    }

    /// Waits for the answer of a job.
    pub(super) fn wait_for(&self, job: &str) -> oneshot::Receiver<Envelope> {
        let (sender, receiver) = oneshot::channel();
        self.lock().entry(job.to_owned()).or_default().push(sender);
        receiver
    }

    /// Hands an answer to all who wait for it. Of a job that was done twice, the second answer waits for nobody.
    pub(super) fn hand(&self, envelope: &Envelope) {
        for sender in self.lock().remove(&envelope.job).unwrap_or_default() {
            // Who waited may be gone.
            let _ = sender.send(envelope.clone());
        }
    }

    /// Removes who waits for a job no longer, for the answer was found otherwise.
    pub(super) fn tidy(&self, job: &str) {
        let mut list = self.lock();
        if let Some(senders) = list.get_mut(job) {
            senders.retain(|sender| !sender.is_closed());
            if senders.is_empty() {
                list.remove(job);
            }
        }
    }

    /// Nothing is handed to anybody any more.
    pub(super) fn clear(&self) {
        self.lock().clear();
    }

    pub(super) fn is_empty(&self) -> bool {
        self.lock().is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::message::Payload;

    #[test]
    fn all_who_wait_for_an_answer_have_it_and_who_is_gone_is_forgotten() {
        let waiting = Waiting::default();
        let envelope = |job: &str| Envelope {
            job: job.to_owned(),
            worker: "w".to_owned(),
            seconds: 1.0,
            content: Payload::Here(vec![7]),
        };
        let (mut one, mut two, gone) = (waiting.wait_for("a"), waiting.wait_for("a"), waiting.wait_for("b"));
        waiting.hand(&envelope("a"));
        waiting.hand(&envelope("a"));
        assert_eq!((one.try_recv().unwrap().job, two.try_recv().unwrap().job), ("a".to_owned(), "a".to_owned()));
        waiting.tidy("b");
        assert!(!waiting.is_empty(), "somebody waits for b");
        drop(gone);
        waiting.tidy("b");
        assert!(waiting.is_empty());
        let mut cleared = waiting.wait_for("c");
        waiting.clear();
        assert_eq!(cleared.try_recv().unwrap_err(), oneshot::error::TryRecvError::Closed);
    }
}
