//! A writer for the little XML that a model needs: elements and attributes. A crate would bring a parser, text and namespaces
//! with it; this closes what it opens and escapes what it is given, and that is all that is asked for.

use std::fmt::{Display, Write};

/// An element with its attributes and what it contains.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Element {
    name: &'static str,
    attributes: String,
    children: Vec<Element>,
}

impl Element {
    /// An empty element.
    pub(super) fn new(name: &'static str) -> Self {
        Self { name, attributes: String::new(), children: Vec::new() }
    }

    /// With an attribute more. Numbers are written so that they are read back to the last bit.
    #[must_use]
    pub(super) fn set(mut self, key: &str, value: impl Display) -> Self {
        let value = value.to_string().replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;");
        // Writing to a string cannot fail.
        let _ = write!(self.attributes, " {key}=\"{value}\"");
        self
    }

    /// With an attribute of several numbers more.
    #[must_use]
    pub(super) fn set_all(self, key: &str, values: &[f64]) -> Self {
        let texts: Vec<String> = values.iter().map(f64::to_string).collect();
        self.set(key, texts.join(" "))
    }

    /// With an element inside more.
    #[must_use]
    pub(super) fn with(mut self, child: Element) -> Self {
        self.children.push(child);
        self
    }

    /// With several elements inside more.
    #[must_use]
    pub(super) fn with_all(mut self, children: impl IntoIterator<Item = Element>) -> Self {
        self.children.extend(children);
        self
    }

    /// The text of it, indented.
    pub(super) fn to_text(&self) -> String {
        let mut text = String::new();
        self.write(0, &mut text);
        text
    }

    fn write(&self, depth: usize, out: &mut String) {
        let (indent, Self { name, attributes, children }) = ("  ".repeat(depth), self);
        let _ = if children.is_empty() {
            writeln!(out, "{indent}<{name}{attributes}/>")
        } else {
            let opened = writeln!(out, "{indent}<{name}{attributes}>");
            for child in children {
                child.write(depth + 1, out);
            }
            opened.and_then(|()| writeln!(out, "{indent}</{name}>"))
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_nest_and_values_are_escaped() {
        let inner = Element::new("b").set("n", r#"<"&">"#).set_all("v", &[0.1, -2e-7]);
        let text = Element::new("a").with(inner).to_text();
        assert_eq!(text, "<a>\n  <b n=\"&lt;&quot;&amp;&quot;>\" v=\"0.1 -0.0000002\"/>\n</a>\n");
    }
}
