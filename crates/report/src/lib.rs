//! Reports: what a run or a comparison came to, as one HTML document that loads nothing.
//!
//! The document is for a telephone, a desk and paper; it has pictures as SVG with titles and descriptions, tables with captions,
//! and one script, which plays the drawn grasps. The same folder gives the same bytes with the same program. Whatever a folder
//! says is escaped, and a policy in the document lets nothing run or load but the style and the script that this program has put
//! there, named by their hashes.

#![forbid(unsafe_code)]

mod comparison;
mod episode;
mod figure;
#[cfg(feature = "mujoco")]
mod grasp;
mod page;
pub mod play;
mod run;
mod run_page;
mod sections;
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
    if folder.join(EXPERIMENT).is_file() {
        return run_page::page(&run::Run::open(folder, catalogue)?).map(page::Page::html);
    }
    if folder.join(COMPARISON).is_file() {
        return comparison::page(folder, catalogue).map(page::Page::html);
    }
    Err(RunError::Nothing { path: folder.to_owned() })
}
