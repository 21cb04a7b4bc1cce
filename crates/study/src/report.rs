//! A comparison as files: tables in three formats, and pictures.

use std::fs;
use std::path::Path;

use hwasp_plot::{Band, Curve, PlotOptions, XAxis, curves};
use hwasp_runs::files::{Disk, Files, json};
use hwasp_runs::io_error;

use crate::cell::CellResult;
use crate::comparison::Comparison;
use crate::error::CompareError;
use crate::table;

/// The figures as JSON.
pub const COMPARISON: &str = "comparison.json";

impl Comparison {
    /// The tables as Markdown.
    pub fn markdown(&self) -> String {
        table::markdown(self)
    }

    /// One line per method.
    pub fn csv(&self) -> String {
        table::csv(self)
    }

    /// Writes `table.md`, `table.csv`, `comparison.json`, and where anything finished `curves.svg` and `time.svg`, into a
    /// folder that is created where it is missing. Each file is written whole, even where another process writes it too.
    pub fn write(&self, folder: &Path, cells: &[CellResult], options: &PlotOptions) -> Result<(), CompareError> {
        fs::create_dir_all(folder).map_err(|source| io_error("create", folder, source))?;
        let mut files = vec![
            ("table.md", self.markdown().into_bytes()),
            ("table.csv", self.csv().into_bytes()),
            (COMPARISON, json(COMPARISON, self)?),
        ];
        for (name, x_axis) in [("curves.svg", XAxis::EnvSteps), ("time.svg", XAxis::WallClock)] {
            if cells.is_empty() {
                continue;
            }
            let runs: Vec<Curve> =
                cells.iter().map(|cell| Curve::from_table(&cell.label, &cell.metrics, x_axis, 0).judged()).collect();
            let title = self.experiment.clone();
            let options = PlotOptions { title, x_axis, band: Band::Bootstrap, asked: self.asked(), ..options.clone() };
            files.push((name, curves(&runs, &options)?.svg.into_bytes()));
        }
        for (name, contents) in files {
            // Beside its place under a name that no other process has.
            let (path, beside) = (folder.join(name), folder.join(format!(".{name}.{}.partial", std::process::id())));
            let written = Disk.write(&beside, &contents).and_then(|()| Disk.rename(&beside, &path));
            written.map_err(|source| io_error("write", &path, source))?;
        }
        Ok(())
    }
}
