"""The native half: what has to be fast, or is the program's own. Letters in shapes: O observations, A components of an action,
C commands, S states, E efforts, U design parameters. Everything is in SI units."""

from collections.abc import Callable, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Literal, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

def experiments() -> list[str]:
    """The names of the experiments that come with the package."""

def problems() -> list[str]:
    """The names of the problems that experiments may name."""

def forget(name: str) -> None:
    """Takes a problem out that was registered from Python; does nothing where there is none."""

def main(words: Sequence[str], itself: Sequence[str]) -> int:
    """Runs the command line `words`, the program first, and returns its exit status; `itself` starts the program again."""

def register(told: dict[str, Any]) -> None:
    """Registers a problem whose world is an environment in Python; `hwasp.worlds` makes the dict."""

def compare(
    experiment: Experiment,
    *,
    methods: Sequence[str],
    seeds: int,
    first_seed: int,
    out: str | PathLike[str],
    threads: int,
    threshold: float | None,
) -> str:
    """Trains methods against each other into a folder, and writes its tables; returns the table as Markdown."""

def trace(
    function: Callable[[list[Number], list[Number], list[Number]], Sequence[Number | float]],
    design: Sequence[tuple[str, str, float, float, int, float | None]],
    command: Sequence[str],
    state: Sequence[str],
    effort: Sequence[str],
) -> Law:
    """A law of a function that is called once, with traced numbers `(U,)`, `(C,)`, `(S,)`, and gives efforts `(E,)`.

    Of each group of design parameters: name, SI unit, lower and upper limit, count, start (the middle where that is None).
    """

@final
class Experiment:
    """What is trained, in which world, by what learner. It never changes: `set` gives another one."""

    @staticmethod
    def load(what: Experiment | str | PathLike[str] | dict[str, Any]) -> Experiment:
        """An experiment by its name, from a TOML file, or from a dict with the tables of a file."""

    def set(self, settings: dict[str, Any] | None = None, /, **more: Any) -> Experiment:
        """The same with other settings, by their keys in files."""

    def check(self) -> str:
        """Tries the world with random commands and designs, and tells what is in the experiment."""

    def placement(self) -> str | None:
        """Where the file itself says that the design sits, which no other method changes; None where the method decides."""

    @property
    def name(self) -> str:
        """What it is called."""

    @property
    def method(self) -> str:
        """How learner, controller and hardware are composed."""

    @property
    def seed(self) -> int:
        """The root of all random numbers."""

    def to_toml(self) -> str:
        """Every setting, as a file."""

    def to_dict(self) -> dict[str, Any]:
        """Every setting, as the tables of a file."""

    def packed(self) -> tuple[str, dict[str, bytes]]:
        """Every setting as TOML, and the files that it names by their paths."""

    @staticmethod
    def unpacked(text: str, files: dict[str, bytes]) -> Experiment:
        """An experiment of what `packed` gave."""

    def train(
        self,
        *,
        out: str | PathLike[str] | None,
        learned: Sequence[str | PathLike[str]],
        threads: int,
        checkpoint_every: float,
        tensorboard: bool,
        watch: Callable[[dict[str, Any]], object] | None,
    ) -> Path:
        """Trains to the end; `checkpoint_every` is in s. `watch` gets the folder first, then each row; `False` stops.

        Returns the run folder.
        """

@final
class Run:
    """A run folder: its experiment, design, policy, curves and figures."""

    @staticmethod
    def open(path: str | PathLike[str]) -> Run:
        """The run in a folder, finished or not."""

    @property
    def path(self) -> Path:
        """The folder."""

    @property
    def finished(self) -> bool:
        """Whether the training came to its end."""

    @property
    def experiment(self) -> Experiment:
        """The experiment, with every setting."""

    @property
    def summary(self) -> dict[str, Any]:
        """The figures of `summary.json`."""

    @property
    def params(self) -> NDArray[np.float32]:
        """The trained parameters of the whole policy as one vector."""

    @property
    def policy(self) -> Policy:
        """The deterministic controller on the design as built."""

    def groups(self) -> dict[str, dict[str, Any]]:
        """By group: `unit`, `limits`, `values` and `as_built` `(count,)`, `optimum`; in the SI unit `unit`."""

    def columns(self) -> dict[str, NDArray[Any]]:
        """The learning curve: arrays `(rows,)` by the names of the columns, of integers for iterations and steps."""

    def evaluation(
        self, *, episodes: int | None, seed: int | None, settings: dict[str, Any] | None, native: bool, threads: int
    ) -> dict[str, Any]:
        """Evaluates the design as built, under other settings by key; `native` is the world of the built robot."""

    def exported(self, out: str | PathLike[str] | None, kinds: Sequence[str], samples: int | None) -> list[Path]:
        """Writes files for other programs, of all kinds where none is named; returns their paths."""

    def html(self) -> str:
        """The report as one HTML page."""

    def resumed(
        self,
        *,
        threads: int,
        checkpoint_every: float,
        tensorboard: bool,
        watch: Callable[[dict[str, Any]], object] | None,
    ) -> Path:
        """Goes on with a training that was interrupted; `checkpoint_every` is in s. Returns the run folder."""

@final
class Policy:
    """The deterministic controller on the design as built."""

    def __call__(self, observation: ArrayLike) -> NDArray[np.float64]:
        """Commands `(C,)` at an observation `(O,)`, or `(rows, C)` at a batch `(rows, O)`; SI, observations in single precision."""

    @property
    def observations(self) -> list[tuple[str, str]]:
        """Names and SI units, `O` of them."""

    @property
    def commands(self) -> list[tuple[str, str, float, float]]:
        """Name, SI unit, lower and upper limit, `C` of them."""

    @property
    def time_step(self) -> float:
        """Time between two commands, s."""

    def state_dict(self) -> dict[str, NDArray[np.float32]]:
        """Every tensor of the policy, in its own shape, by its name in `policy.safetensors`."""

    def layers(self) -> list[tuple[NDArray[np.float32], NDArray[np.float32], Literal["tanh", "relu", "identity"]]]:
        """First to last: weight `(outputs, inputs)`, bias `(outputs,)`, and what follows."""

    def normalizer(self) -> tuple[NDArray[np.float64], NDArray[np.float64], float | None]:
        """Centre `(O,)` and scale `(O,)`, SI, and clip: it sees `clip((observation - centre) / scale, -clip, clip)`."""

@final
class Episodes:
    """Many episodes of one world in lock step; a lane is one of them."""

    def __new__(
        cls,
        experiment: Experiment,
        *,
        lanes: int,
        threads: int | None,
        deployment: bool,
        scale_actions: bool,
        scale_observations: bool,
        progress: float,
        horizon: int | None,
    ) -> Episodes:
        """So many lanes of an experiment's world; `progress` is from 0 to 1, `horizon` in steps."""

    def reset(self, seeds: Sequence[int | None], mask: Sequence[bool] | None) -> NDArray[np.float32]:
        """Starts lanes, all or those of the mask; without a seed, the next episode of the last one. Gives `(lanes, O)`."""

    def step(
        self,
        action: ArrayLike,
        next_step: bool,
        same_step: bool,
        observation: NDArray[np.float32],
        reward: NDArray[np.float64],
        terminated: NDArray[np.bool_],
        truncated: NDArray[np.bool_],
    ) -> list[int]:
        """One step by `action` `(lanes, A)`. Writes `observation` `(lanes, O)` and the others `(lanes,)`; returns lanes that ended.

        Where a lane ended and `same_step` is asked for, `observation` is written by `go_on`.
        """

    def ending(self, lane: int) -> dict[str, Any]:
        """What is to be told of a lane whose episode has ended: `is_success`, `kind`, `ended_by`, `fault`, `terms`, where known."""

    def go_on(self, ended: Sequence[int], observation: NDArray[np.float32]) -> None:
        """Begins the next episodes of these lanes; writes the observations `(lanes, O)`."""

    def last(self, lane: int) -> NDArray[np.float32]:
        """The observation `(O,)` with which the last episode of a lane ended."""

    def build(self, lane: int, design: Sequence[float]) -> None:
        """Builds the hardware of a lane to a design `(U,)`, SI, from its next start on."""

    def design(self, lane: int) -> NDArray[np.float64]:
        """The design `(U,)` of a lane, SI."""

    def actions(self) -> list[tuple[str, tuple[float, float] | None]]:
        """Names and limits (SI; none of an effort) of the `A` components of an action."""

    def observation_ports(self) -> list[tuple[str, str]]:
        """Names and SI units of the `O` observations."""

    def parameters(self) -> list[tuple[str, float, float]]:
        """Names, lower and upper limits (SI) of the `U` design parameters."""

    def state(self, lane: int) -> dict[str, float]:
        """What the law reads of a lane, SI, by name."""

    def set_progress(self, progress: float) -> None:
        """How much of a training is done, 0 to 1, for worlds that begin easier; it counts from the next starts on."""

    @property
    def horizon(self) -> int:
        """Steps of an episode, at most."""

    @property
    def time_step(self) -> float:
        """Time of a step, s."""

    @property
    def is_open(self) -> bool:
        """Whether it was not closed."""

    def close(self) -> None:
        """Ends all episodes and gives the memory back."""

@final
class Number:
    """A number of a law that is traced: it has no value and no truth, and operators give numbers again."""

    @overload
    @staticmethod
    def compute(formula: str, *operands: float) -> float:
        """A formula of experiments over `a0`, `a1` and so on; of plain numbers alone it is a float."""

    @overload
    @staticmethod
    def compute(formula: str, *operands: Number | float) -> Number | float: ...
    def clip(self, low: Number | float, high: Number | float, out: None = None) -> Number:
        """Kept within limits, as `numpy.clip` asks for it."""

    def __add__(self, other: Number | float, /) -> Number: ...
    def __radd__(self, other: Number | float, /) -> Number: ...
    def __sub__(self, other: Number | float, /) -> Number: ...
    def __rsub__(self, other: Number | float, /) -> Number: ...
    def __mul__(self, other: Number | float, /) -> Number: ...
    def __rmul__(self, other: Number | float, /) -> Number: ...
    def __truediv__(self, other: Number | float, /) -> Number: ...
    def __rtruediv__(self, other: Number | float, /) -> Number: ...
    def __pow__(self, other: Number | float, mod: None = None, /) -> Number:
        """A power with a plain exponent, or any power of a positive base."""

    def __rpow__(self, other: Number | float, mod: None = None, /) -> Number:
        """A power of a positive base."""

    def __neg__(self) -> Number: ...
    def __pos__(self) -> Number: ...
    def __abs__(self) -> Number: ...
    def __lt__(self, other: Number | float, /) -> Number:
        """1 where it is less, else 0: a condition for `hwasp.where`, as the other comparisons."""

    def __le__(self, other: Number | float, /) -> Number: ...
    def __gt__(self, other: Number | float, /) -> Number: ...
    def __ge__(self, other: Number | float, /) -> Number: ...
    def __eq__(self, other: Number | float, /) -> Number: ...  # type: ignore[override]
    def __ne__(self, other: Number | float, /) -> Number: ...  # type: ignore[override]
    def __bool__(self) -> bool:
        """Raises `TypeError`: a law does not branch on values."""

    def __float__(self) -> float:
        """Raises `TypeError`: a traced number has no value."""

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Any:
        """numpy's functions of numbers, and of arrays beside them."""

@final
class Law:
    """A law of the hardware: design space, names, and the program."""

    def efforts(self, design: Sequence[float], command: NDArray[np.float64], state: NDArray[np.float64]) -> NDArray[np.float64]:
        """Efforts `(rows, E)` at a design `(U,)`, commands `(rows, C)` and states `(rows, S)`, SI."""

    def pullback(
        self,
        design: Sequence[float],
        command: NDArray[np.float64],
        state: NDArray[np.float64],
        cotangent: NDArray[np.float64],
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """From cotangents of efforts `(rows, E)` to those of design `(U,)`, commands `(rows, C)`, states `(rows, S)`."""

    def gradcheck(self, design: Sequence[float], command: NDArray[np.float64], state: NDArray[np.float64]) -> float:
        """Compares derivatives with finite differences; returns the largest relative error."""

    def svg(self) -> str:
        """The computational graph as SVG."""

    def text(self, design: Sequence[str], columns: Sequence[str]) -> tuple[list[tuple[str, str]], list[str]]:
        """As text over names of design parameters `(U,)`, and of commands and states `(C + S,)`: definitions, and `E` formulas."""
