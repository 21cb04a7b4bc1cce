//! What a formula is made of, for whoever names its parts.

use std::ops::Range;

use crate::parser::parse;
use crate::syntax::{Node, Path, Tree};

/// The names in a formula that stand for all elements of a kind, `joint.*.pos`, each with its bytes in the text, those of an index
/// behind it included. None of a text that is no formula.
pub fn groups(text: &str) -> Vec<(Path, Range<usize>)> {
    let mut found = Vec::new();
    let Ok(tree) = parse(text) else { return found };
    let mut left = vec![&tree];
    while let Some(Tree { node, span }) = left.pop() {
        let name = match node {
            Node::Name(path) => Some(path),
            Node::Slice(inner, _) => match &inner.node {
                Node::Name(path) => Some(path),
                _ => None,
            },
            _ => None,
        };
        match name {
            Some(path) if path.word(1) == Some("*") => found.push((path.clone(), span.clone())),
            Some(_) => {}
            None => left.extend(node.within()),
        }
    }
    found.sort_by_key(|(_, span)| span.start);
    found
}
