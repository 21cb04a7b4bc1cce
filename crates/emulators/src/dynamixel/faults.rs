//! What goes wrong with a motor when it is told to.

use super::table::{self, Register};

/// Hardware errors, by their bits in the register.
pub(super) const WRONG_VOLTAGE: u8 = 1 << 0;
pub(super) const OVERHEATING: u8 = 1 << 2;
pub(super) const ENCODER: u8 = 1 << 3;
pub(super) const SHOCK: u8 = 1 << 4;
pub(super) const OVERLOAD: u8 = 1 << 5;

/// What is wrong now.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Faults {
    /// The share of answers that are lost.
    pub(super) drop: f64,
    /// The share of answers with a wrong checksum.
    pub(super) wrong_crc: f64,
    /// The share of answers that come among noise.
    pub(super) noise: f64,
    /// By how much answers come later, ms.
    pub(super) delay: f64,
    /// Registers that read what they read, whatever happens.
    pub(super) stuck: Vec<(&'static Register, i32)>,
    /// What the current reads, A.
    pub(super) current: Option<f64>,
    /// What the temperature is, °C.
    pub(super) temperature: Option<f64>,
    /// What the voltage is, V.
    pub(super) voltage: Option<f64>,
    /// It answers nothing.
    pub(super) silent: bool,
}

/// What is to be done besides remembering.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Order {
    /// Nothing.
    Nothing,
    /// This register gets stuck.
    Stick(&'static Register),
    /// A hardware error shows.
    Fail(u8),
    /// Power fails for a moment.
    Restart,
    /// The cable is cut.
    Cut,
}

/// Whether an emulated motor can be ordered this.
pub(crate) fn check_fault(text: &str) -> Result<(), String> {
    Faults::default().take(text).map(drop)
}

impl Faults {
    /// Takes a fault by its text, a line of [the table](super).
    pub(super) fn take(&mut self, text: &str) -> Result<Order, String> {
        let mut words = text.split_whitespace();
        let name = words.next().unwrap_or_default();
        let mut argument = || words.next();
        let order = match name {
            "drop" => set(&mut self.drop, share(name, argument())?),
            "wrong-crc" => set(&mut self.wrong_crc, share(name, argument())?),
            "noise" => set(&mut self.noise, share(name, argument())?),
            "delay" => set(&mut self.delay, number(name, "MS", argument(), 0.0, 10_000.0)?),
            "over-current" => set(&mut self.current, Some(number(name, "A", argument(), -80.0, 80.0)?)),
            "heat" => set(&mut self.temperature, Some(number(name, "C", argument(), 0.0, 255.0)?)),
            "voltage" => set(&mut self.voltage, Some(number(name, "V", argument(), 0.0, 100.0)?)),
            "silent" => set(&mut self.silent, true),
            "stuck" => Order::Stick(register(argument())?),
            "overload" => Order::Fail(OVERLOAD),
            "shock" => Order::Fail(SHOCK),
            "encoder" => Order::Fail(ENCODER),
            "restart" => Order::Restart,
            "cut" => Order::Cut,
            "clear" => set(self, Self::default()),
            _ => {
                return Err(format!(
                    "`{name}` is no fault of a motor; there are drop, wrong-crc, noise, delay, stuck, over-current, \
                     heat, voltage, overload, shock, encoder, silent, restart, cut and clear"
                ));
            }
        };
        match words.next() {
            None => Ok(order),
            Some(word) => Err(format!("`{word}` is one word too many after `{name}`")),
        }
    }
}

fn set<T>(place: &mut T, value: T) -> Order {
    *place = value;
    Order::Nothing
}

fn number(name: &str, unit: &str, word: Option<&str>, least: f64, most: f64) -> Result<f64, String> {
    let wanted = || format!("`{name}` needs a number {unit} from {least} to {most}, such as `{name} {least}`");
    let word = word.ok_or_else(wanted)?;
    let value: f64 = word.parse().map_err(|_| format!("{}; `{word}` is none", wanted()))?;
    if (least..=most).contains(&value) { Ok(value) } else { Err(format!("{}; {value} is not", wanted())) }
}

fn share(name: &str, word: Option<&str>) -> Result<f64, String> {
    number(name, "SHARE", word, 0.0, 1.0)
}

fn register(word: Option<&str>) -> Result<&'static Register, String> {
    let word = word.ok_or("`stuck` needs a register, such as `stuck present-position`")?;
    table::by_name(word).ok_or_else(|| {
        let names: Vec<_> = table::REGISTERS.iter().map(|register| register.name).collect();
        format!("`{word}` is no register; there are {}", names.join(", "))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_by_text() {
        let mut faults = Faults::default();
        assert_eq!(faults.take("drop 0.5"), Ok(Order::Nothing));
        assert_eq!(faults.take("heat 80"), Ok(Order::Nothing));
        assert_eq!(faults.take("over-current -1.5"), Ok(Order::Nothing));
        assert_eq!((faults.drop, faults.temperature, faults.current), (0.5, Some(80.0), Some(-1.5)));
        assert_eq!(faults.take("stuck present-position"), Ok(Order::Stick(&table::PRESENT_POSITION)));
        assert_eq!(faults.take("clear"), Ok(Order::Nothing));
        assert_eq!(faults, Faults::default());
        for (text, says) in [
            ("", "`` is no fault of a motor; there are drop,"),
            ("drop", "`drop` needs a number SHARE from 0 to 1"),
            ("drop 2", "such as `drop 0`; 2 is not"),
            ("drop NaN", "; NaN is not"),
            ("delay soon", "; `soon` is none"),
            ("cut 3", "`3` is one word too many after `cut`"),
            ("stuck", "`stuck` needs a register"),
            ("stuck goal", "`goal` is no register; there are model-number,"),
        ] {
            let error = faults.take(text).unwrap_err();
            assert!(error.contains(says), "{text}: {error}");
        }
        assert_eq!(faults, Faults::default());
    }
}
