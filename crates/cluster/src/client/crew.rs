//! Who answers a call.

use std::collections::BTreeSet;
use std::time::{Duration, Instant};

use futures_util::StreamExt;

use crate::identity::Identity;
use crate::message::{pack, unpack};
use crate::store::Store;
use crate::subjects;
use crate::worker::Card;

/// How long answers to a call are waited for after the last one: so many round trips, within limits.
const GAP: (u32, [Duration; 2]) = (20, [Duration::from_millis(25), Duration::from_secs(1)]);
/// Cards that are read, at most.
const MOST_CARDS: usize = 100_000;

/// Workers of the same identity, as of the last call.
#[derive(Clone, Debug, Default)]
pub(crate) struct Crew {
    pub(crate) workers: usize,
    /// Jobs that they do at once.
    pub(crate) slots: usize,
    /// Of those, what is idle.
    pub(crate) idle: usize,
    /// The names of jobs of the run at work.
    pub(crate) at_work: BTreeSet<String>,
    /// Names of workers of another identity, and how they differ.
    pub(crate) refused: Vec<(String, String)>,
}

impl Crew {
    pub(crate) fn of(cards: &[Card], identity: &Identity, run: &str) -> Self {
        let mut crew = Self::default();
        for card in cards {
            if let Some(differs) = identity.differs(&card.identity) {
                crew.refused.push((card.name.clone(), differs));
                continue;
            }
            crew.at_work
                .extend(card.at_work.iter().filter(|at_work| at_work.run == run).map(|at_work| at_work.job.clone()));
            if !card.draining {
                crew.workers += 1;
                crew.slots += card.threads;
                crew.idle += card.threads.saturating_sub(card.at_work.len());
            }
        }
        crew
    }
}

/// Calls, and gathers the cards of all who answer, by name. `asks`: whose jobs they would get.
pub(crate) async fn call(store: &Store, asks: Option<&Identity>) -> Result<Vec<Card>, String> {
    let inbox = store.client.new_inbox();
    let mut answers = store.client.subscribe(inbox.clone()).await.map_err(|error| error.to_string())?;
    let question = pack(&asks)?;
    let sent = store.client.publish_with_reply(subjects::CALL, inbox, question.into()).await;
    sent.map_err(|error| error.to_string())?;
    let (mut cards, began) = (Vec::new(), Instant::now());
    let gap = (GAP.0 * store.round_trip).clamp(GAP.1[0], GAP.1[1]);
    while let Ok(Some(answer)) = tokio::time::timeout(gap, answers.next()).await {
        // Where nobody listens, the server answers itself, with nothing.
        if let Ok(card) = unpack::<Card>(&answer.payload) {
            cards.push(card);
        } else if answer.payload.is_empty() {
            break;
        }
        if cards.len() >= MOST_CARDS || began.elapsed() > 10 * GAP.1[1] {
            break;
        }
    }
    cards.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(cards)
}

#[cfg(test)]
mod tests;
