//! How many components vectors have together, and which of them are meant.

use std::ops::Range;

use crate::error::ExprError;
use crate::formulas::Value;
use crate::syntax::Index;

/// The length of vectors that are taken together.
pub(crate) fn together(values: &[&Value], span: &Range<usize>) -> Result<usize, ExprError> {
    let mut length = 1;
    for value in values {
        match (length, value.parts.len()) {
            (_, 1) => {}
            (1, n) => length = n,
            (a, b) if a == b => {}
            (a, b) => {
                let message = format!("vectors of {a} and of {b} components do not go together");
                return Err(ExprError::new(span.clone(), message).hint("a slice takes a part: x[0:3], x.z"));
            }
        }
    }
    Ok(length)
}

/// Which components are meant.
pub(crate) fn range(index: Index, length: usize, span: &Range<usize>) -> Result<Range<usize>, ExprError> {
    let size = length as i64;
    let from_end = |at: i64| if at < 0 { at + size } else { at };
    let plural = if length == 1 { "component" } else { "components" };
    match index {
        Index::One(at) => {
            let found = from_end(at);
            if (0..size).contains(&found) {
                return Ok(found as usize..found as usize + 1);
            }
            let message = format!("there is no component {at}: the vector has {length} {plural}, counted from 0");
            Err(ExprError::new(span.clone(), message))
        }
        Index::Range(from, to) => {
            let (from, to) = (from.map_or(0, from_end), to.map_or(size, from_end));
            if 0 <= from && from < to && to <= size {
                return Ok(from as usize..to as usize);
            }
            let message =
                format!("the slice is empty or outside of the {length} {plural}; the end is not part of a slice");
            Err(ExprError::new(span.clone(), message))
        }
    }
}
