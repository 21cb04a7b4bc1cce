//! Names of streams and subjects. All begin with `hwasp.`, so that a server may be shared.

/// The stream of jobs: a work queue.
pub(crate) const JOBS: &str = "HWASP_JOBS";
/// The stream of all else that is kept.
pub(crate) const DATA: &str = "HWASP_DATA";
pub(crate) const ALL_JOBS: &str = "hwasp.jobs.>";
pub(crate) const ALL_DATA: &str = "hwasp.data.>";
/// Who hears it tells what it is.
pub(crate) const CALL: &str = "hwasp.call";
/// Of runs that somebody stopped; the run follows.
pub(crate) const STOPS: &str = "hwasp.stop.*";
/// What is said there of a run that nobody will go on with.
pub(crate) const OVER: &[u8] = b"over";

/// Jobs of a run, for workers of one identity.
pub(crate) fn jobs(identity: &str, run: &str) -> String {
    format!("hwasp.jobs.{identity}.{run}")
}

/// All jobs for workers of one identity.
pub(crate) fn jobs_for(identity: &str) -> String {
    format!("hwasp.jobs.{identity}.*")
}

/// The consumer of those jobs.
pub(crate) fn consumer(identity: &str) -> String {
    format!("workers-{identity}")
}

/// What is kept of a run.
pub(crate) fn data(run: &str) -> String {
    format!("hwasp.data.{run}.>")
}

/// What is said of one job: `answer`, `news` or `state`.
pub(crate) fn said(run: &str, what: &str, job: &str) -> String {
    format!("hwasp.data.{run}.{what}.{job}")
}

/// A part of a kept value.
pub(crate) fn part(run: &str, class: &str, hash: &str, index: usize) -> String {
    format!("hwasp.data.{run}.{class}.{hash}.{index}")
}

/// All parts of a kept value.
pub(crate) fn parts(run: &str, class: &str, hash: &str) -> String {
    format!("hwasp.data.{run}.{class}.{hash}.*")
}

/// Ends the work on a run.
pub(crate) fn stop(run: &str) -> String {
    format!("hwasp.stop.{run}")
}

/// Whether a text can be one word of a subject.
pub(crate) fn is_word(text: &str) -> bool {
    (1..=64).contains(&text.len()) && text.bytes().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit())
}

/// All parts of all kept values of a class.
pub(crate) fn parts_of(run: &str, class: &str) -> String {
    format!("hwasp.data.{run}.{class}.>")
}
