//! Files of an export.

/// A file to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportFile {
    /// Its place in the folder of the export.
    pub name: String,
    /// What is in it.
    pub contents: Vec<u8>,
}
