//! A small declarative reader: ask a table for its keys, get a value for each, and all faults at the end.

use std::cell::RefCell;
use std::ops::Range;

use crate::fault::Faults;
use crate::folder::Folder;
use crate::source::{Finding, Origin, Source};
use crate::suggest::{either, listed, nearest};
use crate::text::shorten;
use crate::tree::{Entry, Node, Table, Value};

/// What all sections of one experiment share: where values come from, and the faults found so far.
pub struct Reader<'r> {
    sources: &'r [Source],
    folder: &'r Folder,
    /// The one source whose faults are told; all if none is named.
    only: Option<usize>,
    errors: RefCell<Faults>,
    /// Keys whose value became the default because it was wrong.
    unsound: RefCell<Vec<String>>,
    /// Every key that some section asked for, with the section.
    known: RefCell<Vec<(String, String)>>,
    /// Keys that nobody asked for: section, key and where it stands.
    unknown: RefCell<Vec<(String, String, Origin)>>,
}

impl<'r> Reader<'r> {
    pub(crate) fn new(sources: &'r [Source], folder: &'r Folder) -> Self {
        Self {
            sources,
            folder,
            only: None,
            errors: RefCell::default(),
            unsound: RefCell::default(),
            known: RefCell::default(),
            unknown: RefCell::default(),
        }
    }

    /// The same for the faults of one source: those of the others have been told.
    pub(crate) fn of(sources: &'r [Source], folder: &'r Folder, source: usize) -> Self {
        Self { only: Some(source), ..Self::new(sources, folder) }
    }

    /// Whether faults that stand here are told.
    fn tells(&self, origin: Option<&Origin>) -> bool {
        self.only.is_none_or(|only| origin.is_some_and(|origin| origin.source == only))
    }

    /// Notes a fault; without an origin it is about what the file does not say.
    pub fn fault(&self, origin: Option<&Origin>, key: &str, message: String, hint: Option<String>) {
        if !self.tells(origin) {
            return;
        }
        let mut errors = self.errors.borrow_mut();
        if errors.is_full() {
            return errors.count_one();
        }
        let hint = hint.filter(|hint| !hint.is_empty());
        let finding = Finding { key: key.to_owned(), message, hint };
        let missing = Origin::default();
        let at = origin.unwrap_or(&missing);
        let mut fault = self.sources[at.source].fault(at.source, &at.span, finding);
        if origin.is_none() {
            fault.place = self.sources[at.source].name();
            (fault.line, fault.excerpt, fault.rank, fault.source) = (None, None, (0, 0, 0), None);
        }
        errors.push(fault);
    }

    /// Whether each of these keys has the value that was asked for, so that they can be held against each other.
    pub fn sound(&self, keys: &[&str]) -> bool {
        !self.unsound.borrow().iter().any(|key| keys.contains(&key.as_str()))
    }

    /// The table under `name`, or what stands for it where the file has none.
    pub fn section<'s>(&'s self, root: &mut Section<'s>, name: &str) -> Section<'s> {
        let table = match root.take(name) {
            None => None,
            Some(Node { value: Value::Table(table), .. }) => Some(table),
            Some(node) => {
                // `[[name]]` begins a list, and nobody knows that who wrote it.
                let list = matches!(node.value, Value::List(_));
                let (found, how) =
                    if list { ("a list".to_owned(), " with single brackets") } else { (node.shown(), "") };
                let hint = format!("write its keys below a line [{name}]{how}, or set one, --set {name}.KEY=VALUE");
                let message = format!("{name} is {found}, but has to be a table");
                self.fault(Some(&node.origin), name, message, Some(hint));
                None
            }
        };
        Section { reader: self, path: name.to_owned(), table, known: Vec::new() }
    }

    /// All faults, those of unknown keys included.
    pub fn into_errors(self) -> Faults {
        for (path, key, origin) in self.unknown.borrow().iter().filter(|(_, _, origin)| self.tells(Some(origin))) {
            if self.errors.borrow().is_full() {
                self.errors.borrow_mut().count_one();
                continue;
            }
            let known = self.known.borrow();
            let full = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
            let place = if path.is_empty() { "at the top".to_owned() } else { format!("in [{path}]") };
            let here = || known.iter().filter(|(section, _)| section == path).map(|(_, key)| key.as_str());
            // The sections that have a key of this name, in words.
            let owners = |name: &str| {
                let sections = known.iter().filter(|(_, other)| other == name);
                let sections = sections.map(|(s, _)| if s.is_empty() { "the top".into() } else { format!("[{s}]") });
                either(&sections.collect::<Vec<_>>())
            };
            let hint = if let Some(near) = nearest(key, here()) {
                format!("did you mean `{near}`?")
            } else if let Some(near) = nearest(key, known.iter().map(|(_, other)| other.as_str())) {
                let what = if near == key { "it belongs to" } else { &format!("did you mean `{near}` of") };
                format!("{what} {}{}", owners(near), if near == key { "" } else { "?" })
            } else {
                format!("the keys here are {}", listed(here()))
            };
            let message = format!("unknown key `{}` {place}", shorten(key, 60));
            self.fault(Some(origin), &shorten(&full, 120), message, Some(hint));
        }
        self.errors.into_inner()
    }
}

/// One table of an experiment.
pub struct Section<'r> {
    pub(crate) reader: &'r Reader<'r>,
    path: String,
    table: Option<&'r Table>,
    known: Vec<String>,
}

impl<'r> Section<'r> {
    /// The top of an experiment.
    pub fn root(reader: &'r Reader<'r>, table: &'r Table) -> Self {
        Self { reader, path: String::new(), table: Some(table), known: Vec::new() }
    }

    /// The value of a key, if there is one; the key counts as known from now on.
    pub fn take(&mut self, key: &str) -> Option<&'r Node> {
        self.known.push(key.to_owned());
        self.table?.get(key).map(|entry| &entry.node)
    }

    /// Whether there is a value for a key.
    pub fn has(&self, key: &str) -> bool {
        self.table.is_some_and(|table| table.contains_key(key))
    }

    /// Whether a key has this text; it counts as known then.
    pub fn is_text(&mut self, key: &str, text: &str) -> bool {
        let is = |entry: &Entry| matches!(&entry.node.value, Value::Text(found) if found == text);
        let found = self.table.and_then(|table| table.get(key)).is_some_and(is);
        if found {
            self.known.push(key.to_owned());
        }
        found
    }

    /// The dotted path of a key.
    pub fn path(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    /// Where the value of a key was written.
    pub fn origin(&self, key: &str) -> Option<&'r Origin> {
        self.table?.get(key).map(|entry| &entry.node.origin)
    }

    /// Notes a fault of the value of a key: `path.key = value` followed by `rest`.
    pub fn wrong(&self, key: &str, node: &Node, rest: &str, hint: Option<String>) {
        let path = self.path(key);
        self.reader.fault(Some(&node.origin), &path, format!("{path} = {} {rest}", node.shown()), hint);
        self.reader.unsound.borrow_mut().push(path);
    }

    /// Notes a fault at a place in the table.
    pub fn fault_at(&self, origin: &Origin, key: &str, message: String, hint: Option<String>) {
        self.reader.fault(Some(origin), &self.path(key), message, hint);
    }

    /// The value of a key that was asked for, to look at again.
    pub fn node(&self, key: &str) -> Option<&'r Node> {
        self.table?.get(key).map(|entry| &entry.node)
    }

    /// Where the files are that the experiment names.
    pub fn folder(&self) -> &'r Folder {
        self.reader.folder
    }

    /// Notes a fault of a part of a text, bytes `part` of it, and that the key's value is wrong.
    pub fn wrong_within(&self, key: &str, node: &Node, part: &Range<usize>, message: String, hint: Option<String>) {
        let path = self.path(key);
        let origin = self.reader.sources[node.origin.source].within(&node.origin, part);
        self.reader.fault(Some(&origin), &path, message, hint);
        self.reader.unsound.borrow_mut().push(path);
    }

    /// Whether any key of this table or below it had a wrong value.
    pub fn all_sound(&self) -> bool {
        self.sound_below(&self.path)
    }

    /// Whether each of these keys of this table has the value that was asked for.
    pub fn sound(&self, keys: &[&str]) -> bool {
        let paths: Vec<String> = keys.iter().map(|key| self.path(key)).collect();
        self.reader.sound(&paths.iter().map(String::as_str).collect::<Vec<_>>())
    }

    /// Whether no key of another table had a wrong value.
    pub fn sound_below(&self, table: &str) -> bool {
        let begin = format!("{table}.");
        !self.reader.unsound.borrow().iter().any(|key| key.starts_with(&begin))
    }

    /// Notes a fault between keys, at the value of this one, or at the file where the key is absent.
    pub fn clash(&self, key: &str, message: String, hint: &str) {
        self.reader.fault(self.origin(key), &self.path(key), message, Some(hint.to_owned()));
    }

    /// Refuses a key that exists, but says nothing in this experiment. Hints leave it out.
    pub fn refuse(&mut self, key: &str, why: &str) {
        let Some(entry) = self.table.and_then(|table| table.get(key)) else { return };
        self.known.push(key.to_owned());
        let path = self.path(key);
        let message = format!("{path} does not belong here: {why}");
        self.reader.fault(Some(&entry.key), &path, message, Some("leave it out".into()));
    }

    /// Leaves keys that nobody asked for to be told at the end, when all known ones are known.
    pub fn finish(self) {
        let mut known = self.reader.known.borrow_mut();
        known.extend(self.known.iter().map(|key| (self.path.clone(), key.clone())));
        let mut unknown = self.reader.unknown.borrow_mut();
        for (key, entry) in self.table.into_iter().flatten() {
            if !self.known.contains(key) {
                unknown.push((self.path.clone(), key.clone(), entry.key.clone()));
            }
        }
    }
}
