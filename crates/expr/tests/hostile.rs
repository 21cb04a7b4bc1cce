//! Texts that nobody would write: whatever they are, the answer is a formula or a fault inside of the text.

#[path = "../../../fuzz/src/formula.rs"]
#[allow(unreachable_pub)] // there it is a library
mod fuzz;

use fuzz::formula as try_out;
use proptest::prelude::*;

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
        "uniform(", "pi", "torsion_spring(", "four_bar_ratio(", "nonzero(", "twice(", "late(", "\"a b\"", "é", "1e-400", "99999999999999999999", "x[1:]", "x[-1]", "x^2", "x^16", "x^0.5",
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
    try_out(&format!("x{}", "+x".repeat(990)));
    try_out(&format!("x{}", "+x".repeat(9999)));
    try_out(&format!("x{}", "[0:3]".repeat(3000)));
}
