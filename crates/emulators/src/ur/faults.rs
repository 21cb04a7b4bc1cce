//! Faults to order, by text.

/// What is wrong with the arm or with its line at present.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[allow(clippy::struct_excessive_bools, reason = "faults come in any combination")]
pub(super) struct Faults {
    /// No packet is sent.
    pub(crate) silent: bool,
    /// Packets come so much later, ms.
    pub(crate) delay: u32,
    /// Every packet of so many is lost; 0 loses none.
    pub(crate) drop: u32,
    /// Packets tell the pose of the time when it froze.
    pub(crate) freeze: bool,
    /// Poses are no numbers.
    pub(crate) nan: bool,
    /// The teach pendant is in local control.
    pub(crate) local: bool,
    /// Brakes are closed.
    pub(crate) idle: bool,
}

/// One order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Order {
    ProtectiveStop,
    EmergencyStop,
    Cut,
    Clear,
    Set(Faults),
}

/// Words that are orders; the table of `docs/deploy_arm.md` says what each does.
const WORDS: &str =
    "protective-stop, emergency-stop, silent, delay MS, drop N, freeze, nan, cut, not-remote, idle, clear";

/// Whether an emulated arm can be ordered this.
pub(crate) fn check_fault(text: &str) -> Result<(), String> {
    order(text, Faults::default()).map(drop)
}

/// Reads an order, on top of the faults that there are.
pub(super) fn order(text: &str, now: Faults) -> Result<Order, String> {
    let mut words = text.split_whitespace();
    let (word, value) = (words.next().unwrap_or_default(), words.next());
    let number = |lowest: u32, highest: u32| {
        let value = value.ok_or_else(|| format!("{word} needs a number from {lowest} to {highest}"))?;
        let number = value.parse().ok().filter(|number| (lowest..=highest).contains(number));
        number.ok_or_else(|| format!("{word} {value}: not a number from {lowest} to {highest}"))
    };
    let order = match word {
        "protective-stop" => Order::ProtectiveStop,
        "emergency-stop" => Order::EmergencyStop,
        "cut" => Order::Cut,
        "clear" => Order::Clear,
        "silent" => Order::Set(Faults { silent: true, ..now }),
        "delay" => Order::Set(Faults { delay: number(0, 10_000)?, ..now }),
        "drop" => Order::Set(Faults { drop: number(2, 1000)?, ..now }),
        "freeze" => Order::Set(Faults { freeze: true, ..now }),
        "nan" => Order::Set(Faults { nan: true, ..now }),
        "not-remote" => Order::Set(Faults { local: true, ..now }),
        "idle" => Order::Set(Faults { idle: true, ..now }),
        _ => return Err(format!("{text:?} is no fault of the arm; there are: {WORDS}")),
    };
    let takes = usize::from(matches!(word, "delay" | "drop"));
    match text.split_whitespace().nth(1 + takes) {
        Some(rest) => Err(format!("{text:?}: {rest:?} is too much")),
        None => Ok(order),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_are_read_and_others_told() {
        let none = Faults::default();
        assert_eq!(order("delay 60", none), Ok(Order::Set(Faults { delay: 60, ..none })));
        assert_eq!(order("cut", none), Ok(Order::Cut));
        assert_eq!(order("delay", none), Err("delay needs a number from 0 to 10000".to_owned()));
        assert_eq!(order("drop 1", none), Err("drop 1: not a number from 2 to 1000".to_owned()));
        assert!(order("melt", none).unwrap_err().contains("protective-stop, emergency-stop"));
        assert!(order("cut now", none).is_err());
    }
}
