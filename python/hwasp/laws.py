"""Laws of the hardware, written in Python: traced once, and from then on the same as a law in Rust or as text."""

from __future__ import annotations

from dataclasses import dataclass
from functools import update_wrapper
from typing import TYPE_CHECKING

from ._hwasp import Number, trace
from .errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
    from typing import Any, TypeAlias

    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    #: Of design, commands and state, all by name: the efforts.
    Function: TypeAlias = Callable[[Any, Any, Any], Any]
    Names: TypeAlias = str | Sequence[str]
    Commands: TypeAlias = Names | dict[str, Any]
    #: One value for each parameter, or by the names of groups.
    Design: TypeAlias = Iterable[float] | dict[str, Any]
    Array: TypeAlias = NDArray[np.float64]

__all__ = ["Law", "Parameter", "law"]


@dataclass(frozen=True)
class Parameter:
    """A group of design parameters.

    `limits` are in the SI unit `unit` (`"N/m"`; empty for pure numbers). It begins at `initial`, in the middle where that is
    None. With a `count` above 1 the law gets a list of as many numbers.
    """

    limits: tuple[float, float]
    unit: str = ""
    initial: float | None = None
    count: int = 1


class _Named:
    """Traced numbers by name: as attributes, by `[name]`, and by their place."""

    def __init__(self, values: dict[str, Any]) -> None:
        self._values = values

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        try:
            return self._values[name]
        except KeyError:
            there = f"there are {', '.join(self._values)}" if self._values else "nothing was named"
            raise AttributeError(f"there is no `{name}` here; {there}") from None

    def __dir__(self) -> list[str]:
        return list(self._values)

    def __repr__(self) -> str:
        return f"({', '.join(self._values)})"

    def __getitem__(self, key: str | int | slice) -> Any:
        if isinstance(key, str):
            return getattr(self, key)
        return list(self._values.values())[key]

    def __iter__(self) -> Iterator[Any]:
        return iter(self._values.values())

    def __len__(self) -> int:
        return len(self._values)


def law(*, design: Mapping[str, Parameter | tuple[float, float]] | None = None, command: Commands, state: Names = (),
        effort: Names) -> Callable[[Function], Law]:  # fmt: skip
    """Makes a law of a function `f(design, command, state)` that gives the efforts.

    - `design`: parameters by name, each a `Parameter` or its limits `(low, high)`.
    - `command`: names of what the controller asks of the motors, or limits by name, `{"torque": (-1, 1)}`.
    - `state`: names of what the law reads of the world.
    - `effort`: the name, or names, of what the mechanism does to the world.

    The function is called once, with traced numbers. It computes with `+ - * / **`, with `hwasp.sin` and the like or numpy's
    functions, and may loop over lists. It must not branch on values: `hwasp.where` chooses. It returns the effort, a sequence
    of efforts in their order, or a dict.

    >>> @law(design={"stiffness": Parameter((1, 9), "N/m")}, command=["pull"], state=["position"], effort="force")
    ... def spring(design, command, state):
    ...     return command.pull - design.stiffness * state.position
    >>> spring.effort([4.0], [1.0], [0.5]).tolist()
    [-1.0]
    """

    def decorate(function: Function) -> Law:
        return Law(function, design=design or {}, command=command, state=state, effort=effort)

    return decorate


class Law:
    """A law of the hardware; `law` makes one."""

    def __init__(self, function: Function, *, design: Mapping[str, Parameter | tuple[float, float]], command: Commands,
                 state: Names, effort: Names) -> None:  # fmt: skip
        parameters = {name: p if isinstance(p, Parameter) else Parameter(tuple(p)) for name, p in design.items()}  # type: ignore[arg-type]
        limits: dict[str, tuple[float, float] | None]
        limits = dict(command) if isinstance(command, dict) else {name: None for name in _names(command)}
        states, efforts = _names(state), _names(effort)
        for what, names in [("commands and states", [*(limits if isinstance(command, dict) else _names(command)), *states]), ("efforts", efforts)]:
            twice = [name for i, name in enumerate(names) if name in names[:i]]
            if twice:
                raise InputError(f"two {what} of the law are called {twice[0]}; each has a name of its own")
        for name, limit in limits.items():
            if limit is None:
                continue
            low, high = limit
            if not float(low) < float(high):
                raise InputError(f"the limits {limit} of the command {name} are no interval")

        def traced(uniforms: Iterable[Number], commands: Iterable[Number], columns: Iterable[Number]) -> list[Any]:
            uniforms = iter(uniforms)
            groups: dict[str, Number | list[Number]] = {}
            for name, parameter in parameters.items():
                numbers = [next(uniforms) for _ in range(parameter.count)]
                groups[name] = numbers[0] if parameter.count == 1 else numbers
            given = function(
                _Named(groups), _Named(dict(zip(limits, commands))), _Named(dict(zip(states, columns)))
            )
            if isinstance(given, dict):
                missing = [name for name in efforts if name not in given]
                if missing or len(given) != len(efforts):
                    raise ValueError(f"the law gives {', '.join(given)}, and its efforts are {', '.join(efforts)}")
                return [given[name] for name in efforts]
            return list(given) if isinstance(given, (list, tuple)) or hasattr(given, "__len__") else [given]

        groups: list[tuple[Any, ...]]
        groups = [(n, p.unit, *map(float, p.limits), p.count, p.initial) for n, p in parameters.items()]
        self._law = trace(traced, groups, list(limits), states, efforts)
        self.parameters = parameters
        self.command_limits = limits
        self.command, self.state_names, self.effort_names = list(limits), states, efforts
        update_wrapper(self, function)

    def effort(self, design: Design, command: ArrayLike, state: ArrayLike | None = None) -> Array:
        """Efforts at one design and one row `(C,)`, `(S,)` of commands and states, or rows of them `(B, C)`, `(B, S)`; SI.

        A design is a list with one value for each parameter, or a dict by the names of groups.
        """
        rows = self._rows(command, state)
        efforts = self._law.efforts(self._design(design), *rows)
        return efforts if _is_batch(command) else efforts[0]

    __call__ = effort

    def vjp(
        self, design: Design, command: ArrayLike, state: ArrayLike | None, cotangent: ArrayLike
    ) -> tuple[Array, Array, Array]:
        """The way back: cotangents by the design `(U,)` (summed over rows), by commands and by states, from those of efforts.

        It is what an automatic differentiation of another library needs, `torch.autograd.Function.backward` for one.
        """
        import numpy as np

        cotangent = np.atleast_2d(np.asarray(cotangent, "float64"))
        by_design, by_command, by_state = self._law.pullback(
            self._design(design), *self._rows(command, state), cotangent
        )
        if _is_batch(command):
            return by_design, by_command, by_state
        return by_design, by_command[0], by_state[0]

    def gradcheck(self, design: Design, command: ArrayLike, state: ArrayLike | None = None) -> float:
        """Compares the derivatives with finite differences at a point; returns the largest relative error, or raises."""
        return self._law.gradcheck(self._design(design), *self._rows(command, state))

    def graph(self) -> str:
        """The computational graph as SVG; a notebook shows a law by it."""
        return self._law.svg()

    _repr_svg_ = graph

    def settings(self, prefix: str = "joint.") -> dict[str, Any]:
        """The same law as settings of an experiment with the problem `model`, for `Experiment.set`.

        Its commands, states and efforts have to be called as formulas call them, `joint.knee.pos` for one; commands without a
        dot are `command.NAME`, and efforts without one `prefix` and their name.
        """
        # A law in Python computes with numbers in SI, and units are the caller's business.
        si: Callable[[list[str]], list[str]] = lambda names: [f"si({name})" for name in names]
        # A parameter of a model is one number: of a group each has a name of its own.
        design = {
            name if parameter.count == 1 else f"{name}_{i}": _table(parameter)
            for name, parameter in self.parameters.items()
            for i in range(parameter.count)
        }
        commands = [name if "." in name else f"command.{name}" for name in self.command]
        definitions, formulas = self._law.text(si(list(design)), si(commands + self.state_names))
        efforts = [name if "." in name else prefix + name for name in self.effort_names]
        return {
            "task.define": dict(definitions),
            "task.law": dict(zip(efforts, formulas)),
            "task.design": design,
        }

    def __repr__(self) -> str:
        design = ", ".join(self.parameters) or "nothing designed"
        return f"Law({design}; {', '.join(self.command + self.state_names)} to {', '.join(self.effort_names)})"

    def _design(self, design: Design) -> list[float]:
        if not isinstance(design, dict):
            given = [float(value) for value in design]
            if len(given) != sum(parameter.count for parameter in self.parameters.values()):
                groups = ", ".join(f"{name} ({parameter.count})" for name, parameter in self.parameters.items())
                raise InputError(f"the design has {len(given)} values, and the parameters of the law are {groups or 'none'}")
            return given
        if set(design) != set(self.parameters):
            raise InputError(f"the design has {', '.join(design)}, and the law {', '.join(self.parameters)}")
        values: list[float] = []
        for name in self.parameters:
            value = design[name]
            values.extend(map(float, value) if hasattr(value, "__len__") else [float(value)])
        return values

    def _rows(self, command: ArrayLike, state: ArrayLike | None) -> tuple[Array, Array]:
        import numpy as np

        command = np.atleast_2d(np.asarray(command, "float64"))
        if state is None:
            state = np.zeros((len(command), 0))
        return command, np.atleast_2d(np.asarray(state, "float64"))


def _table(parameter: Parameter) -> dict[str, Any]:
    quantity: Callable[[float], str | float]
    quantity = lambda value: f"{float(value)!r} {parameter.unit}" if parameter.unit else float(value)
    table: dict[str, Any] = {"limits": [quantity(value) for value in parameter.limits]}
    if parameter.initial is not None:
        table["initial"] = quantity(parameter.initial)
    return table


def _names(names: Iterable[str]) -> list[str]:
    return [names] if isinstance(names, str) else list(names)


def _is_batch(value: ArrayLike) -> bool:
    import numpy as np

    return np.ndim(value) == 2


_FORMULAS = {
    "add": "a0 + a1", "subtract": "a0 - a1", "multiply": "a0 * a1", "divide": "a0 / a1", "negative": "-a0",
    "positive": "a0", "absolute": "abs(a0)", "fabs": "abs(a0)", "square": "a0 * a0", "reciprocal": "1 / a0",
    "sin": "sin(a0)", "cos": "cos(a0)", "tan": "tan(a0)", "arcsin": "asin(a0)", "arccos": "acos(a0)",
    "arctan": "atan(a0)", "arctan2": "atan2(a0, a1)", "tanh": "tanh(a0)", "exp": "exp(a0)", "log": "log(a0)",
    "sqrt": "sqrt(a0)", "sign": "sign(a0)", "minimum": "min(a0, a1)", "maximum": "max(a0, a1)",
    "fmin": "min(a0, a1)", "fmax": "max(a0, a1)", "less": "a0 < a1", "less_equal": "a0 <= a1",
    "greater": "a0 > a1", "greater_equal": "a0 >= a1", "deg2rad": "a0 * (pi / 180)", "radians": "a0 * (pi / 180)",
    "hypot": "sqrt(a0 * a0 + a1 * a1)",
}  # fmt: skip


def _ufunc(ufunc: np.ufunc, method: str, inputs: tuple[Any, ...], options: dict[str, Any] | None) -> Any:
    """What numpy's functions do to traced numbers, and to arrays beside them."""
    import numpy as np

    if method != "__call__" or options:
        return NotImplemented
    if ufunc.__name__ in ("power", "float_power"):
        operation = lambda base, exponent: base**exponent
    elif (text := _FORMULAS.get(ufunc.__name__)) is not None:
        operation = lambda *operands: Number.compute(text, *operands)
    else:
        raise TypeError(f"numpy.{ufunc.__name__} is no function of laws; these are: {', '.join(sorted(_FORMULAS))}, power")

    def boxed(value: Any) -> Any:
        if not isinstance(value, Number):
            return value
        box = np.empty((), object)
        box[()] = value
        return box

    return np.frompyfunc(operation, len(inputs), 1)(*map(boxed, inputs))


def _method(number: Number, name: str) -> Callable[..., Number | float]:
    """What an array of traced numbers asks its elements for: functions by numpy's names."""
    if name.startswith("_") or name not in _FORMULAS:
        raise AttributeError(f"a law's number has no {name}")
    return lambda *others: Number.compute(_FORMULAS[name], number, *others)
