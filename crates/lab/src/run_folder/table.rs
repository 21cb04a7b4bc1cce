//! `metrics.csv` of a run that is under way.

use std::fs;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use super::{RunError, io_error};
use crate::files::{self, Files};
use crate::metrics::{MetricsError, MetricsRow, MetricsTable, MetricsWriter};

/// Rows that are on the disk, and rows that are to go there: what cannot be written now is kept.
#[derive(Debug)]
pub(super) struct Table {
    path: PathBuf,
    header: Vec<u8>,
    pending: MetricsWriter<Vec<u8>>,
    /// Bytes of the file that are ours; behind them may be a row that was written in part.
    length: u64,
}

impl Table {
    /// A table without rows, of which nothing is written yet.
    pub(super) fn begin(path: PathBuf, totals: &[String]) -> Result<Self, RunError> {
        let writer = MetricsWriter::new(Vec::new(), totals);
        let pending = writer.map_err(|source| RunError::Metrics { path: path.clone(), source })?;
        Ok(Self { path, header: pending.get_ref().clone(), pending, length: 0 })
    }

    /// Cuts a table back to the rows before `iteration`.
    pub(super) fn resume(
        path: PathBuf,
        files: &dyn Files,
        totals: &[String],
        iteration: u64,
    ) -> Result<Self, RunError> {
        let mut table = Self::begin(path.clone(), totals)?;
        let error = |source| RunError::Metrics { path: path.clone(), source };
        if iteration > 0 && path.exists() {
            let file = fs::File::open(&path).map_err(|e| io_error("read", &path, e))?;
            let kept = MetricsTable::read_before(BufReader::new(file), iteration).map_err(error)?;
            if kept.design_totals != totals {
                return Err(error(MetricsError::Another));
            }
            for row in &kept.rows {
                table.push(row)?;
            }
        }
        files::replace(files, &path, table.pending.get_ref()).map_err(|e| io_error("write", &path, e))?;
        table.length = table.pending.get_ref().len() as u64;
        table.pending.get_mut().clear();
        Ok(table)
    }

    pub(super) fn push(&mut self, row: &MetricsRow) -> Result<(), RunError> {
        self.pending.append(row).map_err(|source| RunError::Metrics { path: self.path.clone(), source })
    }

    /// Writes what is to be written.
    pub(super) fn flush(&mut self, files: &dyn Files) -> Result<(), RunError> {
        if fs::metadata(&self.path).map_or(0, |file| file.len()) < self.length {
            tracing::warn!("{} was removed or cut by someone else: it begins anew", self.path.display());
            self.length = 0;
            self.pending.get_mut().splice(0..0, self.header.iter().copied());
        }
        let rows = self.pending.get_mut();
        if !rows.is_empty() {
            files.append(&self.path, self.length, rows).map_err(|e| io_error("write", &self.path, e))?;
            self.length += rows.len() as u64;
            rows.clear();
        }
        Ok(())
    }

    /// The same, and waits until it is on the disk.
    pub(super) fn sync(&mut self, files: &dyn Files) -> Result<(), RunError> {
        self.flush(files)?;
        files.sync(&self.path).map_err(|e| io_error("write", &self.path, e))
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }
}
