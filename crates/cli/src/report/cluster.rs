//! What is said of queue and workers.

use std::fmt::Write;

use hwasp_cluster::{Measured, Status};

use crate::progress::duration;

/// A table for a terminal; `options` are what is typed to use the queue.
pub(crate) fn status(status: &Status, options: &str) -> String {
    let Status { address, server_version, waiting, at_work, kept_bytes, runs, round_trip_ms, workers } = status;
    let mut text = format!(
        "{address}  NATS {server_version}, {round_trip_ms:.1} ms there and back\n\
         jobs: {waiting} waiting, {at_work} at work; {:.1} MB kept, of {}\n",
        *kept_bytes as f64 / 1e6,
        match runs.len() {
            1 => "one run".to_owned(),
            count => format!("{count} runs"),
        }
    );
    if workers.is_empty() {
        let _ = writeln!(text, "\nno workers; `hwasp worker {options}` starts one");
        return text;
    }
    let width = workers.iter().map(|worker| worker.card.name.len()).max().unwrap_or(0).max(6);
    let _ = writeln!(
        text,
        "\n{:width$}  {:>7}  {:>7}  {:>9}  {:>8}  {:>8}  note",
        "worker", "threads", "at work", "jobs", "a minute", "each"
    );
    let first = &workers[0].card.identity;
    for worker in workers {
        let card = &worker.card;
        let each = worker.job_s.map_or_else(|| "-".to_owned(), short);
        let mut notes = Vec::new();
        if worker.slow {
            notes.push("slow".to_owned());
        }
        if card.draining {
            notes.push("ending".to_owned());
        }
        if let Some(differs) = first.differs(&card.identity) {
            notes.push(format!("other program: {differs}"));
        }
        if let Some(longest) = card.at_work.iter().max_by(|a, b| a.seconds.total_cmp(&b.seconds)) {
            notes.push(format!("{} for {}", longest.kind, duration(longest.seconds)));
        }
        let line = format!(
            "{:width$}  {:>7}  {:>7}  {:>9}  {:>8.1}  {each:>8}  {}",
            card.name,
            card.threads,
            card.at_work.len(),
            card.jobs,
            worker.jobs_per_minute,
            notes.join(", ")
        );
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

/// What was measured.
pub(crate) fn measured(measured: &Measured) -> String {
    let Measured { workers, slots, job_ms, jobs_per_s, up_mb_per_s, down_mb_per_s } = measured;
    format!(
        "{workers} workers, {slots} jobs at once\n  \
         one empty job      {job_ms:>9.2} ms there and back\n  \
         many empty jobs    {jobs_per_s:>9.0} in a second\n  \
         values kept        {up_mb_per_s:>9.0} MB/s\n  \
         values read        {down_mb_per_s:>9.0} MB/s\n"
    )
}

/// Seconds, in what is read at a glance.
fn short(seconds: f64) -> String {
    if seconds < 1.0 { format!("{:.0} ms", 1e3 * seconds) } else { duration(seconds) }
}
