//! Units that files may name. Inside, everything is SI.

use thiserror::Error;

/// A physical dimension, as far as designs and settings need them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Dimension {
    /// A pure number.
    None,
    /// Length, m.
    Length,
    /// Speed, m/s.
    Speed,
    /// Time, s.
    Time,
    /// Mass, kg.
    Mass,
    /// Force, N.
    Force,
    /// Torque, N·m.
    Torque,
    /// Angle, rad.
    Angle,
    /// Angular speed, rad/s.
    AngularSpeed,
    /// Linear stiffness, N/m.
    Stiffness,
    /// Torsional stiffness, N·m/rad.
    TorsionalStiffness,
    /// Linear damping, N·s/m.
    Damping,
    /// Torsional damping, N·m·s/rad.
    TorsionalDamping,
    /// Acceleration, m/s².
    Acceleration,
    /// Moment of inertia, kg·m².
    Inertia,
    /// Density, kg/m³.
    Density,
    /// Power, W.
    Power,
    /// Electric current, A.
    Current,
    /// Voltage, V.
    Voltage,
}

/// A named unit: its symbol, its dimension and the factor to SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// The symbol as written in files.
    pub symbol: &'static str,
    /// What it measures.
    pub dimension: Dimension,
    /// Multiply by this to get the SI value.
    pub to_si: f64,
}

/// Every unit, the SI one of each dimension first. ASCII spellings (`N*m`) are accepted beside the dotted ones.
const UNITS: &[Unit] = &[
    Unit { symbol: "", dimension: Dimension::None, to_si: 1.0 },
    Unit { symbol: "m", dimension: Dimension::Length, to_si: 1.0 },
    Unit { symbol: "mm", dimension: Dimension::Length, to_si: 1e-3 },
    Unit { symbol: "cm", dimension: Dimension::Length, to_si: 1e-2 },
    Unit { symbol: "m/s", dimension: Dimension::Speed, to_si: 1.0 },
    Unit { symbol: "mm/s", dimension: Dimension::Speed, to_si: 1e-3 },
    Unit { symbol: "s", dimension: Dimension::Time, to_si: 1.0 },
    Unit { symbol: "ms", dimension: Dimension::Time, to_si: 1e-3 },
    Unit { symbol: "kg", dimension: Dimension::Mass, to_si: 1.0 },
    Unit { symbol: "g", dimension: Dimension::Mass, to_si: 1e-3 },
    Unit { symbol: "N", dimension: Dimension::Force, to_si: 1.0 },
    Unit { symbol: "mN", dimension: Dimension::Force, to_si: 1e-3 },
    Unit { symbol: "N·m", dimension: Dimension::Torque, to_si: 1.0 },
    Unit { symbol: "N·mm", dimension: Dimension::Torque, to_si: 1e-3 },
    Unit { symbol: "rad", dimension: Dimension::Angle, to_si: 1.0 },
    Unit { symbol: "deg", dimension: Dimension::Angle, to_si: std::f64::consts::PI / 180.0 },
    Unit { symbol: "rad/s", dimension: Dimension::AngularSpeed, to_si: 1.0 },
    Unit { symbol: "N/m", dimension: Dimension::Stiffness, to_si: 1.0 },
    Unit { symbol: "N/mm", dimension: Dimension::Stiffness, to_si: 1e3 },
    Unit { symbol: "N·m/rad", dimension: Dimension::TorsionalStiffness, to_si: 1.0 },
    Unit { symbol: "N·mm/rad", dimension: Dimension::TorsionalStiffness, to_si: 1e-3 },
    Unit { symbol: "N·s/m", dimension: Dimension::Damping, to_si: 1.0 },
    Unit { symbol: "N·m·s/rad", dimension: Dimension::TorsionalDamping, to_si: 1.0 },
    Unit { symbol: "m/s^2", dimension: Dimension::Acceleration, to_si: 1.0 },
    Unit { symbol: "kg·m^2", dimension: Dimension::Inertia, to_si: 1.0 },
    Unit { symbol: "kg/m^3", dimension: Dimension::Density, to_si: 1.0 },
    Unit { symbol: "W", dimension: Dimension::Power, to_si: 1.0 },
    Unit { symbol: "A", dimension: Dimension::Current, to_si: 1.0 },
    Unit { symbol: "V", dimension: Dimension::Voltage, to_si: 1.0 },
];

/// Why a text is not a quantity of the dimension asked for.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum UnitError {
    /// The leading number cannot be read.
    #[error("`{text}` does not begin with a number")]
    Number {
        /// What was written.
        text: String,
    },
    /// The unit is not known.
    #[error("unknown unit `{symbol}` in `{text}`")]
    Unknown {
        /// What was written.
        text: String,
        /// The unit part of it.
        symbol: String,
    },
    /// The unit measures something else.
    #[error("`{text}` has the unit `{symbol}`, which does not measure what is asked for here")]
    Dimension {
        /// What was written.
        text: String,
        /// The unit part of it.
        symbol: String,
    },
    /// A number without a unit where one is needed.
    #[error("`{text}` names no unit")]
    Missing {
        /// What was written.
        text: String,
    },
}

impl Dimension {
    /// Every one.
    pub const ALL: [Self; 19] = [
        Self::None,
        Self::Length,
        Self::Speed,
        Self::Time,
        Self::Mass,
        Self::Force,
        Self::Torque,
        Self::Angle,
        Self::AngularSpeed,
        Self::Stiffness,
        Self::TorsionalStiffness,
        Self::Damping,
        Self::TorsionalDamping,
        Self::Acceleration,
        Self::Inertia,
        Self::Density,
        Self::Power,
        Self::Current,
        Self::Voltage,
    ];

    /// The SI symbol, empty for pure numbers.
    pub fn si(self) -> &'static str {
        UNITS.iter().find(|u| u.dimension == self).map_or("", |u| u.symbol)
    }

    /// Every symbol that measures this dimension.
    pub fn symbols(self) -> Vec<&'static str> {
        UNITS.iter().filter(|u| u.dimension == self).map(|u| u.symbol).collect()
    }
}

/// The unit of this symbol, if there is one.
pub fn unit(symbol: &str) -> Option<Unit> {
    UNITS.iter().find(|unit| unit.symbol == symbol).copied()
}

impl Unit {
    /// The unit of the same dimension in which values of this size, SI, read well: what is below a tenth of a metre is told in
    /// mm. Itself where there is none that is a thousandth.
    pub fn readable(self, size: f64) -> Self {
        let mut units = UNITS.iter().filter(|unit| size.abs() < 0.1 && unit.dimension == self.dimension);
        units.find(|unit| unit.to_si == 1e-3).copied().unwrap_or(self)
    }
}

/// Takes `"-1_000 N/m"` apart into the text of the number, without `_`, and that of the unit, empty where there is none. Neither is
/// checked.
pub fn split_quantity(text: &str) -> (String, &str) {
    let trimmed = text.trim();
    let split = trimmed
        .char_indices()
        .find(|&(i, c)| {
            // An exponent's letter belongs to the number only when a digit or sign follows.
            let exponent = matches!(c, 'e' | 'E')
                && trimmed[i + 1..].starts_with(|d: char| d.is_ascii_digit() || d == '-' || d == '+');
            !(c.is_ascii_digit() || matches!(c, '.' | '-' | '+' | '_') || exponent)
        })
        .map_or(trimmed.len(), |(i, _)| i);
    (trimmed[..split].replace('_', ""), trimmed[split..].trim())
}

/// Reads `"100 N/m"` or `"2.5 N·mm"` (also `N*mm`) and returns the SI value.
pub fn parse_quantity(text: &str, dimension: Dimension) -> Result<f64, UnitError> {
    let (number, symbol) = split_quantity(text);
    let symbol = symbol.replace('*', "·");
    let text = text.to_owned();
    let Ok(value) = number.parse::<f64>() else { return Err(UnitError::Number { text }) };
    if symbol.is_empty() && dimension != Dimension::None {
        return Err(UnitError::Missing { text });
    }
    match UNITS.iter().find(|u| u.symbol == symbol) {
        None => Err(UnitError::Unknown { text, symbol }),
        Some(unit) if unit.dimension == dimension => Ok(value * unit.to_si),
        Some(_) => Err(UnitError::Dimension { text, symbol }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_numbers_with_units() {
        assert_eq!(parse_quantity("100 N/m", Dimension::Stiffness), Ok(100.0));
        assert_eq!(parse_quantity("1.5e-1 m", Dimension::Length), Ok(0.15));
        assert_eq!(parse_quantity("-2 N*mm", Dimension::Torque), Ok(-0.002));
        assert_eq!(parse_quantity("20mm", Dimension::Length), Ok(0.02));
    }

    #[test]
    fn refuses_what_is_not_asked_for() {
        assert!(matches!(parse_quantity("100", Dimension::Stiffness), Err(UnitError::Missing { .. })));
        assert!(matches!(parse_quantity("100 N", Dimension::Stiffness), Err(UnitError::Dimension { .. })));
        assert!(matches!(parse_quantity("100 lbf", Dimension::Force), Err(UnitError::Unknown { .. })));
        assert!(matches!(parse_quantity("fast", Dimension::Speed), Err(UnitError::Number { .. })));
    }

    #[test]
    fn small_quantities_have_small_units() {
        let readable = |symbol, size| unit(symbol).unwrap().readable(size);
        assert_eq!((readable("m", 0.012).symbol, readable("m", 0.012).to_si), ("mm", 1e-3));
        assert_eq!((readable("m", 0.5).symbol, readable("N·m/rad", 0.01).symbol), ("m", "N·mm/rad"));
        assert_eq!((readable("", 0.01).symbol, readable("rad", 0.01).symbol, unit("lbf")), ("", "rad", None));
    }
}
