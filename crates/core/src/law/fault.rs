//! Why a program is no law.

use thiserror::Error;

/// What differs between a program and the law that it should be.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum LawError {
    /// Too few of them or too many.
    #[error("{what}: the program has {found}, the law needs {needed}; {program:?} against {law:?}")]
    Count {
        /// Which of them: design parameters, commands and states, efforts.
        what: &'static str,
        /// How many the program has.
        found: usize,
        /// How many the law needs.
        needed: usize,
        /// Their names in the program.
        program: Vec<String>,
        /// Their names in the law.
        law: Vec<String>,
    },
    /// One of another name, or in another place.
    #[error("{what}: number {index} is `{found}` in the program, but `{needed}` in the law")]
    Name {
        /// Which of them: design parameters, commands and states, efforts.
        what: &'static str,
        /// Its place, from 1.
        index: usize,
        /// Its name in the program.
        found: String,
        /// Its name in the law.
        needed: String,
    },
}

/// Whether a program has the names that a law needs, in their order.
pub(super) fn check_names(what: &'static str, program: &[String], law: &[String]) -> Result<(), LawError> {
    if program.len() != law.len() {
        let (found, needed) = (program.len(), law.len());
        return Err(LawError::Count { what, found, needed, program: program.to_vec(), law: law.to_vec() });
    }
    match program.iter().zip(law).enumerate().find(|(_, (found, needed))| found != needed) {
        Some((before, (found, needed))) => {
            Err(LawError::Name { what, index: before + 1, found: found.clone(), needed: needed.clone() })
        }
        None => Ok(()),
    }
}
