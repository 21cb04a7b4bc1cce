//! Three quantities in brackets.

use std::ops::RangeInclusive;

use hwasp_core::Dimension;
use hwasp_settings::{Fields, Item, Kind, Value, with_unit};

/// A field such as `["0.4 m", "0 m", "0 m"]`, in SI.
pub(super) fn vector(
    fields: &mut Fields<'_, '_>,
    key: &'static str,
    value: &mut [f64; 3],
    dimension: Dimension,
    limits: RangeInclusive<f64>,
    meaning: &str,
) {
    let of = Kind::Quantity(dimension, [*limits.start(), *limits.end()]);
    let item = Item::List(value.iter().map(|&x| Item::Text(with_unit(x, dimension))).collect());
    let kind = Kind::List { of: Box::new(of), length: [3, 3], single: false };
    fields.limits(format!("three, each {}", kind_limits(&kind))).kind(kind);
    fields.open(key, meaning, Some(item), |section, node| {
        let Value::List(items) = &node.value else {
            section.wrong(key, node, "is not a list of three quantities", Some(hint(dimension)));
            return;
        };
        if items.len() != 3 {
            section.wrong(key, node, &format!("has {} items, not three", items.len()), Some(hint(dimension)));
            return;
        }
        // All three are looked at before the first wrong one ends it.
        for (value, item) in value.iter_mut().zip(items) {
            if let Some(found) = section.checked_quantity(key, item, dimension, *value, &limits) {
                *value = found;
            }
        }
    });
}

fn kind_limits(kind: &Kind) -> String {
    if let Kind::List { of, .. } = kind { of.limits() } else { kind.limits() }
}

fn hint(dimension: Dimension) -> String {
    let example = with_unit(0.1, dimension);
    format!("write x, y and z like [\"{example}\", \"{example}\", \"{example}\"]")
}
