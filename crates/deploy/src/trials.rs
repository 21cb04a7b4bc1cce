//! Real grasps, counted: a table of them, and the share that held, beside the paper's.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use hwasp_runs::files::{Disk, read_limited, replace};
use hwasp_tasks::grasp::ShapeKind;
use hwasp_training::stats::{Interval, wilson};

use crate::error::{DeployError, file};

/// What the table is called.
pub const TRIALS: &str = "trials.csv";
const HEADER: &str = "date,task,run,shape,size_x_mm,size_y_mm,size_z_mm,held,note";
/// The largest table that is read, bytes.
const LARGEST: u64 = 1 << 24;

/// A grasp.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// When, as `2026-11-29T12:00:00Z`.
    pub date: String,
    /// The problem of the run: `z-grasp`, `3d-grasp`.
    pub task: String,
    /// The run folder.
    pub run: String,
    /// Shape of the object.
    pub shape: ShapeKind,
    /// Its bounding box, m.
    pub size: [f64; 3],
    /// Whether it held.
    pub held: bool,
    /// What else there is to say.
    pub note: String,
}

/// What the paper reports of its real hand: per cent held of boxes, cylinders and balls, by problem.
pub const PAPER: [(&str, [(ShapeKind, f64); 3]); 2] = [
    ("z-grasp", [(ShapeKind::Box, 100.0), (ShapeKind::Cylinder, 90.0), (ShapeKind::Sphere, 100.0)]),
    ("3d-grasp", [(ShapeKind::Box, 100.0), (ShapeKind::Cylinder, 80.0), (ShapeKind::Sphere, 50.0)]),
];

/// What the paper reports of a shape, %.
pub fn paper(task: &str, shape: ShapeKind) -> Option<f64> {
    let (_, shapes) = PAPER.iter().find(|(name, _)| *name == task)?;
    shapes.iter().find(|(other, _)| *other == shape).map(|(_, share)| *share)
}

/// How often a shape held.
#[derive(Clone, Debug, PartialEq)]
pub struct Rate {
    /// The problem.
    pub task: String,
    /// The shape.
    pub shape: ShapeKind,
    /// How often it held.
    pub held: u64,
    /// Of so many.
    pub trials: u64,
    /// Wilson's 95 % interval of the share.
    pub interval: Interval,
    /// The paper's share, %, where it has one.
    pub paper: Option<f64>,
}

/// The trials of a table; none where there is no table yet.
///
/// # Errors
/// Where a line is no trial: it is named.
pub fn read(path: &Path) -> Result<Vec<Trial>, DeployError> {
    if !path.exists() {
        return Ok(Vec::new());
    }
    let bytes = read_limited(path, LARGEST)
        .map_err(|error| DeployError::Log { path: path.to_owned(), what: error.to_string() })?;
    let text = String::from_utf8_lossy(&bytes);
    let wrong = |line: usize, what: &str| DeployError::Log {
        path: path.to_owned(),
        what: format!("line {line}: {what}; mend it in an editor or a spreadsheet, whose columns are {HEADER}"),
    };
    let mut lines = text.lines().enumerate();
    if lines.next().is_none_or(|(_, first)| first.trim_end() != HEADER) {
        return Err(wrong(1, "it is not the line of columns"));
    }
    lines
        .filter(|(_, line)| !line.trim().is_empty())
        .map(|(i, line)| {
            let parts: Vec<_> = line.splitn(9, ',').collect();
            let [date, task, run, shape, x, y, z, held, note] = parts[..] else {
                return Err(wrong(i + 1, &format!("it has {} columns, not 9", parts.len())));
            };
            let shape = ShapeKind::from_name(shape).ok_or_else(|| wrong(i + 1, &format!("`{shape}` is no shape")))?;
            let mut size = [0.0; 3];
            for (size, text) in size.iter_mut().zip([x, y, z]) {
                let mm: f64 = text.parse().map_err(|_| wrong(i + 1, &format!("`{text}` is no number")))?;
                *size = 1e-3 * mm;
            }
            let held = match held {
                "yes" => true,
                "no" => false,
                other => return Err(wrong(i + 1, &format!("held is `{other}`, neither yes nor no"))),
            };
            let [date, task, run, note] = [date, task, run, note.trim_matches('"')].map(str::to_owned);
            Ok(Trial { date, task, run, shape, size, held, note })
        })
        .collect()
}

/// Adds trials to a table, which is made where it is missing. It is written whole or not at all.
///
/// # Errors
/// Where it cannot be read or written.
pub fn add(path: &Path, trials: &[Trial]) -> Result<Vec<Trial>, DeployError> {
    let mut all = read(path)?;
    all.extend_from_slice(trials);
    let mut text = format!("{HEADER}\n");
    for Trial { date, task, run, shape, size, held, note } in &all {
        let [x, y, z] = size.map(|edge| 1e3 * edge);
        let held = if *held { "yes" } else { "no" };
        let [task, run, note] = [task, run, note].map(|word| plain(word));
        let _ = writeln!(text, "{date},{task},{run},{shape},{x:.1},{y:.1},{z:.1},{held},{note}");
    }
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        fs::create_dir_all(folder).map_err(file("made", folder))?;
    }
    replace(&Disk, path, text.as_bytes()).map_err(file("written", path))?;
    Ok(all)
}

/// A word that a column can hold.
fn plain(word: &str) -> String {
    word.chars().map(|c| if c == ',' || c == '"' || c.is_control() { ' ' } else { c }).collect()
}

/// How often each shape held, by problem, in the order of the table.
pub fn rates(trials: &[Trial]) -> Vec<Rate> {
    let mut rates: Vec<Rate> = Vec::new();
    for trial in trials {
        let at = rates.iter().position(|rate| rate.task == trial.task && rate.shape == trial.shape);
        let at = at.unwrap_or_else(|| {
            let (task, shape) = (trial.task.clone(), trial.shape);
            let paper = paper(&task, shape);
            rates.push(Rate { task, shape, held: 0, trials: 0, interval: wilson(0, 0), paper });
            rates.len() - 1
        });
        rates[at].trials += 1;
        rates[at].held += u64::from(trial.held);
    }
    for rate in &mut rates {
        rate.interval = wilson(rate.held, rate.trials);
    }
    rates
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trial(task: &str, shape: ShapeKind, held: bool) -> Trial {
        let (date, run) = ("2026-11-29T12:00:00Z".to_owned(), "results/z-grasp".to_owned());
        Trial {
            date,
            task: task.to_owned(),
            run,
            shape,
            size: [0.06, 0.05, 0.08],
            held,
            note: "wet, \"odd\"".to_owned(),
        }
    }

    #[test]
    fn trials_are_kept_and_counted() {
        let folder = std::env::temp_dir().join(format!("hwasp-trials-{}", std::process::id()));
        let path = folder.join(TRIALS);
        let _ = fs::remove_dir_all(&folder);
        assert_eq!(read(&path).unwrap(), []);
        for i in 0..10 {
            add(&path, &[trial("z-grasp", ShapeKind::Cylinder, i != 3)]).unwrap();
        }
        let all = add(&path, &[trial("3d-grasp", ShapeKind::Sphere, false)]).unwrap();
        assert_eq!(read(&path).unwrap().len(), 11);
        assert_eq!(read(&path).unwrap()[0].size, [0.06, 0.05, 0.08]);
        let rates = rates(&all);
        assert_eq!((rates[0].held, rates[0].trials, rates[0].paper), (9, 10, Some(90.0)));
        // scipy.stats.binomtest(9, 10).proportion_ci(method="wilson")
        assert!((rates[0].interval.low - 0.5958).abs() < 1e-4 && (rates[0].interval.high - 0.9821).abs() < 1e-4);
        assert_eq!((rates[1].held, rates[1].trials, rates[1].paper), (0, 1, Some(50.0)));
        fs::write(&path, format!("{HEADER}\n2026,z-grasp,r,pyramid,1,2,3,yes,\n")).unwrap();
        let error = read(&path).unwrap_err().to_string();
        assert!(error.contains("line 2: `pyramid` is no shape"), "{error}");
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn ellipsoids_are_not_in_the_paper() {
        assert_eq!(paper("z-grasp", ShapeKind::Ellipsoid), None);
        assert_eq!(paper("reach", ShapeKind::Box), None);
    }
}
