//! From the rows of runs to what is drawn: bad rows left out, smoothed, runs of one label brought to one grid.

use hwasp_core::Stream;
use hwasp_runs::metrics::TERM;
use hwasp_training::stats::{Bootstrap, Interval, LEAST_VALUES, Sample, StatsError};
use rand::SeedableRng;

use crate::curve::{Curve, DISCOUNTED, RETURN};
use crate::error::{MOST_PANELS, PlotError};
use crate::options::{Band, PlotOptions};

/// Larger magnitudes are taken for a run that has blown up: they would leave nothing else to see.
pub(super) const LARGEST: f64 = 1e100;
/// Points of the common grid of several runs: one for every other pixel or so.
const GRID: usize = 201;
/// The bootstrap of a picture draws the same resamples at each of its grid points, and every time.
const RESAMPLES: [u8; 32] = *b"bootstrap bands of hwasp's plots";

/// A point: steps or seconds, value.
pub(super) type Point = (f64, f64);

/// One run in one panel.
#[derive(Clone, Debug)]
pub(super) struct Line {
    /// As logged; empty where nothing is smoothed.
    pub(super) raw: Vec<Point>,
    /// The trailing mean of a return or a term of it, a design total as logged.
    pub(super) smooth: Vec<Point>,
}

/// The runs of one label in one panel.
#[derive(Debug)]
pub(super) enum Shape {
    /// No row can be drawn.
    Nothing,
    /// One run.
    Single(Line),
    /// Interquartile mean and a band (steps, low, high) over several runs.
    Summary { centre: Vec<Point>, band: Vec<(f64, f64, f64)> },
    /// Several runs that have no common range of steps, or are too few for the band that is asked for.
    Separate(Vec<Line>),
}

impl Shape {
    /// Brings every value to a unit of this many SI ones.
    pub(super) fn divide(&mut self, to_si: f64) {
        let divide = |points: &mut Vec<Point>| points.iter_mut().for_each(|point| point.1 /= to_si);
        let lines = match self {
            Self::Nothing => return,
            Self::Single(line) => std::slice::from_mut(line),
            Self::Separate(lines) => lines,
            Self::Summary { centre, band } => {
                divide(centre);
                for side in band {
                    (side.1, side.2) = (side.1 / to_si, side.2 / to_si);
                }
                return;
            }
        };
        for line in lines {
            divide(&mut line.raw);
            divide(&mut line.smooth);
        }
    }
}

/// Something that the picture does not show; it prints as a sentence.
#[derive(Clone, Debug, PartialEq)]
pub enum Note {
    /// More columns than a picture has panels.
    Panels {
        /// How many have none.
        left_out: usize,
    },
    /// Rows without a finite value below 1e100, or whose steps go backwards.
    Skipped {
        /// The run's label.
        label: String,
        /// The column.
        series: String,
        /// How many rows.
        rows: usize,
    },
    /// A run without any row: it has no curve.
    Empty {
        /// The run's label.
        label: String,
    },
    /// A run without any row of a column that can be drawn.
    NoRows {
        /// The run's label.
        label: String,
        /// The column.
        series: String,
    },
    /// Runs of one label end at different steps, and only what all have reached is drawn.
    Shortened {
        /// Their label.
        label: String,
        /// The column.
        series: String,
        /// The last step drawn.
        shown: f64,
        /// The last step of the longest run.
        longest: f64,
    },
    /// Runs of one label that have no steps in common, and so are drawn one by one.
    Apart {
        /// Their label.
        label: String,
        /// The column.
        series: String,
    },
}

impl std::fmt::Display for Note {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Panels { left_out } => {
                write!(f, "{left_out} columns are left out: a picture has {MOST_PANELS} panels; metrics.csv has all")
            }
            Self::Skipped { label, series, rows } => {
                write!(f, "{label}: {series} is drawn without {rows} of its rows (not finite, or out of order)")
            }
            Self::Empty { label } => write!(f, "{label}: the run has no iteration yet, and so no curve"),
            Self::NoRows { label, series } => write!(f, "{label}: no row of {series} can be drawn"),
            Self::Shortened { label, series, shown, longest } => write!(
                f,
                "{label}: {series} is drawn up to {shown} steps, which all its runs reached; the longest has {longest}"
            ),
            Self::Apart { label, series } => {
                write!(f, "{label}: the runs have no steps of {series} in common and are drawn one by one")
            }
        }
    }
}

/// The shape of one label's runs in the panel of this column; nothing if no run has the column.
pub(super) fn shape(
    runs: &[&Curve],
    column: &str,
    options: &PlotOptions,
    notes: &mut Vec<Note>,
) -> Result<Option<Shape>, PlotError> {
    let mut lines = Vec::new();
    let mut present = false;
    for run in runs {
        let Some(values) = run.column(column) else { continue };
        present = true;
        let (label, series) = (run.label.clone(), column.to_owned());
        if values.len() != run.x.len() {
            return Err(PlotError::Lengths { label, series, steps: run.x.len(), values: values.len() });
        }
        let raw = drawable(&run.x, values);
        let rows = values.len() - raw.len();
        if values.is_empty() {
            // Once, however many panels there are.
            let empty = Note::Empty { label };
            if !notes.contains(&empty) {
                notes.push(empty);
            }
            continue;
        }
        if raw.is_empty() {
            notes.push(Note::NoRows { label, series });
            continue;
        }
        if rows > 0 {
            notes.push(Note::Skipped { label, series, rows });
        }
        // A design moves without noise: a trailing mean would only make it late.
        let noisy = (column == RETURN || column == DISCOUNTED || column.starts_with(TERM)) && options.window > 1;
        lines.push(if noisy {
            Line { smooth: trailing_mean(&raw, options.window), raw }
        } else {
            Line { smooth: raw, raw: Vec::new() }
        });
    }
    let label = runs.first().map_or("", |run| &run.label);
    Ok(if present { Some(combine(lines, label, column, options.band, notes)?) } else { None })
}

fn combine(
    mut lines: Vec<Line>,
    label: &str,
    column: &str,
    band: Band,
    notes: &mut Vec<Note>,
) -> Result<Shape, StatsError> {
    if lines.len() < 2 {
        return Ok(lines.pop().map_or(Shape::Nothing, Shape::Single));
    }
    let (label, series) = (label.to_owned(), column.to_owned());
    let ends = lines.iter().filter_map(|l| Some((l.smooth.first()?.0, l.smooth.last()?.0)));
    let (from, to, longest) =
        ends.fold((0f64, f64::INFINITY, 0f64), |(f, t, l), (first, last)| (f.max(first), t.min(last), l.max(last)));
    if from >= to {
        notes.push(Note::Apart { label, series });
        return Ok(Shape::Separate(lines));
    }
    // Up to three runs carry no interval: they stand for themselves.
    if band == Band::Bootstrap && lines.len() < LEAST_VALUES {
        return Ok(Shape::Separate(lines));
    }
    if longest > to {
        notes.push(Note::Shortened { label, series, shown: to, longest });
    }
    let (mut centre, mut sides) = (Vec::with_capacity(GRID), Vec::with_capacity(GRID));
    for place in 0..GRID {
        let step = from + (to - from) * (place as f64 / (GRID - 1) as f64);
        let values: Vec<f64> = lines.iter().map(|line| interpolate(&line.smooth, step)).collect();
        let sample = Sample::new(&values)?;
        let extremes = Interval { low: sample.min(), high: sample.max() };
        let Interval { low, high } = match band {
            Band::MinMax => extremes,
            Band::Bootstrap => {
                let mut stream = Stream::from_seed(RESAMPLES);
                let interval = Bootstrap::default().interval(&sample, Sample::interquartile_mean, &mut stream)?;
                // Where all runs are at the same place, so is the band.
                interval.unwrap_or(extremes)
            }
        };
        centre.push((step, sample.interquartile_mean()));
        sides.push((step, low, high));
    }
    Ok(Shape::Summary { centre, band: sides })
}

/// The rows with a finite value of sane size and steps that do not fall.
fn drawable(steps: &[f64], values: &[f64]) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::with_capacity(values.len());
    for (&step, &value) in steps.iter().zip(values) {
        // A NaN fails the comparison too.
        if value.abs() <= LARGEST && kept.last().is_none_or(|last| last.0 <= step) {
            kept.push((step, value));
        }
    }
    kept
}

/// The mean of each value and up to `window - 1` before it.
fn trailing_mean(raw: &[Point], window: usize) -> Vec<Point> {
    let mean = |end: usize| {
        let rows = &raw[(end + 1).saturating_sub(window)..=end];
        (raw[end].0, rows.iter().map(|row| row.1).sum::<f64>() / rows.len() as f64)
    };
    (0..raw.len()).map(mean).collect()
}

/// The value at a step inside the line, linear between its points.
fn interpolate(line: &[Point], step: f64) -> f64 {
    let after = line.partition_point(|point| point.0 < step).min(line.len() - 1);
    let (x1, y1) = line[after];
    let (x0, y0) = line[after.saturating_sub(1)];
    if x1 > x0 && step < x1 { y0 + (y1 - y0) * ((step - x0) / (x1 - x0)) } else { y1 }
}

/// As many points as a screen can show: for each of `columns` equal ranges of steps the first, the lowest, the highest
/// and the last. Shorter lines stay as they are.
pub(super) fn thin(line: &[Point], columns: usize) -> Vec<Point> {
    let (Some(first), Some(last)) = (line.first(), line.last()) else { return Vec::new() };
    if line.len() <= 4 * columns || last.0 <= first.0 {
        return line.to_vec();
    }
    let column = |p: &Point| ((p.0 - first.0) / (last.0 - first.0) * columns as f64) as usize;
    let mut kept = Vec::with_capacity(4 * columns);
    for bucket in line.chunk_by(|a, b| column(a) == column(b)) {
        let by_value = |a: &(usize, &Point), b: &(usize, &Point)| a.1.1.total_cmp(&b.1.1);
        let low = bucket.iter().enumerate().min_by(by_value).map_or(0, |p| p.0);
        let high = bucket.iter().enumerate().max_by(by_value).map_or(0, |p| p.0);
        let mut places = [0, low, high, bucket.len() - 1];
        places.sort_unstable();
        for (i, &place) in places.iter().enumerate() {
            if i == 0 || places[i - 1] != place {
                kept.push(bucket[place]);
            }
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_trailing_mean_by_hand() {
        let raw = [(0.0, 1.0), (1.0, 3.0), (2.0, 8.0), (3.0, 1.0)];
        assert_eq!(trailing_mean(&raw, 3), [(0.0, 1.0), (1.0, 2.0), (2.0, 4.0), (3.0, 4.0)]);
        assert_eq!(trailing_mean(&raw, 1), raw);
    }

    #[test]
    fn interpolation_by_hand() {
        let line = [(0.0, 0.0), (10.0, 5.0), (10.0, 7.0), (20.0, 9.0)];
        let at = |step| interpolate(&line, step);
        assert_eq!([at(0.0), at(4.0), at(10.0), at(15.0), at(20.0)], [0.0, 2.0, 5.0, 8.0, 9.0]);
    }

    #[test]
    fn rows_that_cannot_be_drawn_are_left_out() {
        let kept = drawable(&[0.0, 1.0, 2.0, 1.0, 3.0], &[1.0, f64::NAN, 2.0, 5.0, f64::NEG_INFINITY]);
        assert_eq!(kept, [(0.0, 1.0), (2.0, 2.0)]);
    }

    #[test]
    fn thinning_keeps_the_extremes_and_the_ends() {
        let mut line: Vec<Point> = (0..10_000).map(|i| (f64::from(i), f64::from(i % 7))).collect();
        line[5_003].1 = 99.0;
        let thinned = thin(&line, 100);
        assert!(thinned.len() <= 404, "{}", thinned.len());
        assert!(thinned.contains(&(5_003.0, 99.0)));
        assert_eq!((thinned.first(), thinned.last()), (line.first(), line.last()));
        assert_eq!(thin(&line[..50], 100), line[..50]);
    }
}
