//! Where the design begins.

use hwasp_core::{Dimension, Initial};
use hwasp_settings::text::{shorten, show};
use hwasp_settings::{Item, Keys, Node, Section, Value, listed, nearest, with_unit};

use crate::group::Group;

/// Where the parameters begin.
#[derive(Clone, Debug, PartialEq)]
pub enum InitialDesign {
    /// Where the problem's law says.
    Law,
    /// The unbounded parameters uniform within ±`logit_half_width`.
    Logit,
    /// In the middle of their limits.
    Middle,
    /// The parameters of these groups at these values, others where the law says, if it names a value, or in the middle.
    Values(Vec<InitialValue>),
}

/// Where the parameters of a group begin.
#[derive(Clone, Debug, PartialEq)]
pub struct InitialValue {
    /// The group.
    pub group: String,
    /// In SI.
    pub value: f64,
    /// What it measures.
    pub dimension: Dimension,
    /// Whether it is the task's only group, which needs no name.
    only: bool,
}

impl InitialDesign {
    /// Every group at a value of its own, SI; the values are in the order of the groups.
    pub fn at(groups: &[Group], values: &[f64]) -> Self {
        let only = groups.len() == 1;
        let initial =
            |(g, &value): (&Group, &f64)| InitialValue { group: g.name.clone(), value, dimension: g.dimension, only };
        let mut values: Vec<InitialValue> = groups.iter().zip(values).map(initial).collect();
        // As they are read from a file.
        values.sort_by(|a, b| a.group.cmp(&b.group));
        Self::Values(values)
    }

    /// One start for each group; none where the law says.
    pub fn starts(&self, groups: &[Group], logit_half_width: f64) -> Option<Vec<Initial>> {
        let start = |group: &Group| {
            let middle = Initial::Value(0.5 * (group.lo + group.hi));
            match self {
                Self::Law => None,
                Self::Logit => Some(Initial::Logit { half_width: logit_half_width }),
                Self::Middle => Some(middle),
                Self::Values(values) => {
                    let found = values.iter().find(|value| value.group == group.name);
                    let left_out = group.initial.map_or(middle, Initial::Value);
                    Some(found.map_or(left_out, |value| Initial::Value(value.value)))
                }
            }
        };
        groups.iter().map(start).collect()
    }

    /// As it is written.
    pub(crate) fn item(&self) -> Item {
        match self {
            Self::Law => Item::from("law"),
            Self::Logit => Item::from("logit"),
            Self::Middle => Item::from("middle"),
            Self::Values(values) => match &values[..] {
                [InitialValue { value, dimension, only: true, .. }] => Item::Text(with_unit(*value, *dimension)),
                values => {
                    let item = |v: &InitialValue| (v.group.clone(), Item::Text(with_unit(v.value, v.dimension)));
                    Item::Keys(Keys(values.iter().map(item).collect()))
                }
            },
        }
    }
}

/// Reads a start. What is wrong becomes the law's.
pub(crate) fn read_initial(section: &Section<'_>, node: &Node, groups: &[Group]) -> InitialDesign {
    match (&node.value, groups) {
        (Value::Text(text), _) if text == "law" => InitialDesign::Law,
        (Value::Text(text), _) if text == "logit" => InitialDesign::Logit,
        (Value::Text(text), _) if text == "middle" => InitialDesign::Middle,
        (Value::Text(text), _) if !text.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.')) => {
            let hint = "it is \"law\", \"logit\", \"middle\" or a quantity".to_owned();
            section.wrong("initial", node, "is no start that is known", Some(hint));
            InitialDesign::Law
        }
        (Value::Table(table), _) => {
            let mut values = Vec::new();
            for (name, entry) in table {
                let key = format!("initial.{}", shorten(name, 60));
                if let Some(group) = groups.iter().find(|group| group.name == *name) {
                    values.extend(read_value(section, &key, &entry.node, group, groups.len() == 1));
                } else {
                    let names = || groups.iter().map(|group| group.name.as_str());
                    let hint = nearest(name, names()).map(|near| format!("did you mean `{near}`?"));
                    let message = format!("design.{key} is none of the task's parameters: {}", listed(names()));
                    section.fault_at(&entry.key, &key, message, hint);
                }
            }
            InitialDesign::Values(values)
        }
        (_, [group]) => {
            let value = read_value(section, "initial", node, group, true);
            value.map_or(InitialDesign::Law, |value| InitialDesign::Values(vec![value]))
        }
        (_, groups) => {
            let first = groups.first().map_or("stiffness", |group| &group.name);
            let hint = format!("name the parameters: {{ {first} = … }}");
            section.wrong(
                "initial",
                node,
                &format!("is one value for {} different parameters", groups.len()),
                Some(hint),
            );
            InitialDesign::Law
        }
    }
}

fn read_value(section: &Section<'_>, key: &str, node: &Node, group: &Group, only: bool) -> Option<InitialValue> {
    let &Group { dimension, lo, hi, count, .. } = group;
    let any = f64::NEG_INFINITY..=f64::INFINITY;
    let value = section.checked_quantity(key, node, dimension, 0.5 * (lo + hi), &any)?;
    if value > lo && value < hi {
        return Some(InitialValue { group: group.name.clone(), value, dimension, only });
    }
    // The limits depend on the task; where that is wrong, this may well be right.
    if section.sound_below("task") {
        let (lo, hi) = (show(lo), with_unit(hi, dimension));
        let start = if count == 1 { "it".to_owned() } else { format!("each of the {count}") };
        let hint = format!("{start} has to begin between them: the squash has no inverse at its limits");
        section.wrong(key, node, &format!("is not inside ({lo}, {hi})"), Some(hint));
    }
    None
}
