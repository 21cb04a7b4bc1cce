//! Values of programs.

use std::fmt;

/// A value. Whole numbers are numbers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    Nothing,
    Number(f64),
    Truth(bool),
    Text(String),
    List(Vec<Value>),
    Pose([f64; 6]),
    /// A thread that was started.
    Thread(usize),
}

impl Value {
    /// As a number.
    pub(crate) fn number(&self) -> Result<f64, String> {
        match self {
            Self::Number(number) => Ok(*number),
            other => Err(format!("{other} is no number")),
        }
    }

    /// As a truth.
    pub(crate) fn truth(&self) -> Result<bool, String> {
        match self {
            Self::Truth(truth) => Ok(*truth),
            other => Err(format!("{other} is neither True nor False")),
        }
    }

    /// As six numbers: a pose or a list.
    pub(crate) fn six(&self) -> Result<[f64; 6], String> {
        match self {
            Self::Pose(pose) => Ok(*pose),
            Self::List(list) if list.len() == 6 => {
                let mut six = [0.0; 6];
                for (number, value) in six.iter_mut().zip(list) {
                    *number = value.number()?;
                }
                Ok(six)
            }
            other => Err(format!("{other} does not have six numbers")),
        }
    }

    /// A list of numbers.
    pub(crate) fn list(numbers: &[f64]) -> Self {
        Self::List(numbers.iter().map(|number| Self::Number(*number)).collect())
    }

    /// The element at `index`.
    pub(crate) fn at(&self, index: f64) -> Result<Self, String> {
        let found = match self {
            Self::Pose(pose) => pose.get(index as usize).map(|number| Self::Number(*number)),
            Self::List(list) => list.get(index as usize).cloned(),
            _ => None,
        };
        found.filter(|_| index >= 0.0).ok_or_else(|| format!("{self} has no element {index}"))
    }

    /// Writes the element at `index`.
    pub(crate) fn set(&mut self, index: f64, value: Self) -> Result<(), String> {
        let place = index as usize;
        match self {
            Self::Pose(pose) if index >= 0.0 && place < 6 => pose[place] = value.number()?,
            Self::List(list) if index >= 0.0 && place < list.len() => list[place] = value,
            other => return Err(format!("{other} has no element {index}")),
        }
        Ok(())
    }
}

impl fmt::Display for Value {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nothing => out.write_str("None"),
            Self::Number(number) => write!(out, "{number}"),
            Self::Truth(truth) => out.write_str(if *truth { "True" } else { "False" }),
            Self::Text(text) => out.write_str(text),
            Self::List(list) => {
                out.write_str("[")?;
                for (at, value) in list.iter().enumerate() {
                    write!(out, "{}{value}", if at > 0 { ", " } else { "" })?;
                }
                out.write_str("]")
            }
            Self::Pose(pose) => write!(out, "p{}", Self::list(pose)),
            Self::Thread(number) => write!(out, "thread {number}"),
        }
    }
}
