//! Functions from text, and the library of laws, against mechanics by hand.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use std::collections::HashMap;
use std::sync::Arc;

use hwasp_diff::{GradCheckSettings, Program, gradcheck};
use hwasp_expr::{Formulas, Function, NameError, Path, Quantity, Scope, Signature, Symbol, laws, parse_unit};

/// Names with units, each a column, and functions.
#[derive(Default)]
struct Bench {
    names: Vec<(&'static str, Quantity)>,
    functions: HashMap<String, Arc<Function>>,
}

impl Bench {
    fn new(names: &[(&'static str, &str)]) -> Self {
        let quantity = |unit: &str| parse_unit(unit).map_or(Quantity::Unknown, |(_, own)| Quantity::Known(own));
        let names = names.iter().map(|&(name, unit)| (name, quantity(unit))).collect();
        Self { names, ..Self::default() }
    }

    fn define(&mut self, signature: &str, text: &str) -> Result<(), hwasp_expr::ExprError> {
        let function = Function::new(Signature::parse(signature)?, text)?;
        Formulas::default().check(&function, self)?;
        self.functions.insert(function.name().to_owned(), Arc::new(function));
        Ok(())
    }

    fn program(&mut self, text: &str) -> Program {
        let mut formulas = Formulas::default();
        let value = formulas.read(text, self).unwrap_or_else(|error| panic!("{text}: {error:?}"));
        let columns: Vec<String> = self.names.iter().map(|(name, _)| (*name).to_owned()).collect();
        formulas.program(&[], &columns, value.parts.iter().map(|&part| (String::new(), part)).collect())
    }

    fn value(&mut self, text: &str, inputs: &[f64]) -> f64 {
        let program = self.program(text);
        let (mut tape, mut out) = (program.tape::<f64>(1), vec![0.0; program.output_names().len()]);
        program.bind(&[], &mut tape);
        program.forward(inputs, 1, 1, &mut tape, &mut out, 1);
        assert_eq!(out.len(), 1, "{text}");
        out[0]
    }

    fn fault(&mut self, text: &str) -> (String, String, String) {
        let error = Formulas::default().read(text, self).unwrap_err();
        (text[error.span].to_owned(), error.message, error.hint.unwrap_or_default())
    }
}

impl Scope for Bench {
    fn name(&mut self, formulas: &mut Formulas, path: &Path) -> Result<Symbol, NameError> {
        let at = self.names.iter().position(|(name, _)| *name == path.first());
        let at = at.ok_or_else(|| NameError::unknown(self.names.iter().map(|(name, _)| *name)))?;
        Ok(Symbol::new(vec![formulas.column(at)], self.names[at].1, 1))
    }

    fn function(&self, name: &str) -> Option<Arc<Function>> {
        self.functions.get(name).cloned()
    }

    fn functions(&self) -> Vec<String> {
        self.functions.keys().cloned().collect()
    }

    fn strict(&self) -> bool {
        true
    }
}

#[test]
fn a_function_is_its_formula() {
    let mut bench = Bench::new(&[("knee", "rad"), ("rest", "rad"), ("stiffness", "N*m/rad")]);
    bench.define("spring(angle, k)", "-k * (angle - rest)").unwrap();
    bench.define("both(a, b)", "[spring(a, stiffness), spring(b, stiffness)].y + a[0]*0 N*m").unwrap();
    let inputs = [0.5, 0.2, 3.0];
    assert_eq!(bench.value("spring(knee, stiffness)", &inputs), -3.0 * 0.3);
    // A parameter goes before what is called so outside, and what is called so outside goes into it.
    bench.define("turned(rest, knee)", "rest - 2 * knee").unwrap();
    assert_eq!(bench.value("turned(knee, rest)", &inputs), 0.5 - 0.4);
    assert_eq!(bench.value("both(1 rad, knee)", &inputs), -3.0 * 0.3);
    // The program is that of the formula by itself.
    let same = |bench: &mut Bench, a: &str, b: &str| assert_eq!(bench.program(a), bench.program(b), "{a}");
    same(&mut bench, "spring(knee, stiffness)", "-stiffness * (knee - rest)");
    same(&mut bench, "torsion_spring(knee, stiffness, rest)", "-stiffness * (knee - rest)");
    // The user's goes before the library's, but not within the library.
    bench.define("rod_length(a, b, c)", "7 m").unwrap();
    assert_eq!(bench.value("rod_length(knee, 1 m, 1 m)", &inputs), 7.0);
    assert!((bench.value("rod_arm(knee, 1 m, 1 m)", &inputs) - 0.25_f64.cos()).abs() < 1e-12);
}

#[test]
fn faults_of_functions() {
    let mut bench = Bench::new(&[("knee", "rad"), ("place", "m"), ("force", "")]);
    bench.define("spring(angle: rad, k: N*m/rad)", "-k * angle").unwrap();
    bench.define("sum_of(a, b)", "2 * (a + b)").unwrap();
    bench.define("outer(a)", "sum_of(a, 1 kg)").unwrap();
    for (text, at, message, hint) in [
        (
            "1 + spring(knee)",
            "spring(knee)",
            "spring takes 2 arguments, and has 1",
            "write it spring(angle: rad, k: N*m/rad)",
        ),
        ("spring(knee, place)", "place", "`k` of spring is in N·m/rad, and this is in m", "write it spring("),
        ("gear_torque(force, place)", "place", "`ratio` of gear_torque is a pure number, and this is in m", ""),
        (
            "sum_of(knee, place)",
            "sum_of(knee, place)",
            "in sum_of, at `(a + b)`: rad and m do not go together in +",
            "same",
        ),
        ("1 + outer(place)", "outer(place)", "in sum_of, at `(a + b)`: m and kg do not go together in +", ""),
        ("sprong(knee, 1)", "sprong", "there is no function `sprong`", "did you mean `spring`?"),
        ("torsion_sprin(knee, 1, 2)", "torsion_sprin", "there is no function `torsion_sprin`", "`torsion_spring`"),
    ] {
        let (found_at, found, found_hint) = bench.fault(text);
        assert_eq!((found_at.as_str(), found.as_str()), (at, message), "{text}");
        assert!(found_hint.contains(hint), "{text}: {found_hint}");
    }
    // What carries no unit is in that of the parameter.
    assert!(bench.fault("spring(force, 3) + 1 m").1.contains("N·m and m"));
    for (signature, text, message) in [
        ("f(x)", "f(x - 1)", "there is no function `f`"),
        ("f(x)", "y + x", "`y` is not known"),
        ("f(x)", "spring(x)", "spring takes 2 arguments, and has 1"),
        ("f(x)", "sin(x, x)", "sin takes 1 argument, and has 2"),
        ("f(x)", "x +", "the formula ends where a value should be"),
        ("sin(x)", "x", "the function `sin` cannot be called so: formulas have a function of this name"),
        ("f(kg)", "1", "the parameter `kg` cannot be called so: `kg` is a unit"),
        ("f(pi)", "1", "the parameter `pi` cannot be called so: `pi` has a meaning in formulas"),
        ("f(x, x)", "x", "the parameter `x` cannot be called so: another one has this name"),
        ("f(x, )", "x", "`f(x, )` has a parameter without a name"),
        ("f()", "1", "`f` is a function without parameters"),
        ("f(x", "x", "`f(x` is no function with parameters"),
        ("f(x: deg)", "x", "`deg` of `x` is no unit of SI"),
        ("1f(x)", "x", "the function `1f` cannot be called so: names begin with a letter"),
    ] {
        let error = bench.define(signature, text).unwrap_err();
        assert!(error.message.starts_with(message), "{signature} = {text}: {error:?}");
    }
}

/// Functions that call each other twice, in operations or in nothing but calls, and calls as deep as may be.
#[test]
fn what_functions_come_to_has_an_end() {
    for body in ["{}(x) + {}(x)", "[{}(x), {}(x)][0]"] {
        let mut bench = Bench::new(&[("knee", "rad")]);
        bench.define("f0(x)", "x").unwrap();
        for i in 1..60 {
            bench.define(&format!("f{i}(x)"), &body.replace("{}", &format!("f{}", i - 1))).unwrap();
        }
        let (at, message, _) = bench.fault("1 + f59(knee)");
        assert!(at == "f59(knee)" && message.contains("come to more than 200000 operations"), "{message}");
    }
    let mut bench = Bench::new(&[("knee", "rad")]);
    bench.define("f0(x)", "x").unwrap();
    for i in 1..2000 {
        bench.define(&format!("f{i}(x)"), &format!("f{}(x)", i - 1)).unwrap();
    }
    assert!(bench.fault("f1999(knee)").1.contains("stand within each other"));
    assert_eq!(bench.value("f400(knee)", &[0.5]), 0.5);
}

/// Each says what it is, is in units that fit, and has the derivatives that finite differences give.
#[test]
fn every_law_of_the_library() {
    let defined = hwasp_expr::LIBRARY.lines().filter(|line| line.starts_with('"')).count();
    assert_eq!(laws().len(), defined, "a line is no definition");
    for law in laws() {
        let name = law.function.name();
        assert!(!law.about.is_empty() && !law.source.is_empty(), "{name} is not explained");
        let gives = law.gives().unwrap_or_else(|error| panic!("{name}: {error:?}"));
        assert!(matches!(gives, Quantity::Known(_) | Quantity::Number) || name == "nonzero", "{name} gives {gives}");
        Formulas::default().check(&law.function, &mut Bench::default()).unwrap();
        let names = ["a", "b", "c", "d", "e", "f"];
        let count = law.function.signature().parameters.len();
        let mut bench = Bench::new(&names.map(|name| (name, "")));
        let program = bench.program(&format!("{name}({})", names[..count].join(", ")));
        // A four-bar linkage that closes; springs and tendons on either side of their rest.
        for inputs in [[0.9, 0.5, 0.8, 0.7, 1.1, 0.3], [2.0, 1.3, 1.2, 1.5, 1.9, 0.4], [-0.6, 0.4, 0.3, 1.0, 1.1, 0.2]]
        {
            let report = gradcheck(&program, &[], &inputs, &GradCheckSettings::default());
            let report = report.unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(report.max_relative_error < 1e-6, "{name}: {report:?}");
        }
    }
}

#[test]
fn gears_springs_tendons_and_motors_by_hand() {
    let mut bench = Bench::new(&[("x", "")]);
    for (text, wanted) in [
        ("gear_torque(2, 50) + 0 * x", 100.0),
        ("reflected_inertia(2e-5, 100)", 0.2),
        ("torsion_spring(0.5, 4, 0.2)", -1.2),
        ("one_sided_torsion_spring(-0.1, 4, 0.2)", 1.2),
        ("one_sided_torsion_spring(0.3, 4, 0.2)", 0.0),
        ("linear_spring(0.02, 300, 0.05)", 9.0),
        ("one_sided_linear_spring(0.02, 300, 0.05)", 9.0),
        ("one_sided_linear_spring(0.06, 300, 0.05)", 0.0),
        // A triangle of 3, 4 and 5; the arm is the height over the longest side.
        ("rod_length(90 deg, 0.3, 0.4)", 0.5),
        ("rod_arm(90 deg, 0.3, 0.4)", 0.24),
        ("extension_spring(90 deg, 0.3, 0.4, 100, 0.2)", -100.0 * 0.3 * 0.24),
        ("extension_spring(90 deg, 0.3, 0.4, 100, 0.6)", 0.0),
        // Without free length it balances an arm at every angle.
        ("extension_spring(0.7, 0.1, 0.1, 432, 0) / sin(0.7)", -4.32),
        ("extension_spring(0, 0.1, 0.1, 432, 0)", 0.0),
        ("series_elastic(0.3, 0.1, 50)", 10.0),
        ("tendon_travel([0.5, -0.2], [0.01, 0.02])", 0.001),
        ("tendon_tension(0.105, 0.1, 2000)", 10.0),
        ("tendon_tension(0.095, 0.1, 2000)", 0.0),
        ("pulley_torque(10, 0.02)", -0.2),
        ("dc_motor(9, 0, 2, 30)", 2.0),
        ("dc_motor(9, 15, 2, 30)", 1.0),
        ("dc_motor(-9, 15, 2, 30)", -3.0),
        ("dc_motor(0.5, 15, 2, 30)", 0.5),
        ("dc_motor(1, 45, 2, 30)", -1.0),
        ("copper_loss(0.2, 0.05, 0.5)", 8.0),
    ] {
        let found = bench.value(text, &[0.25]);
        assert!((found - wanted).abs() < 1e-12, "{text} is {found}, not {wanted}");
    }
}

/// The rocker's angle and rate against linkages that are closed by iteration, from one crank angle to the next.
#[test]
fn a_four_bar_linkage_closes() {
    // Crank-rocker, drag link (both turn), double rocker within its reach, and a parallelogram off its dead points.
    let linkages: [([f64; 4], [f64; 2]); 4] = [
        ([0.1, 0.3, 0.25, 0.35], [0.1, 6.2]),
        ([0.3, 0.25, 0.35, 0.1], [0.1, 6.2]),
        ([0.3, 0.15, 0.25, 0.35], [0.35, 1.1]),
        ([0.2, 0.5, 0.2, 0.5], [0.2, 2.9]),
    ];
    let mut bench = Bench::new(&[("x", ""), ("a", ""), ("b", ""), ("c", ""), ("d", "")]);
    for (bars @ [crank, coupler, rocker, ground], [from, to]) in linkages {
        let inputs = |angle: f64| [angle, crank, coupler, rocker, ground];
        // Newton's method on the length of the coupler, from the angle before.
        let gap = |angle: f64, psi: f64| {
            let (x, y) = (ground + rocker * psi.cos() - crank * angle.cos(), rocker * psi.sin() - crank * angle.sin());
            let slope = 2.0 * rocker * (y * psi.cos() - x * psi.sin());
            (x * x + y * y - coupler * coupler, slope)
        };
        let closed = |angle: f64, mut psi: f64| {
            for _ in 0..50 {
                let (gap, slope) = gap(angle, psi);
                psi -= gap / slope;
            }
            assert!(gap(angle, psi).0.abs() < 1e-14, "{bars:?} does not close at {angle}");
            psi
        };
        let mut psi = bench.value("four_bar_angle(x, a, b, c, d)", &inputs(from));
        assert!(gap(from, psi).0.abs() < 1e-14, "{bars:?} is not closed at {from}");
        let steps = 400;
        for i in 1..=steps {
            let angle = from + (to - from) * f64::from(i) / f64::from(steps);
            psi = closed(angle, psi);
            let found = bench.value("four_bar_angle(x, a, b, c, d)", &inputs(angle));
            let turns = (found - psi) / (2.0 * std::f64::consts::PI);
            assert!((turns - turns.round()).abs() < 1e-9, "{bars:?} at {angle}: {found}, not {psi}");
            let h = 1e-5;
            let slope = (closed(angle + h, psi) - closed(angle - h, psi)) / (2.0 * h);
            for text in ["four_bar_ratio(x, a, b, c, d)", "bar_ratio(x, four_bar_angle(x, a, b, c, d), a, c, d)"] {
                let ratio = bench.value(text, &inputs(angle));
                assert!(
                    (ratio - slope).abs() < 1e-6 * (1.0 + slope.abs()),
                    "{bars:?} at {angle}: {ratio}, not {slope}"
                );
            }
        }
    }
    // A parallelogram turns as one.
    assert!((bench.value("four_bar_ratio(x, a, b, c, d)", &[0.8, 0.2, 0.5, 0.2, 0.5]) - 1.0).abs() < 1e-12);
    // Out of reach and at a dead point it is a number, and so is its gradient.
    for inputs in [[0.5, 0.1, 0.1, 0.1, 0.9], [0.0, 0.2, 0.5, 0.2, 0.5]] {
        let program = bench.program("four_bar_ratio(x, a, b, c, d)");
        let (mut tape, mut out) = (program.tape::<f64>(1), [0.0]);
        program.bind(&[], &mut tape);
        program.forward(&inputs, 1, 1, &mut tape, &mut out, 1);
        let mut gradient = [0.0; 5];
        program.vjp(&inputs, 1, 1, &[1.0], 1, &mut tape, &mut gradient, 1);
        assert!(out[0].is_finite() && gradient.iter().all(|g| g.is_finite()), "{inputs:?}: {out:?} {gradient:?}");
    }
}
