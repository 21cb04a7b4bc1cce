//! Names that Cargo takes for a package with a program in it.

use std::path::Path;

use super::ProjectError;

/// The longest name, bytes.
const LONGEST: usize = 64;

/// Words of the language, used and reserved (the Rust reference, "Keywords", edition 2024).
const KEYWORDS: &[&str] = &[
    "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate", "do", "dyn", "else",
    "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl", "in", "let", "loop", "macro", "match", "mod",
    "move", "mut", "override", "priv", "pub", "ref", "return", "self", "static", "struct", "super", "trait", "true",
    "try", "type", "typeof", "unsafe", "unsized", "use", "virtual", "where", "while", "yield",
];
/// What comes with the language, and folders of Cargo's.
const TAKEN: &[&str] =
    &["alloc", "build", "core", "deps", "examples", "incremental", "proc-macro", "proc_macro", "std", "test"];

/// The name of a folder, made into one for a package as far as that goes without guessing.
pub(super) fn of_folder(folder: &Path) -> String {
    // A folder that is there may be called by another name here, such as `.`.
    let absolute = folder.canonicalize().ok().unwrap_or_else(|| folder.to_owned());
    let name = absolute.file_name().unwrap_or_default().to_string_lossy();
    name.trim().to_lowercase().replace([' ', '.'], "-")
}

/// Whether Cargo takes it.
pub(super) fn check(name: &str) -> Result<(), ProjectError> {
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || matches!(c, '-' | '_');
    let why = if name.is_empty() {
        "it is empty"
    } else if name.len() > LONGEST {
        "it is longer than 64 characters"
    } else if !name.chars().all(plain) {
        "it has other characters than lower-case letters, digits, `-` and `_`"
    } else if !name.starts_with(|c: char| c.is_ascii_lowercase()) {
        "it does not begin with a letter"
    } else if KEYWORDS.contains(&name) {
        "it is a word of the language"
    } else if TAKEN.contains(&name) {
        "Cargo or the language has it for something else"
    } else if name == "rand" || name == "hwasp" || name.starts_with("hwasp-") {
        "what the project is built with has it"
    } else {
        return Ok(());
    };
    Err(ProjectError::Name { name: name.to_owned(), why })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_give_names() {
        for (folder, name) in [("lamp", "lamp"), ("work/My Lamp", "my-lamp"), ("arm_2", "arm_2"), ("v0.2", "v0-2")] {
            assert_eq!(of_folder(Path::new(folder)), name);
            assert!(check(name).is_ok(), "{name}");
        }
    }

    #[test]
    fn what_cargo_refuses_is_refused() {
        for name in ["", "2lamps", "-lamp", "Lamp", "lampé", "la/mp", "fn", "test", "core", "rand", "hwasp-training"] {
            assert!(check(name).is_err(), "{name}");
        }
        assert!(check(&"x".repeat(65)).is_err());
    }
}
