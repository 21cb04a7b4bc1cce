//! A learning curve that grows: `metrics.csv` read piece by piece while someone writes it, and kept in few points however long it
//! becomes.

use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use hwasp_runs::metrics::{LONGEST_LINE, MetricsTable};
use hwasp_runs::saved_metrics;
use hwasp_training::MetricsRow;

/// The most points that are kept.
pub(crate) const MOST_POINTS: usize = 500;
/// Bytes that are read at once.
const PIECE: u64 = 4 << 20;
/// Rows by which the speed of a training is judged.
const RECENT: usize = 20;

/// Several rows in a row, as one.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    /// How many they are.
    rows: u64,
    /// Real simulator steps at the end of the last of them.
    pub(crate) env_steps: u64,
    /// Time since training began at that point, s.
    pub(crate) wall_s: f64,
    /// For each column the sum and the number of what is known.
    sums: Vec<(f64, u64)>,
}

impl Point {
    /// The mean of a column; NaN where nothing is known.
    pub(crate) fn mean(&self, column: usize) -> f64 {
        let (sum, count) = self.sums[column];
        sum / count as f64
    }

    fn of(row: &MetricsRow) -> Self {
        let sums = columns(row).map(|value| if value.is_finite() { (value, 1) } else { (0.0, 0) }).collect();
        Self { rows: 1, env_steps: row.env_steps, wall_s: row.wall_s, sums }
    }

    fn join(&mut self, next: &Self) {
        self.rows += next.rows;
        (self.env_steps, self.wall_s) = (next.env_steps, next.wall_s);
        for (sum, next) in self.sums.iter_mut().zip(&next.sums) {
            *sum = (sum.0 + next.0, sum.1 + next.1);
        }
    }
}

/// The values of a row: returns, metrics of the learner, terms of the reward, totals of the design, and what [`LAST`] names.
pub(crate) fn columns(row: &MetricsRow) -> impl Iterator<Item = f64> {
    let rest = row.learner.iter().chain(&row.terms).chain(&row.design_totals);
    let last = [row.episode_steps, row.noise.command, row.noise.effort, row.noise.design];
    [row.undiscounted_return, row.discounted_return].into_iter().chain(rest.copied()).chain(last)
}

/// The last columns, with their meanings.
pub(crate) const LAST: [(&str, &str); 4] = [
    ("episode_steps", "the mean length of the training episodes of an iteration, steps"),
    ("noise.command", "the standard deviation of commands, as a share of their range"),
    ("noise.effort", "the standard deviation of efforts, SI"),
    ("noise.design", "the standard deviation of designs that are drawn, as a share of their range"),
];

/// What is known of a table so far.
#[derive(Debug, Default)]
pub(crate) struct Curve {
    /// The first line, with its end.
    header: Vec<u8>,
    /// The last line that was read. Where it stands no longer in its place, the table is another one.
    anchor: Vec<u8>,
    /// Bytes that were read: whole lines.
    read: u64,
    /// Names without rows.
    pub(crate) names: MetricsTable,
    pub(crate) points: Vec<Point>,
    /// Rows of a point.
    pub(crate) width: u64,
    pub(crate) last: Option<MetricsRow>,
    /// Time and steps of the last rows.
    recent: VecDeque<(f64, u64)>,
    /// What is wrong with the table.
    pub(crate) fault: Option<String>,
}

impl Curve {
    /// Reads what is new; a table that is another one than before is read from its beginning. Returns whether it was.
    pub(crate) fn update(&mut self, run: &Path, file: &Path) -> bool {
        let anew = !self.header.is_empty() && !matches!(self.stands(file), Ok(true));
        if anew {
            *self = Self::default();
        }
        self.fault = match self.read_on(file) {
            Ok(()) => None,
            // Read as a whole it tells the right line. A table that is sound by now is read at the next look.
            Err(_) => saved_metrics(run).err().map(|error| error.to_string()),
        };
        anew
    }

    /// Steps per second by the last rows; none before there are some.
    pub(crate) fn steps_per_s(&self) -> Option<f64> {
        let ((from, before), (to, after)) = (self.recent.front()?, self.recent.back()?);
        let rate = if self.recent.len() > 1 { (after - before) as f64 / (to - from) } else { *after as f64 / to };
        Some(rate).filter(|rate| rate.is_finite())
    }

    /// Whether what was read is still there.
    fn stands(&self, file: &Path) -> io::Result<bool> {
        let mut file = File::open(file)?;
        file.seek(SeekFrom::Start(self.read - self.anchor.len() as u64))?;
        let mut found = vec![0; self.anchor.len()];
        match file.read_exact(&mut found) {
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(false),
            read => read.map(|()| found == self.anchor),
        }
    }

    fn read_on(&mut self, path: &Path) -> Result<(), Box<dyn std::error::Error>> {
        let mut file = BufReader::new(File::open(path)?);
        if self.header.is_empty() {
            let mut header = Vec::new();
            file.by_ref().take(LONGEST_LINE as u64 + 1).read_until(b'\n', &mut header)?;
            if !header.ends_with(b"\n") {
                return if header.len() > LONGEST_LINE { Err("no header".into()) } else { Ok(()) };
            }
            self.names = MetricsTable::read(&header[..])?;
            (self.read, self.anchor, self.header, self.width) = (header.len() as u64, header.clone(), header, 1);
        }
        loop {
            file.seek(SeekFrom::Start(self.read))?;
            let mut piece = Vec::new();
            file.by_ref().take(PIECE).read_to_end(&mut piece)?;
            let Some(end) = piece.iter().rposition(|byte| *byte == b'\n') else {
                // A line that is being written is read when it has its end.
                return if piece.len() > LONGEST_LINE { Err("a line without an end".into()) } else { Ok(()) };
            };
            let lines = &piece[..=end];
            let table = MetricsTable::read(self.header.chain(lines))?;
            if table.rows.first().zip(self.last.as_ref()).is_some_and(|(next, last)| next.env_steps < last.env_steps) {
                return Err("steps fall".into());
            }
            table.rows.iter().for_each(|row| self.push(row));
            let before = lines[..end].iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
            self.anchor = lines[before..].to_vec();
            self.read += lines.len() as u64;
            self.last = table.rows.into_iter().next_back().or(self.last.take());
        }
    }

    fn push(&mut self, row: &MetricsRow) {
        let next = Point::of(row);
        match self.points.last_mut().filter(|last| last.rows < self.width) {
            Some(last) => last.join(&next),
            None => self.points.push(next),
        }
        if self.points.len() > MOST_POINTS {
            self.width *= 2;
            let pairs = self.points.chunks(2).map(|pair| {
                let mut joined = pair[0].clone();
                pair[1..].iter().for_each(|next| joined.join(next));
                joined
            });
            self.points = pairs.collect();
        }
        self.recent.push_back((row.wall_s, row.env_steps));
        if self.recent.len() > RECENT {
            self.recent.pop_front();
        }
    }
}

#[cfg(test)]
mod tests {
    use hwasp_core::NoiseSizes;

    use super::*;

    fn row(iteration: u64, value: f64) -> MetricsRow {
        MetricsRow {
            iteration,
            env_steps: 10 * (iteration + 1),
            wall_s: iteration as f64,
            discounted_return: value,
            undiscounted_return: 2.0 * value,
            episodes: 4.0,
            episode_steps: 50.0,
            noise: NoiseSizes { command: 0.5, ..NoiseSizes::default() },
            learner: vec![f64::NAN],
            terms: Vec::new(),
            design_totals: vec![1.0],
        }
    }

    /// 1100 rows are 275 points of 4 rows: at 501, and at the next 501, neighbours were joined.
    #[test]
    fn a_long_curve_has_few_points_which_are_means() {
        let mut curve = Curve { width: 1, ..Curve::default() };
        (0..1100).for_each(|i| curve.push(&row(i, i as f64)));
        assert_eq!((curve.points.len(), curve.width), (275, 4));
        let last = curve.points.last().unwrap();
        // Rows 1096 to 1099.
        assert_eq!((last.env_steps, last.wall_s), (11_000, 1099.0));
        assert_eq!((last.mean(0), last.mean(1), last.mean(3)), (2195.0, 1097.5, 1.0));
        assert!(last.mean(2).is_nan());
        assert_eq!((last.mean(4), last.mean(5)), (50.0, 0.5));
        // Twenty rows, ten steps a second.
        assert_eq!(curve.steps_per_s(), Some(10.0));
    }

    #[test]
    fn what_is_not_known_is_left_out_of_means() {
        let mut curve = Curve { width: 2, ..Curve::default() };
        [1.0, f64::NAN, f64::NAN, f64::NAN].into_iter().enumerate().for_each(|(i, v)| curve.push(&row(i as u64, v)));
        assert_eq!(curve.points[0].mean(1), 1.0);
        assert!(curve.points[1].mean(1).is_nan());
    }
}
