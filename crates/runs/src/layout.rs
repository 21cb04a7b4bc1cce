//! The files of a run folder, by name.

/// Where it came from.
pub const PROVENANCE: &str = "provenance.json";
/// Its learning curve.
pub const METRICS: &str = "metrics.csv";
/// Its design.
pub const DESIGN: &str = "design.toml";
/// Its parameters.
pub const POLICY: &str = "policy.safetensors";
/// Checkpoints of a training that is under way, or was.
pub const CHECKPOINTS: &str = "checkpoints";
/// What it takes to see iterations fail again.
pub(crate) const FAULTS: &str = "faults";
/// What was told while it trained.
pub const LOG: &str = "train.log";
/// Written last: a folder that has it is finished.
pub const SUMMARY: &str = "summary.json";

/// What lies in a run folder by these names is the run's own, in lower case.
pub(crate) const OWN: [&str; 18] = [
    "experiment.toml",
    PROVENANCE,
    METRICS,
    "metrics.damaged",
    DESIGN,
    POLICY,
    CHECKPOINTS,
    FAULTS,
    SUMMARY,
    LOG,
    "curves.svg",
    "report.html",
    "tensorboard",
    "export",
    "play",
    "build",
    "closing.svg",
    "closing.png",
];

/// The largest summary that is read, bytes: ten thousand parameters take less than one.
pub const LARGEST_SUMMARY: u64 = 16 << 20;
