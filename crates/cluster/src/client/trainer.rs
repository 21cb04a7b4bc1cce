//! Whole trainings on workers: their events come back in order, whoever trains, and however often another worker takes over.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::RecvTimeoutError;
use std::time::Duration;

use bytes::Bytes;
use hwasp_training::collect::{CollectError, ExperimentText};
use hwasp_training::{
    AssembleError, Assembly, Checkpoint, Event, FailedIteration, Observer, TrainError, Trained, Trainer,
};
use tokio::sync::Notify;

use super::ask::Asker;
use super::run;
use super::{Cluster, long};
use crate::message::{Job, News, Payload, Task, Told, TrainingAnswer, pack, unpack};
use crate::store::StoreError;
use crate::subjects;

/// How often news are looked for where none are announced.
const LOOK: Duration = Duration::from_secs(2);
/// How often it is looked whether somebody wants it to end.
const STOP: Duration = Duration::from_millis(100);

/// What comes from a worker.
enum Item {
    Told(Box<Told>),
    /// A checkpoint's bytes.
    Checkpoint(Bytes),
    End(Result<TrainingAnswer, CollectError>),
}

impl Trainer for Cluster {
    fn train(
        &self,
        from: Option<&Checkpoint>,
        assembly: &Assembly,
        observer: &mut dyn Observer,
        stop: &AtomicBool,
    ) -> Result<Trained, TrainError> {
        let text = ExperimentText::of(assembly.experiment())?;
        let bytes = from.map(pack).transpose().map_err(CollectError::Unanswered)?;
        let (iteration, env_steps) = from.map_or((0, 0), |checkpoint| (checkpoint.iteration, checkpoint.env_steps));
        let (sender, receiver) = std::sync::mpsc::channel();
        let asker = Arc::clone(&self.asker);
        let task = self.handle.spawn(async move {
            let ended = follow(&asker, &text, bytes, iteration, &sender).await;
            let _ = sender.send(Item::End(ended));
        });
        let resumed = from.map(|checkpoint| checkpoint.env_steps);
        let budget = assembly.experiment().train.env_steps;
        let ended = Heard { env_steps, resumed, begun: false, observer }.listen(&receiver, stop, budget);
        task.abort();
        ended
    }
}

/// Tells an observer.
struct Heard<'a> {
    env_steps: u64,
    /// The steps of the checkpoint that it goes on from.
    resumed: Option<u64>,
    begun: bool,
    observer: &'a mut dyn Observer,
}

impl Heard<'_> {
    fn listen(
        mut self,
        receiver: &std::sync::mpsc::Receiver<Item>,
        stop: &AtomicBool,
        budget: u64,
    ) -> Result<Trained, TrainError> {
        loop {
            match receiver.recv_timeout(STOP) {
                Ok(Item::Told(told)) => self.hear(&told)?,
                Ok(Item::Checkpoint(bytes)) => {
                    let checkpoint: Checkpoint = unpack(&bytes).map_err(CollectError::Unanswered)?;
                    self.observer.on(Event::Checkpoint(&checkpoint))?;
                }
                Ok(Item::End(answer)) => {
                    return match answer? {
                        TrainingAnswer::Trained(trained) => Ok(*trained),
                        TrainingAnswer::Failed(why) => Err(TrainError::Elsewhere(why)),
                        TrainingAnswer::Setup(why) => Err(AssembleError::Elsewhere(why).into()),
                    };
                }
                Err(_) if stop.load(Ordering::Relaxed) => {
                    return Err(TrainError::Interrupted { env_steps: self.env_steps, budget });
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(error) => return Err(CollectError::Unanswered(error.to_string()).into()),
            }
        }
    }

    fn hear(&mut self, told: &Told) -> Result<(), TrainError> {
        match told {
            Told::Iteration(row) => {
                self.env_steps = row.env_steps;
                self.observer.on(Event::Iteration(row))?;
            }
            // Each worker that takes over begins.
            Told::Started { .. } if self.begun => {}
            Told::Started { env_steps, learner, terms, totals } => {
                self.begun = true;
                let learner: Vec<&str> = learner.iter().map(String::as_str).collect();
                let (env_steps, resumed) = (*env_steps, self.resumed);
                self.observer.on(Event::Started { env_steps, resumed, learner: &learner, terms, totals })?;
            }
            Told::Failed { checkpoint, batch, what } => {
                self.observer.on(Event::Failed(&FailedIteration { checkpoint, batch: batch.as_deref(), what }))?;
            }
            Told::Evaluating => self.observer.on(Event::Evaluating)?,
            Told::Evaluated(evaluation) => self.observer.on(Event::Evaluated(evaluation))?,
            Told::Checkpoint { .. } => {}
        }
        Ok(())
    }
}

/// Asks for a training and hands on what comes of it, in order.
async fn follow(
    asker: &Asker,
    text: &ExperimentText,
    from: Option<Vec<u8>>,
    known: u64,
    sender: &std::sync::mpsc::Sender<Item>,
) -> Result<TrainingAnswer, CollectError> {
    let (job, needs) = long::job(asker, text, from, |from| Task::Training { from }).await?;
    let announced = asker.announce(&job.name);
    let mut reader = Reader { asker, job: &job, next: 0, known, sender };
    let answer = {
        let mut asked = std::pin::pin!(asker.ask(&job, &needs));
        loop {
            let heard = std::pin::pin!(wait(&announced));
            match futures_util::future::select(asked.as_mut(), heard).await {
                futures_util::future::Either::Left((answer, _)) => break answer?,
                futures_util::future::Either::Right(_) => reader.read().await?,
            }
        }
    };
    // All news are kept before the answer is.
    reader.read().await?;
    asker.silence(&job.name);
    let answer = unpack(&answer.content).map_err(CollectError::Unanswered)?;
    if let TrainingAnswer::Trained(trained) = &answer
        && reader.known < trained.iterations
    {
        run::forget_job(&asker.store, &asker.run, &job.name).await;
        return Err(CollectError::Unanswered(format!(
            "the server lost what was told of iteration {}; the same command again goes on before it",
            reader.known
        )));
    }
    // News stay until the run is over: who goes on after the next line of code may not have them yet.
    run::forget_state(&asker.store, &asker.run, &job.name).await;
    Ok(answer)
}

/// Until news are announced, or it is time to look for them.
async fn wait(announced: &Notify) {
    let _ = tokio::time::timeout(LOOK, announced.notified()).await;
}

/// Whether something is news where so many iterations are known, which it may add to: whoever took over from an earlier state tells some
/// once more, and whoever was left behind tells of states that are old.
fn is_new(told: &Told, known: &mut u64) -> bool {
    match told {
        Told::Iteration(row) => {
            let new = row.iteration == *known;
            *known += u64::from(new);
            new
        }
        Told::Checkpoint { iteration, .. } => iteration == known,
        _ => true,
    }
}

/// Reads the news of a job from where it stopped.
struct Reader<'a> {
    asker: &'a Asker,
    job: &'a Job,
    /// The first number of the stream that was not looked at.
    next: u64,
    /// Iterations that are known: those of the checkpoint that it goes on from, and those told since.
    known: u64,
    sender: &'a std::sync::mpsc::Sender<Item>,
}

impl Reader<'_> {
    async fn read(&mut self) -> Result<(), CollectError> {
        let subject = subjects::said(&self.asker.run, "news", &self.job.name);
        let lost = |error: StoreError| CollectError::Unanswered(error.to_string());
        while let Some((number, bytes)) = self.asker.store.next(&subject, self.next.max(1)).await.map_err(lost)? {
            self.next = number + 1;
            let Ok(payload) = unpack::<Payload>(&bytes) else { continue };
            let Ok(bytes) = self.asker.store.get(&self.asker.run, &payload).await else { continue };
            let Ok(News(news)) = unpack(&bytes) else { continue };
            for told in news {
                if !is_new(&told, &mut self.known) {
                    continue;
                }
                let item = match told {
                    Told::Checkpoint { state, .. } => match self.asker.store.get(&self.asker.run, &state).await {
                        Ok(bytes) => Item::Checkpoint(bytes),
                        // It is not kept any more, because a newer one is.
                        Err(_) => continue,
                    },
                    told => Item::Told(Box::new(told)),
                };
                // Whoever asked may be gone.
                let _ = self.sender.send(item);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
