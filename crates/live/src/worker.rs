//! Simulations, one after the other on a thread of their own that steps back for trainings.

use std::collections::VecDeque;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};

use hwasp_experiment::Catalogue;
use hyper::StatusCode;
use tokio::sync::oneshot;

use crate::answer::Answer;
use crate::nice::step_back;
use crate::simulate::{Asked, Stage};

/// Requests that wait, at most.
const MOST_WAITING: usize = 4;
/// Answers that are kept, and their bytes, at most.
const MOST_KEPT: usize = 64;
const MOST_BYTES: usize = 64 << 20;

struct Job {
    asked: Asked,
    answer: oneshot::Sender<Answer>,
}

/// What was asked before, the oldest first.
#[derive(Default)]
struct Kept {
    answers: VecDeque<(Asked, Answer)>,
    bytes: usize,
}

impl Kept {
    fn get(&self, asked: &Asked) -> Option<Answer> {
        self.answers.iter().find(|(known, _)| known == asked).map(|(_, answer)| answer.clone())
    }

    fn put(&mut self, asked: Asked, answer: Answer) {
        self.bytes += answer.len();
        self.answers.push_back((asked, answer));
        while self.answers.len() > MOST_KEPT || self.bytes > MOST_BYTES {
            let Some((_, old)) = self.answers.pop_front() else { break };
            self.bytes -= old.len();
        }
    }
}

/// The thread, from outside. It ends when this is dropped and its last simulation is done.
pub(crate) struct Worker {
    jobs: SyncSender<Job>,
    kept: Arc<Mutex<Kept>>,
}

impl Worker {
    pub(crate) fn start(catalogue: Catalogue) -> io::Result<Self> {
        let (jobs, waiting) = sync_channel(MOST_WAITING);
        let kept = Arc::new(Mutex::new(Kept::default()));
        let keeping = Arc::clone(&kept);
        let work = move || work(&waiting, &keeping, &catalogue);
        std::thread::Builder::new().name("hwasp-simulate".to_owned()).spawn(work)?;
        Ok(Self { jobs, kept })
    }

    /// Simulates what is asked for, unless it is known. Whoever goes away while he waits is not waited for.
    pub(crate) async fn answer(&self, asked: Asked) -> Answer {
        if let Some(answer) = lock(&self.kept).get(&asked) {
            return answer;
        }
        let (answer, later) = oneshot::channel();
        match self.jobs.try_send(Job { asked, answer }) {
            Ok(()) => later.await.unwrap_or_else(|_| ended()),
            Err(TrySendError::Full(_)) => Answer::fault(
                StatusCode::SERVICE_UNAVAILABLE,
                "too many simulations are asked for at once; try again in a second",
            ),
            Err(TrySendError::Disconnected(_)) => ended(),
        }
    }
}

fn ended() -> Answer {
    Answer::fault(StatusCode::INTERNAL_SERVER_ERROR, "this simulation broke down; the program's own output may say why")
}

fn lock(kept: &Mutex<Kept>) -> std::sync::MutexGuard<'_, Kept> {
    kept.lock().unwrap_or_else(PoisonError::into_inner)
}

fn work(jobs: &Receiver<Job>, kept: &Mutex<Kept>, catalogue: &Catalogue) {
    step_back(10);
    let mut stage = Stage::default();
    for Job { asked, answer } in jobs {
        if answer.is_closed() {
            continue;
        }
        let known = lock(kept).get(&asked);
        let told = known.unwrap_or_else(|| {
            let simulated = catch_unwind(AssertUnwindSafe(|| stage.answer(&asked, catalogue)));
            let (told, keep) = simulated.unwrap_or_else(|_| {
                stage = Stage::default();
                (ended(), false)
            });
            if keep {
                lock(kept).put(asked, told.clone());
            }
            told
        });
        // Nobody may listen any more.
        let _ = answer.send(told);
    }
}
