//! `metrics.csv` of a run that is under way.

use std::fs;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use hwasp_training::MetricsRow;

use crate::error::{RunError, io_error};
use crate::files::{self, Files};
use crate::metrics::{Columns, MetricsError, MetricsTable, MetricsWriter};

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
    fn begin(path: &Path, columns: Columns<'_>) -> Result<Self, RunError> {
        let writer = MetricsWriter::new(Vec::new(), columns);
        let pending = writer.map_err(|source| RunError::Metrics { path: path.to_owned(), source })?;
        Ok(Self { path: path.to_owned(), header: pending.get_ref().clone(), pending, length: 0 })
    }

    /// Cuts a table back to the rows before `iteration`, and writes it anew with these columns: one that an earlier version
    /// wrote may have others. One that is damaged is set aside: a curve is not worth a training.
    pub(super) fn resume(
        path: &Path,
        files: &dyn Files,
        columns: Columns<'_>,
        iteration: u64,
    ) -> Result<Self, RunError> {
        let mut table = Self::begin(path, columns)?;
        if iteration > 0 && path.exists() {
            match rows_before(path, columns, iteration) {
                Ok(rows) => rows.iter().try_for_each(|row| table.push(row))?,
                Err(error) => {
                    let aside = path.with_extension("damaged");
                    files.rename(path, &aside).map_err(|e| io_error("rename", path, e))?;
                    tracing::warn!("{}: {error}; it is set aside, and the learning curve begins anew", path.display());
                }
            }
        }
        files::replace(files, path, table.pending.get_ref()).map_err(|e| io_error("write", path, e))?;
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

fn rows_before(path: &Path, columns: Columns<'_>, iteration: u64) -> Result<Vec<MetricsRow>, MetricsError> {
    let kept = MetricsTable::read_before(BufReader::new(fs::File::open(path)?), iteration)?;
    if kept.design_totals == columns.totals { Ok(kept.rows_with(columns)) } else { Err(MetricsError::Another) }
}
