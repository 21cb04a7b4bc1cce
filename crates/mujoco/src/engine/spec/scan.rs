//! What a text says of other files, read before the engine reads it.
//!
//! The engine looks for a file in the set that it is given, and then on the disk. So the names of all files that a text asks
//! for have to be known first ([`super::mount`]). No structure is needed for that: each attribute is a name, `=` and a
//! value in quotes, wherever it stands. Comments give a few names too many, which is no harm.

use std::collections::BTreeSet;

/// What was found in a text.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Found {
    /// The name of the outermost element, such as `mujoco` or `robot`.
    pub(super) root: String,
    /// Each part of each path, in lower case as the engine compares them.
    pub(super) parts: BTreeSet<Vec<u8>>,
}

/// What the engine or its wrapper could not stand.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Unreadable {
    pub(super) line: usize,
    pub(super) message: String,
}

/// Whether a file is an XML text: whether `<` is its first byte that is no white space.
pub(super) fn is_xml(bytes: &[u8]) -> bool {
    const MARK: &[u8] = b"\xEF\xBB\xBF";
    bytes.strip_prefix(MARK).unwrap_or(bytes).trim_ascii_start().first() == Some(&b'<')
}

/// Reads a file. Only XML texts are refused; but the engine's parser passes over what comes before the first `<`, so other
/// files may name files too.
pub(super) fn scan(bytes: &[u8]) -> Result<Found, Unreadable> {
    let fault = |offset: usize, message: String| {
        let line = bytes[..offset].split(|&byte| byte == b'\n').count();
        Unreadable { line, message }
    };
    let mut found = Found::default();
    if is_xml(bytes) {
        let text = std::str::from_utf8(bytes)
            .map_err(|error| fault(error.valid_up_to(), "the text is not UTF-8 here".to_owned()))?;
        if let Some(offset) = text.find('\0') {
            return Err(fault(offset, "the text has a NUL character".to_owned()));
        }
        // Names with such a character would be no UTF-8.
        for (offset, _) in text.match_indices("&#") {
            let reference = text[offset + 2..].split(';').next().unwrap_or_default();
            if character(reference.as_bytes()).is_none() {
                let shown: String = reference.chars().take(12).collect();
                return Err(fault(offset, format!("`&#{shown};` is no character")));
            }
        }
        found.root = root(text);
    }
    for equals in (0..bytes.len()).filter(|&at| bytes[at] == b'=') {
        let name = attribute(&bytes[..equals]);
        let names_file = name.starts_with(b"file") || name.ends_with(b"dir");
        let value = match quoted(&bytes[equals + 1..]) {
            Quoted::Value(value) => value,
            Quoted::Endless if names_file => {
                let name = String::from_utf8_lossy(name);
                return Err(fault(equals, format!("the attribute `{name}` has no end within 64 KiB")));
            }
            Quoted::Endless | Quoted::Nothing => continue,
        };
        if !(names_file || value.iter().copied().any(is_separator)) {
            continue;
        }
        let value = resolved(value);
        if names_file && value.iter().any(u8::is_ascii_control) {
            // The engine changes ends of lines.
            let name = String::from_utf8_lossy(name);
            return Err(fault(equals, format!("the attribute `{name}` names a file with a control character")));
        }
        // A part with a NUL is chance: the parser ends there.
        let parts = value
            .split(|&byte| is_separator(byte))
            .filter(|part| !matches!(*part, b"" | b"." | b"..") && !part.contains(&0));
        found.parts.extend(parts.map(<[u8]>::to_ascii_lowercase));
    }
    Ok(found)
}

fn is_separator(byte: u8) -> bool {
    matches!(byte, b'/' | b'\\')
}

/// The name of the first element; `?` and `!` begin declarations and comments.
fn root(text: &str) -> String {
    let mut rest = text;
    while let Some(start) = rest.find('<') {
        rest = &rest[start + 1..];
        if let Some(comment) = rest.strip_prefix("!--") {
            rest = comment.split_once("-->").map_or("", |(_, after)| after);
        } else if !rest.starts_with(['?', '!']) {
            let end = rest.find(|c: char| c.is_ascii_whitespace() || matches!(c, '>' | '/')).unwrap_or(rest.len());
            return rest[..end].to_owned();
        }
    }
    String::new()
}

/// The name that ends before `=`.
fn attribute(before: &[u8]) -> &[u8] {
    let before = before.trim_ascii_end();
    let ends = |byte: &u8| byte.is_ascii_whitespace() || matches!(byte, b'"' | b'\'' | b'<');
    &before[before.iter().rposition(ends).map_or(0, |at| at + 1)..]
}

/// What follows `=`.
enum Quoted<'a> {
    Nothing,
    Endless,
    Value(&'a [u8]),
}

/// What stands in quotes at the start. No path is so long that its end would have to be looked for farther off.
fn quoted(after: &[u8]) -> Quoted<'_> {
    const MOST: usize = 1 << 16;
    match after[..after.len().min(MOST)].trim_ascii_start().split_first() {
        Some((quote @ (b'"' | b'\''), after)) => {
            after.iter().position(|byte| byte == quote).map_or(Quoted::Endless, |end| Quoted::Value(&after[..end]))
        }
        _ => Quoted::Nothing,
    }
}

/// The value with its references replaced; what is none stays, as the engine leaves it.
fn resolved(value: &[u8]) -> Vec<u8> {
    const NAMED: [(&[u8], char); 5] = [(b"quot", '"'), (b"amp", '&'), (b"apos", '\''), (b"lt", '<'), (b"gt", '>')];
    let mut text = Vec::with_capacity(value.len());
    let mut rest = value;
    while let Some((&first, after)) = rest.split_first() {
        rest = after;
        let name =
            if first == b'&' { after.iter().position(|&byte| byte == b';').map(|end| &after[..end]) } else { None };
        let replaced = name.and_then(|name| {
            let named = NAMED.iter().find(|(known, _)| *known == name).map(|&(_, character)| character);
            Some((named.or_else(|| character(name.strip_prefix(b"#")?))?, name.len() + 1))
        });
        match replaced {
            Some((character, length)) => {
                text.extend_from_slice(character.encode_utf8(&mut [0; 4]).as_bytes());
                rest = &rest[length..];
            }
            None => text.push(first),
        }
    }
    text
}

/// The character of a reference, `65` or `x41`.
fn character(reference: &[u8]) -> Option<char> {
    let reference = std::str::from_utf8(reference).ok()?;
    let (digits, radix) = reference.strip_prefix('x').map_or((reference, 10), |digits| (digits, 16));
    let number = digits.chars().all(|digit| digit.is_digit(radix)).then(|| u32::from_str_radix(digits, radix).ok());
    number.flatten().and_then(char::from_u32).filter(|&character| character != '\0')
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parts(text: &str) -> Vec<String> {
        let found = scan(text.as_bytes()).expect("readable");
        found.parts.into_iter().map(|part| String::from_utf8(part).expect("of a text")).collect()
    }

    #[test]
    fn every_path_of_a_text_is_found() {
        let text = r#"<?xml version="1.0"?><!-- <a file="Old.stl"> --><mujoco><compiler meshdir='/Meshes/'/>
            <asset><mesh file = "a&#47;leg&amp;.STL"/><texture fileright="../x\y.png" width="3"/></asset></mujoco>"#;
        assert_eq!(parts(text), ["a", "leg&.stl", "meshes", "old.stl", "x", "y.png"]);
        assert_eq!(parts("<robot><mesh filename=\"package://arm/leg.stl\"/></robot>"), ["arm", "leg.stl", "package:"]);
        assert_eq!(parts("<a b=\"x\" c=\"file='q/r'\" d=\"1\"/>"), ["file='q", "q", "r", "r'"]);
        let found = scan(b"\xff\xff<a file='b/\xfe&#65;'/>").expect("no text of ours");
        assert_eq!(found.parts.into_iter().collect::<Vec<_>>(), [b"b".as_slice(), b"\xfea"]);
    }

    #[test]
    fn the_outermost_element_is_found() {
        for (text, root) in [
            ("\u{feff}<?xml?>\n<!-- <b/> -->\n<robot name='r'>", "robot"),
            ("<mujoco/>", "mujoco"),
            ("<a>", "a"),
            ("<!-- <b/> ", ""),
        ] {
            assert_eq!(scan(text.as_bytes()).expect("readable").root, root);
            assert!(is_xml(text.as_bytes()));
        }
        assert!(!is_xml(b"solid leg") && !is_xml(b""));
    }

    #[test]
    fn what_the_engine_could_not_stand_is_refused() {
        for (bytes, line, said) in [
            (b"<a>\n\xff</a>".as_slice(), 2, "not UTF-8"),
            (b"<a>\0</a>", 1, "NUL"),
            (b"<a>\n\n<b name='&#xD800;'/></a>", 3, "`&#xD800;` is no character"),
            (b"<a b='&#0;'/>", 1, "no character"),
            (b"<a b='&#x110000;'/>", 1, "no character"),
            (b"<a b='&#+65;'/>", 1, "no character"),
            (b"<a file='x&#10;y'/>", 1, "control character"),
            (b"<a\nfile='x/>", 2, "the attribute `file` has no end"),
        ] {
            let fault = scan(bytes).expect_err("unreadable");
            assert!(fault.line == line && fault.message.contains(said), "{fault:?}");
        }
    }
}
