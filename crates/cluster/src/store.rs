//! What the server keeps: streams, values under their hashes, notes of jobs.

use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use async_nats::Client;
use async_nats::connection::State;
use async_nats::jetstream::consumer::{AckPolicy, PullConsumer, pull};
use async_nats::jetstream::context::{Context, ContextBuilder, PublishError, PublishErrorKind};
use async_nats::jetstream::message::PublishMessage;
use async_nats::jetstream::publish::PublishAck;
use async_nats::jetstream::stream::{
    self, DirectGetError, DirectGetErrorKind, DiscardPolicy, RetentionPolicy, StorageType, Stream,
};
use bytes::{Bytes, BytesMut};

use crate::error::ClusterError;
use crate::message::{ACK_WAIT, Class, Kept, Payload, hash};
use crate::subjects;

/// Values up to this size travel in the message that needs them, bytes.
pub(crate) const INLINE: usize = 64 << 10;
/// What a message has besides a part, bytes, at most.
const HEAD: usize = 4 << 10;
/// The largest part of a value, bytes: larger messages hold up small ones.
const PART: usize = 512 << 10;
/// How long what belongs to a run is kept where nobody removes it.
const MOST_AGE: Duration = Duration::from_hours(24 * 14);
/// Pauses between two attempts.
const PAUSE: [Duration; 2] = [Duration::from_millis(100), Duration::from_secs(2)];
/// Jobs that may be at work at once.
const AT_WORK: i64 = 1 << 20;

/// The queue and what is kept.
#[derive(Clone)]
pub(crate) struct Store {
    pub(crate) client: Client,
    pub(crate) context: Context,
    /// How long a server that is away, or full, is waited for.
    patience: Duration,
    /// Time that a request took when it was opened.
    pub(crate) round_trip: Duration,
}

/// Why something is not kept.
#[derive(Debug, thiserror::Error)]
pub(crate) enum StoreError {
    #[error("the server did not answer as it should for {}: {why}", seconds(*.waited))]
    Away { waited: Duration, why: String },
    #[error("what it names is not kept any more")]
    Gone,
    #[error("it is not what it is named after")]
    Other,
}

fn seconds(time: Duration) -> String {
    format!("{:.0} s", time.as_secs_f64())
}

impl Store {
    /// Makes the streams where they are not there yet.
    pub(crate) async fn open(client: Client, address: &str, patience: Duration) -> Result<Self, ClusterError> {
        let context = ContextBuilder::new().ack_timeout(Duration::from_secs(5)).build(client.clone());
        let mut store = Self { client, context, patience, round_trip: Duration::ZERO };
        let queue = |why| ClusterError::Queue { address: address.to_owned(), why };
        store.ensure().await.map_err(queue)?;
        let began = Instant::now();
        store.ensure().await.map_err(queue)?;
        store.round_trip = began.elapsed() / 2;
        Ok(store)
    }

    fn is_connected(&self) -> bool {
        self.client.connection_state() == State::Connected
    }

    /// How often there was a new connection.
    pub(crate) fn connects(&self) -> u64 {
        self.client.statistics().connects.load(Ordering::Relaxed)
    }

    async fn ensure(&self) -> Result<(), String> {
        let stream = |name: &str, subjects: &str| stream::Config {
            name: name.to_owned(),
            subjects: vec![subjects.to_owned()],
            storage: StorageType::File,
            discard: DiscardPolicy::New,
            max_age: MOST_AGE,
            num_replicas: 1,
            ..stream::Config::default()
        };
        let jobs = stream::Config {
            retention: RetentionPolicy::WorkQueue,
            // Long enough for a job that is published again because its acknowledgement was late.
            duplicate_window: Duration::from_secs(30),
            ..stream(subjects::JOBS, subjects::ALL_JOBS)
        };
        let data = stream::Config { allow_direct: true, ..stream(subjects::DATA, subjects::ALL_DATA) };
        for config in [jobs, data] {
            self.context.get_or_create_stream(config).await.map_err(|error| error.to_string())?;
        }
        Ok(())
    }

    /// Jobs for workers of one identity.
    pub(crate) async fn consumer(&self, identity: &str) -> Result<PullConsumer, String> {
        self.ensure().await?;
        let jobs = self.jobs().await?;
        let config = pull::Config {
            durable_name: Some(subjects::consumer(identity)),
            filter_subject: subjects::jobs_for(identity),
            ack_policy: AckPolicy::Explicit,
            ack_wait: ACK_WAIT,
            max_ack_pending: AT_WORK,
            // Workers that wait for jobs.
            max_waiting: 1 << 16,
            // Programs change: the consumer of one that nobody runs any more goes, and its jobs age.
            inactive_threshold: MOST_AGE,
            ..pull::Config::default()
        };
        jobs.create_consumer(config).await.map_err(|error| error.to_string())
    }

    pub(crate) async fn jobs(&self) -> Result<Stream<()>, String> {
        self.context.get_stream_no_info(subjects::JOBS).await.map_err(|error| error.to_string())
    }

    pub(crate) async fn data(&self) -> Result<Stream<()>, String> {
        self.context.get_stream_no_info(subjects::DATA).await.map_err(|error| error.to_string())
    }

    /// Keeps a message. `id`: messages of one id are kept once.
    pub(crate) async fn publish(
        &self,
        subject: &str,
        bytes: Bytes,
        id: Option<&str>,
    ) -> Result<PublishAck, StoreError> {
        let (began, mut pause, mut told) = (Instant::now(), PAUSE[0], false);
        loop {
            let (kind, why) = match self.publish_once(subject, bytes.clone(), id).await {
                Ok(acknowledged) => return Ok(acknowledged),
                Err(error) => match std::error::Error::source(&error) {
                    Some(source) => (error.kind(), format!("{error}: {source}")),
                    None => (error.kind(), error.to_string()),
                },
            };
            if began.elapsed() >= self.patience || kind == PublishErrorKind::MaxPayloadExceeded {
                return Err(StoreError::Away { waited: began.elapsed(), why });
            }
            if !told && pause > PAUSE[0] {
                tracing::warn!(
                    "the server does not keep what is sent ({why}); it is tried again for {}",
                    seconds(self.patience)
                );
                told = true;
            }
            if kind == PublishErrorKind::StreamNotFound {
                // It begins anew, with an empty store.
                let _ = self.ensure().await;
            }
            tokio::time::sleep(pause).await;
            pause = (2 * pause).min(PAUSE[1]);
        }
    }

    async fn publish_once(&self, subject: &str, bytes: Bytes, id: Option<&str>) -> Result<PublishAck, PublishError> {
        // The client would keep what is sent now for later, each attempt of it.
        if !self.is_connected() {
            return Err(PublishError::new(PublishErrorKind::BrokenPipe));
        }
        let message = PublishMessage::build().payload(bytes);
        let message = match id {
            Some(id) => message.message_id(id),
            None => message,
        };
        self.context.send_publish(subject.to_owned(), message).await?.await
    }

    /// Keeps bytes of a run, unless they are few.
    pub(crate) async fn put(&self, run: &str, class: Class, bytes: Vec<u8>) -> Result<Payload, StoreError> {
        if bytes.len() <= INLINE {
            return Ok(Payload::Here(bytes));
        }
        Ok(Payload::Kept(self.keep(run, class, bytes.into()).await?))
    }

    /// Keeps bytes of a run, few or many.
    pub(crate) async fn keep(&self, run: &str, class: Class, bytes: Bytes) -> Result<Kept, StoreError> {
        let largest = self.part();
        let kept = Kept { class, hash: hash(&bytes), bytes: bytes.len() as u64 };
        let parts = bytes.len().div_ceil(largest);
        let part = |i: usize| bytes.slice(i * largest..((i + 1) * largest).min(bytes.len()));
        let publish = |i: usize| {
            let subject = subjects::part(run, class.word(), &kept.hash, i);
            let part = part(i);
            async move { self.publish(&subject, part, None).await }
        };
        // All at once: one way there and back, and not one for each.
        futures_util::future::try_join_all((0..parts).map(publish)).await?;
        Ok(kept)
    }

    /// The largest part of a value, bytes.
    fn part(&self) -> usize {
        PART.min(self.client.max_payload().saturating_sub(HEAD)).max(1)
    }

    /// The bytes of a payload.
    pub(crate) async fn get(&self, run: &str, payload: &Payload) -> Result<Bytes, StoreError> {
        match payload {
            Payload::Here(bytes) => Ok(Bytes::from(bytes.clone())),
            Payload::Kept(kept) => self.kept(run, kept).await,
        }
    }

    /// The bytes of a kept value.
    pub(crate) async fn kept(&self, run: &str, kept: &Kept) -> Result<Bytes, StoreError> {
        if !subjects::is_word(&kept.hash) {
            return Err(StoreError::Other);
        }
        let (mut bytes, mut i) = (BytesMut::new(), 0);
        while (bytes.len() as u64) < kept.bytes {
            let part =
                self.last(&subjects::part(run, kept.class.word(), &kept.hash, i)).await?.ok_or(StoreError::Gone)?;
            if part.is_empty() {
                return Err(StoreError::Other);
            }
            bytes.extend_from_slice(&part);
            i += 1;
        }
        if hash(&bytes) == kept.hash { Ok(bytes.freeze()) } else { Err(StoreError::Other) }
    }

    /// The newest message of a subject, if there is one.
    pub(crate) async fn last(&self, subject: &str) -> Result<Option<Bytes>, StoreError> {
        self.read(|data| {
            let subject = subject.to_owned();
            async move { data.direct_get_last_for_subject(subject).await.map(|message| message.payload) }
        })
        .await
    }

    /// The first message of a subject from a number of the stream on, and its number.
    pub(crate) async fn next(&self, subject: &str, from: u64) -> Result<Option<(u64, Bytes)>, StoreError> {
        self.read(|data| {
            let subject = subject.to_owned();
            async move {
                let message = data.direct_get_next_for_subject(subject, Some(from)).await;
                message.map(|message| (message.sequence, message.payload))
            }
        })
        .await
    }

    /// Reads, and tries again while the server is away.
    async fn read<T, F>(&self, get: impl Fn(Stream<()>) -> F) -> Result<Option<T>, StoreError>
    where
        F: Future<Output = Result<T, DirectGetError>>,
    {
        let (began, mut pause) = (Instant::now(), PAUSE[0]);
        loop {
            let why = match self.read_once(&get).await {
                Ok(found) => return Ok(found),
                Err(why) => why,
            };
            if began.elapsed() >= self.patience {
                return Err(StoreError::Away { waited: began.elapsed(), why });
            }
            tokio::time::sleep(pause).await;
            pause = (2 * pause).min(PAUSE[1]);
        }
    }

    async fn read_once<T, F>(&self, get: &impl Fn(Stream<()>) -> F) -> Result<Option<T>, String>
    where
        F: Future<Output = Result<T, DirectGetError>>,
    {
        if !self.is_connected() {
            return Err("there is no connection".to_owned());
        }
        match get(self.data().await?).await {
            Ok(found) => Ok(Some(found)),
            Err(error) if error.kind() == DirectGetErrorKind::NotFound => Ok(None),
            Err(error) => {
                // Where it came back with an empty store, nothing is there.
                self.ensure().await?;
                Err(error.to_string())
            }
        }
    }

    /// Removes what is kept under some subjects. What cannot be removed now ages.
    pub(crate) async fn remove(&self, subjects: String) {
        if let Ok(data) = self.data().await {
            let _ = data.purge().filter(subjects).await;
        }
    }

    /// Removes the messages of some subjects before a number of the stream.
    pub(crate) async fn remove_before(&self, subjects: &str, sequence: u64) {
        if let Ok(data) = self.data().await {
            let _ = data.purge().filter(subjects).sequence(sequence).await;
        }
    }

    /// Removes a kept value.
    pub(crate) async fn drop(&self, run: &str, payload: &Payload) {
        if let Payload::Kept(kept) = payload {
            self.remove(subjects::parts(run, kept.class.word(), &kept.hash)).await;
        }
    }
}
