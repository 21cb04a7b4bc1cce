//! The engine's complaints, with the file and the line that they are about.

use std::ffi::{CStr, CString, c_char, c_int};

use mujoco_rs::mujoco_c::{mj_deleteSpec, mj_parseXML};

use super::super::BuildError;
use super::mount::Mount;
use super::scan;

/// What the engine says of the text at `file` when it parses it, in full; the wrapper cuts it after 100 bytes.
#[expect(unsafe_code, reason = "the wrapper's buffer is too short")]
pub(super) fn parsing(mount: &Mount, file: &str) -> String {
    let Ok(path) = CString::new(mount.path(file)) else { return String::new() };
    let mut buffer = [0 as c_char; 4096];
    // SAFETY: path and buffer are terminated and live during the call, and the length is the buffer's. A specification that
    // comes back is ours alone and is freed once.
    unsafe {
        let spec = mj_parseXML(path.as_ptr(), mount.vfs().ffi(), buffer.as_mut_ptr(), buffer.len() as c_int);
        if !spec.is_null() {
            mj_deleteSpec(spec);
            return String::new();
        }
        CStr::from_ptr(buffer.as_ptr()).to_string_lossy().into_owned()
    }
}

/// An error in the engine's words, for the model in `main`.
pub(super) fn error(mount: &Mount, main: &str, said: &str) -> BuildError {
    let said = mount.plain(said);
    if said.contains("Include error") {
        // The engine gives neither the name nor the line.
        let other = mount.files().paths().filter(|path| *path != main).find_map(|path| {
            let said = mount.plain(&parsing(mount, path));
            said.starts_with("XML parse error").then(|| error_in(mount, path, &said))
        });
        if let Some(error) = other {
            return error;
        }
    }
    error_in(mount, main, &said)
}

fn error_in(mount: &Mount, main: &str, said: &str) -> BuildError {
    let Said { message, line, element, name } = Said::read(said);
    let (file, line, message) = match line {
        // Elements of included files have no line.
        Some(0) => match included(mount, main, &element, &name) {
            Some((file, line)) => (file, line, message),
            None => (main.to_owned(), None, format!("{message} (in a file that it includes)")),
        },
        line => (main.to_owned(), line, message),
    };
    if message.contains("mass and inertia of moving bodies") {
        return BuildError::NoInertia { file, line, body: name };
    }
    BuildError::Model { file, line, message }
}

/// The parts of a complaint.
#[derive(Debug, Default, PartialEq, Eq)]
struct Said {
    message: String,
    line: Option<usize>,
    /// What the element is called in the text, such as `geom`.
    element: String,
    /// The element's own name.
    name: String,
}

impl Said {
    /// The engine says `XML Error: WHAT\nElement 'geom', line 5`, `Error: WHAT\nElement name 'shin', id 3, line 5`, or
    /// `XML parse error 14:\nError=WHAT ErrorID=14 (0xe) Line number=3: XMLElement name=body`.
    fn read(said: &str) -> Self {
        let number = |after: &str| {
            let (_, rest) = said.rsplit_once(after)?;
            rest[..rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len())].parse().ok()
        };
        let between = |before: &str| Some(said.split_once(before)?.1.split_once('\'')?.0.to_owned());
        let element = between("Element '").unwrap_or_default();
        let name = between("Element name '").unwrap_or_default();
        let line = number("Line number=").or_else(|| number(", line "));
        let message = if let Some((_, fault)) = said.split_once("Error=XML_") {
            let fault = fault.split_whitespace().next().unwrap_or_default().to_lowercase().replace('_', " ");
            format!("the text is no XML: {fault}")
        } else {
            let plain = said.trim_start_matches("XML ").trim_start_matches("Error: ");
            let what = plain.split("\nElement ").next().unwrap_or_default().trim().replace('\n', " ");
            match (element.as_str(), name.as_str()) {
                ("", "") => what,
                (element, "") => format!("{what} (element `{element}`)"),
                (_, name) => format!("{what} (element of the name `{name}`)"),
            }
        };
        Self { message, line, element, name }
    }
}

/// The file other than `main`, and the line in it, where an element stands, if there is but one such file.
fn included(mount: &Mount, main: &str, element: &str, name: &str) -> Option<(String, Option<usize>)> {
    let wanted: &[String] = match (element, name) {
        ("", "") => return None,
        (_, name) if !name.is_empty() => &[format!("\"{name}\""), format!("'{name}'")],
        (element, _) => &[format!("<{element}")],
    };
    let mut places = mount.files().iter().filter(|(path, _)| *path != main).filter_map(|(path, bytes)| {
        let text = std::str::from_utf8(bytes).ok().filter(|_| scan::is_xml(bytes))?;
        let found: Vec<usize> = wanted.iter().flat_map(|wanted| text.match_indices(wanted)).map(|(at, _)| at).collect();
        let line = |at: usize| 1 + text[..at].matches('\n').count();
        match found[..] {
            [] => None,
            [at] => Some((path.to_owned(), Some(line(at)))),
            _ => Some((path.to_owned(), None)),
        }
    });
    places.next().filter(|_| places.next().is_none())
}

#[cfg(test)]
mod tests {
    use super::Said;

    #[test]
    fn the_parts_of_a_complaint_are_found() {
        let read = |said: &str| {
            let Said { message, line, .. } = Said::read(said);
            (message, line)
        };
        assert_eq!(
            read("XML Error: Schema violation: unrecognized element\nElement 'boddy', line 3\n"),
            ("Schema violation: unrecognized element (element `boddy`)".to_owned(), Some(3))
        );
        assert_eq!(
            read("Error: size 0 must be positive in geom\nElement name 'shin', id 0, line 12"),
            ("size 0 must be positive in geom (element of the name `shin`)".to_owned(), Some(12))
        );
        assert_eq!(
            read(
                "XML parse error 14:\nError=XML_ERROR_MISMATCHED_ELEMENT ErrorID=14 (0xe) Line number=3: XMLElement n"
            ),
            ("the text is no XML: error mismatched element".to_owned(), Some(3))
        );
        assert_eq!(read("Error: Error opening file 'q.stl'"), ("Error opening file 'q.stl'".to_owned(), None));
        assert_eq!(read(""), (String::new(), None));
    }
}
