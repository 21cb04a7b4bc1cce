//! Design parameters and commands, as experiments have them.

use hwasp_core::Dimension;
use hwasp_expr::{Exponents, quantity};
use hwasp_settings::text::{shorten, show};
use hwasp_settings::{Entry, Item, Keys, Node, Section, Table, Value, listed, nearest};

use crate::texts::{list, list_item, text};

/// The largest size of any quantity, SI.
const LARGEST: f64 = 1e9;

/// A quantity as it was written, and in SI.
#[derive(Clone, Debug, PartialEq)]
pub struct Amount {
    /// As it was written.
    pub text: String,
    /// In SI.
    pub value: f64,
    /// What it measures; none where no unit was written.
    pub exponents: Option<Exponents>,
}

impl Amount {
    fn read(section: &Section<'_>, key: &str, node: &Node) -> Option<Self> {
        let text = text(section, key, node)?;
        match quantity(&text) {
            Ok((value, exponents)) if value.is_finite() && value.abs() <= LARGEST => {
                Some(Self { text, value, exponents })
            }
            Ok((value, _)) => {
                let hint = format!("sizes are at most {} in SI", show(LARGEST));
                section.wrong(key, node, &format!("is {} in SI", show(value)), Some(hint));
                None
            }
            Err(error) => {
                section.wrong_within(
                    key,
                    node,
                    &error.span,
                    format!("{}: {}", section.path(key), error.message),
                    error.hint,
                );
                None
            }
        }
    }

    fn item(&self) -> Item {
        // A number by itself is written as one.
        self.text.parse().map_or_else(|_| Item::from(self.text.as_str()), Item::Float)
    }
}

/// Two limits, the lower one first.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// The lower one.
    pub low: Amount,
    /// The upper one.
    pub high: Amount,
}

impl Limits {
    fn read(section: &Section<'_>, key: &str, node: &Node) -> Option<Self> {
        let Value::List(ends) = &node.value else {
            section.wrong(key, node, "is no list of two limits", Some("write it [\"0.3 m\", \"0.7 m\"]".into()));
            return None;
        };
        let [low, high] = &ends[..] else {
            section.wrong(key, node, "has not two limits", Some("write it [\"0.3 m\", \"0.7 m\"]".into()));
            return None;
        };
        let (low, high) = (Amount::read(section, key, low)?, Amount::read(section, key, high)?);
        let alike = match (low.exponents, high.exponents) {
            // One unit is enough where the other limit is 0.
            (None, Some(_)) => low.value == 0.0,
            (Some(_), None) => high.value == 0.0,
            (Some(a), Some(b)) => a.fits(b),
            (None, None) => true,
        };
        if !alike {
            section.wrong(key, node, "has limits of different units", Some("give both the same unit".into()));
            return None;
        }
        if low.value >= high.value {
            section.wrong(
                key,
                node,
                "has a lower limit that is not below the upper one",
                Some("exchange them, or take them apart".into()),
            );
            return None;
        }
        Some(Self { low, high })
    }

    /// What they measure; none where no unit was written.
    pub fn exponents(&self) -> Option<Exponents> {
        self.low.exponents.or(self.high.exponents)
    }

    fn item(&self) -> Item {
        Item::List(vec![self.low.item(), self.high.item()])
    }
}

/// A design parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Between which limits it is sought.
    pub limits: Limits,
    /// Where it begins; the middle where nothing was said.
    pub initial: Option<Amount>,
    /// Fields of the model that follow it, `"geom.shin.size[1] = shank/2"`.
    pub sets: Vec<String>,
}

impl Parameter {
    pub(crate) fn read(section: &Section<'_>, name: &str, entry: &Entry) -> Option<Self> {
        let key = format!("design.{}", shorten(name, 60));
        check_name(section, &key, name, entry)?;
        let table =
            table(section, &key, &entry.node, "{ limits = [\"0.3 m\", \"0.7 m\"] }", &["limits", "initial", "sets"])?;
        let inner = |name: &str| format!("{key}.{name}");
        let Some(limits) = table.get("limits") else {
            let message = format!("{} has no limits", section.path(&key));
            section.fault_at(&entry.key, &key, message, Some("add limits = [\"0.3 m\", \"0.7 m\"]".into()));
            return None;
        };
        let limits = Limits::read(section, &inner("limits"), &limits.node)?;
        let initial = match table.get("initial") {
            None => None,
            Some(entry) => Some(Self::start(section, &inner("initial"), &entry.node, &limits)?),
        };
        let sets = match table.get("sets") {
            None => Vec::new(),
            Some(entry) => list(section, &inner("sets"), &entry.node)?,
        };
        let own = Self { name: name.to_owned(), limits, initial, sets };
        if own.dimension().is_none() {
            let exponents = own.limits.exponents().unwrap_or(Exponents::NONE);
            let units = listed(Dimension::ALL.iter().map(|dimension| dimension.si()).filter(|si| !si.is_empty()));
            let message =
                format!("{} is in {exponents}, of which a design is not told", section.path(&inner("limits")));
            section.fault_at(&entry.key, &key, message, Some(format!("leave the unit out, or take one of {units}")));
            return None;
        }
        Some(own)
    }

    fn start(section: &Section<'_>, key: &str, node: &Node, limits: &Limits) -> Option<Amount> {
        let start = Amount::read(section, key, node)?;
        let fits = match (start.exponents, limits.exponents()) {
            (Some(a), Some(b)) => a.fits(b),
            (None, Some(_)) => start.value == 0.0,
            (given, None) => given.is_none(),
        };
        if !fits {
            section.wrong(key, node, "has not the unit of the limits", Some("give it the same unit".into()));
            return None;
        }
        if !(start.value > limits.low.value && start.value < limits.high.value) {
            let rest = format!("is not between the limits {} and {}", limits.low.text, limits.high.text);
            section.wrong(key, node, &rest, Some("a design begins inside of its limits, on none of them".into()));
            return None;
        }
        Some(start)
    }

    /// What it measures; none where its unit has no name.
    pub fn dimension(&self) -> Option<Dimension> {
        match self.limits.exponents() {
            None => Some(Dimension::None),
            Some(exponents) => exponents.dimension(),
        }
    }

    pub(crate) fn item(&self) -> Item {
        let mut keys = Keys::default();
        keys.push("limits", self.limits.item());
        if let Some(initial) = &self.initial {
            keys.push("initial", initial.item());
        }
        if let Some(sets) = list_item(&self.sets) {
            keys.push("sets", sets);
        }
        Item::Keys(keys)
    }
}

/// A motor: the limits of its command, and for one that is added its gear.
#[derive(Clone, Debug, PartialEq)]
pub struct Command {
    /// The actuator; of a motor that is added the joint.
    pub name: String,
    /// Limits of the command.
    pub limits: Limits,
    /// From the command to the torque or force of the joint.
    pub gear: f64,
}

impl Command {
    pub(crate) fn read(section: &Section<'_>, table_key: &str, name: &str, node: &Node) -> Option<Self> {
        let key = format!("{table_key}.{}", shorten(name, 60));
        let motors = table_key == "motors";
        let known: &[&str] = if motors { &["limits", "gear"] } else { &["limits"] };
        let table = table(section, &key, node, "{ limits = [-1, 1] }", known)?;
        let inner = |name: &str| format!("{key}.{name}");
        let Some(limits) = table.get("limits") else {
            let rest = "has no limits";
            section.wrong(&key, node, rest, Some("add limits = [-1, 1]".into()));
            return None;
        };
        let limits = Limits::read(section, &inner("limits"), &limits.node)?;
        let gear = match table.get("gear") {
            None => 1.0,
            Some(entry) => {
                let gear = section.checked_number_of(&inner("gear"), &entry.node, &(-1e6..=1e6))?;
                if gear == 0.0 {
                    let hint = "the gear is the torque or force at a command of 1; leave the motor out for none";
                    section.wrong(&inner("gear"), &entry.node, "lets the motor do nothing", Some(hint.into()));
                    return None;
                }
                gear
            }
        };
        Some(Self { name: name.to_owned(), limits, gear })
    }

    /// What it measures.
    pub fn dimension(&self) -> Dimension {
        self.limits.exponents().and_then(Exponents::dimension).unwrap_or(Dimension::None)
    }

    pub(crate) fn item(&self) -> Item {
        let mut keys = Keys::default();
        keys.push("limits", self.limits.item());
        if self.gear != 1.0 {
            keys.push("gear", Item::Float(self.gear));
        }
        Item::Keys(keys)
    }
}

/// The keys of a small table; unknown ones are faults.
fn table<'r>(section: &Section<'_>, key: &str, node: &'r Node, example: &str, known: &[&str]) -> Option<&'r Table> {
    let Value::Table(table) = &node.value else {
        section.wrong(key, node, "is no table", Some(format!("write it {example}")));
        return None;
    };
    let mut sound = true;
    for (name, entry) in table.iter().filter(|(name, _)| !known.contains(&name.as_str())) {
        let hint = match nearest(name, known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("the keys here are {}", listed(known.iter().copied())),
        };
        let message = format!("unknown key `{}` in {}", shorten(name, 60), section.path(key));
        section.fault_at(&entry.key, &format!("{key}.{}", shorten(name, 60)), message, Some(hint));
        sound = false;
    }
    sound.then_some(table)
}

/// Whether formulas can name it, and nothing else has the name.
fn check_name(section: &Section<'_>, key: &str, name: &str, entry: &Entry) -> Option<()> {
    match name_fault(name) {
        None => Some(()),
        Some(why) => {
            let message = format!("{} cannot be called so: {why}", section.path(key));
            section.fault_at(&entry.key, key, message, Some("take another name".into()));
            None
        }
    }
}

/// Why a name of one's own is none that formulas can use.
pub(crate) fn name_fault(name: &str) -> Option<String> {
    let reserved = crate::names::RESERVED.contains(&name);
    hwasp_expr::name_fault(name).or_else(|| reserved.then(|| format!("`{name}` has a meaning in formulas")))
}
