//! Fields of several values.

use std::ops::RangeInclusive;

use hwasp_core::Dimension;

use super::{Fields, ends, names, quantity, shown};
use crate::choice::Choice;
use crate::field::{Kind, readable};
use crate::item::Item;

impl Fields<'_, '_> {
    /// A list of names, from 1 to `most` of them.
    pub fn choices<T: Choice>(&mut self, key: &str, value: &mut Vec<T>, most: usize, meaning: &str) {
        let kind = || Kind::List { of: Box::new(Kind::Choice(names::<T>())), length: [1, most], single: false };
        let item = Item::List(value.iter().map(|choice| Item::from(choice.name())).collect());
        self.field(key, meaning, kind, &shown(&item), item.clone(), |section| {
            if let Some(chosen) = section.choices(key, T::ALL, most) {
                *value = chosen;
            }
        });
    }

    /// Two quantities, `["40 mm", "100 mm"]`, the smaller one first, or one for both; SI.
    pub fn span(
        &mut self,
        key: &str,
        value: &mut [f64; 2],
        dimension: Dimension,
        limits: RangeInclusive<f64>,
        meaning: &str,
    ) {
        let of = || match dimension {
            Dimension::None => Kind::Number(ends(&limits)),
            _ => Kind::Quantity(dimension, ends(&limits)),
        };
        let kind = || Kind::List { of: Box::new(of()), length: [1, 2], single: true };
        let exchanged = *value;
        let item = Item::List(exchanged.iter().map(|&end| quantity(end, dimension)).collect());
        let unit = readable(dimension, *limits.end());
        let [from, to] = exchanged.map(|end| unit.short(end));
        let default = format!("{from} to {to} {}", unit.symbol);
        self.field(key, meaning, kind, default.trim_end(), item, |section| {
            *value = section.span(key, dimension, exchanged, &limits);
        });
    }

    /// Two fractions of training, in order.
    pub fn fractions(&mut self, key: &str, value: &mut [f64; 2], meaning: &str) {
        let kind = || Kind::List { of: Box::new(Kind::Number([0.0, 1.0])), length: [2, 2], single: false };
        let exchanged = *value;
        let item = Item::List(exchanged.map(Item::Float).to_vec());
        self.limits.get_or_insert_with(|| "0 to 1, in order".to_owned());
        self.field(key, meaning, kind, &shown(&item), item.clone(), |section| {
            *value = section.fractions(key, exchanged);
        });
    }

    /// Whole numbers, at most `most` of them: sizes of layers.
    pub fn counts(
        &mut self,
        key: &str,
        value: &mut Vec<usize>,
        most: usize,
        limits: RangeInclusive<usize>,
        meaning: &str,
    ) {
        let of = || Kind::Integer([*limits.start() as u64, *limits.end() as u64]);
        let kind = || Kind::List { of: Box::new(of()), length: [0, most], single: false };
        let item = Item::List(value.iter().map(|&count| Item::Integer(count as u64)).collect());
        self.field(key, meaning, kind, &shown(&item), item.clone(), |section| {
            *value = section.counts(key, value, most, &limits);
        });
    }

    /// Real numbers, as many as there are.
    pub fn numbers(&mut self, key: &str, value: &mut Vec<f64>, limits: RangeInclusive<f64>, meaning: &str) {
        let kind = || Kind::List { of: Box::new(Kind::Number(ends(&limits))), length: [0, usize::MAX], single: false };
        let item = Item::List(value.iter().map(|&number| Item::Float(number)).collect());
        self.field(key, meaning, kind, &shown(&item), item.clone(), |section| {
            *value = section.numbers(key, value, &limits);
        });
    }

    /// Real numbers, as many as there are, where one stands for all of them.
    pub fn each(&mut self, key: &str, value: &mut [f64], limits: RangeInclusive<f64>, meaning: &str) {
        let kind = || Kind::List { of: Box::new(Kind::Number(ends(&limits))), length: [1, usize::MAX], single: true };
        let item = one_for_all(value);
        self.field(key, meaning, kind, &shown(&item), item.clone(), |section| {
            if let Some(each) = section.each(key, value.len(), &limits) {
                value.copy_from_slice(&each);
            }
        });
    }

    /// The same, or "none", which is not written.
    pub fn optional_each(
        &mut self,
        key: &str,
        value: &mut Option<Vec<f64>>,
        (length, limits): (usize, RangeInclusive<f64>),
        meaning: &str,
    ) {
        let each = || Kind::List { of: Box::new(Kind::Number(ends(&limits))), length: [1, usize::MAX], single: true };
        let kind = || Kind::Optional(Box::new(each()));
        let item = value.as_deref().map(one_for_all);
        self.optional_field(key, meaning, kind, item, |section| {
            if section.has(key) {
                *value = section.each(key, length, &limits);
            }
        });
    }
}

/// One number where all are alike.
fn one_for_all(values: &[f64]) -> Item {
    match values {
        [first, rest @ ..] if rest.iter().all(|other| other == first) => Item::Float(*first),
        all => Item::List(all.iter().map(|&value| Item::Float(value)).collect()),
    }
}
