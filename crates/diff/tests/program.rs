//! Programs against plain `f64`, against finite differences and against themselves on other blocks of rows.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use hwasp_diff::{GradCheckError, GradCheckSettings, Program, Scalar, Var, gradcheck};
use proptest::prelude::*;

/// Every primitive, kept inside its domain.
const OPERATIONS: usize = 25;

/// The `code`-th operation on two numbers; `kink` is told how far the operands are from where the derivative jumps, and may ask: a
/// trace that did would record a step that is no part of the law.
fn operation<T: Scalar>(code: usize, a: T, b: T, kink: &mut impl FnMut(&dyn Fn() -> T)) -> T {
    match code {
        0 => a + b,
        1 => a - b,
        2 => a * b,
        3 => a / (b * b + 0.5),
        4 => -a,
        5 => a.tanh().exp(),
        6 => (a * a + 0.5).ln(),
        7 => (a * a + 0.5).sqrt(),
        8 => a.sin(),
        9 => a.cos(),
        10 => a.tanh(),
        11 => a.sigmoid(),
        12 => {
            kink(&|| a);
            a.abs()
        }
        13 => {
            kink(&|| a - b);
            a.min(b)
        }
        14 => {
            kink(&|| a - b);
            a.max(b)
        }
        15 => {
            kink(&|| a - 0.4);
            kink(&|| a + 0.3);
            a.clamp(-0.3, 0.4)
        }
        16 => [a, b, a].into_iter().sum(),
        17 => (T::constant(0.0) + a) * 1.0 - 0.0,
        18 => (a - 0.25) / 3.0,
        19 => T::constant(2.0) / (a * a + 1.5),
        20 => T::constant(1.0) * -(-b),
        21 => (a - b).atan(),
        22 => {
            kink(&|| a - b);
            a.less(b) * a + b.less(a)
        }
        23 => {
            kink(&|| a - b);
            a.less(b).gate(a * b) + (T::constant(1.0) - a.less(b)).gate(b)
        }
        _ => T::constant(-0.0) + (a * 0.7 + T::constant(0.5).sin()),
    }
}

/// Runs a list of operations, each on two earlier values, and returns the last value and all of them summed.
fn law<T: Scalar>(code: &[(usize, usize, usize)], inputs: &[T], mut kink: impl FnMut(&dyn Fn() -> T)) -> [T; 2] {
    let mut values = inputs.to_vec();
    for &(operation_code, a, b) in code {
        let (a, b) = (values[a % values.len()], values[b % values.len()]);
        values.push(operation(operation_code, a, b, &mut kink));
    }
    [values[values.len() - 1], values.into_iter().sum()]
}

fn traced(code: &[(usize, usize, usize)]) -> Program {
    Program::trace(&["u0", "u1", "u2"], &["c0", "c1"], |u, c| {
        let inputs: Vec<_> = u.iter().chain(c).copied().collect();
        let [last, all] = law(code, &inputs, |_| {});
        vec![("last".into(), last), ("all".into(), all), ("u1".into(), u[1]), ("c0".into(), c[0])]
    })
}

fn code() -> impl Strategy<Value = Vec<(usize, usize, usize)>> {
    prop::collection::vec((0..OPERATIONS, 0..64_usize, 0..64_usize), 1..12)
}

fn numbers(count: usize) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(prop_oneof![8 => -1.5..1.5, 1 => Just(0.0), 1 => Just(-0.0)], count)
}

/// The distance to the nearest kink and the largest value met.
fn conditions(code: &[(usize, usize, usize)], uniforms: &[f64], columns: &[f64], rows: usize) -> (f64, f64) {
    let (mut gap, mut largest) = (f64::INFINITY, 0.0_f64);
    for row in 0..rows {
        let inputs = [uniforms, &[columns[row], columns[rows + row]]].concat();
        for value in law(code, &inputs, |distance: &dyn Fn() -> f64| gap = gap.min(distance().abs())) {
            largest = largest.max(value.abs());
        }
    }
    (gap, largest)
}

const ROWS: usize = 37;

proptest! {
    #[test]
    fn equals_plain_f64_bit_for_bit(code in code(), uniforms in numbers(3), columns in numbers(2 * ROWS)) {
        let program = traced(&code);
        let mut tape = program.tape::<f64>(ROWS);
        let mut out = vec![0.0; 4 * ROWS];
        program.bind(&uniforms, &mut tape);
        program.forward(&columns, ROWS, ROWS, &mut tape, &mut out, ROWS);
        for row in 0..ROWS {
            let inputs = [&uniforms[..], &[columns[row], columns[ROWS + row]]].concat();
            let [last, all] = law(&code, &inputs, |_| {});
            let expected = [last, all, uniforms[1], columns[row]];
            for (o, expected) in expected.into_iter().enumerate() {
                prop_assert_eq!(out[o * ROWS + row].to_bits(), f64::to_bits(expected), "output {} row {}", o, row);
            }
        }
    }

    /// A law that is data was composed into a policy with other sums than one that is code: its uniform steps all came
    /// before its row steps, and an operand that the composition makes a column collected its cotangents in another order.
    #[test]
    fn a_retraced_program_is_the_one_that_the_law_gives_in_its_place(code in code()) {
        // -(-b) leaves -b behind: no step of the program, until something later is the same.
        prop_assume!(code.iter().all(|&(operation, ..)| operation != 20));
        let inner = traced(&code);
        let compose = |retraced: bool| {
            Program::trace(&["u"], &["c0", "c1"], |u, c| {
                let uniforms = [u[0].sigmoid(), c[0], Scalar::constant(1.0)];
                let columns = [c[1] * 2.0, Scalar::constant(0.5)];
                let values = if retraced {
                    inner.retrace(&uniforms, &columns)
                } else {
                    let inputs = [&uniforms[..], &columns].concat();
                    let [last, all] = law(&code, &inputs, |_| {});
                    vec![last, all, uniforms[1], columns[0]]
                };
                (0..).map(|o: usize| o.to_string()).zip(values).collect()
            })
        };
        prop_assert_eq!(format!("{:?}", compose(true)), format!("{:?}", compose(false)));
    }

    #[test]
    fn derivatives_agree_with_finite_differences(code in code(), uniforms in numbers(3), columns in numbers(4)) {
        let (gap, largest) = conditions(&code, &uniforms, &columns, 2);
        prop_assume!(gap > 1e-2 && largest < 1e3);
        if let Err(error) = gradcheck(&traced(&code), &uniforms, &columns, &GradCheckSettings::default()) {
            return Err(TestCaseError::fail(error.to_string()));
        }
    }

    #[test]
    fn a_row_does_not_depend_on_the_others(code in code(), uniforms in numbers(3), columns in numbers(2 * ROWS)) {
        let (_, largest) = conditions(&code, &uniforms, &columns, ROWS);
        let program = traced(&code);
        let narrow = |list: &[f64]| list.iter().map(|&x| x as f32).collect::<Vec<_>>();
        let (uniforms, columns, w) = (narrow(&uniforms), narrow(&columns), narrow(&vec![0.7; 4 * ROWS]));
        let (mut tape, mut one) = (program.tape::<f32>(ROWS), program.tape::<f32>(1));
        let (mut out, mut tangent, mut cotangent) = (vec![0.0; 4 * ROWS], vec![0.0; 4 * ROWS], vec![9.0; 2 * ROWS]);
        program.bind(&uniforms, &mut tape);
        program.bind(&uniforms, &mut one);
        program.forward(&columns, ROWS, ROWS, &mut tape, &mut out, ROWS);
        program.vjp(&columns, ROWS, ROWS, &w, ROWS, &mut tape, &mut cotangent, ROWS);
        program.bind_tangent(&[0.3, -0.2, 0.9], &mut tape);
        program.jvp(&columns, &columns, ROWS, ROWS, &mut tape, &mut tangent, ROWS);
        program.bind_tangent(&[0.3, -0.2, 0.9], &mut one);
        for row in 0..ROWS {
            let (mut out_1, mut tangent_1, mut cotangent_1) = ([0.0; 4], [0.0; 4], [9.0; 2]);
            program.forward(&columns[row..], ROWS, 1, &mut one, &mut out_1, 1);
            program.vjp(&columns[row..], ROWS, 1, &w, 1, &mut one, &mut cotangent_1, 1);
            program.jvp(&columns[row..], &columns[row..], ROWS, 1, &mut one, &mut tangent_1, 1);
            for o in 0..4 {
                prop_assert_eq!(out[o * ROWS + row].to_bits(), out_1[o].to_bits());
                prop_assert_eq!(tangent[o * ROWS + row].to_bits(), tangent_1[o].to_bits());
            }
            for c in 0..2 {
                prop_assert_eq!(cotangent[c * ROWS + row].to_bits(), cotangent_1[c].to_bits());
            }
        }
        // The same rows, one by one on another tape: the same sum up to the order of adding.
        let (mut whole, mut single) = ([0.0; 3], [0.0; 3]);
        program.vjp_uniform(&mut tape, &mut whole);
        program.vjp_uniform(&mut one, &mut single);
        prop_assume!(largest < 1e2);
        for u in 0..3 {
            let scale = 1.0 + whole.iter().map(|g: &f32| g.abs()).sum::<f32>();
            prop_assert!((whole[u] - single[u]).abs() < 1e-2 * scale, "{:?} {:?}", whole, single);
        }
    }

    #[test]
    fn f32_agrees_with_f64(code in code(), uniforms in numbers(3), columns in numbers(2 * ROWS)) {
        let (gap, largest) = conditions(&code, &uniforms, &columns, ROWS);
        prop_assume!(gap > 1e-2 && largest < 1e2);
        let program = traced(&code);
        let mut out = vec![0.0; 4 * ROWS];
        let mut tape = program.tape::<f64>(ROWS);
        program.bind(&uniforms, &mut tape);
        program.forward(&columns, ROWS, ROWS, &mut tape, &mut out, ROWS);
        let narrow = |list: &[f64]| list.iter().map(|&x| x as f32).collect::<Vec<_>>();
        let mut out_32 = vec![0.0; 4 * ROWS];
        let mut tape = program.tape::<f32>(ROWS);
        program.bind(&narrow(&uniforms), &mut tape);
        program.forward(&narrow(&columns), ROWS, ROWS, &mut tape, &mut out_32, ROWS);
        for (a, b) in out.iter().zip(&out_32) {
            prop_assert!((a - f64::from(*b)).abs() < 1e-3 * (1.0 + largest), "{} {}", a, b);
        }
    }

    #[test]
    fn accumulators_add_up_over_blocks(code in code(), uniforms in numbers(3), columns in numbers(2 * ROWS)) {
        let (_, largest) = conditions(&code, &uniforms, &columns, ROWS);
        prop_assume!(largest < 1e2);
        let program = traced(&code);
        let w = vec![1.0; 4 * ROWS];
        let run = |from: usize, rows: usize| {
            let mut tape = program.tape::<f64>(ROWS);
            let (mut out, mut cotangent) = (vec![0.0; 4 * ROWS], vec![0.0; 2 * ROWS]);
            program.bind(&uniforms, &mut tape);
            program.forward(&columns[from..], ROWS, rows, &mut tape, &mut out, ROWS);
            program.vjp(&columns[from..], ROWS, rows, &w, ROWS, &mut tape, &mut cotangent, ROWS);
            tape
        };
        let gradient = |mut tape| {
            let mut gradient = [1.0; 3];
            program.vjp_uniform(&mut tape, &mut gradient);
            gradient
        };
        let whole = gradient(run(0, ROWS));
        let mut first = run(0, 20);
        first.add_uniform_cotangents(&run(20, ROWS - 20));
        let parts = gradient(first);
        for u in 0..3 {
            let scale: f64 = 1e3 + whole.iter().map(|g| g.abs()).sum::<f64>();
            prop_assert!((whole[u] - parts[u]).abs() < 1e-9 * scale, "{:?} {:?}", whole, parts);
        }
    }

    #[test]
    fn held_columns_have_no_derivative(code in code(), uniforms in numbers(3), columns in numbers(2)) {
        let free = traced(&code);
        let held = free.clone().holding(&[false, true]);
        let derivatives = |program: &Program, tangent: &[f64]| {
            let mut tape = program.tape::<f64>(1);
            let (mut out, mut cotangent, mut gradient) = ([0.0; 4], [9.0; 2], [0.0; 3]);
            program.bind(&uniforms, &mut tape);
            program.forward(&columns, 1, 1, &mut tape, &mut out, 1);
            program.vjp(&columns, 1, 1, &[1.0; 4], 1, &mut tape, &mut cotangent, 1);
            program.vjp_uniform(&mut tape, &mut gradient);
            program.bind_tangent(&[0.5; 3], &mut tape);
            program.jvp(&columns, tangent, 1, 1, &mut tape, &mut out, 1);
            (out, cotangent, gradient)
        };
        let (out, cotangent, gradient) = derivatives(&free, &[0.5, 0.0]);
        let (out_held, cotangent_held, gradient_held) = derivatives(&held, &[0.5, 7.0]);
        prop_assume!(gradient.iter().chain(&out).all(|g| g.is_finite()));
        prop_assert_eq!(out, out_held);
        prop_assert_eq!([cotangent[0], 0.0], cotangent_held);
        prop_assert_eq!(gradient, gradient_held);
    }
}

/// Each primitive alone, on a column and on a uniform, and each binary one on all pairs of kinds.
#[test]
fn every_primitive_differentiates() {
    for code in 0..OPERATIONS {
        for (a, b) in [(0, 1), (0, 3), (3, 0), (3, 4)] {
            let program = Program::trace(&["u0", "u1", "u2"], &["c0", "c1"], |u, c| {
                let inputs = [u[0], u[1], u[2], c[0], c[1]];
                vec![("y".into(), operation(code, inputs[a], inputs[b], &mut |_| {}))]
            });
            for columns in [[0.7, -0.8], [-0.9, 0.1], [0.2, 0.6]] {
                let uniforms = [-0.55, 0.25, 0.0];
                let report = gradcheck(&program, &uniforms, &columns, &GradCheckSettings::default());
                let report = report.unwrap_or_else(|error| panic!("operation {code} on {a}, {b}: {error}"));
                assert!(report.max_relative_error < 1e-8, "operation {code} on {a}, {b}: {report:?}");
            }
        }
    }
}

/// abs at 0 counts as flat; ties of min and max follow the first operand.
#[test]
fn conventions_at_kinks() {
    let program = Program::trace(&[] as &[&str], &["x", "y"], |_, c| {
        vec![("abs".into(), c[0].abs()), ("min".into(), c[0].min(c[1])), ("max".into(), c[0].max(c[1]))]
    });
    let mut tape = program.tape::<f64>(1);
    let at = [0.0, 0.0];
    program.bind(&[], &mut tape);
    program.forward(&at, 1, 1, &mut tape, &mut [0.0; 3], 1);
    for (o, expected) in [[0.0, 0.0], [1.0, 0.0], [1.0, 0.0]].into_iter().enumerate() {
        let mut w = [0.0; 3];
        w[o] = 1.0;
        let mut gradient = [9.0; 2];
        program.vjp(&at, 1, 1, &w, 1, &mut tape, &mut gradient, 1);
        assert_eq!(gradient, expected, "output {o}");
    }
}

/// What a choice leaves out may be no number, in value and derivative: `x.less(0).gate(ln(-x))` was the reason for a gate of its own.
#[test]
fn the_side_that_is_not_chosen_may_be_no_number() {
    let program = Program::trace(&[] as &[&str], &["x"], |_, c| {
        let negative = c[0].less(Var::constant(0.0));
        vec![("y".into(), negative.gate((-c[0]).ln()) + (Var::constant(1.0) - negative).gate(c[0] * 3.0))]
    });
    let mut tape = program.tape::<f64>(2);
    let (at, mut y, mut slope) = ([2.0, -1.0], [0.0; 2], [9.0; 2]);
    program.bind(&[], &mut tape);
    program.forward(&at, 2, 2, &mut tape, &mut y, 2);
    program.vjp(&at, 2, 2, &[1.0; 2], 2, &mut tape, &mut slope, 2);
    assert_eq!((y, slope), ([6.0, 0.0], [3.0, -1.0]));
}

/// Only what some output needs is kept, and what rows do not change is done once.
#[test]
fn work_is_counted() {
    let program = Program::trace(&["k0", "k1"], &["y"], |u, c| {
        let stiffness = u[0].sigmoid() * 100.0 + u[1].sigmoid() * 100.0;
        let _unused = (c[0] * u[0]).exp();
        let again = u[0].sigmoid() * 100.0 + u[1].sigmoid() * 100.0;
        vec![("force".into(), -(stiffness * c[0])), ("stiffness".into(), again)]
    });
    assert_eq!((program.uniform_instructions(), program.row_instructions()), (5, 2));
    assert_eq!(program.uniform_names(), ["k0", "k1"]);
    assert_eq!(program.column_names(), ["y"]);
    assert_eq!(program.output_names(), ["force", "stiffness"]);
}

/// Outputs may be anything, and zero rows are a batch too.
#[test]
fn outputs_of_every_kind() {
    let program = Program::trace(&["u"], &["c"], |u, c| {
        let constant = <hwasp_diff::Var<'_> as Scalar>::constant(4.0);
        vec![("constant".into(), constant), ("uniform".into(), u[0]), ("column".into(), c[0]), ("again".into(), c[0])]
    });
    let mut tape = program.tape::<f64>(3);
    let mut out = [0.0; 8];
    program.bind(&[2.0], &mut tape);
    program.forward(&[5.0, 6.0], 2, 2, &mut tape, &mut out, 2);
    assert_eq!(out, [4.0, 4.0, 2.0, 2.0, 5.0, 6.0, 5.0, 6.0]);
    let (mut by_column, mut by_uniform) = ([9.0; 2], [10.0]);
    program.vjp(&[5.0, 6.0], 2, 2, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0], 2, &mut tape, &mut by_column, 2);
    program.vjp_uniform(&mut tape, &mut by_uniform);
    assert_eq!((by_column, by_uniform), ([12.0, 14.0], [17.0]));
    program.forward(&[], 0, 0, &mut tape, &mut [], 0);
    program.vjp(&[], 0, 0, &[], 0, &mut tape, &mut [], 0);
}

#[test]
fn gradcheck_names_what_is_wrong() {
    let ramp = Program::trace(&["offset"], &["x"], |u, c| {
        vec![("push".into(), (c[0] - u[0]).max(<hwasp_diff::Var<'_> as Scalar>::constant(0.0)))]
    });
    let error = gradcheck(&ramp, &[0.5], &[1.0, 0.5], &GradCheckSettings::default()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "d(push)/d(offset) in row 1, at offset = 5e-1: the program says -1e0, finite differences -5e-1; \
         relative error 5.0e-1 is above 1.0e-6"
    );
    let root = Program::trace(&[] as &[&str], &["x"], |_, c| vec![("root".into(), c[0].sqrt())]);
    let error = gradcheck(&root, &[], &[0.0], &GradCheckSettings::default()).unwrap_err();
    assert!(matches!(error, GradCheckError::NotFinite { .. }), "{error}");
}

/// A branch that is not taken, and a root, power or logarithm of 0 that counts nothing, gave gradients that were no numbers: zero
/// times an infinite derivative.
#[test]
fn what_counts_nothing_has_no_gradient() {
    let program = Program::trace(&["u"], &["x"], |u, c| {
        let (u, x) = (u[0], c[0]);
        let above = Var::constant(0.0).less(x);
        let safe = |value| above.gate(value);
        vec![
            ("quotient".into(), safe(u / x * x.exp()) + u * x),
            ("root".into(), safe(x.sqrt() * u)),
            ("logarithm".into(), safe((x.ln() * 1.5).exp() / x) + x),
            // x^1.5, whose derivative at 0 is 0.
            ("power".into(), (x.ln() * 1.5).exp() * u),
            ("of a negative".into(), safe((x - 1.0).sqrt().sin() * u)),
        ]
    });
    let (mut tape, mut out) = (program.tape::<f64>(1), [0.0; 5]);
    program.bind(&[2.0], &mut tape);
    program.forward(&[0.0], 1, 1, &mut tape, &mut out, 1);
    assert_eq!(out, [0.0; 5]);
    let mut pulled = [f64::NAN];
    program.vjp(&[0.0], 1, 1, &[1.0; 5], 1, &mut tape, &mut pulled, 1);
    // Of u·x the 2, of x itself the 1.
    assert_eq!(pulled, [3.0]);
    program.bind_tangent(&[0.0], &mut tape);
    let mut pushed = [f64::NAN; 5];
    program.jvp(&[0.0], &[1.0], 1, 1, &mut tape, &mut pushed, 1);
    assert_eq!(pushed, [2.0, 0.0, 1.0, 0.0, 0.0]);
}

/// What changes nothing gave derivatives that were no numbers where what stands within it has an infinite slope: forwards at x^1.5,
/// backwards at the length of a vector that is zero. Both ways now agree, at points beside it with finite differences too.
#[test]
fn what_is_flat_has_no_infinite_slope() {
    let program = Program::trace(&[] as &[&str], &["x", "y"], |_, c| {
        let (x, y) = (c[0], c[1]);
        vec![
            ("power".into(), (x.ln() * 1.5).exp()),
            ("length".into(), (x * x + y * y).sqrt()),
            ("cosine".into(), x.sqrt().cos()),
            ("product".into(), x.sqrt() * y),
            ("quotient".into(), y / (x.sqrt() + 1.0)),
            ("beyond".into(), (x.sqrt() + 500.0).tanh() + (x.sqrt() + 1e3).sigmoid()),
        ]
    });
    gradcheck(&program, &[], &[0.3, 1e-3, 0.7, -0.2], &GradCheckSettings::default()).unwrap();
    let mut tape = program.tape::<f64>(1);
    program.bind(&[], &mut tape);
    program.bind_tangent(&[], &mut tape);
    program.forward(&[0.0; 2], 1, 1, &mut tape, &mut [0.0; 6], 1);
    let (mut pushed, mut pulled) = ([f64::NAN; 6], [f64::NAN; 2]);
    program.jvp(&[0.0; 2], &[1.0, 0.0], 1, 1, &mut tape, &mut pushed, 1);
    assert_eq!(pushed, [0.0; 6]);
    program.jvp(&[0.0; 2], &[0.0, 1.0], 1, 1, &mut tape, &mut pushed, 1);
    assert_eq!(pushed, [0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    program.vjp(&[0.0; 2], 1, 1, &[1.0; 6], 1, &mut tape, &mut pulled, 1);
    assert_eq!(pulled, [0.0, 1.0]);
    // A slope that is infinite and counts stays so.
    let root = Program::trace(&[] as &[&str], &["x"], |_, c| vec![("root".into(), c[0].sqrt() * 2.0)]);
    let (mut tape, mut slope) = (root.tape::<f64>(1), [0.0]);
    root.bind(&[], &mut tape);
    root.forward(&[0.0], 1, 1, &mut tape, &mut [0.0], 1);
    root.vjp(&[0.0], 1, 1, &[1.0], 1, &mut tape, &mut slope, 1);
    assert_eq!(slope, [f64::INFINITY]);
}
