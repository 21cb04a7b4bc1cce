//! Run folders: everything about one training, in files that explain themselves.

use std::fs::{self, File};
use std::io::{self, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use serde::Serialize;
use thiserror::Error;

use crate::assemble::{AssembleError, Assembly};
use crate::metrics::{MetricsError, MetricsTable, MetricsWriter};
use crate::observer::{Event, Observer, ObserverError};
use crate::plot::{Curve, PlotError, PlotOptions, XAxis, curves};
use crate::policy_file::{LARGEST_POLICY, PolicyFileError, read_policy, write_policy};
use crate::spec::{self, Layers, Spec, SpecErrors};
use crate::summary::Summary;
use crate::train::Trained;

/// Why a run folder cannot be written or read.
#[derive(Debug, Error)]
pub enum RunError {
    /// Something is there already.
    #[error("{path} exists already and is not overwritten; name another folder with --out, or remove it first")]
    Exists {
        /// The folder.
        path: PathBuf,
    },
    /// It is not a run folder.
    #[error("{path} is not a run folder: it has no {file}")]
    NotARun {
        /// The folder.
        path: PathBuf,
        /// What it lacks.
        file: &'static str,
    },
    /// A run that has not come to its end.
    #[error("{path} has no {file}: the training did not finish")]
    Unfinished {
        /// The folder.
        path: PathBuf,
        /// What it lacks.
        file: &'static str,
    },
    /// The file system.
    #[error("cannot {action} {path}: {source}")]
    Io {
        /// read, write …
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The experiment in it.
    #[error(transparent)]
    Spec(#[from] SpecErrors),
    /// The experiment in it, put together.
    #[error(transparent)]
    Assemble(#[from] AssembleError),
    /// The learning curve.
    #[error("{path}: {source}")]
    Metrics {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: MetricsError,
    },
    /// The picture.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// The parameters.
    #[error("{path}: {source}")]
    Policy {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: PolicyFileError,
    },
    /// A file that does not hold what it should.
    #[error("{path}: {message}")]
    Decode {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        message: String,
    },
    /// A value that cannot be written as TOML or JSON.
    #[error("cannot write {file}: {message}")]
    Encode {
        /// The file.
        file: &'static str,
        /// What is wrong.
        message: String,
    },
}

const EXPERIMENT: &str = "experiment.toml";
const PROVENANCE: &str = "provenance.json";
const METRICS: &str = "metrics.csv";
pub(crate) const DESIGN: &str = "design.toml";
const POLICY: &str = "policy.safetensors";
/// Written last: a folder that has it is finished.
pub(crate) const SUMMARY: &str = "summary.json";
const CURVES: &str = "curves.svg";

/// The largest summary that is read, bytes: ten thousand parameters take less than one.
pub(crate) const LARGEST_SUMMARY: u64 = 16 << 20;

/// Where a run came from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Provenance {
    /// The program's version.
    pub hwasp_version: &'static str,
    /// What was typed.
    pub command_line: Vec<String>,
    /// Seconds since 1970, UTC.
    pub started_unix_s: u64,
    /// Operating system and processor family.
    pub platform: String,
    /// The vector instructions that were used.
    pub vector_instructions: String,
    /// Threads that episodes ran on; they do not change the result.
    pub threads: usize,
    /// The root seed.
    pub seed: u64,
}

impl Provenance {
    /// Of a training that begins now.
    pub fn new(command_line: Vec<String>, threads: usize, seed: u64) -> Self {
        Self {
            hwasp_version: env!("CARGO_PKG_VERSION"),
            command_line,
            started_unix_s: SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs()),
            platform: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            vector_instructions: hwasp_diff::fast::instructions(),
            threads,
            seed,
        }
    }
}

/// A folder being written: an [`Observer`] that keeps the learning curve, and a place for the result.
#[derive(Debug)]
pub struct RunFolder {
    path: PathBuf,
    metrics: Option<MetricsWriter<File>>,
}

impl RunFolder {
    /// Creates the folder and writes what is known before training. A folder that exists is not touched.
    pub fn create(path: &Path, spec: &Spec, provenance: &Provenance) -> Result<Self, RunError> {
        if let Some(parent) = path.parent().filter(|p| !p.as_os_str().is_empty()) {
            fs::create_dir_all(parent).map_err(|source| io_error("create", parent, source))?;
        }
        match fs::create_dir(path) {
            Ok(()) => {}
            // An empty folder holds nothing that could be lost.
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists && is_empty(path) => {}
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {
                return Err(RunError::Exists { path: path.to_owned() });
            }
            Err(source) => return Err(io_error("create", path, source)),
        }
        let folder = Self { path: path.to_owned(), metrics: None };
        let experiment = spec.to_toml().map_err(|e| encode(EXPERIMENT, &e))?;
        let about = "# The experiment as it was run, every setting resolved. `hwasp train` on this file repeats it.\n";
        folder.write(EXPERIMENT, format!("{about}{experiment}").as_bytes())?;
        folder.write_json(PROVENANCE, provenance)?;
        Ok(folder)
    }

    /// The first free name for a run of `spec` under `root`: `mass-spring-hwasp-seed0`, then `…-2` and so on.
    pub fn free_name(root: &Path, spec: &Spec) -> PathBuf {
        let name = format!("{}-{}-seed{}", spec.name.replace(['/', '\\'], "-"), spec.method.name(), spec.seed);
        let numbered = (2..).map(|n| root.join(format!("{name}-{n}")));
        let mut names = std::iter::once(root.join(&name)).chain(numbered);
        names.find(|path| !path.exists()).unwrap_or_else(|| root.join(name))
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes what training gave: parameters, design, picture, and last the summary, which marks the run as finished.
    pub fn finish(&self, assembly: &Assembly, trained: &Trained) -> Result<Summary, RunError> {
        let summary = Summary::new(assembly, trained);
        let policy = write_policy(&assembly.policy, &trained.params)
            .map_err(|source| RunError::Policy { path: self.path.join(POLICY), source })?;
        self.write(POLICY, &policy)?;
        let design = toml::to_string(&summary.design).map_err(|e| encode(DESIGN, &e))?;
        let about = "# The design in SI units. `as_built` is what to build; it differs from `values` only where the law softens an\n\
                     # interface that is rigid in reality.\n\n";
        self.write(DESIGN, format!("{about}{design}").as_bytes())?;
        let saved = SavedRun::open(&self.path)?;
        let curve = saved.curve(XAxis::EnvSteps)?;
        if !curve.x.is_empty() {
            let plot = curves(&[curve], &saved.plot_options(String::new()))?;
            self.write(CURVES, plot.svg.as_bytes())?;
        }
        self.write_json(SUMMARY, &summary)?;
        Ok(summary)
    }

    /// Writes a file whole or not at all.
    fn write(&self, name: &str, contents: &[u8]) -> Result<(), RunError> {
        let (path, partial) = (self.path.join(name), self.path.join(format!(".{name}.partial")));
        let written = File::create(&partial).and_then(|mut file| {
            file.write_all(contents)?;
            file.sync_all()?;
            fs::rename(&partial, &path)
        });
        written.map_err(|source| io_error("write", &path, source))
    }

    fn write_json(&self, name: &'static str, value: &impl Serialize) -> Result<(), RunError> {
        let mut text = serde_json::to_string_pretty(value).map_err(|e| encode(name, &e))?;
        text.push('\n');
        self.write(name, text.as_bytes())
    }
}

impl Observer for RunFolder {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        let path = self.path.join(METRICS);
        let metrics = |source| RunError::Metrics { path: path.clone(), source };
        match event {
            Event::Started { totals, .. } => {
                let file = File::create(&path).map_err(|source| io_error("write", &path, source)).map_err(boxed)?;
                self.metrics = Some(MetricsWriter::new(file, totals).map_err(metrics).map_err(boxed)?);
            }
            Event::Iteration(row) => {
                if let Some(writer) = &mut self.metrics {
                    writer.append(row).map_err(metrics).map_err(boxed)?;
                }
            }
            Event::Evaluating | Event::Evaluated(_) => {}
        }
        Ok(())
    }
}

fn boxed(error: RunError) -> ObserverError {
    ObserverError(Box::new(error))
}

pub(crate) fn io_error(action: &'static str, path: &Path, source: io::Error) -> RunError {
    RunError::Io { action, path: path.to_owned(), source }
}

fn encode(file: &'static str, error: &dyn std::fmt::Display) -> RunError {
    RunError::Encode { file, message: error.to_string() }
}

fn is_empty(path: &Path) -> bool {
    fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_none())
}

/// A run that was written before.
pub struct SavedRun {
    path: PathBuf,
    assembly: Assembly,
}

impl SavedRun {
    /// Opens a run folder and puts its experiment together again.
    pub fn open(path: &Path) -> Result<Self, RunError> {
        Self::open_with(path, &[])
    }

    /// The same with values of the experiment set anew (`key=value`), to see what a result is worth in another world.
    pub fn open_with(path: &Path, assignments: &[String]) -> Result<Self, RunError> {
        let spec = saved_spec(path, assignments)?;
        Ok(Self { path: path.to_owned(), assembly: Assembly::new(&spec)? })
    }

    /// Its experiment, ready to run.
    pub fn assembly(&self) -> &Assembly {
        &self.assembly
    }

    /// The trained parameters.
    pub fn params(&self) -> Result<Vec<f32>, RunError> {
        let path = self.path.join(POLICY);
        if !path.is_file() {
            return Err(RunError::Unfinished { path: self.path.clone(), file: POLICY });
        }
        let bytes = read_limited(&path, LARGEST_POLICY)?;
        read_policy(&self.assembly.policy, &bytes).map_err(|source| RunError::Policy { path, source })
    }

    /// Its figures.
    pub fn summary(&self) -> Result<Summary, RunError> {
        let path = self.path.join(SUMMARY);
        if !path.is_file() {
            return Err(RunError::Unfinished { path: self.path.clone(), file: SUMMARY });
        }
        let bytes = read_limited(&path, LARGEST_SUMMARY)?;
        let decode = |e: serde_json::Error| RunError::Decode { path, message: e.to_string() };
        serde_json::from_slice(&bytes).map_err(decode)
    }

    /// Its learning curve, labelled with experiment and method.
    pub fn curve(&self, axis: XAxis) -> Result<Curve, RunError> {
        let table = self.metrics()?;
        let spec = self.assembly.spec();
        let label = format!("{} · {}", spec.name, spec.method.name());
        Ok(Curve::from_table(label, &table, axis, spec.train.nominal_steps))
    }

    /// Its learning curve as a table.
    pub fn metrics(&self) -> Result<MetricsTable, RunError> {
        let path = self.path.join(METRICS);
        let file = File::open(&path).map_err(|source| io_error("read", &path, source))?;
        MetricsTable::read(BufReader::new(file)).map_err(|source| RunError::Metrics { path, source })
    }

    /// Axis texts, units and known optima for its picture.
    pub fn plot_options(&self, title: String) -> PlotOptions {
        self.assembly.plot_options(title)
    }
}

/// The experiment of a run folder, with values of it set anew (`key=value`).
pub(crate) fn saved_spec(path: &Path, assignments: &[String]) -> Result<Spec, RunError> {
    let file = path.join(EXPERIMENT);
    if !file.is_file() {
        return Err(RunError::NotARun { path: path.to_owned(), file: EXPERIMENT });
    }
    let text = read_limited(&file, spec::LONGEST_FILE as u64)?;
    let text = String::from_utf8_lossy(&text);
    let layers = Layers::from_text(&file.to_string_lossy(), &text)?;
    let layers = assignments.iter().fold(layers, |layers, set| layers.with_assignment(set));
    Ok(spec::resolve(layers, None)?)
}

/// Reads a file that a stranger may have sent.
pub(crate) fn read_limited(path: &Path, limit: u64) -> Result<Vec<u8>, RunError> {
    let error = |source| io_error("read", path, source);
    let file = File::open(path).map_err(error)?;
    let mut bytes = Vec::new();
    file.take(limit + 1).read_to_end(&mut bytes).map_err(error)?;
    if bytes.len() as u64 > limit {
        let source = io::Error::new(io::ErrorKind::FileTooLarge, format!("it is larger than {limit} bytes"));
        return Err(error(source));
    }
    Ok(bytes)
}
