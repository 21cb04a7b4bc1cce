//! What functions there are, for messages and the reference.

use std::ops::Range;

use crate::error::ExprError;

/// A function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FunctionDoc {
    /// Its name.
    pub name: &'static str,
    /// How it is written. Arguments in brackets may be left out; `…` stands for any number.
    pub usage: &'static str,
    /// What it gives.
    pub about: &'static str,
}

impl FunctionDoc {
    /// How many arguments it takes, at least and at most.
    pub(crate) fn arguments(&self) -> (usize, usize) {
        let inside = self.usage.split_once('(').map_or("", |(_, rest)| rest.trim_end_matches(')'));
        let count = inside.split(',').count();
        if inside.contains('…') { (count - 1, usize::MAX) } else { (count, count) }
    }

    /// Refuses a call with another number of arguments.
    pub(crate) fn count_arguments(&self, count: usize, span: &Range<usize>) -> Result<(), ExprError> {
        let (least, most) = self.arguments();
        if (least..=most).contains(&count) {
            return Ok(());
        }
        let wanted = if least == most { least.to_string() } else { format!("at least {least}") };
        let plural = if most == 1 { "argument" } else { "arguments" };
        let message = format!("{} takes {wanted} {plural}, and has {count}", self.name);
        Err(ExprError::new(span.clone(), message).hint(format!("write it {}", self.usage)))
    }
}

const fn function(name: &'static str, usage: &'static str, about: &'static str) -> FunctionDoc {
    FunctionDoc { name, usage, about }
}

/// All of them, in the order of the reference. Those of scalars act on each component of a vector.
pub const FUNCTIONS: &[FunctionDoc] = &[
    function("abs", "abs(x)", "absolute value"),
    function("sign", "sign(x)", "-1, 0 or 1"),
    function(
        "min",
        "min(x, …)",
        "the least component of a vector; of several values the least, component by component",
    ),
    function("max", "max(x, …)", "the greatest, likewise"),
    function("clip", "clip(x, low, high)", "x kept within limits"),
    function("where", "where(condition, yes, no)", "one of two values; the other may be no number"),
    function("si", "si(x)", "its number in SI, which fits everything: for arithmetic that knows no units"),
    function("sqrt", "sqrt(x)", "square root"),
    function("exp", "exp(x)", "e to the power of x"),
    function("log", "log(x)", "natural logarithm"),
    function("sin", "sin(x)", "sine of an angle"),
    function("cos", "cos(x)", "cosine"),
    function("tan", "tan(x)", "tangent"),
    function("asin", "asin(x)", "arc sine, x kept within ±1"),
    function("acos", "acos(x)", "arc cosine, x kept within ±1"),
    function("atan", "atan(x)", "arc tangent"),
    function("atan2", "atan2(y, x)", "angle of the point (x, y), within ±pi"),
    function("wrap", "wrap(angle)", "the same angle within ±pi"),
    function("tanh", "tanh(x)", "hyperbolic tangent"),
    function("sigmoid", "sigmoid(x)", "1/(1 + exp(-x))"),
    function("sum", "sum(v)", "sum of the components"),
    function("mean", "mean(v)", "mean of the components"),
    function("norm", "norm(v)", "Euclidean length"),
    function("dot", "dot(a, b)", "sum of the products of components"),
    function("cross", "cross(a, b)", "vector product of two vectors of three components"),
    function("any", "any(v)", "1 where a component is not 0"),
    function("all", "all(v)", "1 where no component is 0"),
    function("rotate", "rotate(q, v)", "vector v of a body with orientation q, in the world's frame"),
    function("unrotate", "unrotate(q, v)", "vector v of the world, in the frame of a body with orientation q"),
    function("multiply", "multiply(q, p)", "product of two quaternions: first p, then q"),
    function("conjugate", "conjugate(q)", "the inverse rotation"),
    function("turn", "turn(q, p)", "angle of the rotation from q to p, 0 to pi"),
    function("roll", "roll(q)", "angle about x of an orientation (yaw, then pitch, then roll)"),
    function("pitch", "pitch(q)", "angle about y"),
    function("yaw", "yaw(q)", "angle about z"),
    function("previous", "previous(x)", "x at the end of the step before; at the start of an episode, x there"),
    function("diff", "diff(x)", "x - previous(x)"),
    function("uniform", "uniform(low, high)", "drawn evenly between two limits, for each component anew"),
    function("log_uniform", "log_uniform(low, high)", "drawn so that its logarithm is uniform"),
    function("normal", "normal(mean, std)", "drawn from a normal distribution"),
];
