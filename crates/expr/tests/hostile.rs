//! Texts that nobody would write: whatever they are, the answer is a formula or a fault inside of the text.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use hwasp_expr::{Formulas, NameError, Path, Quantity, Scope, Symbol, quantity};
use proptest::prelude::*;

/// Everything is a vector of three.
struct Anything;

impl Scope for Anything {
    fn name(&mut self, formulas: &mut Formulas, path: &Path) -> Result<Symbol, NameError> {
        match path.first() {
            "x" => Ok(Symbol::new((0..3).map(|i| formulas.column(i)).collect(), Quantity::Unknown, 1)),
            _ => Err(NameError::unknown(["x"])),
        }
    }

    fn strict(&self) -> bool {
        true
    }
}

/// Reads a text, and runs what it gives.
fn try_out(text: &str) {
    let _ = quantity(text);
    let mut formulas = Formulas::default();
    match formulas.read(text, &mut Anything) {
        Ok(value) => {
            let columns = ["x0", "x1", "x2"].map(str::to_owned);
            let outputs: Vec<_> = value.parts.iter().enumerate().map(|(i, &part)| (i.to_string(), part)).collect();
            let count = outputs.len();
            let program = formulas.program(&[], &columns, outputs);
            let (mut tape, mut out) = (program.tape::<f64>(1), vec![0.0; count]);
            program.bind(&[], &mut tape);
            program.forward(&[0.5, -1.0, 2.0], 1, 1, &mut tape, &mut out, 1);
        }
        Err(error) => {
            assert!(text.get(error.span.clone()).is_some(), "{text:?}: {error:?}");
            assert!(!error.message.is_empty() && error.message.len() < 500, "{error:?}");
        }
    }
}

/// How many texts of each kind; all of the million with `HWASP_EXHAUSTIVE=1`.
fn cases() -> u32 {
    if std::env::var_os("HWASP_EXHAUSTIVE").is_some() { 500_000 } else { 3000 }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(cases()))]

    #[test]
    fn any_text(text in "\\PC{0,60}") {
        try_out(&text);
    }

    /// Words of the language in any order come further than noise does.
    #[test]
    fn any_words(words in prop::collection::vec(prop::sample::select(vec![
        "x", "x.y", "joint", ".", "*", "#2", "(", ")", "[", "]", ",", ":", "+", "-", "^", "/", "<", "<=", "==", "and", "or", "not",
        "0", "1", "-1", "2.5e3", "0.7 m", "3 N*m/rad", "45 deg", "sin(", "where(", "norm(", "clip(", "max(", "rotate(", "diff(",
        "uniform(", "pi", "\"a b\"", "é", "1e-400", "99999999999999999999", "x[1:]", "x[-1]", "x^2", "x^16", "x^0.5",
    ]), 0..30)) {
        try_out(&words.join(""));
        try_out(&words.join(" "));
    }
}

/// Formulas that grow from step to step end in a fault, not in all of the memory.
#[test]
fn what_grows_without_end_is_refused() {
    let mut text = "x".to_owned();
    for _ in 0..12 {
        text = format!("[{text}, {text}]");
    }
    try_out(&text);
    try_out("([x,x,x,x])^16");
    try_out(&"-".repeat(10_000));
    try_out(&"(".repeat(10_000));
    try_out(&"not ".repeat(4000));
    try_out(&format!("x{}", "^2".repeat(5000)));
    try_out(&format!("x{}", "[0:3]".repeat(3000)));
}
