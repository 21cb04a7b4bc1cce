//! Formulas: parsed, checked, compiled, run and differentiated. `crates/expr/tests/hostile.rs` includes this file, too.

use std::sync::{Arc, LazyLock};

use hwasp_expr::{
    Distribution, Formulas, Function, NameError, Part, Path, Quantity, Scope, Signature, Symbol, Value, quantity,
};

/// Steps of a formula that are run: what is longer is only read.
const MOST_OUTPUTS: usize = 1000;

/// `x` is a vector of three; everything can be remembered and drawn.
struct Anything;

impl Scope for Anything {
    fn name(&mut self, formulas: &mut Formulas, path: &Path) -> Result<Symbol, NameError> {
        match path.first() {
            "x" => Ok(Symbol::new((0..3).map(|i| formulas.column(i)).collect(), Quantity::Unknown, 1)),
            _ => Err(NameError::unknown(["x"])),
        }
    }

    fn previous(&mut self, formulas: &mut Formulas, value: &Value) -> Result<Vec<Part>, String> {
        Ok(value.parts.iter().map(|_| formulas.column(0)).collect())
    }

    fn draw(&mut self, formulas: &mut Formulas, _: Distribution, count: usize) -> Result<Vec<Part>, String> {
        Ok((0..count).map(|_| formulas.column(1)).collect())
    }

    fn function(&self, name: &str) -> Option<Arc<Function>> {
        FUNCTIONS.iter().find(|function| function.name() == name).cloned()
    }

    fn strict(&self) -> bool {
        true
    }
}

/// Functions of one's own; the second calls the first.
static FUNCTIONS: LazyLock<Vec<Arc<Function>>> = LazyLock::new(|| {
    let define = |(signature, text)| {
        let signature = Signature::parse(signature).expect("a signature");
        Arc::new(Function::new(signature, text).expect("a formula"))
    };
    [("late(a)", "previous(a)^2 + x"), ("twice(a: m, b)", "[a, b, x][0] + late(a)")].map(define).to_vec()
});

/// A formula: a fault inside of it, or a program that runs. The same text as a signature, as a function and as a quantity.
pub fn formula(text: &str) {
    let _ = quantity(text);
    if let Ok(function) = Signature::parse(text).and_then(|signature| Function::new(signature, "x + 1")) {
        assert!(Signature::parse(&function.signature().to_string()).as_ref() == Ok(function.signature()), "{text:?}");
    }
    if let Ok(function) = Signature::parse("f(a, b: m)").and_then(|signature| Function::new(signature, text)) {
        let _ = Formulas::default().check(&function, &mut Anything);
    }
    let mut formulas = Formulas::default();
    let value = match formulas.read(text, &mut Anything) {
        Ok(value) => value,
        Err(error) => {
            assert!(text.get(error.span.clone()).is_some(), "{text:?}: {error:?}");
            assert!(!error.message.is_empty() && error.message.len() < 500, "{error:?}");
            return;
        }
    };
    let columns = ["x0", "x1", "x2"].map(str::to_owned);
    let outputs = value.parts.iter().take(MOST_OUTPUTS).enumerate().map(|(i, &part)| (i.to_string(), part));
    let outputs: Vec<_> = outputs.collect();
    let count = outputs.len();
    let program = formulas.program(&[], &columns, outputs);
    let (mut tape, mut out) = (program.tape::<f64>(1), vec![0.0; count]);
    program.bind(&[], &mut tape);
    program.forward(&[0.5, -1.0, 2.0], 1, 1, &mut tape, &mut out, 1);
    program.vjp(&[0.5, -1.0, 2.0], 1, 1, &vec![1.0; count], 1, &mut tape, &mut [0.0; 3], 1);
}
