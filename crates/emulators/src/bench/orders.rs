//! What a line orders.

use hwasp_grasp::Object;

use super::tell::ObjectText;
use crate::{dynamixel, ur};

/// Who gets a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Device {
    Arm,
    Motor,
}

/// An order.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Order {
    State,
    Fault(Device, String),
    /// Seed and index of an episode of evaluation.
    Draw(u64, u64),
    Put(Object),
    Quit,
}

const ORDERS: &str = "`state`, `object SEED INDEX`, `object {…}`, `fault arm TEXT`, `fault motor TEXT` and `quit`";

/// Reads a line.
pub(super) fn read(line: &str) -> Result<Order, String> {
    let line = line.trim();
    let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    let rest = rest.trim();
    match (word, rest) {
        ("state", "") => Ok(Order::State),
        ("quit", "") => Ok(Order::Quit),
        ("fault", _) => fault(rest),
        ("object", _) if rest.starts_with('{') => {
            let text: ObjectText = serde_json::from_str(rest).map_err(|error| format!("no object: {error}"))?;
            text.object().map(Order::Put)
        }
        ("object", _) => draw(rest),
        _ => Err(format!("`{line}` is no order; there are {ORDERS}")),
    }
}

/// Reads who gets which fault, such as `motor heat 80`.
pub(super) fn fault(rest: &str) -> Result<Order, String> {
    let wanted =
        || format!("`fault {rest}` names neither `arm` nor `motor` and then a fault, such as `fault motor heat 80`");
    let (device, text) = rest.split_once(char::is_whitespace).ok_or_else(wanted)?;
    let text = text.trim();
    let device = match device {
        "arm" => ur::check_fault(text).map(|()| Device::Arm)?,
        "motor" => dynamixel::check_fault(text).map(|()| Device::Motor)?,
        _ => return Err(wanted()),
    };
    Ok(Order::Fault(device, text.to_owned()))
}

fn draw(rest: &str) -> Result<Order, String> {
    let words: Vec<_> = rest.split_whitespace().map(str::parse).collect();
    match words[..] {
        [Ok(seed), Ok(index)] => Ok(Order::Draw(seed, index)),
        _ => Err(format!("`object {rest}` has not two whole numbers, seed and index, such as `object 0 7`")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_by_line() {
        assert_eq!(read(" state "), Ok(Order::State));
        assert_eq!(read("object 3  14"), Ok(Order::Draw(3, 14)));
        assert_eq!(read("fault motor heat 80"), Ok(Order::Fault(Device::Motor, "heat 80".into())));
        assert_eq!(read("fault arm protective-stop"), Ok(Order::Fault(Device::Arm, "protective-stop".into())));
        for (line, says) in [
            ("", "`` is no order; there are `state`,"),
            ("state now", "`state now` is no order"),
            ("fault heat 80", "names neither `arm` nor `motor`"),
            ("fault motor", "names neither `arm` nor `motor`"),
            ("fault motor melt", "`melt` is no fault of a motor"),
            ("fault arm melt", "\"melt\" is no fault of the arm"),
            ("object -1 2", "has not two whole numbers"),
            ("object 1", "such as `object 0 7`"),
            ("object {\"kind\": 1}", "no object: "),
        ] {
            let error = read(line).unwrap_err();
            assert!(error.contains(says), "{line}: {error}");
        }
    }
}
