//! The runs that are watched: those that were named, and those in folders that were named.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use hwasp_experiment::{Catalogue, EXPERIMENT};
use hwasp_runs::Writers;
use serde::Serialize;

use crate::follow::{Detail, Follower, Overview, Since};
use crate::stamp::Stamp;

/// The most runs of a page.
pub(crate) const MOST_RUNS: usize = 100;
/// How deep below a folder runs are looked for. The deepest are those of comparisons.
const DEPTH: usize = 3;
/// The folder of a comparison with its runs.
const CELLS: &str = "cells";
/// Entries of a folder that are looked at.
const MOST_ENTRIES: usize = 10_000;
/// Who asks sooner gets what was found before.
const FRESH: Duration = Duration::from_millis(200);

/// The runs. One that is in the list keeps its place.
pub(crate) struct List {
    given: Vec<PathBuf>,
    runs: Vec<Follower>,
    catalogue: Catalogue,
    refreshed: Option<Instant>,
    /// What tells this server from another.
    pub(crate) server: String,
}

/// The list as a page has it.
#[derive(Debug, Serialize)]
pub(crate) struct Listed<'a> {
    version: &'static str,
    server: &'a str,
    /// What was named and is no run yet.
    waiting: Vec<String>,
    /// Whether there are more runs than a page has.
    full: bool,
    runs: Vec<Overview<'a>>,
}

impl List {
    pub(crate) fn new(given: Vec<PathBuf>, catalogue: Catalogue, server: String) -> Self {
        Self { given, runs: Vec::new(), catalogue, refreshed: None, server }
    }

    /// Looks at all folders again, unless that was done just now.
    pub(crate) fn refresh(&mut self) {
        if self.refreshed.is_some_and(|at| at.elapsed() < FRESH) {
            return;
        }
        let below = |path: &PathBuf| {
            let mut found = runs_at(path, DEPTH);
            // Those of comparisons, which may be many, come last.
            found.sort_by_key(|run| run.components().count());
            found
        };
        let found: Vec<PathBuf> = self.given.iter().flat_map(below).collect();
        for path in found {
            if self.runs.len() < MOST_RUNS && self.runs.iter().all(|run| run.path != path) {
                let label = path.display().to_string();
                self.runs.push(Follower::new(path, label));
            }
        }
        let writers = Writers::now();
        self.runs.iter_mut().for_each(|run| run.refresh(&writers, &self.catalogue));
        self.refreshed = Some(Instant::now());
    }

    pub(crate) fn listed(&self) -> Listed<'_> {
        let waits = |path: &&PathBuf| self.runs.iter().all(|run| !run.path.starts_with(path));
        Listed {
            version: env!("CARGO_PKG_VERSION"),
            server: &self.server,
            waiting: self.given.iter().filter(waits).map(|path| path.display().to_string()).collect(),
            full: self.runs.len() == MOST_RUNS,
            runs: self.runs.iter().enumerate().map(|(index, run)| run.overview(index)).collect(),
        }
    }

    /// Counts whatever was new in any of them.
    pub(crate) fn version(&self) -> u64 {
        self.runs.iter().map(|run| run.version + 1).sum()
    }

    pub(crate) fn run(&self, index: usize) -> Option<&Follower> {
        self.runs.get(index)
    }

    pub(crate) fn detail(&self, index: usize, since: &Since) -> Option<Detail<'_>> {
        Some(self.runs.get(index)?.detail(index, &self.server, since))
    }
}

/// The run in a folder, or those below it by their names.
fn runs_at(path: &Path, depth: usize) -> Vec<PathBuf> {
    if Stamp::of(&path.join(EXPERIMENT)).is_some() {
        return vec![path.to_owned()];
    }
    if depth == 0 || depth == 1 && !path.ends_with(CELLS) {
        return Vec::new();
    }
    let entries = fs::read_dir(path).into_iter().flatten().take(MOST_ENTRIES).flatten();
    let folder = |entry: &fs::DirEntry| entry.file_type().is_ok_and(|kind| kind.is_dir());
    let mut folders: Vec<PathBuf> = entries.filter(folder).map(|entry| entry.path()).collect();
    folders.sort();
    folders.iter().flat_map(|folder| runs_at(folder, depth - 1)).collect()
}
