//! How programs call the functions of the controller.

use super::value::Value;

/// For what a thread waits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Wait {
    /// For nothing.
    No,
    /// For the next period.
    Period,
    /// So long, s.
    Time(f64),
    /// Until the motion of this count is over.
    Motion(u64),
}

/// What a function of the controller was given, in order and by name.
#[derive(Clone, Debug, Default)]
pub(crate) struct Arguments {
    pub(super) values: Vec<(Option<String>, Value)>,
}

impl Arguments {
    /// The one at this place, or of this name.
    pub(crate) fn get(&self, place: usize, name: &str) -> Option<&Value> {
        let named = self.values.iter().find(|(key, _)| key.as_deref() == Some(name)).map(|(_, value)| value);
        named.or_else(|| self.values.get(place).filter(|(key, _)| key.is_none()).map(|(_, value)| value))
    }

    /// The same, which has to be there.
    pub(crate) fn need(&self, place: usize, name: &str) -> Result<&Value, String> {
        self.get(place, name).ok_or_else(|| format!("{name} is missing"))
    }

    /// A number that may be left out.
    pub(crate) fn number_or(&self, place: usize, name: &str, otherwise: f64) -> Result<f64, String> {
        self.get(place, name).map_or(Ok(otherwise), Value::number)
    }

    /// All of them as text.
    pub(crate) fn text(&self) -> String {
        self.values.iter().map(|(_, value)| value.to_string()).collect()
    }
}

/// What a function of the controller gives back.
#[derive(Clone, Debug)]
pub(crate) struct Answer(pub Value, pub Wait);

/// What runs the functions that a program does not define itself.
pub(crate) trait Controller {
    /// Calls one; an error ends the program.
    fn call(&mut self, name: &str, arguments: &Arguments) -> Result<Answer, String>;
    /// Whether the motion of this count is over.
    fn over(&self, motion: u64) -> bool;
}
