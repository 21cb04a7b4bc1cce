//! The numbers of a model that can be named: how many there are, what they measure and what they may be.
//!
//! Limits are wider than any robot. They keep out what the engine would take without a word (infinite places, spheres of
//! 1e30 m) and what would end the process.

use super::super::{Kind, Quantity};

/// A number, or several of one name, of the elements of a kind. Names are those of MJCF.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Field {
    pub(super) name: &'static str,
    /// How many numbers it has.
    pub(super) len: usize,
    /// Whether the name alone stands for the first number.
    pub(super) lone: bool,
    /// Letters that name its numbers, if any.
    pub(super) letters: &'static str,
    pub(super) measures: Measures,
    pub(super) limits: Limits,
}

/// What a field measures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Measures {
    /// The same for all its numbers.
    All(Quantity),
    /// One quantity for the first number and one for the others.
    First(Quantity, Quantity),
    /// One quantity for joints that turn and one for those that slide.
    Joint(Quantity, Quantity),
    /// As before for the first number; the others are factors of higher powers.
    Polynomial(Quantity, Quantity),
}

/// What a number may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Limits {
    pub(super) low: f64,
    pub(super) high: f64,
    /// Whether `low` itself is too low.
    pub(super) above: bool,
}

impl Limits {
    /// A place or a direction.
    const COORDINATE: Self = Self::of(-1e4, 1e4);
    /// A length that is not zero.
    const SIZE: Self = Self::over(0.0, 1e4);
    const MASS: Self = Self::of(0.0, 1e6);
    const UNIT: Self = Self::of(-1.0, 1.0);
    const POSITIVE: Self = Self::of(0.0, 1e9);
    const ANY: Self = Self::of(-1e9, 1e9);

    const fn of(low: f64, high: f64) -> Self {
        Self { low, high, above: false }
    }

    const fn over(low: f64, high: f64) -> Self {
        Self { low, high, above: true }
    }

    /// Whether the value is within. What is no number is not.
    pub(super) fn hold(self, value: f64) -> bool {
        value <= self.high && if self.above { value > self.low } else { value >= self.low }
    }
}

const fn one(name: &'static str, quantity: Quantity, limits: Limits) -> Field {
    Field { name, len: 1, lone: true, letters: "", measures: Measures::All(quantity), limits }
}

const fn joint(name: &'static str, turns: Quantity, slides: Quantity, limits: Limits) -> Field {
    Field { name, len: 1, lone: true, letters: "", measures: Measures::Joint(turns, slides), limits }
}

const fn several(name: &'static str, len: usize, quantity: Quantity, limits: Limits) -> Field {
    Field { name, len, lone: false, letters: "", measures: Measures::All(quantity), limits }
}

const fn coordinates(name: &'static str, quantity: Quantity, limits: Limits) -> Field {
    Field { name, len: 3, lone: false, letters: "xyz", measures: Measures::All(quantity), limits }
}

const fn polynomial(name: &'static str, turns: Quantity, slides: Quantity) -> Field {
    let measures = Measures::Polynomial(turns, slides);
    Field { name, len: 3, lone: true, letters: "", measures, limits: Limits::ANY }
}

/// A field whose name alone stands for its first number.
const fn lone(field: Field) -> Field {
    Field { lone: true, ..field }
}

const POS: Field = coordinates("pos", Quantity::Length, Limits::COORDINATE);
const QUAT: Field = Field { letters: "wxyz", ..several("quat", 4, Quantity::Number, Limits::UNIT) };
const EULER: Field = several("euler", 3, Quantity::Angle, Limits::COORDINATE);
const SIZE: Field = several("size", 3, Quantity::Length, Limits::SIZE);
const FROMTO: Field = several("fromto", 6, Quantity::Length, Limits::COORDINATE);
const MARGIN: Field = one("margin", Quantity::Length, Limits::of(0.0, 1e4));

const BODY: &[Field] = &[
    POS,
    QUAT,
    EULER,
    one("mass", Quantity::Mass, Limits::over(0.0, 1e6)),
    coordinates("ipos", Quantity::Length, Limits::COORDINATE),
    several("inertia", 3, Quantity::Inertia, Limits::over(0.0, 1e9)),
    several("fullinertia", 6, Quantity::Inertia, Limits::ANY),
    one("gravcomp", Quantity::Number, Limits::COORDINATE),
];

const GEOM: &[Field] = &[
    POS,
    QUAT,
    EULER,
    SIZE,
    FROMTO,
    one("mass", Quantity::Mass, Limits::MASS),
    one("density", Quantity::Density, Limits::MASS),
    Field {
        measures: Measures::First(Quantity::Number, Quantity::Length),
        ..lone(several("friction", 3, Quantity::Number, Limits::of(0.0, 1e4)))
    },
    several("solref", 2, Quantity::Mixed, Limits::ANY),
    several("solimp", 5, Quantity::Mixed, Limits::of(0.0, 1e4)),
    MARGIN,
    one("gap", Quantity::Length, Limits::of(0.0, 1e4)),
];

const SITE: &[Field] = &[POS, QUAT, EULER, SIZE, FROMTO];

const JOINT: &[Field] = &[
    POS,
    coordinates("axis", Quantity::Number, Limits::COORDINATE),
    polynomial("stiffness", Quantity::TorsionalStiffness, Quantity::Stiffness),
    polynomial("damping", Quantity::TorsionalDamping, Quantity::Damping),
    joint("springref", Quantity::Angle, Quantity::Length, Limits::COORDINATE),
    joint("ref", Quantity::Angle, Quantity::Length, Limits::COORDINATE),
    joint("armature", Quantity::Inertia, Quantity::Mass, Limits::POSITIVE),
    joint("frictionloss", Quantity::Torque, Quantity::Force, Limits::POSITIVE),
    Field { len: 2, lone: false, ..joint("range", Quantity::Angle, Quantity::Length, Limits::COORDINATE) },
    Field { len: 2, lone: false, ..joint("actuatorfrcrange", Quantity::Torque, Quantity::Force, Limits::ANY) },
    joint("margin", Quantity::Angle, Quantity::Length, Limits::of(0.0, 1e4)),
    several("solreflimit", 2, Quantity::Mixed, Limits::ANY),
    several("solimplimit", 5, Quantity::Mixed, Limits::of(0.0, 1e4)),
];

const ACTUATOR: &[Field] = &[
    lone(several("gear", 6, Quantity::Mixed, Limits::ANY)),
    several("ctrlrange", 2, Quantity::Mixed, Limits::ANY),
    several("forcerange", 2, Quantity::Mixed, Limits::ANY),
    several("actrange", 2, Quantity::Mixed, Limits::ANY),
    several("gainprm", 10, Quantity::Mixed, Limits::ANY),
    several("biasprm", 10, Quantity::Mixed, Limits::ANY),
    several("dynprm", 10, Quantity::Mixed, Limits::ANY),
    one("armature", Quantity::Mixed, Limits::POSITIVE),
    lone(several("damping", 3, Quantity::Mixed, Limits::ANY)),
    one("cranklength", Quantity::Length, Limits::SIZE),
];

const TENDON: &[Field] = &[
    polynomial("stiffness", Quantity::Stiffness, Quantity::Stiffness),
    polynomial("damping", Quantity::Damping, Quantity::Damping),
    lone(several("springlength", 2, Quantity::Length, Limits::COORDINATE)),
    several("range", 2, Quantity::Length, Limits::COORDINATE),
    several("actuatorfrcrange", 2, Quantity::Force, Limits::ANY),
    one("frictionloss", Quantity::Force, Limits::POSITIVE),
    one("armature", Quantity::Mass, Limits::POSITIVE),
    one("width", Quantity::Length, Limits::SIZE),
    MARGIN,
    several("solreflimit", 2, Quantity::Mixed, Limits::ANY),
    several("solimplimit", 5, Quantity::Mixed, Limits::of(0.0, 1e4)),
];

const EQUALITY: &[Field] = &[
    several("data", 11, Quantity::Mixed, Limits::COORDINATE),
    several("solref", 2, Quantity::Mixed, Limits::ANY),
    several("solimp", 5, Quantity::Mixed, Limits::of(0.0, 1e4)),
];

const OPTIONS: &[Field] = &[
    one("timestep", Quantity::Time, Limits::of(1e-6, 1.0)),
    coordinates("gravity", Quantity::Acceleration, Limits::COORDINATE),
    coordinates("wind", Quantity::Velocity, Limits::COORDINATE),
    one("density", Quantity::Density, Limits::MASS),
    one("viscosity", Quantity::Viscosity, Limits::of(0.0, 1e4)),
    one("impratio", Quantity::Number, Limits::over(0.0, 1e4)),
    one("tolerance", Quantity::Number, Limits::of(0.0, 1.0)),
];

/// The kinds whose elements have fields, as paths name them.
pub(super) const KINDS: [Kind; 8] =
    [Kind::Body, Kind::Geom, Kind::Joint, Kind::Site, Kind::Actuator, Kind::Tendon, Kind::Equality, Kind::Options];

/// The fields of a kind.
pub(super) fn fields(kind: Kind) -> &'static [Field] {
    match kind {
        Kind::Body => BODY,
        Kind::Geom => GEOM,
        Kind::Joint => JOINT,
        Kind::Site => SITE,
        Kind::Actuator => ACTUATOR,
        Kind::Tendon => TENDON,
        Kind::Equality => EQUALITY,
        Kind::Options => OPTIONS,
        Kind::Camera | Kind::Sensor | Kind::Keyframe => &[],
    }
}

/// A field that can be set, as a reference tells it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SettableField {
    /// The kind of its elements.
    pub kind: Kind,
    /// MJCF's name.
    pub name: &'static str,
    /// How many numbers it has.
    pub len: usize,
    /// Letters that name its numbers, if any.
    pub letters: &'static str,
    /// What they measure, by the symbols of units.
    pub units: String,
}

/// Every field that can be set, by the kinds of elements.
pub fn settable_fields() -> Vec<SettableField> {
    let told = |quantity: Quantity| match quantity.unit() {
        "" => if quantity == Quantity::Number { "a number" } else { "as the model means it" }.to_owned(),
        unit => unit.to_owned(),
    };
    let units = |measures| match measures {
        Measures::All(quantity) => told(quantity),
        Measures::First(first, others) => format!("{}, then {}", told(first), told(others)),
        Measures::Joint(turns, slides) | Measures::Polynomial(turns, slides) if turns != slides => {
            format!("{} of a hinge, {} of a slide", told(turns), told(slides))
        }
        Measures::Joint(all, _) | Measures::Polynomial(all, _) => told(all),
    };
    let of_kind = |kind: Kind| {
        let settable = move |field: &Field| SettableField {
            kind,
            name: field.name,
            len: field.len,
            letters: field.letters,
            units: units(field.measures),
        };
        fields(kind).iter().map(settable)
    };
    KINDS.into_iter().flat_map(of_kind).collect()
}

impl Field {
    /// What one of its numbers may be.
    pub(super) fn limits(&self, index: usize) -> Limits {
        match self.measures {
            Measures::Polynomial(..) if index == 0 => Limits::POSITIVE,
            _ => self.limits,
        }
    }

    /// What one of its numbers measures; `slides` says that the joint it belongs to does not turn.
    pub(super) fn quantity(&self, index: usize, slides: bool) -> Quantity {
        match self.measures {
            Measures::All(quantity) => quantity,
            Measures::First(first, others) => [first, others][usize::from(index > 0)],
            Measures::Polynomial(..) if index > 0 => Quantity::Mixed,
            Measures::Joint(turns, slide) | Measures::Polynomial(turns, slide) => [turns, slide][usize::from(slides)],
        }
    }
}
