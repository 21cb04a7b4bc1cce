//! What each effort is explored by: one quantity for all, a list, or by name. Efforts may have dimensions of their own.

use std::ops::RangeInclusive;

use hwasp_core::{Dimension, Port, parse_quantity};
use hwasp_settings::text::shorten;
use hwasp_settings::{Item, Keys, Node, Section, Value, listed, nearest, with_unit};

/// Limits of a standard deviation, SI.
const EFFORT: RangeInclusive<f64> = 1e-6..=1e4;

/// Whether one quantity can stand for all.
fn alike(ports: &[Port]) -> bool {
    ports.windows(2).all(|pair| pair[0].dimension == pair[1].dimension)
}

/// Values, SI, as a file has them; none where there are none.
pub(crate) fn item(values: &[Option<f64>], ports: &[Port]) -> Option<Item> {
    let given: Vec<(&Port, f64)> =
        ports.iter().zip(values).filter_map(|(port, value)| Some((port, (*value)?))).collect();
    let text = |&(port, value): &(&Port, f64)| Item::Text(with_unit(value, port.dimension));
    let first = given.first()?;
    let one = given.len() == ports.len() && alike(ports) && given.iter().all(|(_, value)| *value == first.1);
    Some(if one {
        text(first)
    } else {
        Item::Keys(Keys(given.iter().map(|entry| (entry.0.name.clone(), text(entry))).collect()))
    })
}

/// Reads the values of a key.
pub(crate) struct Efforts<'a, 'r> {
    pub(crate) section: &'a Section<'r>,
    pub(crate) key: &'static str,
    pub(crate) ports: &'a [Port],
    /// What hints show, SI, one for each.
    pub(crate) examples: &'a [f64],
}

impl Efforts<'_, '_> {
    /// One value for each effort, SI; none where it is wrong, or where nothing is said of it.
    pub(crate) fn read(&self, node: &Node) -> Vec<Option<f64>> {
        let mut values = vec![None; self.ports.len()];
        let one = |i: usize, key: &str, node: &Node| {
            self.section.checked_quantity(key, node, self.ports[i].dimension, self.examples[i], &EFFORT)
        };
        match &node.value {
            Value::Text(text) if text == "none" => {}
            Value::Table(table) => {
                for (name, entry) in table {
                    let key = format!("{}.{}", self.key, shorten(name, 60));
                    match self.ports.iter().position(|port| port.name == *name) {
                        Some(i) => values[i] = one(i, &key, &entry.node),
                        None => self.refuse_name(name, &key, entry),
                    }
                }
            }
            Value::List(items) if items.len() == self.ports.len() => {
                for (i, item) in items.iter().enumerate() {
                    values[i] = one(i, &format!("{}[{i}]", self.key), item);
                }
            }
            Value::List(items) => {
                let (given, count) = (items.len(), self.ports.len());
                let rest = format!("has {given} items, but the law has {count} efforts");
                self.section.wrong(self.key, node, &rest, Some(self.example()));
            }
            _ if !alike(self.ports) => {
                let rest = "is one quantity for efforts that measure different things";
                self.section.wrong(self.key, node, rest, Some(self.example()));
            }
            _ => {
                // A mistake is told once.
                let value = if self.ports.is_empty() { None } else { one(0, self.key, node) };
                values.fill(value);
            }
        }
        values
    }

    fn refuse_name(&self, name: &str, key: &str, entry: &hwasp_settings::Entry) {
        let names = || self.ports.iter().map(|port| port.name.as_str());
        let hint = nearest(name, names()).map(|near| format!("did you mean `{near}`?"));
        let message = format!("noise.{key} is none of the law's efforts: {}", listed(names()));
        self.section.fault_at(&entry.key, key, message, hint);
    }

    /// How to write it.
    fn example(&self) -> String {
        let name = |name: &str| {
            if name.chars().all(|c| c.is_ascii_alphanumeric() || "_-".contains(c)) {
                name.to_owned()
            } else {
                format!("{name:?}")
            }
        };
        let each = self.ports.iter().zip(self.examples);
        let each = each.map(|(port, &std)| format!("{} = \"{}\"", name(&port.name), with_unit(std, port.dimension)));
        format!("write it like {{ {} }}", each.collect::<Vec<_>>().join(", "))
    }
}

/// A key that says nothing here, because efforts are no action: a base table may have it for another method, whose efforts may
/// even be others. It still has to be made of quantities.
pub(crate) fn skim(section: &Section<'_>, key: &str, node: &Node, ports: &[Port]) {
    let own = ports.iter().map(|port| port.dimension);
    let any: Vec<Dimension> =
        [Dimension::Force, Dimension::Length, Dimension::Speed, Dimension::Torque].into_iter().chain(own).collect();
    let fits = |text: &str| text == "none" || any.iter().any(|&d| parse_quantity(text, d).is_ok());
    let quantity = |node: &Node| node.text().is_some_and(fits);
    let sound = match &node.value {
        Value::Table(table) => table.values().all(|entry| quantity(&entry.node)),
        Value::List(items) => items.iter().all(quantity),
        _ => quantity(node),
    };
    if !sound {
        section.wrong(key, node, "is not a quantity", Some("write it like \"3 N\"".into()));
    }
}
