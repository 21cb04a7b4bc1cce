"""Functions of laws, by the names that formulas of experiments have, and by numpy's where those differ.

They take traced numbers and plain ones; of plain ones alone they give a float. numpy's functions work on traced numbers, too:
`numpy.sin(x)` is `hwasp.sin(x)`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, overload

from ._hwasp import Number

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import TypeAlias, TypeVar

    Scalar: TypeAlias = Number | float
    #: Of plain numbers the result is a float.
    X = TypeVar("X", float, Scalar)

__all__ = [
    "arccos",
    "arcsin",
    "arctan",
    "arctan2",
    "clip",
    "cos",
    "exp",
    "formula",
    "log",
    "maximum",
    "minimum",
    "sigmoid",
    "sign",
    "sin",
    "sqrt",
    "tan",
    "tanh",
    "where",
    "wrap",
]


@overload
def formula(text: str, *operands: float) -> float: ...
@overload
def formula(text: str, *operands: Scalar) -> Scalar: ...
def formula(text: str, *operands: Scalar) -> Scalar:
    """A formula of experiments over `a0`, `a1` and so on: everything that they can say, the library of laws included.

    >>> formula("torsion_spring(a0, 2 N*m/rad, 0.1 rad)", 0.6)
    -1.0
    """
    return Number.compute(text, *operands)


def _unary(name: str, doc: str) -> Callable[[X], X]:
    def function(x: X) -> X:
        return Number.compute(f"{name}(a0)", x)

    function.__doc__ = doc
    return function


sin = _unary("sin", "Sine of an angle in rad.")
cos = _unary("cos", "Cosine of an angle in rad.")
tan = _unary("tan", "Tangent of an angle in rad.")
arcsin = _unary("asin", "Arc sine, rad; x is kept within ±1.")
arccos = _unary("acos", "Arc cosine, rad; x is kept within ±1.")
arctan = _unary("atan", "Arc tangent, rad.")
tanh = _unary("tanh", "Hyperbolic tangent.")
exp = _unary("exp", "e to the power of x.")
log = _unary("log", "Natural logarithm.")
sqrt = _unary("sqrt", "Square root.")
sigmoid = _unary("sigmoid", "1/(1 + exp(-x)).")
sign = _unary("sign", "-1, 0 or 1.")
wrap = _unary("wrap", "The same angle within ±pi, rad.")
for _name in ("sin", "cos", "tan", "arcsin", "arccos", "arctan", "tanh", "exp", "log", "sqrt", "sigmoid", "sign", "wrap"):
    globals()[_name].__name__ = globals()[_name].__qualname__ = _name
del _name


@overload
def arctan2(y: float, x: float) -> float: ...
@overload
def arctan2(y: Scalar, x: Scalar) -> Scalar: ...
def arctan2(y: Scalar, x: Scalar) -> Scalar:
    """Angle of the point (x, y) within ±pi, rad."""
    return Number.compute("atan2(a0, a1)", y, x)


@overload
def minimum(x: float, y: float) -> float: ...
@overload
def minimum(x: Scalar, y: Scalar) -> Scalar: ...
def minimum(x: Scalar, y: Scalar) -> Scalar:
    """The smaller of two."""
    return Number.compute("min(a0, a1)", x, y)


@overload
def maximum(x: float, y: float) -> float: ...
@overload
def maximum(x: Scalar, y: Scalar) -> Scalar: ...
def maximum(x: Scalar, y: Scalar) -> Scalar:
    """The larger of two."""
    return Number.compute("max(a0, a1)", x, y)


@overload
def clip(x: float, low: float, high: float) -> float: ...
@overload
def clip(x: Scalar, low: Scalar, high: Scalar) -> Scalar: ...
def clip(x: Scalar, low: Scalar, high: Scalar) -> Scalar:
    """x kept within limits; no derivative outside."""
    return Number.compute("clip(a0, a1, a2)", x, low, high)


@overload
def where(condition: float, yes: float, no: float) -> float: ...
@overload
def where(condition: Scalar, yes: Scalar, no: Scalar) -> Scalar: ...
def where(condition: Scalar, yes: Scalar, no: Scalar) -> Scalar:
    """One of two values. The other may be no number, and no derivative passes to it."""
    return Number.compute("where(a0, a1, a2)", condition, yes, no)
