//! Design parameters that sit elsewhere than the others.

use std::ops::Range;

use hwasp_settings::text::shorten;
use hwasp_settings::{Item, Keys, Node, Section, Value};

use crate::group::{Group, Place};

/// Parameters that sit elsewhere than the others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlacedRange {
    /// Their group.
    pub group: String,
    /// Their indices in it.
    pub range: Range<usize>,
    /// The index of the group's first parameter in the design.
    pub first: usize,
    /// Where they sit.
    pub place: Place,
}

pub(crate) fn read_placements(section: &Section<'_>, node: &Node, groups: &[Group]) -> Vec<PlacedRange> {
    let count = groups.iter().map(|group| group.count).sum::<usize>();
    let first = groups.first().map_or("stiffness", |group| &group.name);
    let example = format!("write it like {{ \"{first}[0]\" = \"action\" }}, or as a list of one place each");
    let mut placed: Vec<PlacedRange> = Vec::new();
    match &node.value {
        Value::Table(table) => {
            for (name, entry) in table {
                let key = format!("placements.\"{}\"", shorten(name, 60));
                let place = section.chosen(&key, &entry.node, Place::ALL);
                match parse_range(name, groups) {
                    Ok((group, range)) => {
                        let place = place.filter(|&place| may_sit(section, &key, &entry.node, group, place));
                        placed.extend(place.map(|place| placed_range(group, range, place)));
                    }
                    Err(message) => section.fault_at(&entry.key, &key, message, Some(example.clone())),
                }
            }
        }
        Value::List(items) if items.len() == count => {
            let members = groups.iter().flat_map(|group| (0..group.count).map(move |i| (group, i)));
            for (at, ((group, i), item)) in members.zip(items).enumerate() {
                let key = format!("placements[{at}]");
                let place = section.chosen(&key, item, Place::ALL);
                let place = place.filter(|&place| may_sit(section, &key, item, group, place));
                placed.extend(place.map(|place| placed_range(group, i..i + 1, place)));
            }
        }
        Value::List(items) => {
            let parameters = if count == 1 { "parameter" } else { "parameters" };
            let rest = format!("has {} items, but the task has {count} {parameters}", items.len());
            section.wrong("placements", node, &rest, Some(example));
        }
        _ => section.wrong("placements", node, "is neither a table nor a list", Some(example)),
    }
    placed.sort_by_key(|p| (p.first, p.range.start, p.range.end));
    check_disjoint(section, node, &placed);
    placed
}

/// Whether a parameter of this group may sit there: what the world's model is made from cannot change within an episode.
fn may_sit(section: &Section<'_>, key: &str, node: &Node, group: &Group, place: Place) -> bool {
    let may = !(group.shapes_world && matches!(place, Place::Graph | Place::Action));
    if !may {
        let rest =
            format!("is impossible: the world's model is made from {}, once at the start of an episode", group.name);
        let hint = "write \"episode\" to have it drawn once an episode, or \"fixed\"; or leave it to a search, such as \
                    --method cmaes";
        section.wrong(key, node, &rest, Some(hint.to_owned()));
    }
    may
}

fn placed_range(group: &Group, range: Range<usize>, place: Place) -> PlacedRange {
    PlacedRange { group: group.name.clone(), range, first: group.first, place }
}

fn check_disjoint(section: &Section<'_>, node: &Node, placed: &[PlacedRange]) {
    for pair in placed.windows(2) {
        if pair[1].first == pair[0].first && pair[1].range.start < pair[0].range.end {
            let message = format!(
                "design.placements places {} twice: by {} as \"{}\" and by {} as \"{}\"",
                name_of(&(pair[1].range.start..pair[1].range.start + 1), &pair[1].group),
                name_of(&pair[0].range, &pair[0].group),
                pair[0].place.name(),
                name_of(&pair[1].range, &pair[1].group),
                pair[1].place.name(),
            );
            let hint = "let every parameter be in one of them".to_owned();
            section.fault_at(&node.origin, "placements", message, Some(hint));
        }
    }
}

/// `stiffness[3]`, `stiffness[2..5]` (2, 3 and 4) or `stiffness` (all).
fn parse_range<'g>(name: &str, groups: &'g [Group]) -> Result<(&'g Group, Range<usize>), String> {
    let shown = shorten(name, 60);
    let stranger = || {
        let known = groups.iter().map(|group| name_of(&(0..group.count), &group.name)).collect::<Vec<_>>().join(", ");
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

pub(crate) fn write_placements(placed: &[PlacedRange]) -> Keys {
    let item = |p: &PlacedRange| (name_of(&p.range, &p.group), Item::from(p.place.name()));
    Keys(placed.iter().map(item).collect())
}
