//! Dimensions as exponents of SI base units.

use std::fmt;

use hwasp_core::Dimension;

/// Base units, in the order in which they are shown.
const BASES: [&str; 5] = ["kg", "m", "s", "A", "rad"];
/// Where the radian stands, which counts in names alone: an angle times a radius is a length.
const RADIAN: usize = 4;

/// The exponents of kg, m, s, A and rad, in halves, so that square roots stay exact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Exponents([i8; 5]);

impl Exponents {
    /// Of a pure number.
    pub const NONE: Self = Self([0; 5]);

    /// Of whole exponents of kg, m, s, A and rad.
    pub const fn new(exponents: [i8; 5]) -> Self {
        let [kg, m, s, a, rad] = exponents;
        Self([2 * kg, 2 * m, 2 * s, 2 * a, 2 * rad])
    }

    /// The exponents of a dimension that has a name.
    pub fn of(dimension: Dimension) -> Self {
        Self::new(match dimension {
            Dimension::None => [0; 5],
            Dimension::Length => [0, 1, 0, 0, 0],
            Dimension::Speed => [0, 1, -1, 0, 0],
            Dimension::Acceleration => [0, 1, -2, 0, 0],
            Dimension::Time => [0, 0, 1, 0, 0],
            Dimension::Mass => [1, 0, 0, 0, 0],
            Dimension::Force => [1, 1, -2, 0, 0],
            Dimension::Torque => [1, 2, -2, 0, 0],
            Dimension::Angle => [0, 0, 0, 0, 1],
            Dimension::AngularSpeed => [0, 0, -1, 0, 1],
            Dimension::Stiffness => [1, 0, -2, 0, 0],
            Dimension::TorsionalStiffness => [1, 2, -2, 0, -1],
            Dimension::Damping => [1, 0, -1, 0, 0],
            Dimension::TorsionalDamping => [1, 2, -1, 0, -1],
            Dimension::Inertia => [1, 2, 0, 0, 0],
            Dimension::Density => [1, -3, 0, 0, 0],
            Dimension::Power => [1, 2, -3, 0, 0],
            Dimension::Current => [0, 0, 0, 1, 0],
            Dimension::Voltage => [1, 2, -3, -1, 0],
        })
    }

    /// The dimension of these exponents, where it has a name; energy is told as a torque, which has the same.
    pub fn dimension(self) -> Option<Dimension> {
        Dimension::ALL.into_iter().find(|&dimension| Self::of(dimension) == self)
    }

    /// Whether sums of both make sense: the radian does not count.
    pub fn fits(self, other: Self) -> bool {
        self.0[..RADIAN] == other.0[..RADIAN]
    }

    /// Whether it is a pure number or an angle.
    pub fn is_pure(self) -> bool {
        self.fits(Self::NONE)
    }

    /// Of a product.
    #[must_use]
    pub fn times(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i].saturating_add(other.0[i])))
    }

    /// Of a quotient.
    #[must_use]
    pub fn over(self, other: Self) -> Self {
        self.times(other.power(-1))
    }

    /// Of a whole power.
    #[must_use]
    pub fn power(self, exponent: i32) -> Self {
        let exponent = exponent.clamp(-64, 64) as i8;
        Self(self.0.map(|own| own.saturating_mul(exponent)))
    }

    /// Of a square root, where it has exponents in halves.
    pub fn root(self) -> Option<Self> {
        self.0.iter().all(|own| own % 2 == 0).then(|| Self(self.0.map(|own| own / 2)))
    }
}

impl fmt::Display for Exponents {
    /// The unit of a name, `N·m/rad`, or base units, `m^2/s`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0 == [0; 5] {
            return f.write_str("a pure number");
        }
        if let Some(dimension) = self.dimension() {
            return f.write_str(dimension.si());
        }
        let power = |(base, &own): (&&str, &i8)| match own.unsigned_abs() {
            2 => (*base).to_owned(),
            even if even % 2 == 0 => format!("{base}^{}", even / 2),
            odd => format!("{base}^{}", f64::from(odd) / 2.0),
        };
        let side = |sign: i8| BASES.iter().zip(&self.0).filter(move |(_, own)| own.signum() == sign).map(power);
        let (above, below) = (side(1).collect::<Vec<_>>().join("·"), side(-1).collect::<Vec<_>>().join("/"));
        let above = if above.is_empty() { "1" } else { &above };
        if below.is_empty() { f.write_str(above) } else { write!(f, "{above}/{below}") }
    }
}

/// What a value measures, as far as its text says it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Of numbers without a unit: a pure number in products, and whatever is asked for in sums, `pos.z < 0.7`.
    Number,
    /// Known.
    Known(Exponents),
    /// Nobody has said what it measures, so that it fits everything: a command without a unit.
    Unknown,
}

impl Quantity {
    /// Of a dimension that has a name.
    pub fn of(dimension: Dimension) -> Self {
        Self::Known(Exponents::of(dimension))
    }

    /// The dimension, where it is known and has a name.
    pub fn dimension(self) -> Option<Dimension> {
        match self {
            Self::Number | Self::Unknown => None,
            Self::Known(exponents) => exponents.dimension(),
        }
    }

    /// Of a sum, a choice or a comparison; none where both are known and differ.
    pub(crate) fn with(self, other: Self) -> Option<Self> {
        match (self, other) {
            (Self::Known(a), Self::Known(b)) => a.fits(b).then_some(self),
            (Self::Known(_), _) | (Self::Unknown, Self::Number) => Some(self),
            (Self::Number | Self::Unknown, _) => Some(other),
        }
    }

    pub(crate) fn times(self, other: Self) -> Self {
        match (self, other) {
            (Self::Unknown, _) | (_, Self::Unknown) => Self::Unknown,
            (Self::Number, other) | (other, Self::Number) => other,
            (Self::Known(a), Self::Known(b)) => Self::Known(a.times(b)),
        }
    }

    pub(crate) fn power(self, exponent: i32) -> Self {
        match self {
            Self::Known(own) => Self::Known(own.power(exponent)),
            other => other,
        }
    }

    pub(crate) fn root(self) -> Self {
        match self {
            Self::Known(own) => own.root().map_or(Self::Unknown, Self::Known),
            other => other,
        }
    }

    /// Whether it can be an angle or a pure number.
    pub(crate) fn is_pure(self) -> bool {
        !matches!(self, Self::Known(own) if !own.is_pure())
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number => f.write_str("a number"),
            Self::Known(own) => own.fmt(f),
            Self::Unknown => f.write_str("of no known unit"),
        }
    }
}
