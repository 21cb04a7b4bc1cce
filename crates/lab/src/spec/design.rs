//! `[design]`: where each design parameter sits and where it begins.

use std::ops::Range;

use hwasp_core::Dimension;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use super::Method;
use super::fault::{shorten, show};
use super::names::named;
use super::section::Section;
use super::task::{GroupSpec, TaskSpec};
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

/// Where every parameter begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InitialSpec {
    /// The unbounded parameter uniform within ±`logit_half_width`.
    Logit,
    /// In the middle of its limits.
    Middle,
    /// At this value.
    Value {
        /// In SI.
        value: f64,
        /// What it measures.
        dimension: Dimension,
    },
}

/// Parameters that sit elsewhere than the others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlacedRange {
    /// Their group.
    pub group: &'static str,
    /// Their indices in it.
    pub range: Range<usize>,
    /// Where they sit.
    pub place: Place,
}

/// `[design]`.
///
/// | key | default | meaning | limits |
/// |---|---|---|---|
/// | `placement` | hwasp: "graph", fixed: "fixed", else "action" | where the parameters sit | |
/// | `placements` | none | where some of them sit: `{ "stiffness[0]" = "action", "stiffness[3..5]" = "fixed" }` (3 and 4), or a list of one place each | |
/// | `initial` | "logit" | `logit`, `middle` or a quantity | inside of the parameter's limits |
/// | `logit_half_width` | 5.0 | half width of the uniform start before the squash | 0 to 20 |
/// | `learning_rate_scale` | 1.0 | times the policy's learning rate | 0 to 1000 |
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
        self.placements.iter().find(|placed| placed.range.contains(&i)).map_or(self.placement, |placed| placed.place)
    }

    /// Reads the table for the parameters of a task.
    pub(super) fn read(mut s: Section<'_>, method: Method, task: &TaskSpec) -> Self {
        let group = task.group();
        let default = match method {
            Method::Hwasp => Place::Graph,
            Method::Fixed => Place::Fixed,
            // A search moves the parameter, and the plant evaluates the law.
            Method::Minimal | Method::Cmaes | Method::Ars | Method::CmaesRl | Method::ArsRl => Place::Action,
        };
        let spec = Self {
            placement: s.choice("placement", Place::ALL).unwrap_or(default),
            initial: read_initial(&mut s, &group),
            logit_half_width: s.number("logit_half_width", 5.0, 0.0..=20.0),
            learning_rate_scale: s.number("learning_rate_scale", 1.0, 0.0..=1000.0),
            placements: read_placements(&mut s, &group),
        };
        s.finish();
        spec
    }
}

fn read_initial(s: &mut Section<'_>, group: &GroupSpec) -> InitialSpec {
    let Some(node) = s.take("initial") else { return InitialSpec::Logit };
    match &node.value {
        Value::Text(text) if text == "logit" => return InitialSpec::Logit,
        Value::Text(text) if text == "middle" => return InitialSpec::Middle,
        Value::Text(text) if !text.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.')) => {
            let hint = "it is \"logit\", \"middle\" or a quantity".to_owned();
            s.wrong("initial", node, "is no start that is known", Some(hint));
            return InitialSpec::Logit;
        }
        _ => {}
    }
    let range = f64::NEG_INFINITY..=f64::INFINITY;
    let Some(value) = s.checked_quantity("initial", node, group.dimension, 0.5 * (group.lo + group.hi), &range) else {
        return InitialSpec::Logit;
    };
    if value > group.lo && value < group.hi {
        return InitialSpec::Value { value, dimension: group.dimension };
    }
    // The limits depend on other keys; where those are wrong, this may well be right.
    if s.reader.sound(&["task.segments", "task.stiffness_total_max", "task.length_total_max"]) {
        let (lo, hi) = (show(group.lo), with_unit(group.hi, group.dimension));
        let hint = format!("each of the {} begins there, and the squash has no inverse at its limits", group.count);
        s.wrong("initial", node, &format!("is not inside ({lo}, {hi})"), Some(hint));
    }
    InitialSpec::Logit
}

fn read_placements(s: &mut Section<'_>, group: &GroupSpec) -> Vec<PlacedRange> {
    let Some(node) = s.take("placements") else { return Vec::new() };
    let example = format!("write it like {{ \"{}[0]\" = \"action\" }}, or as a list of one place each", group.name);
    let mut placed: Vec<PlacedRange> = Vec::new();
    match &node.value {
        Value::Table(table) => {
            for (name, entry) in table {
                let key = format!("placements.\"{}\"", shorten(name, 60));
                let place = s.chosen(&key, &entry.node, Place::ALL);
                match parse_range(name, group) {
                    Ok(range) => placed.extend(place.map(|place| PlacedRange { group: group.name, range, place })),
                    Err(message) => {
                        let key = s.path(&key);
                        s.reader.fault(Some(&entry.key), &key, message, Some(example.clone()));
                    }
                }
            }
        }
        Value::List(items) if items.len() == group.count => {
            for (i, item) in items.iter().enumerate() {
                let place = s.chosen(&format!("placements[{i}]"), item, Place::ALL);
                placed.extend(place.map(|place| PlacedRange { group: group.name, range: i..i + 1, place }));
            }
        }
        Value::List(items) => {
            let rest = format!("has {} items, but the task has {} parameters", items.len(), group.count);
            s.wrong("placements", node, &rest, Some(example));
        }
        _ => s.wrong("placements", node, "is neither a table nor a list", Some(example)),
    }
    placed.sort_by_key(|p| (p.range.start, p.range.end));
    check_disjoint(s, node, &placed);
    placed
}

fn check_disjoint(s: &Section<'_>, node: &Node, placed: &[PlacedRange]) {
    for pair in placed.windows(2) {
        if pair[1].range.start < pair[0].range.end {
            let message = format!(
                "design.placements places {} twice: by {} and by {}",
                name_of(&(pair[1].range.start..pair[1].range.start + 1), pair[1].group),
                name_of(&pair[0].range, pair[0].group),
                name_of(&pair[1].range, pair[1].group)
            );
            let hint = "let every parameter be in one of them".to_owned();
            s.reader.fault(Some(&node.origin), "design.placements", message, Some(hint));
        }
    }
}

/// `stiffness[3]`, `stiffness[2..5]` (2, 3 and 4) or `stiffness` (all).
fn parse_range(name: &str, group: &GroupSpec) -> Result<Range<usize>, String> {
    let shown = shorten(name, 60);
    let stranger =
        || format!("`{shown}` names none of the task's parameters, {}", name_of(&(0..group.count), group.name));
    let rest = name.trim().strip_prefix(group.name).ok_or_else(stranger)?;
    if rest.is_empty() {
        return Ok(0..group.count);
    }
    let inside = rest.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')).ok_or_else(stranger)?;
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
    Ok(range)
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
    for PlacedRange { group, range, place } in placed {
        map.serialize_entry(&name_of(range, group), place)?;
    }
    map.end()
}

impl Serialize for InitialSpec {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match *self {
            Self::Logit => serializer.serialize_str("logit"),
            Self::Middle => serializer.serialize_str("middle"),
            Self::Value { value, dimension } => serializer.serialize_str(&with_unit(value, dimension)),
        }
    }
}
