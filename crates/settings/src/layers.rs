//! The layers of an experiment: its file, the tables of a method, the command line.

use std::sync::Arc;

use toml::de::{DeTable, DeValue};

use crate::fault::{Fault, Faults};
use crate::folder::Folder;
use crate::section::Reader;
use crate::source::{Finding, Origin, Source};
use crate::suggest::{listed, nearest};
use crate::text::shorten;
use crate::tree::{Entry, Node, Table, Value, from_toml, merge};

/// The longest file that is read, bytes: 1 MiB.
pub const LONGEST_FILE: usize = 1 << 20;
/// The longest file of which every syntax error is told; of a longer one the first has to do, because a file of
/// nothing but errors needs a hundred times its size for them.
const LONGEST_RECOVERY: usize = 1 << 16;
/// The longest value of an option, bytes.
const LONGEST_OPTION: usize = 1 << 14;
/// The deepest key of an option.
const DEEPEST: usize = 8;
/// Tables below `[methods]` that are looked into.
const MOST_OVERLAYS: usize = 64;

/// What one experiment was asked to be, before anything is checked. Later layers win: the file, then its
/// `[methods.<method>]` tables, then overrides in their order.
#[derive(Clone, Debug)]
pub struct Layers {
    sources: Vec<Source>,
    base: Table,
    overlays: Vec<(String, Origin, Node)>,
    overrides: Vec<Table>,
    /// Overrides that could not be understood, told together with all other faults.
    faults: Vec<Fault>,
    /// Where the files are that it names.
    folder: Folder,
}

impl Layers {
    /// Reads a file's text; `name` is what messages call it. Fails on what is no TOML, with every such line.
    pub fn from_text(name: &str, text: &str) -> Result<Self, Faults> {
        if text.len() > LONGEST_FILE {
            let message = format!("it has more than {LONGEST_FILE} bytes, the most that an experiment may have");
            return Err(Faults::single(name, message, Some("is this the right file?".into())));
        }
        let file = Source::File { name: name.into(), text: Arc::from(text) };
        let parsed = parse(&file, text)?;
        let mut layers = Self {
            sources: vec![file],
            base: parsed,
            overlays: Vec::new(),
            overrides: Vec::new(),
            faults: Vec::new(),
            folder: Folder::Nowhere,
        };
        layers.split_overlays();
        Ok(layers)
    }

    /// Gives each table under `[methods]` a source of its own, so that its faults are told apart from the file's.
    fn split_overlays(&mut self) {
        if !matches!(self.base.get("methods"), Some(Entry { node: Node { value: Value::Table(_), .. }, .. })) {
            return; // absent, or no table: `resolve` says so
        }
        let Some(Entry { node: Node { value: Value::Table(methods), .. }, .. }) = self.base.remove("methods") else {
            return;
        };
        for (name, Entry { key, mut node }) in methods {
            // Beyond any number of methods they are refused, whatever they hold.
            if self.overlays.len() < MOST_OVERLAYS {
                retag(&mut node, self.sources.len());
                self.sources.push(self.sources[0].clone());
            }
            self.overlays.push((name, key, node));
        }
    }

    /// The same, whose files are to be found there.
    #[must_use]
    pub fn with_folder(mut self, folder: Folder) -> Self {
        self.folder = folder;
        self
    }

    /// `--set key=value`. A fault in it is told when the experiment is resolved, together with all others.
    #[must_use]
    pub fn with_override(self, key: &str, value: &str) -> Self {
        self.with_option(format!("--set {key}={value}"), key, value)
    }

    /// `--set` with its argument as typed, `key=value`.
    #[must_use]
    pub fn with_assignment(mut self, assignment: &str) -> Self {
        if let Some((key, value)) = assignment.split_once('=') {
            return self.with_override(key.trim(), value.trim());
        }
        let hint = "write it as key=value, --set ppo.clip_ratio=0.1 for example".to_owned();
        self.refuse(
            Source::Option(format!("--set {assignment}")),
            "this sets nothing: it has no `=`".into(),
            Some(hint),
        );
        self
    }

    /// An option that stands for a key, such as `--seed 3` for `seed`; `typed` is what messages show. The value is read
    /// as TOML; what is none is taken as a text, so that `--set task.problem=reach` needs no quotes.
    #[must_use]
    pub fn with_option(mut self, typed: String, key: &str, value: &str) -> Self {
        let option = Source::Option(typed);
        if key.len() + value.len() > LONGEST_OPTION {
            let message = format!("it has {} bytes, and an option at most {LONGEST_OPTION}", key.len() + value.len());
            self.refuse(option, message, Some("write what is so long into an experiment file".into()));
            return self;
        }
        let path = match split_key(key) {
            Ok(path) => path,
            Err(message) => {
                self.refuse(option, message, Some("keys look like `seed` or `ppo.clip_ratio`".into()));
                return self;
            }
        };
        let source = self.sources.len();
        let origin = Origin { source, span: 0..0 };
        let node = match DeValue::parse(value) {
            Ok(parsed) => Node { origin: origin.clone(), ..Node::from_toml(&parsed, source) },
            Err(error) if value.starts_with(['[', '{', '"', '\'']) => {
                let hint = "texts in it are in double quotes; put the whole option into single ones for the shell";
                self.refuse(option, format!("the value is no TOML: {}", error.message()), Some(hint.into()));
                return self;
            }
            Err(_) => Node { origin: origin.clone(), value: Value::Text(value.to_owned()) },
        };
        self.sources.push(option);
        let mut path = path.into_iter().rev();
        let mut table = Table::new();
        if let Some(last) = path.next() {
            table.insert(last, Entry { key: origin.clone(), node });
        }
        for name in path {
            let node = Node { origin: origin.clone(), value: Value::Table(table) };
            table = Table::from([(name, Entry { key: origin.clone(), node })]);
        }
        self.overrides.push(table);
        self
    }

    fn refuse(&mut self, option: Source, message: String, hint: Option<String>) {
        let index = self.sources.len();
        self.faults.push(option.fault(index, &(0..0), Finding { key: String::new(), message, hint }));
        self.sources.push(option);
    }

    /// The text of a key at the top that was asked for last; none where it is absent or no text.
    pub fn top_text(&self, key: &str) -> Option<&str> {
        let tables = self.overrides.iter().rev().chain([&self.base]);
        match tables.filter_map(|table| table.get(key)).map(|entry| &entry.node.value).next() {
            Some(Value::Text(text)) => Some(text),
            _ => None,
        }
    }

    /// The methods that have tables of their own, with the source that these are.
    pub fn overlaid(&self) -> impl Iterator<Item = (&str, usize)> {
        self.overlays.iter().map(|(name, _, node)| (name.as_str(), node.origin.source))
    }

    /// The file's tables as they are for a method.
    pub fn merged(&self, method: &str) -> Table {
        let mut table = self.base.clone();
        for (name, _, node) in &self.overlays {
            if let (true, Value::Table(over)) = (name == method, &node.value) {
                merge(&mut table, over.clone());
            }
        }
        table
    }

    /// The same with the command line's overrides.
    pub fn overridden(&self, method: &str) -> Table {
        let mut table = self.merged(method);
        for over in &self.overrides {
            merge(&mut table, over.clone());
        }
        table
    }

    /// A reader of merged tables of these layers.
    pub fn reader(&self) -> Reader<'_> {
        Reader::new(&self.sources, &self.folder)
    }

    /// The same, which tells the faults of one source alone: those of the others have been told.
    pub fn reader_of(&self, source: usize) -> Reader<'_> {
        Reader::of(&self.sources, &self.folder, source)
    }

    /// Tells values in the place of tables, which a later option's key in that table would replace without a word.
    fn tell_replaced(&self, errors: &mut Faults) {
        let is_table = |entry: &Entry| matches!(entry.node.value, Value::Table(_));
        for (i, over) in self.overrides.iter().enumerate() {
            for (key, entry) in over.iter().filter(|(_, entry)| is_table(entry)) {
                let earlier = std::iter::once(&self.base).chain(&self.overrides[..i]);
                for Entry { node, .. } in earlier.filter_map(|layer| layer.get(key)).filter(|entry| !is_table(entry)) {
                    let (later, shown) = (self.sources[entry.node.origin.source].name(), node.shown());
                    let finding = Finding {
                        key: key.clone(),
                        message: format!("{key} is {shown}, and a table for {later}"),
                        hint: Some("leave one of them out".to_owned()),
                    };
                    let origin = &node.origin;
                    errors.push_with(|| self.sources[origin.source].fault(origin.source, &origin.span, finding));
                }
            }
        }
    }

    /// Tells faults of the layers themselves: options that say nothing, tables for methods that are none of `methods`.
    pub fn tell(&self, methods: &[&str], errors: &mut Faults) {
        self.faults.iter().for_each(|fault| errors.push(fault.clone()));
        self.tell_replaced(errors);
        for (name, key, node) in &self.overlays {
            let path = format!("methods.{}", shorten(name, 60));
            let mut add = |origin: &Origin, message: String, hint: String| {
                let finding = Finding { key: path.clone(), message, hint: Some(hint) };
                errors.push_with(|| self.sources[origin.source].fault(origin.source, &origin.span, finding));
            };
            if !methods.contains(&name.as_str()) {
                let hint = match nearest(name, methods.iter().copied()) {
                    Some(near) => format!("did you mean `{near}`?"),
                    None => format!("the methods are {}", listed(methods.iter().copied())),
                };
                add(key, format!("[{path}] is for a method that does not exist"), hint);
            } else if !matches!(node.value, Value::Table(_)) {
                let hint = format!("write its tables as [{path}.ppo] and so on");
                add(&node.origin, format!("{path} is {}, but has to be a table", node.shown()), hint);
            }
        }
    }
}

/// A file's tables, or every line of it that is no TOML.
fn parse(file: &Source, text: &str) -> Result<Table, Faults> {
    let (parsed, mut errors) = if text.len() <= LONGEST_RECOVERY {
        DeTable::parse_recoverable(text)
    } else {
        match DeTable::parse(text) {
            Ok(parsed) => (parsed, Vec::new()),
            Err(error) => (toml::Spanned::new(0..0, DeTable::new()), vec![error]),
        }
    };
    errors.sort_by_key(|error| error.span().map(|span| span.start));
    let mut faults = Faults::default();
    let mut first = None;
    let mut last = None;
    for error in errors {
        let span = error.span().unwrap_or_default();
        let at = span.start.min(text.len());
        // What follows on the same line is mostly an echo.
        if last.is_none_or(|last| text.as_bytes()[last..at].contains(&b'\n')) {
            let comma = text.as_bytes().get(at) == Some(&b',');
            let hint = match error.message() {
                "duplicate key" => Some("it is there already, further up".to_owned()),
                _ if comma => Some("is it a decimal comma? numbers have a point".to_owned()),
                _ => None,
            };
            let finding = Finding { key: String::new(), message: format!("no TOML: {}", error.message()), hint };
            faults.push_with(|| {
                let fault = file.fault(0, &span, finding);
                first.get_or_insert_with(|| fault.clone());
                fault
            });
            last = Some(at);
        }
    }
    // Another kind of file is told once, not line by line.
    let lines = text.lines().filter(|line| !line.trim().is_empty()).count();
    if let Some(first) = first.filter(|_| faults.count() > 3 && 2 * faults.count() > lines) {
        let most = format!("{} of its {lines} lines are no TOML: is this the right file?", faults.count());
        faults = Faults::default();
        faults.push(Fault { hint: Some(most), ..first });
    }
    faults.into_result()?;
    Ok(from_toml(parsed.get_ref(), 0))
}

/// Says of a value and everything in it that it is part of another source with the same text.
fn retag(node: &mut Node, source: usize) {
    node.origin.source = source;
    match &mut node.value {
        Value::List(items) => items.iter_mut().for_each(|item| retag(item, source)),
        Value::Table(table) => {
            for entry in table.values_mut() {
                entry.key.source = source;
                retag(&mut entry.node, source);
            }
        }
        _ => {}
    }
}

/// The parts of `design.placements.stiffness[2..5]`: dots inside of brackets and quotes do not part.
fn split_key(key: &str) -> Result<Vec<String>, String> {
    let mut parts = vec![String::new()];
    let (mut quote, mut depth) = (None, 0_usize);
    for c in key.chars() {
        match c {
            '"' | '\'' if quote.is_none() => quote = Some(c),
            c if quote == Some(c) => quote = None,
            '.' if quote.is_none() && depth == 0 => {
                parts.push(String::new());
            }
            c => {
                depth = match c {
                    '[' => depth + 1,
                    ']' => depth.saturating_sub(1),
                    _ => depth,
                };
                if let Some(part) = parts.last_mut() {
                    part.push(c);
                }
            }
        }
    }
    if quote.is_some() || parts.iter().any(|part| part.trim().is_empty()) {
        return Err(format!("`{}` is no key", shorten(key, 60)));
    }
    if parts.len() > DEEPEST {
        return Err(format!("a key of {} parts is deeper than any that exists", parts.len()));
    }
    Ok(parts.into_iter().map(|part| part.trim().to_owned()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `--set train=[]` before `--env-steps 2400` was lost: the later option made a table of it.
    #[test]
    fn a_value_in_the_place_of_a_table_is_told_whatever_comes_later() {
        let layers = Layers::from_text("mine.toml", "name = \"mine\"\n").unwrap();
        let layers = layers.with_override("train", "[]").with_option("--env-steps 9".into(), "train.env_steps", "9");
        let mut errors = Faults::default();
        layers.tell(&[], &mut errors);
        let told: Vec<_> = errors.faults().iter().map(|fault| (&*fault.place, &*fault.message)).collect();
        assert_eq!(told, [("--set train=[]", "train is [], and a table for --env-steps 9")]);
        // A list that a key of its own changes is no mistake.
        let layers = Layers::from_text("mine.toml", "[design]\nplacements = []\n").unwrap();
        let layers = layers.with_override("design.placements.gear", "action");
        let mut errors = Faults::default();
        layers.tell(&[], &mut errors);
        assert_eq!(errors.count(), 0);
    }
}
