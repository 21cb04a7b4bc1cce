//! Reports: the result of a run or a comparison, as one HTML document that loads nothing.
//!
//! The document is for a telephone, a desktop screen and paper. It has pictures as SVG with titles and descriptions, tables with
//! captions, a script that plays the drawn episodes, and one that opens on paper what is folded. The same folder gives the same bytes with the same program. All text
//! of a folder is escaped. A content security policy in the document names the program's own style and script by their hashes,
//! and forbids everything else.

#![forbid(unsafe_code)]

mod comparison;
mod episode;
mod figure;
mod film;
mod page;
pub mod play;
mod run;
mod run_page;
mod sections;
mod trials;
mod words;

use std::path::Path;

use hwasp_experiment::{Catalogue, EXPERIMENT};
use hwasp_runs::RunError;
use hwasp_study::COMPARISON;

/// The report of a run folder, or of the folder of a comparison.
///
/// # Errors
/// Of folders that are neither, of runs that did not come to their end, of files that are missing or damaged.
pub fn report(folder: &Path, catalogue: &Catalogue) -> Result<String, RunError> {
    report_in(folder, folder, catalogue)
}

/// The same for a page that will lie in the folder `page`: its links to files of the run lead from there.
///
/// # Errors
/// Those of [`report`].
pub fn report_in(page: &Path, folder: &Path, catalogue: &Catalogue) -> Result<String, RunError> {
    if folder.join(EXPERIMENT).is_file() {
        return run_page::page(&run::Run::open(folder, page, catalogue)?).map(page::Page::html);
    }
    if folder.join(COMPARISON).is_file() {
        return comparison::page(folder, catalogue).map(page::Page::html);
    }
    Err(RunError::Nothing { path: folder.to_owned() })
}
