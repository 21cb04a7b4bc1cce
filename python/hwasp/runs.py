"""Experiments, the runs that they become, and comparisons."""

from __future__ import annotations

import html
import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from . import _hwasp
from ._progress import watcher
from .errors import InputError
from .policy import Policy

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from typing import Any, TypeAlias

    import numpy as np
    import pandas  # type: ignore[import-untyped]
    from numpy.typing import NDArray
    from typing_extensions import Self

    PathLike: TypeAlias = str | os.PathLike[str]
    #: A name, a file, the tables of a file, or an experiment as it is.
    Loadable: TypeAlias = "Experiment | PathLike | dict[str, Any]"
    #: Gets each row of the learning curve; where it returns False the training stops.
    Callback: TypeAlias = Callable[[dict[str, float]], object]

__all__ = ["Comparison", "DesignGroup", "Experiment", "Metrics", "Run", "compare"]


class Experiment:
    """What is trained, in which world, by what learner: every setting of an experiment file.

    It never changes; `set` gives another one. `str(experiment)` is the file with every setting in its place.
    """

    def __init__(self, what: Loadable | _hwasp.Experiment) -> None:
        self._native: _hwasp.Experiment = what if isinstance(what, _hwasp.Experiment) else Experiment.load(what)._native

    @classmethod
    def load(cls, what: Loadable) -> Self:
        """An experiment by the name of one that comes along (`hwasp.experiments()`), from a TOML file, or from a dict.

        A dict has the tables of a file: `{"name": "mine", "task": {"problem": "reach"}, "train": {"env_steps": 100_000}}`.
        """
        return cls(_hwasp.Experiment.load(what._native if isinstance(what, Experiment) else what))

    def set(self, settings: dict[str, Any] | None = None, /, **more: Any) -> Self:
        """The same with other settings, by their keys in files.

        >>> Experiment.load("reach").set({"ppo.clip_ratio": 0.1, "task.goal": "30 cm"}, seed=3, method="minimal").seed
        3
        """
        asked = {**(settings or {}), **more}
        placement = self._native.placement()
        if "method" in asked and placement is not None and "design.placement" not in asked:
            raise InputError(
                f'this experiment says design.placement = "{placement}" itself, so that another method would change little of it: '
                "set design.placement, too, or begin with the experiment that it was made of"
            )
        return type(self)(self._native.set(asked))

    def check(self) -> Text:
        """Tries the world with random commands and designs, and tells what is in the experiment; raises `InputError` with
        every fault at once."""
        return Text(self._native.check())

    def train(self, out: PathLike | None = None, *, seed: int | None = None, env_steps: int | None = None, threads: int = 1,
              callback: Callback | None = None, begin_with: PathLike | Iterable[PathLike] = (), progress: bool = True,
              checkpoint_every: float = 30.0, tensorboard: bool = False) -> Run:  # fmt: skip
        """Trains, and returns the `Run`. The same experiment and seed give the same bits as the command `hwasp train`.

        - `out`: the run folder; a new one under `runs/` where there is none.
        - `seed`, `env_steps`: as in the experiment, unless given.
        - `threads`: for episodes; they do not change the result.
        - `callback`: called with a dict for each iteration, the columns of `metrics.csv` by name. Where it returns `False` the
          training stops; `Run.resume` goes on.
        - `begin_with`: runs whose parameters it begins with.
        - `progress`: shows a bar, on a terminal and in a notebook.
        - `checkpoint_every`: s between two checkpoints, at least.
        - `tensorboard`: writes the curves for TensorBoard as well.

        Ctrl-C finishes the iteration, keeps a checkpoint, and raises `KeyboardInterrupt`; a second one does not wait.
        """
        more = {key: value for key, value in [("seed", seed), ("train.env_steps", env_steps)] if value is not None}
        begin_with = [begin_with] if isinstance(begin_with, (str, os.PathLike, Run)) else list(begin_with)
        watch = watcher(progress, callback)
        try:
            path = self._native.set(more).train(
                out=None if out is None else os.fspath(out),
                learned=[os.fspath(run) for run in begin_with],
                threads=threads,
                checkpoint_every=checkpoint_every,
                tensorboard=tensorboard,
                watch=watch,
            )
        finally:
            watch.close()
        return Run.open(path)

    @property
    def name(self) -> str:
        """What it is called."""
        return self._native.name

    @property
    def method(self) -> str:
        """How learner, controller and hardware are composed: `"hwasp"`, `"minimal"`, `"episode"`, `"fixed"` and others."""
        return self._native.method

    @property
    def seed(self) -> int:
        """The root of all random numbers."""
        return self._native.seed

    def to_dict(self) -> dict[str, Any]:
        """Every setting, as the tables of a file."""
        return self._native.to_dict()

    def to_toml(self) -> str:
        """Every setting, as a file."""
        return self._native.to_toml()

    __str__ = to_toml

    def __repr__(self) -> str:
        return repr(self._native)

    def __reduce__(self) -> tuple[Callable[..., Experiment], tuple[str, dict[str, bytes]]]:
        # With all files that it names: what is on the disk may be something else by then.
        return (_restored, self._native.packed())


def _restored(text: str, files: dict[str, bytes]) -> Experiment:
    return Experiment(_hwasp.Experiment.unpacked(text, files))


def cores() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class Text(str):
    """A text that shows its lines where a value is shown."""

    __slots__ = ()

    def __repr__(self) -> str:
        return str(self)


@dataclass(frozen=True, eq=False)
class DesignGroup:
    """A group of design parameters: arrays of values as trained and as they are to be built, in the SI unit `unit`."""

    name: str
    unit: str
    limits: tuple[float, float]
    values: NDArray[np.float64]
    as_built: NDArray[np.float64]
    optimum: float | None

    @property
    def total(self) -> float:
        """The sum of the values as trained."""
        return float(self.values.sum())

    def __repr__(self) -> str:
        values = ", ".join(f"{value:.4g}" for value in self.as_built[:8]) + (", …" if len(self.as_built) > 8 else "")
        total = f" (total {self.total:.4g})" if len(self.values) > 1 else ""
        return f"{values}{' ' + self.unit if self.unit else ''}{total}"


class Metrics(dict[str, "NDArray[Any]"]):
    """A learning curve: numpy arrays by the names of the columns of `metrics.csv`."""

    def to_pandas(self) -> pandas.DataFrame:
        """The same as a frame of pandas."""
        import pandas

        return pandas.DataFrame(dict(self))


class Run:
    """What a training left in its folder."""

    def __init__(self, path: PathLike | _hwasp.Run) -> None:
        self._native = path if isinstance(path, _hwasp.Run) else _hwasp.Run.open(os.fspath(path))

    @classmethod
    def open(cls, path: PathLike) -> Self:
        """The run in a folder, finished or not."""
        return cls(_hwasp.Run.open(os.fspath(path)))

    @property
    def path(self) -> Path:
        """The folder."""
        return Path(self._native.path)

    def __fspath__(self) -> str:
        return os.fspath(self._native.path)

    @property
    def finished(self) -> bool:
        """Whether the training came to its end. The others have the design and policy of their newest checkpoint."""
        return self._native.finished

    @property
    def experiment(self) -> Experiment:
        """The experiment, with every setting."""
        return Experiment(self._native.experiment)

    @property
    def design(self) -> dict[str, DesignGroup]:
        """The groups of design parameters by name, each a `DesignGroup`."""
        return {name: DesignGroup(name, **group) for name, group in self._native.groups().items()}

    @property
    def metrics(self) -> Metrics:
        """The learning curve, a `Metrics`: arrays by name."""
        return Metrics(self._native.columns())

    @property
    def summary(self) -> dict[str, Any]:
        """The figures of `summary.json` as a dict."""
        return self._native.summary

    @property
    def policy(self) -> Policy:
        """The deterministic controller on the design as built, a `Policy`."""
        return Policy(self._native.policy)

    @property
    def params(self) -> NDArray[np.float32]:
        """All parameters of the policy as one vector; `policy.state_dict()` has them by name."""
        return self._native.params

    def evaluate(self, episodes: int | None = None, *, seed: int | None = None, settings: dict[str, Any] | None = None,
                 native: bool = False, threads: int = 1) -> dict[str, Any]:  # fmt: skip
        """Evaluates the design as built on starts that no training sees; a dict of figures with 95 % intervals.

        - `episodes`, `seed`: as the experiment says, unless given.
        - `settings`: other values of the experiment, by key, to see what the result is worth in another world.
        - `native`: in the world that stands in for the built robot, where there is one.
        """
        return self._native.evaluation(
            episodes=episodes, seed=seed, settings=settings, native=native, threads=threads
        )

    def export(self, out: PathLike | None = None, kinds: str | Iterable[str] = (), samples: int | None = None) -> list[Path]:
        """Writes files for other programs (ONNX, safetensors, JSON; of a hand MJCF, URDF, STL and more); returns their paths.

        `kinds` are the names of `hwasp export`; all that the run has where none is given.
        """
        kinds = [kinds] if isinstance(kinds, str) else list(kinds)
        out = None if out is None else os.fspath(out)
        return [Path(path) for path in self._native.exported(out, kinds, samples)]

    def report(self, out: PathLike | None = None) -> Path:
        """Writes the report, one HTML page that loads nothing, and returns its path."""
        out = Path(self.path / "report.html" if out is None else out)
        out.write_text(self._native.html(), encoding="utf-8")
        return out

    def resume(self, *, threads: int = 1, callback: Callback | None = None, progress: bool = True,
               checkpoint_every: float = 30.0, tensorboard: bool = False) -> Run:  # fmt: skip
        """Goes on with a training that was interrupted: the result has the bits of one that never was."""
        watch = watcher(progress, callback)
        try:
            path = self._native.resumed(
                threads=threads, checkpoint_every=checkpoint_every, tensorboard=tensorboard, watch=watch
            )
        finally:
            watch.close()
        return Run.open(path)

    def __reduce__(self) -> tuple[Any, ...]:
        return (Run.open, (os.fspath(self.path),))

    def __repr__(self) -> str:
        design = "; ".join(f"{name} {group!r}" for name, group in self.design.items())
        state = "" if self.finished else ", not finished"
        return f"Run({str(self.path)!r}{state}; {design or 'nothing designed'})"

    def _repr_html_(self) -> str:
        if not self.finished:
            return f"<code>{html.escape(repr(self))}</code>"
        page = html.escape(self._native.html(), quote=True)
        return f'<iframe srcdoc="{page}" style="width: 100%; height: 40em; border: 1px solid #ccc"></iframe>'


class Comparison:
    """Methods against each other, in a folder: `table` as Markdown, `figures` as `comparison.json` has them."""

    def __init__(self, path: PathLike, table: str) -> None:
        self.path, self.table = Path(path), Text(table)

    @property
    def figures(self) -> Any:
        """The figures of `comparison.json`."""
        return json.loads((self.path / "comparison.json").read_text(encoding="utf-8"))

    def __repr__(self) -> str:
        return self.table

    def _repr_markdown_(self) -> str:
        return str(self.table)


def compare(experiment: Loadable, methods: str | Iterable[str] = ("hwasp", "minimal", "fixed"), *, seeds: int = 3,
            first_seed: int = 0, out: PathLike | None = None, threads: int | None = None,
            threshold: float | None = None) -> Comparison:  # fmt: skip
    """Trains methods against each other under one budget of simulator steps, several seeds each; returns a `Comparison`.

    `methods` are those of `hwasp compare`: `"cmaes"`, `"ars-rl"`, `"fixed:middle"` and so on. What is finished in `out` stays as it
    is; a comparison that was stopped goes on with the same call.
    """
    experiment = Experiment.load(experiment)
    out = Path("runs") / f"compare-{experiment.name}" if out is None else Path(out)
    methods = [methods] if isinstance(methods, str) else list(methods)
    if (placement := experiment._native.placement()) is not None and len(methods) > 1:
        raise InputError(
            f'this experiment says design.placement = "{placement}" itself, so that its methods would be alike: begin with the '
            "experiment that it was made of"
        )
    table = _hwasp.compare(
        experiment._native,
        methods=methods,
        seeds=seeds,
        first_seed=first_seed,
        out=os.fspath(out),
        threads=cores() if threads is None else threads,
        threshold=threshold,
    )
    return Comparison(out, table)
