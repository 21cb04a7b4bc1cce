//! Names that cannot be read because of faults told elsewhere.

use std::cell::RefCell;

/// Names that stand for nothing because of faults that are told where they are said: whoever names them is not told again.
#[derive(Clone, Debug, Default)]
pub(crate) struct Faulty {
    /// Names and functions of one's own.
    pub(crate) own: Vec<String>,
    /// Definitions that were not read yet: what names them may be in order later.
    pub(crate) pending: Vec<String>,
    /// Whether commands or efforts are missing.
    pub(crate) ports: bool,
    /// What was named of these since somebody asked.
    named: RefCell<Option<String>>,
}

impl Faulty {
    /// Notes what is not found.
    pub(super) fn note(&self, name: &str) {
        let missing = |names: &[String]| names.iter().any(|known| known == name);
        if missing(&self.own) || missing(&self.pending) || self.ports && matches!(name, "command" | "effort") {
            self.named.borrow_mut().get_or_insert_with(|| name.to_owned());
        }
    }

    /// The first such name since the last call: a fault that came of it is none of its own.
    pub(crate) fn take(&self) -> Option<String> {
        self.named.take()
    }
}
