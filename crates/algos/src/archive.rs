//! What a learner or a search knows, as named arrays: written and taken up again by one and the same text.

use std::collections::BTreeMap;

use hwasp_core::Moments;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// The most that a state may have counted: ten times the steps of the longest training, and so little that sums of counters
/// do not overflow.
const MOST_COUNTED: u64 = 1 << 44;

/// An array of one kind of number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Array {
    /// Parameters and what belongs to them.
    F32(#[serde(with = "hwasp_core::bits")] Vec<f32>),
    /// Real numbers.
    F64(#[serde(with = "hwasp_core::bits")] Vec<f64>),
    /// Counters.
    U64(Vec<u64>),
}

/// Arrays by name; the parts of a name are separated by dots.
pub type Archive = BTreeMap<String, Array>;

/// Why a saved state is not one of what it was given to.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum StateError {
    /// An array is not there, or of another kind of number.
    #[error("the saved state has no {kind} array `{name}`")]
    Missing {
        /// Its name.
        name: String,
        /// What it should hold.
        kind: &'static str,
    },
    /// An array is too long or too short.
    #[error("`{name}` of the saved state has {found} elements instead of {wanted}")]
    Length {
        /// Its name.
        name: String,
        /// How many it has.
        found: usize,
        /// How many it should have.
        wanted: usize,
    },
    /// A number that cannot be.
    #[error("`{name}` of the saved state is {value}, which is not {limits}")]
    Value {
        /// The array's name.
        name: String,
        /// What it has.
        value: f64,
        /// What it may have.
        limits: &'static str,
    },
}

/// Something that can be interrupted: with its settings and this state it goes on to the same bits.
pub trait Persist {
    /// Goes over everything that it has learned, in either direction. After an error while loading it is of no use any more.
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError>;

    /// What it has learned.
    ///
    /// # Errors
    /// [`StateError::Value`] where a number is not finite: such a state could not be loaded.
    fn save(&mut self) -> Result<Archive, StateError> {
        let mut archive = Archive::new();
        self.exchange(&mut Exchange::saving(&mut archive))?;
        Ok(archive)
    }

    /// Takes over what it had learned.
    fn load(&mut self, archive: &Archive) -> Result<(), StateError> {
        self.exchange(&mut Exchange::loading(archive))
    }
}

/// One direction of an exchange between a state and an [`Archive`]: each method writes its value into the archive, or
/// overwrites it from there.
#[derive(Debug)]
pub struct Exchange<'a> {
    side: Side<'a>,
    /// The names of the parts around, each with its dot.
    within: String,
}

#[derive(Debug)]
enum Side<'a> {
    Save(&'a mut Archive),
    Load(&'a Archive),
}

/// A kind of number that arrays have.
pub trait Element: Copy {
    /// What messages call it.
    const KIND: &'static str;
    /// As an array.
    fn wrap(values: Vec<Self>) -> Array;
    /// The array, if it is of this kind.
    fn unwrap(array: &Array) -> Option<&[Self]>;
    /// What numbers of this kind have to be in a state.
    const LIMITS: &'static str;
    /// The element, where it is no number that a state may have.
    fn unsound(self) -> Option<f64>;
}

macro_rules! element {
    ($type:ty, $variant:ident, $kind:literal, $limits:literal, $unsound:expr) => {
        impl Element for $type {
            const KIND: &'static str = $kind;
            const LIMITS: &'static str = $limits;

            fn wrap(values: Vec<Self>) -> Array {
                Array::$variant(values)
            }

            fn unwrap(array: &Array) -> Option<&[Self]> {
                if let Array::$variant(values) = array { Some(values) } else { None }
            }

            fn unsound(self) -> Option<f64> {
                let unsound: fn(Self) -> Option<f64> = $unsound;
                unsound(self)
            }
        }
    };
}

element!(f32, F32, "f32", "finite", |v| (!v.is_finite()).then_some(f64::from(v)));
element!(f64, F64, "f64", "finite", |v| (!v.is_finite()).then_some(v));
element!(u64, U64, "u64", "at most 2^44", |v| (v > MOST_COUNTED).then_some(v as f64));

impl<'a> Exchange<'a> {
    /// From states into `archive`.
    pub fn saving(archive: &'a mut Archive) -> Self {
        Self { side: Side::Save(archive), within: String::new() }
    }

    /// From `archive` into states.
    pub fn loading(archive: &'a Archive) -> Self {
        Self { side: Side::Load(archive), within: String::new() }
    }

    /// Whether values come from the archive.
    pub fn loads(&self) -> bool {
        matches!(self.side, Side::Load(_))
    }

    /// A part with names of its own.
    pub fn part(&mut self, name: &str, part: &mut dyn Persist) -> Result<(), StateError> {
        let outside = self.within.len();
        self.within.push_str(name);
        self.within.push('.');
        let done = part.exchange(self);
        self.within.truncate(outside);
        done
    }

    /// A vector whose length follows from the settings; its elements are finite, and counters below 2^44.
    pub fn vector<E: Element>(&mut self, name: &str, values: &mut Vec<E>) -> Result<(), StateError> {
        let wanted = values.len();
        self.series(name, values)?;
        if values.len() == wanted {
            return Ok(());
        }
        Err(StateError::Length { name: self.full(name), found: values.len(), wanted })
    }

    /// A vector of any length; its elements are finite.
    pub fn series<E: Element>(&mut self, name: &str, values: &mut Vec<E>) -> Result<(), StateError> {
        let name = self.full(name);
        if let Side::Load(archive) = &self.side {
            let found = archive.get(&name).and_then(E::unwrap);
            let Some(found) = found else { return Err(StateError::Missing { name, kind: E::KIND }) };
            values.clear();
            values.extend_from_slice(found);
        }
        if let Some(value) = values.iter().find_map(|v| v.unsound()) {
            return Err(StateError::Value { name, value, limits: E::LIMITS });
        }
        if let Side::Save(archive) = &mut self.side {
            archive.insert(name, E::wrap(values.clone()));
        }
        Ok(())
    }

    /// One number, finite.
    pub fn number<E: Element>(&mut self, name: &str, value: &mut E) -> Result<(), StateError> {
        let mut one = vec![*value];
        self.vector(name, &mut one)?;
        *value = one[0];
        Ok(())
    }

    /// A text, as the numbers of its characters; none where there is no array of this name.
    pub fn text(&mut self, name: &str, text: &mut Option<String>) -> Result<(), StateError> {
        let name = self.full(name);
        match &mut self.side {
            Side::Save(archive) => {
                if let Some(text) = text {
                    archive.insert(name, Array::U64(text.chars().map(u64::from).collect()));
                }
            }
            Side::Load(archive) => {
                let Some(array) = archive.get(&name) else {
                    *text = None;
                    return Ok(());
                };
                let Some(codes) = u64::unwrap(array) else { return Err(StateError::Missing { name, kind: u64::KIND }) };
                let mut read = String::with_capacity(codes.len());
                for &code in codes {
                    let Some(character) = u32::try_from(code).ok().and_then(char::from_u32) else {
                        return Err(StateError::Value {
                            name,
                            value: code as f64,
                            limits: "the number of a character",
                        });
                    };
                    read.push(character);
                }
                *text = Some(read);
            }
        }
        Ok(())
    }

    /// The archive of something else, as it is.
    ///
    /// # Errors
    /// None; in the form of the others.
    pub fn archive(&mut self, name: &str, archive: &mut Archive) -> Result<(), StateError> {
        let within = format!("{}.", self.full(name));
        match &mut self.side {
            Side::Save(all) => {
                all.extend(archive.iter().map(|(name, array)| (format!("{within}{name}"), array.clone())));
            }
            Side::Load(all) => {
                let parts =
                    all.range(within.clone()..).map_while(|(name, array)| Some((name.strip_prefix(&within)?, array)));
                *archive = parts.map(|(name, array)| (name.to_owned(), array.clone())).collect();
            }
        }
        Ok(())
    }

    /// An error about a value that was loaded.
    pub fn refuse(&self, name: &str, value: f64, limits: &'static str) -> StateError {
        StateError::Value { name: self.full(name), value, limits }
    }

    fn full(&self, name: &str) -> String {
        format!("{}{name}", self.within)
    }
}

impl Persist for Moments {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        with.number("count", &mut self.count)?;
        with.vector("mean", &mut self.mean)?;
        with.vector("squares", &mut self.squares)?;
        let unsound = [("count", &[self.count][..]), ("squares", &self.squares)]
            .into_iter()
            .find_map(|(name, values)| Some((name, *values.iter().find(|value| **value < 0.0)?)));
        unsound.map_or(Ok(()), |(name, value)| Err(with.refuse(name, value, "at least 0")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Clone, Debug, Default, PartialEq)]
    struct Inner {
        weights: Vec<f32>,
        steps: u64,
    }

    impl Persist for Inner {
        fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
            with.vector("weights", &mut self.weights)?;
            with.number("steps", &mut self.steps)
        }
    }

    #[derive(Clone, Debug, Default, PartialEq)]
    struct Outer {
        first: Inner,
        second: Inner,
        scores: Vec<f64>,
    }

    impl Persist for Outer {
        fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
            with.part("first", &mut self.first)?;
            with.part("second", &mut self.second)?;
            with.series("scores", &mut self.scores)
        }
    }

    fn outer() -> Outer {
        Outer {
            first: Inner { weights: vec![0.1, -0.0], steps: 3 },
            second: Inner { weights: vec![f32::MIN_POSITIVE], steps: MOST_COUNTED },
            scores: vec![1e-300, 2.0],
        }
    }

    fn blank() -> Outer {
        Outer {
            first: Inner { weights: vec![0.0; 2], steps: 0 },
            second: Inner { weights: vec![0.0], steps: 0 },
            ..Outer::default()
        }
    }

    #[test]
    fn comes_back_with_all_bits() {
        let archive = outer().save().unwrap();
        let names: Vec<&str> = archive.keys().map(String::as_str).collect();
        assert_eq!(names, ["first.steps", "first.weights", "scores", "second.steps", "second.weights"]);
        let mut again = blank();
        again.load(&archive).unwrap();
        assert_eq!(again, outer());
        assert!(again.first.weights[1].is_sign_negative());
    }

    #[test]
    fn says_what_does_not_fit() {
        let told = |change: fn(&mut Archive)| {
            let mut archive = outer().save().unwrap();
            change(&mut archive);
            blank().load(&archive).unwrap_err().to_string()
        };
        assert_eq!(
            told(|archive| drop(archive.remove("second.weights"))),
            "the saved state has no f32 array `second.weights`"
        );
        assert_eq!(
            told(|archive| drop(archive.insert("scores".into(), Array::F32(vec![])))),
            "the saved state has no f64 array `scores`"
        );
        assert_eq!(
            told(|archive| drop(archive.insert("first.weights".into(), Array::F32(vec![1.0])))),
            "`first.weights` of the saved state has 1 elements instead of 2"
        );
        assert_eq!(
            told(|archive| drop(archive.insert("scores".into(), Array::F64(vec![1.0, f64::NAN])))),
            "`scores` of the saved state is NaN, which is not finite"
        );
        assert_eq!(
            told(|archive| drop(archive.insert("first.steps".into(), Array::U64(vec![u64::MAX])))),
            "`first.steps` of the saved state is 18446744073709552000, which is not at most 2^44"
        );
        let broken = Outer { scores: vec![f64::INFINITY], ..outer() }.save();
        assert_eq!(broken.unwrap_err().to_string(), "`scores` of the saved state is inf, which is not finite");
    }

    /// A text and the lack of one, both ways.
    struct Said(Option<String>);

    impl Persist for Said {
        fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
            with.text("said", &mut self.0)
        }
    }

    #[test]
    fn texts_come_back_and_may_be_missing() {
        for said in [None, Some(String::new()), Some("5 µm, \"…\"".to_owned())] {
            let archive = Said(said.clone()).save().unwrap();
            assert_eq!(archive.contains_key("said"), said.is_some());
            let mut back = Said(Some("before".into()));
            back.load(&archive).unwrap();
            assert_eq!(back.0, said);
        }
        let surrogate: Archive = [("said".to_owned(), Array::U64(vec![0xD800]))].into();
        let error = Said(None).load(&surrogate).unwrap_err();
        assert_eq!(error.to_string(), "`said` of the saved state is 55296, which is not the number of a character");
    }
}
