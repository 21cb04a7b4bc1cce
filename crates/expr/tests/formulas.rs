//! What formulas give, against arithmetic by hand, and what is said of wrong ones.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use hwasp_core::Dimension;
use hwasp_diff::{GradCheckSettings, gradcheck};
use hwasp_expr::{
    Distribution, Exponents, FUNCTIONS, Formulas, NameError, Part, Path, Quantity, Scope, Symbol, Value, quantity,
};

/// Columns: knee (rad), speed (rad/s), place (m, three of them), way (quaternion), force (no unit). One uniform: stiffness.
struct Robot {
    strict: bool,
    drawn: usize,
    remembered: Vec<Part>,
}

const NAMES: [(&str, usize, usize, Quantity); 5] = [
    ("knee", 0, 1, Quantity::Known(Exponents::new([0, 0, 0, 0, 1]))),
    ("speed", 1, 1, Quantity::Known(Exponents::new([0, 0, -1, 0, 1]))),
    ("place", 2, 3, Quantity::Known(Exponents::new([0, 1, 0, 0, 0]))),
    ("way", 5, 4, Quantity::Number),
    ("force", 9, 1, Quantity::Unknown),
];
/// Columns of the names; draws and what is remembered come after them.
const COLUMNS: usize = 10;

impl Robot {
    fn new() -> Self {
        Self { strict: false, drawn: 0, remembered: Vec::new() }
    }
}

impl Scope for Robot {
    fn name(&mut self, formulas: &mut Formulas, path: &Path) -> Result<Symbol, NameError> {
        if path.first() == "stiffness" {
            return Ok(Symbol::new(vec![formulas.uniform(0)], Quantity::of(Dimension::TorsionalStiffness), 1));
        }
        if path.first() == "joint" {
            return match path.word(1) {
                Some("knee" | "*") if path.word(2) == Some("pos") => {
                    Ok(Symbol::new(vec![formulas.column(0)], NAMES[0].3, 3))
                }
                Some("knee") => Err(NameError::at(2, ["pos", "vel"])),
                _ => Err(NameError::at(1, ["knee"])),
            };
        }
        let found = NAMES.iter().find(|(name, ..)| *name == path.first());
        let &(_, at, count, quantity) = found.ok_or_else(|| NameError::unknown(NAMES.map(|name| name.0)))?;
        Ok(Symbol::new((at..at + count).map(|i| formulas.column(i)).collect(), quantity, 1))
    }

    fn previous(&mut self, formulas: &mut Formulas, value: &Value) -> Result<Vec<Part>, String> {
        self.remembered.extend(&value.parts);
        Ok(value.parts.iter().map(|_| formulas.constant(0.25)).collect())
    }

    fn draw(&mut self, formulas: &mut Formulas, _: Distribution, count: usize) -> Result<Vec<Part>, String> {
        let first = COLUMNS + self.drawn;
        self.drawn += count;
        Ok((first..first + count).map(|i| formulas.column(i)).collect())
    }

    fn width(&self) -> usize {
        2
    }

    fn strict(&self) -> bool {
        self.strict
    }
}

const INPUTS: [f64; 14] = [0.5, -2.0, 1.0, 2.0, 3.0, 0.5, -0.5, 0.5, 0.5, 4.0, 0.25, 0.75, 0.5, 0.1];
const STIFFNESS: f64 = 3.0;

fn program(text: &str) -> hwasp_diff::Program {
    let mut formulas = Formulas::default();
    let value = formulas.read(text, &mut Robot::new()).unwrap_or_else(|error| panic!("{text}: {error:?}"));
    let columns: Vec<String> = (0..INPUTS.len()).map(|i| format!("c{i}")).collect();
    let outputs = value.parts.iter().enumerate().map(|(i, &part)| (format!("y{i}"), part)).collect();
    formulas.program(&["stiffness".to_owned()], &columns, outputs)
}

fn value(text: &str) -> Vec<f64> {
    let program = program(text);
    let (mut tape, mut out) = (program.tape::<f64>(1), vec![0.0; program.output_names().len()]);
    program.bind(&[STIFFNESS], &mut tape);
    program.forward(&INPUTS, 1, 1, &mut tape, &mut out, 1);
    out
}

fn number(text: &str) -> f64 {
    let value = value(text);
    assert_eq!(value.len(), 1, "{text}");
    value[0]
}

fn near(text: &str, wanted: &[f64]) {
    let value = value(text);
    assert_eq!(value.len(), wanted.len(), "{text}: {value:?}");
    for (value, wanted) in value.iter().zip(wanted) {
        assert!((value - wanted).abs() < 1e-12, "{text} is {value}, not {wanted}");
    }
}

#[test]
fn arithmetic_binds_as_everywhere() {
    for (text, wanted) in [
        ("1 + 2 * 3", 7.0),
        ("(1 + 2) * 3", 9.0),
        ("-2^2", -4.0),
        ("2^3^2", 512.0),
        ("2^-1", 0.5),
        ("2 - 3 - 4", -5.0),
        ("8 / 4 / 2", 1.0),
        ("1_000e-3", 1.0),
        ("not 1 < 2 or 3 > 2 and 2 >= 2", 1.0),
    ] {
        assert_eq!(number(text), wanted, "{text}");
    }
    assert_eq!(number("knee^2"), 0.25);
    assert_eq!(number("4^0.5"), 2.0);
    near("2^1.5", &[2.0_f64.powf(1.5)]);
    assert_eq!(number("joint.knee.pos * 2 + force"), 5.0);
    assert_eq!(number("joint.*.pos*2"), 1.0);
    assert_eq!(number("stiffness * (knee - 0.25 rad)"), 0.75);
}

#[test]
fn vectors_have_components_and_slices() {
    assert_eq!(value("place"), [1.0, 2.0, 3.0]);
    assert_eq!(value("place.z"), [3.0]);
    assert_eq!(value("place[1:]"), [2.0, 3.0]);
    assert_eq!(value("place[:-1] * 2"), [2.0, 4.0]);
    assert_eq!(value("(2 * place).y"), [4.0]);
    assert_eq!(value("[knee, place[0:2], 7]"), [0.5, 1.0, 2.0, 7.0]);
    assert_eq!(number("sum(place^2)"), 14.0);
    assert_eq!(number("max(place) - min(place, 2)[0]"), 2.0);
    near("[norm(place), mean(place), dot(place, [1, 0, 2])]", &[14.0_f64.sqrt(), 2.0, 7.0]);
    assert_eq!(value("cross([1, 0, 0], [0, 1, 0])"), [0.0, 0.0, 1.0]);
    assert_eq!([number("any(place > 2)"), number("all(place > 2)")], [1.0, 0.0]);
    assert_eq!(value("clip(place, 1.5, 2.5)"), [1.5, 2.0, 2.5]);
}

#[test]
fn choices_do_not_touch_the_other_side() {
    assert_eq!(number("where(speed < 0, 7, log(speed))"), 7.0);
    assert_eq!(value("where(place > 1.5, place, 0)"), [0.0, 2.0, 3.0]);
    assert_eq!([number("knee == 0.5"), number("knee != 0.5"), number("sign(speed)")], [1.0, 0.0, -1.0]);
}

#[test]
fn angles_and_rotations() {
    for (y, x) in [(0.0, 1.0), (0.0, -1.0), (1.0, 0.0), (-1.0, 0.0), (0.3, -2.0), (-0.3, -2.0), (2.0, 0.1), (0.0, 0.0)]
    {
        let wanted = if (y, x) == (0.0, 0.0) { 0.0 } else { f64::atan2(y, x) };
        let text = format!("atan2({y}, {x}) + 0 * knee");
        let found = number(&text);
        assert!((found - wanted).abs() < 1e-12 || (x, y) == (0.0, 0.0), "{text} is {found}, not {wanted}");
    }
    near("wrap(4 rad + 0 * knee)", &[4.0 - 2.0 * std::f64::consts::PI]);
    near(
        "[asin(0.3), acos(0.3), asin(2), atan(2), tan(0.4)]",
        &[0.3_f64.asin(), 0.3_f64.acos(), std::f64::consts::FRAC_PI_2, 2.0_f64.atan(), 0.4_f64.tan()],
    );
    // A third of a turn about (-1, 1, 1), and back.
    near("unrotate(way, rotate(way, place))", &[1.0, 2.0, 3.0]);
    near("rotate([cos(0.2), 0, 0, sin(0.2)], [1, 0, 0])", &[0.4_f64.cos(), 0.4_f64.sin(), 0.0]);
    near("multiply(way, conjugate(way))", &[1.0, 0.0, 0.0, 0.0]);
    near("turn([1, 0, 0, 0], [cos(0.2), sin(0.2), 0, 0])", &[0.4]);
    near(
        "[yaw([cos(0.2), 0, 0, sin(0.2)]), pitch([cos(0.2), 0, sin(0.2), 0]), roll([cos(0.2), sin(0.2), 0, 0])]",
        &[0.4; 3],
    );
}

#[test]
fn what_was_and_what_is_drawn() {
    assert_eq!(number("diff(knee)"), 0.25);
    assert_eq!(number("previous(knee)"), 0.25);
    assert_eq!(value("uniform(-1, 3)"), [0.0, 2.0]);
    assert_eq!(value("normal(1, place)"), [1.25, 2.5, 2.5]);
    near("log_uniform(1, 16)", &[2.0, 8.0]);
}

#[test]
fn units_are_read_into_si() {
    near(
        "[90 deg, 5 mm, 2 N*mm, 3 m/s^2, 60 rpm, 1 kN, 2 N*m/rad * 1]",
        &[std::f64::consts::FRAC_PI_2, 0.005, 0.002, 3.0, 2.0 * std::f64::consts::PI, 1000.0, 2.0],
    );
    assert_eq!(quantity("0.2 N*m*s/rad").unwrap().1.unwrap().dimension(), Some(Dimension::TorsionalDamping));
    assert_eq!(quantity("-3").unwrap(), (-3.0, None));
    assert!(quantity("3 lbf").unwrap_err().hint.unwrap().contains("N*m/rad"));
    for dimension in Dimension::ALL {
        let exponents = Exponents::of(dimension);
        assert_eq!(exponents.dimension(), Some(dimension));
        if dimension != Dimension::None {
            assert_eq!(hwasp_expr::parse_unit(dimension.si()), Some((1.0, exponents)), "{dimension:?}");
        }
    }
}

/// Every function of the reference is there, takes what the reference says, and has the derivative that finite differences give.
#[test]
fn every_function_differentiates() {
    for function in FUNCTIONS {
        let quaternions = ["rotate", "unrotate", "multiply", "conjugate", "turn", "roll", "pitch", "yaw"];
        let text = match function.name {
            name @ ("rotate" | "unrotate") => format!("{name}(way, place)"),
            name @ ("multiply" | "turn") => format!("{name}(way, [0.1, 0.2, 0.3, 0.4] + 0.1 * way)"),
            name if quaternions.contains(&name) => format!("{name}(way * [1, 0.8, 0.9, 1.1])"),
            "cross" | "dot" => format!("{}(place, [speed, knee, force])", function.name),
            "where" => "where(place > 1.5, place * knee, speed)".to_owned(),
            "clip" => "clip(place, knee, 2.5)".to_owned(),
            "min" | "max" | "atan2" => format!("{}(knee, 0.3 * speed)", function.name),
            "uniform" | "log_uniform" | "normal" => format!("{}(knee, force)", function.name),
            "asin" | "acos" => format!("{}(0.7 * knee)", function.name),
            "tan" => "tan(0.3 * place)".to_owned(),
            name @ ("any" | "all" | "sign") => format!("{name}(place) * knee"),
            name => format!("{name}(place * knee)"),
        };
        let program = program(&text);
        let report = gradcheck(&program, &[STIFFNESS], &INPUTS, &GradCheckSettings::default());
        let report = report.unwrap_or_else(|error| panic!("{text}: {error}"));
        assert!(report.max_relative_error < 1e-7, "{text}: {report:?}");
    }
}

/// Robots start at rest in the middle: an angle of exactly 0 has a derivative, and so has what stands in the branch not taken.
#[test]
fn angles_at_zero_differentiate() {
    let mut inputs = INPUTS;
    inputs[0] = 0.0;
    for text in ["wrap(stiffness * knee)", "atan2(stiffness * knee, stiffness)", "atan2(stiffness * knee, 1) * speed"] {
        let report = gradcheck(&program(text), &[STIFFNESS], &inputs, &GradCheckSettings::default());
        let report = report.unwrap_or_else(|error| panic!("{text}: {error}"));
        assert!(report.max_relative_error < 1e-7, "{text}: {report:?}");
    }
    for text in ["norm([stiffness * knee, 0])", "atan2(stiffness * knee, 0)", "atan2(stiffness * knee, -1)"] {
        let program = program(text);
        let (mut tape, mut out) = (program.tape::<f64>(1), [0.0]);
        program.bind(&[STIFFNESS], &mut tape);
        program.forward(&inputs, 1, 1, &mut tape, &mut out, 1);
        let (mut gradient, mut of_columns) = ([0.0], [0.0; INPUTS.len()]);
        program.vjp(&inputs, 1, 1, &[1.0], 1, &mut tape, &mut of_columns, 1);
        program.vjp_uniform(&mut tape, &mut gradient);
        assert_eq!(gradient, [0.0], "{text}");
    }
}

/// What is wrong, where, and what is said of it.
#[test]
fn faults_name_place_and_way_out() {
    let strict = |text: &str| {
        let error = Formulas::default().read(text, &mut Robot { strict: true, ..Robot::new() }).unwrap_err();
        (text[error.span].to_owned(), error.message, error.hint.unwrap_or_default())
    };
    for (text, at, message, hint) in [
        ("", "", "the formula is empty", ""),
        ("1 +", "", "the formula ends where a value should be", ""),
        ("knee * (speed", "(", "the bracket is not closed by `)`", ""),
        ("sin(knee))", ")", "`)` stands where the formula could end here", ""),
        ("kneee", "kneee", "`kneee` is not known", "did you mean `knee`?"),
        ("joint.kne.pos", "kne", "`joint` has no `kne`", "did you mean `knee`?"),
        ("joint.knee.velocity", "velocity", "`joint.knee` has no `velocity`", "known here: pos, vel"),
        ("place.q", "q", "`q` is no component of `place`", "components are"),
        ("place[3]", "place[3]", "there is no component 3: the vector has 3 components, counted from 0", ""),
        ("knee.y", "y", "there is no component 1: the vector has 1 component, counted from 0", ""),
        ("place + way", "place + way", "vectors of 3 and of 4 components do not go together", "slice"),
        ("knee + speed", "knee + speed", "rad and rad/s do not go together in +", "same"),
        ("sin(place.x)", "place.x", "the argument of sin is a pure number or an angle, and this is m", "divide"),
        ("clip(knee, 1 m, 2 m)", "clip(knee, 1 m, 2 m)", "rad and m do not go together in clip", ""),
        ("sine(knee)", "sine", "there is no function `sine`", "did you mean `sin`?"),
        ("clip(knee, 1)", "clip(knee, 1)", "clip takes 3 arguments, and has 2", "write it clip(x, low, high)"),
        ("1 < knee < 2", "<", "< and < are chained", "write a < b and b < c"),
        ("knee = 2", "=", "`=` means nothing in a formula", "=="),
        ("knee && speed", "&", "`&` means nothing in a formula", "and, or, not"),
        ("2 lbf", "lbf", "`lbf` after a number is no unit", "N*m/rad"),
        ("2knee", "knee", "`knee` after a number is no unit", "*"),
        ("joint.2.pos", "2", "a name does not begin with a digit", "#2"),
        ("1e999", "1e999", "`1e999` is no finite number", ""),
        ("rotate(place, place)", "place", "a vector of 4 components is wanted here, and this has 3", ""),
        ("\"knee", "\"knee", "the quotes are not closed", ""),
        ("45°", "°", "`°` means nothing in a formula", "45 deg"),
    ] {
        let (found_at, found, found_hint) = strict(text);
        assert_eq!((found_at.as_str(), found.as_str()), (at, message), "{text}");
        assert!(found_hint.contains(hint), "{text}: {found_hint}");
    }
    // Without strictness sums of unlike quantities are sums of numbers.
    assert_eq!(number("knee + speed"), -1.5);
    let deep = format!("{}knee{}", "(".repeat(200), ")".repeat(200));
    assert!(strict(&deep).1.contains("nested deeper"));
    let long = format!("knee{}", " + knee".repeat(4000));
    assert!(strict(&long).1.contains("more than 20000"));
}
