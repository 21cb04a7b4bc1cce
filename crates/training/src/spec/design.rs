//! `[design]`: where each design parameter sits and where it begins.

use std::ops::Range;

use hwasp_core::Dimension;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use super::Method;
use super::fault::{shorten, show};
use super::names::named;
use super::section::Section;
use super::suggest::{listed, nearest};
use super::task::{GroupSpec, Problem, TaskSpec};
use super::tree::{Node, Value};
use super::values::with_unit;

named! {
    /// Where a design parameter sits.
    pub enum Place {
        /// In the policy's computational graph (`HWasP`).
        Graph = "graph",
        /// In the action (HWasP-Minimal).
        Action = "action",
        /// Nowhere: it keeps its first value.
        Fixed = "fixed",
    }
}

/// Where the parameters begin.
#[derive(Clone, Debug, PartialEq)]
pub enum InitialSpec {
    /// The unbounded parameters uniform within ±`logit_half_width`.
    Logit,
    /// In the middle of their limits.
    Middle,
    /// Where the law of a problem of one's own says.
    Law,
    /// The parameters of these groups at these values, others in the middle of their limits.
    Values(Vec<InitialValue>),
}

/// Where the parameters of a group begin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InitialValue {
    /// The group.
    pub group: &'static str,
    /// In SI.
    pub value: f64,
    /// What it measures.
    pub dimension: Dimension,
    /// Whether it is the task's only group, which needs no name.
    only: bool,
}

impl InitialSpec {
    /// Every group at a value of its own, SI; the values are in the order of the groups.
    pub fn at(groups: &[GroupSpec], values: &[f64]) -> Self {
        let only = groups.len() == 1;
        let initial =
            |(g, &value): (&GroupSpec, &f64)| InitialValue { group: g.name, value, dimension: g.dimension, only };
        let mut values: Vec<InitialValue> = groups.iter().zip(values).map(initial).collect();
        // As they are read from a file.
        values.sort_by_key(|value| value.group);
        Self::Values(values)
    }
}

/// Parameters that sit elsewhere than the others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlacedRange {
    /// Their group.
    pub group: &'static str,
    /// Their indices in it.
    pub range: Range<usize>,
    /// The index of its first parameter in the design.
    pub first: usize,
    /// Where they sit.
    pub place: Place,
}

/// `[design]`.
///
/// | key | default | meaning | limits |
/// |---|---|---|---|
/// | `placement` | hwasp: "graph", fixed: "fixed", else "action" | where the parameters sit | |
/// | `placements` | none | where some of them sit: `{ "stiffness[0]" = "action", "stiffness[3..5]" = "fixed" }` (3 and 4), or a list of one place each | |
/// | `initial` | "logit" (a problem of your own: "law") | `logit`, `middle`, `law` (as its law says), a quantity, or one for each group, `{ thumb_distal_radius = "6 mm" }`; groups left out begin in the middle | inside of the parameter's limits |
/// | `logit_half_width` | 5.0 | half width of the uniform start before the squash | 0 to 20 |
/// | `learning_rate_scale` | 1.0 | times the policy's learning rate (PPO) | 0 to 1000 |
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DesignSpec {
    /// Where the parameters sit, unless `placements` says otherwise.
    pub placement: Place,
    /// Where every parameter begins.
    pub initial: InitialSpec,
    /// Half width of the uniform start before the squash.
    pub logit_half_width: f64,
    /// Times the policy's learning rate.
    pub learning_rate_scale: f64,
    /// Exceptions, in order and disjoint.
    #[serde(serialize_with = "write_placements", skip_serializing_if = "Vec::is_empty")]
    pub placements: Vec<PlacedRange>,
}

impl DesignSpec {
    /// Where parameter `i` sits.
    pub fn place_of(&self, i: usize) -> Place {
        let here = |placed: &&PlacedRange| i >= placed.first && placed.range.contains(&(i - placed.first));
        self.placements.iter().find(here).map_or(self.placement, |placed| placed.place)
    }

    /// Reads the table for the parameters of a task.
    pub(super) fn read(mut s: Section<'_>, method: Method, task: &TaskSpec) -> Self {
        let groups = task.groups();
        let default = match method {
            Method::Hwasp => Place::Graph,
            Method::Fixed => Place::Fixed,
            // A search moves the parameter, and the plant evaluates the law.
            Method::Minimal | Method::Cmaes | Method::Ars | Method::CmaesRl | Method::ArsRl => Place::Action,
        };
        let spec = Self {
            placement: s.choice("placement", Place::ALL).unwrap_or(default),
            initial: read_initial(&mut s, &groups, matches!(task.problem, Problem::Own(_))),
            logit_half_width: s.number("logit_half_width", 5.0, 0.0..=20.0),
            learning_rate_scale: s.number("learning_rate_scale", 1.0, 0.0..=1000.0),
            placements: read_placements(&mut s, &groups),
        };
        s.finish();
        spec
    }
}

fn read_initial(s: &mut Section<'_>, groups: &[GroupSpec], own: bool) -> InitialSpec {
    let Some(node) = s.take("initial") else {
        return if own { InitialSpec::Law } else { InitialSpec::Logit };
    };
    match (&node.value, groups) {
        (Value::Text(text), _) if text == "law" && own => InitialSpec::Law,
        (Value::Text(text), _) if text == "logit" => InitialSpec::Logit,
        (Value::Text(text), _) if text == "middle" => InitialSpec::Middle,
        (Value::Text(text), _) if !text.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.')) => {
            let hint = "it is \"logit\", \"middle\" or a quantity".to_owned();
            s.wrong("initial", node, "is no start that is known", Some(hint));
            InitialSpec::Logit
        }
        (Value::Table(table), _) => {
            let mut values = Vec::new();
            for (name, entry) in table {
                let key = format!("initial.{}", shorten(name, 60));
                if let Some(group) = groups.iter().find(|group| group.name == name) {
                    values.extend(read_value(s, &key, &entry.node, group, groups.len() == 1));
                } else {
                    let names = groups.iter().map(|group| group.name);
                    let hint = nearest(name, names.clone()).map(|near| format!("did you mean `{near}`?"));
                    let message = format!("design.{key} is none of the task's parameters: {}", listed(names));
                    s.reader.fault(Some(&entry.key), &s.path(&key), message, hint);
                }
            }
            InitialSpec::Values(values)
        }
        (_, [group]) => {
            read_value(s, "initial", node, group, true).map_or(InitialSpec::Logit, |v| InitialSpec::Values(vec![v]))
        }
        (_, groups) => {
            let hint = format!("name the parameters: {{ {} = … }}", groups[0].name);
            s.wrong("initial", node, &format!("is one value for {} different parameters", groups.len()), Some(hint));
            InitialSpec::Logit
        }
    }
}

fn read_value(s: &Section<'_>, key: &str, node: &Node, group: &GroupSpec, only: bool) -> Option<InitialValue> {
    let &GroupSpec { name, dimension, lo, hi, count, .. } = group;
    let value = s.checked_quantity(key, node, dimension, 0.5 * (lo + hi), &(f64::NEG_INFINITY..=f64::INFINITY))?;
    if value > lo && value < hi {
        return Some(InitialValue { group: name, value, dimension, only });
    }
    // The limits depend on other keys; where those are wrong, this may well be right.
    if s.reader.sound(&["task.segments", "task.stiffness_total_max", "task.length_total_max", "task.range"]) {
        let (lo, hi) = (show(lo), with_unit(hi, dimension));
        let start = if count == 1 { "it".to_owned() } else { format!("each of the {count}") };
        let hint = format!("{start} has to begin between them: the squash has no inverse at its limits");
        s.wrong(key, node, &format!("is not inside ({lo}, {hi})"), Some(hint));
    }
    None
}

fn read_placements(s: &mut Section<'_>, groups: &[GroupSpec]) -> Vec<PlacedRange> {
    let Some(node) = s.take("placements") else { return Vec::new() };
    let count = groups.iter().map(|group| group.count).sum::<usize>();
    let example = format!("write it like {{ \"{}[0]\" = \"action\" }}, or as a list of one place each", groups[0].name);
    let mut placed: Vec<PlacedRange> = Vec::new();
    match &node.value {
        Value::Table(table) => {
            for (name, entry) in table {
                let key = format!("placements.\"{}\"", shorten(name, 60));
                let place = s.chosen(&key, &entry.node, Place::ALL);
                match parse_range(name, groups) {
                    Ok((group, range)) => placed.extend(place.map(|place| placed_range(group, range, place))),
                    Err(message) => {
                        let key = s.path(&key);
                        s.reader.fault(Some(&entry.key), &key, message, Some(example.clone()));
                    }
                }
            }
        }
        Value::List(items) if items.len() == count => {
            let members = groups.iter().flat_map(|group| (0..group.count).map(move |i| (group, i)));
            for (at, ((group, i), item)) in members.zip(items).enumerate() {
                let place = s.chosen(&format!("placements[{at}]"), item, Place::ALL);
                placed.extend(place.map(|place| placed_range(group, i..i + 1, place)));
            }
        }
        Value::List(items) => {
            let parameters = if count == 1 { "parameter" } else { "parameters" };
            let rest = format!("has {} items, but the task has {count} {parameters}", items.len());
            s.wrong("placements", node, &rest, Some(example));
        }
        _ => s.wrong("placements", node, "is neither a table nor a list", Some(example)),
    }
    placed.sort_by_key(|p| (p.first, p.range.start, p.range.end));
    check_disjoint(s, node, &placed);
    placed
}

fn placed_range(group: &GroupSpec, range: Range<usize>, place: Place) -> PlacedRange {
    PlacedRange { group: group.name, range, first: group.first, place }
}

fn check_disjoint(s: &Section<'_>, node: &Node, placed: &[PlacedRange]) {
    for pair in placed.windows(2) {
        if pair[1].first == pair[0].first && pair[1].range.start < pair[0].range.end {
            let message = format!(
                "design.placements places {} twice: by {} as \"{}\" and by {} as \"{}\"",
                name_of(&(pair[1].range.start..pair[1].range.start + 1), pair[1].group),
                name_of(&pair[0].range, pair[0].group),
                pair[0].place.name(),
                name_of(&pair[1].range, pair[1].group),
                pair[1].place.name(),
            );
            let hint = "let every parameter be in one of them".to_owned();
            s.reader.fault(Some(&node.origin), "design.placements", message, Some(hint));
        }
    }
}

/// `stiffness[3]`, `stiffness[2..5]` (2, 3 and 4) or `stiffness` (all).
fn parse_range<'g>(name: &str, groups: &'g [GroupSpec]) -> Result<(&'g GroupSpec, Range<usize>), String> {
    let shown = shorten(name, 60);
    let stranger = || {
        let known = groups.iter().map(|group| name_of(&(0..group.count), group.name)).collect::<Vec<_>>().join(", ");
        format!("`{shown}` names none of the task's parameters, {known}")
    };
    let (stem, inside) = match name.trim().split_once('[') {
        Some((stem, rest)) => (stem, Some(rest.strip_suffix(']').ok_or_else(stranger)?)),
        None => (name.trim(), None),
    };
    let group = groups.iter().find(|group| group.name == stem).ok_or_else(stranger)?;
    let Some(inside) = inside else { return Ok((group, 0..group.count)) };
    let index = |text: &str| text.trim().parse::<usize>().map_err(|_| stranger());
    let range = match inside.split_once("..") {
        Some((start, end)) => index(start)?..index(end)?,
        None => index(inside).and_then(|i| i.checked_add(1).map(|end| i..end).ok_or_else(stranger))?,
    };
    if range.start >= range.end {
        return Err(format!("`{shown}` is empty: the end of a range is not part of it"));
    }
    if range.end > group.count {
        return Err(format!("`{shown}` goes beyond the last parameter, `{}[{}]`", group.name, group.count - 1));
    }
    Ok((group, range))
}

/// A range as it is written in files.
fn name_of(range: &Range<usize>, group: &str) -> String {
    if range.len() == 1 {
        format!("{group}[{}]", range.start)
    } else {
        format!("{group}[{}..{}]", range.start, range.end)
    }
}

fn write_placements<S: Serializer>(placed: &[PlacedRange], serializer: S) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(Some(placed.len()))?;
    for PlacedRange { group, range, place, .. } in placed {
        map.serialize_entry(&name_of(range, group), place)?;
    }
    map.end()
}

impl Serialize for InitialSpec {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Logit => serializer.serialize_str("logit"),
            Self::Middle => serializer.serialize_str("middle"),
            Self::Law => serializer.serialize_str("law"),
            Self::Values(values) => match &values[..] {
                [InitialValue { value, dimension, only: true, .. }] => {
                    serializer.serialize_str(&with_unit(*value, *dimension))
                }
                values => serializer.collect_map(values.iter().map(|v| (v.group, with_unit(v.value, v.dimension)))),
            },
        }
    }
}
