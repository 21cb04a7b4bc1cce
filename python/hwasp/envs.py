"""The problems as Gymnasium environments: one at a time, and many at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode

from . import _hwasp
from .errors import InputError
from .runs import Experiment

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from typing import Any, Literal, TypeAlias

    from numpy.typing import ArrayLike, NDArray

    from .runs import Loadable

    Box: TypeAlias = spaces.Box[np.float32]
    Observation: TypeAlias = NDArray[np.float32]
    Limits: TypeAlias = tuple[float, float]
    World: TypeAlias = Literal["training", "deployment"]

__all__ = ["Env", "VectorEnv"]


class _Stepped:
    """What both have: an experiment, its episodes, and the spaces that follow."""

    np_random: np.random.Generator

    def _open(self, experiment: Loadable, num_envs: int, threads: int | None, method: str | None, settings: dict[str, Any] | None,
              world: World, scale_actions: bool, scale_observations: bool, progress: float,
              horizon: int | None) -> tuple[Box, Box]:  # fmt: skip
        if world not in ("training", "deployment"):
            raise InputError(f"world = {world!r}; it is 'training' or 'deployment'")
        experiment = Experiment.load(experiment)
        if settings:
            experiment = experiment.set(settings)
        if method is None:
            # Another learner cannot follow a gradient through the law: it has the design in its actions.
            method = {"hwasp": "minimal", "minimal": "minimal", "episode": "episode"}.get(experiment.method, "fixed")
        placement = {"hwasp": "graph", "minimal": "action", "episode": "episode", "fixed": "fixed"}.get(method)
        if placement is None:
            raise InputError(f"method = {method!r}; an environment has 'minimal', 'episode', 'fixed' or 'hwasp'")
        self.experiment = experiment.set({"method": method, "design.placement": placement})
        self._episodes = _hwasp.Episodes(
            self.experiment._native,
            lanes=num_envs,
            threads=threads,
            deployment=world == "deployment",
            scale_actions=scale_actions,
            scale_observations=scale_observations,
            progress=progress,
            horizon=horizon,
        )
        ports = self._episodes.actions()
        self.action_names = [name for name, _ in ports]
        self.observation_names = [name for name, _ in self._episodes.observation_ports()]
        scaled: Callable[[Limits], Limits] = lambda limits: (-1.0, 1.0) if scale_actions else limits
        low, high = zip(*[(-np.inf, np.inf) if limits is None else scaled(limits) for _, limits in ports])
        action = spaces.Box(np.array(low, np.float32), np.array(high, np.float32), dtype=np.float32)
        return spaces.Box(-np.inf, np.inf, (len(self.observation_names),), np.float32), action

    def _seed(self) -> int:
        """The seed of whoever was given none."""
        return int(self.np_random.integers(2**31))

    def _design_of(self, lane: int) -> dict[str, float]:
        """The design of a lane by the names of parameters, SI."""
        names = [name for name, _, _ in self._episodes.parameters()]
        return dict(zip(names, self._episodes.design(lane).tolist()))

    def _designed(self, lane: int, design: ArrayLike | dict[str, Any]) -> None:
        """Builds the hardware of a lane to a design: a dict by the names of parameters, or all of them in order."""
        if isinstance(design, dict):
            values = self._design_of(lane)
            for name, value in design.items():
                own = [known for known in values if known == name or known.startswith(f"{name}[")]
                if not own:
                    raise InputError(f"there is no design parameter {name!r}; these are {', '.join(values)}")
                if np.size(value) not in (1, len(own)):
                    raise InputError(f"{name} has {len(own)} values, and {np.size(value)} were given")
                for known, x in zip(own, np.broadcast_to(np.asarray(value, float).ravel(), len(own))):
                    values[known] = x
            design = list(values.values())
        elif np.shape(design) != (len(self._episodes.parameters()),):
            known = ", ".join(name for name, _, _ in self._episodes.parameters())
            raise InputError(f"a design has one value for each of {known}; {np.size(design)} were given")
        built = np.asarray(design, float).tolist()
        for (name, low, high), value in zip(self._episodes.parameters(), built):
            if not low <= value <= high:
                raise InputError(f"{name} = {value} is outside of its limits, {low} to {high}")
        self._episodes.build(lane, built)

    @property
    def dt(self) -> float:
        """Time of a step, s."""
        return self._episodes.time_step

    def set_progress(self, progress: float) -> None:
        """Says how much of a training is done, 0 to 1, to worlds that begin easier; it counts from the next starts on."""
        self._episodes.set_progress(float(progress))


class Env(_Stepped, gymnasium.Env["Observation", "NDArray[Any]"]):
    """One environment of an experiment, with the law of the hardware in it.

    - `experiment`: a name, a file, a dict, or an `Experiment`; `settings` are set in it.
    - `method`: where the design is. `"minimal"` (the default where something is designed): part of each action; `"episode"`: part
      of the action too, but only the first action of an episode counts, and is held; `"fixed"`: nowhere; `"hwasp"`: in the graph,
      so that actions are the efforts of the law, which `hwasp.Law` or a learner of this package differentiates.
    - `world`: `"training"`, or `"deployment"`, where evaluations happen.
    - `scale_actions`: actions are from -1 to 1 between their limits; else they are in SI.
    - `scale_observations`: observations are centred and scaled as the experiment's controller sees them; else they are in SI.
    - `progress`: how much of a training is done, for worlds that begin easier.
    - `horizon`: steps after which an episode is truncated; the experiment's where none is given.

    `reset(seed=s)` starts the first episode of a training with seed s, and each further `reset()` the next one.
    `options={"design": {"stiffness": 3.0}}` builds the hardware to another design, SI, from this start on. The last info of an
    episode has `is_success`, `ended_by`, `terms` of the reward and `fault`, where the world knows them.
    """

    metadata = {"render_modes": []}
    observation_space: Box
    action_space: Box

    def __init__(self, experiment: Loadable, *, method: str | None = None, settings: dict[str, Any] | None = None,
                 world: World = "training", scale_actions: bool = True, scale_observations: bool = True,
                 progress: float = 1.0, horizon: int | None = None, render_mode: None = None) -> None:  # fmt: skip
        if render_mode is not None:
            raise NoPictures(f"render_mode = {render_mode!r}; pictures are drawn by `hwasp play`, and here there are none")
        self.observation_space, self.action_space = self._open(
            experiment, 1, 1, method, settings, world, scale_actions, scale_observations, progress, horizon
        )
        self._options = dict(world=world, scale_actions=scale_actions, scale_observations=scale_observations,
                             progress=progress, horizon=horizon)  # fmt: skip
        width = self.observation_space.shape
        self._observation = np.empty((1, *width), np.float32)
        self._reward, self._terminated, self._truncated = np.empty(1), np.empty(1, bool), np.empty(1, bool)
        self._seeded = False

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Observation, dict[str, Any]]:
        super().reset(seed=seed)
        _known(options, "design")
        if options and "design" in options:
            self._designed(0, options["design"])
        if seed is None and not self._seeded:
            seed = self._seed()
        self._seeded = True
        return self._episodes.reset([seed], None)[0], {}

    def step(self, action: NDArray[Any]) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        action = np.asarray(action)
        ended = self._episodes.step(
            action[None], False, False, self._observation, self._reward, self._terminated, self._truncated
        )
        info = self._episodes.ending(0) if ended else {}
        return (
            self._observation[0].copy(),
            float(self._reward[0]),
            bool(self._terminated[0]),
            bool(self._truncated[0]),
            info,
        )

    def close(self) -> None:
        if hasattr(self, "_episodes"):
            self._episodes.close()

    @property
    def design(self) -> dict[str, float]:
        """The design of the episode by the names of parameters, SI."""
        return self._design_of(0)

    @property
    def state(self) -> dict[str, float]:
        """What the law reads of the world, SI, by name."""
        return self._episodes.state(0)

    def __reduce__(self) -> tuple[Callable[..., Env], tuple[Experiment, dict[str, Any]]]:
        return (_env, (self.experiment, self._options))


class NoPictures(InputError, TypeError):
    """Nothing is drawn here. Whoever asks for pictures on a chance asks again without them."""


def _known(options: dict[str, Any] | None, *known: str) -> None:
    for name in options or ():
        if name not in known:
            raise InputError(f"reset has no option {name!r}; its options are {', '.join(known)}")


def _env(experiment: Experiment, options: dict[str, Any]) -> Env:
    return Env(experiment, method=experiment.method, **options)


class VectorEnv(_Stepped, gymnasium.vector.VectorEnv["Observation", "NDArray[Any]", "NDArray[Any]"]):
    """Many environments of an experiment, stepped in Rust by `threads` threads: all cores where none is given and a step is worth it.

    The options of `Env` apply. `autoreset_mode` is Gymnasium's: `NEXT_STEP` (the default), `SAME_STEP`, with `final_obs` and
    `final_info` in the info, or `DISABLED`, where `reset(options={"reset_mask": mask})` starts the lanes of a mask. Environment i has
    the seed `seed + i`, and gives the bits of an `Env` with that seed, for any number of threads.

    `reset(options={"design": designs})` builds the hardware: to one design for all, or to one for each (a list of dicts, or an array
    `(num_envs, parameters)`), of the lanes of a `reset_mask` where there is one.

    Arrays are new ones in each step; with `copy=False` they are the same ones, written anew.
    """

    single_observation_space: Box
    single_action_space: Box
    observation_space: Box
    action_space: Box

    def __init__(self, experiment: Loadable, num_envs: int, *, threads: int | None = None,
                 autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP, copy: bool = True, method: str | None = None,
                 settings: dict[str, Any] | None = None, world: World = "training", scale_actions: bool = True,
                 scale_observations: bool = True, progress: float = 1.0, horizon: int | None = None,
                 render_mode: None = None) -> None:  # fmt: skip
        if render_mode is not None:
            raise NoPictures(f"render_mode = {render_mode!r}; many environments are not drawn")
        named = isinstance(autoreset_mode, str) and autoreset_mode in AutoresetMode.__members__
        autoreset_mode = AutoresetMode[autoreset_mode] if named else AutoresetMode(autoreset_mode)  # type: ignore[misc]
        self.single_observation_space, self.single_action_space = self._open(
            experiment, num_envs, threads, method, settings, world, scale_actions, scale_observations, progress, horizon
        )
        batch = gymnasium.vector.utils.batch_space
        self.num_envs = num_envs
        self.observation_space = batch(self.single_observation_space, num_envs)  # type: ignore[assignment]
        self.action_space = batch(self.single_action_space, num_envs)  # type: ignore[assignment]
        self.autoreset_mode, self._copy = autoreset_mode, copy
        self.metadata = {"render_modes": [], "autoreset_mode": autoreset_mode}
        self._arrays = self._new_arrays()
        # Which of them have a seed to go on with.
        self._seeded = np.zeros(num_envs, bool)

    def _new_arrays(self) -> tuple[Observation, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_]]:
        n = self.num_envs
        observation = np.empty(self.observation_space.shape, np.float32)
        return observation, np.empty(n), np.empty(n, bool), np.empty(n, bool)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        n, options = self.num_envs, options or {}
        _known(options, "design", "reset_mask")
        super().reset(seed=int(seed) if isinstance(seed, (int, np.integer)) else None)
        mask = np.ones(n, bool) if options.get("reset_mask") is None else np.asarray(options["reset_mask"], bool)
        seeds: list[int | None]
        if seed is None:
            seeds = [None] * n
        elif isinstance(seed, (int, np.integer)):
            seeds = [int(seed) + i for i in range(n)]
        else:
            seeds = list(seed)
        if mask.shape != (n,) or len(seeds) != n:
            raise InputError(f"reset_mask and a list of seeds have one entry for each of {n} environments")
        fresh = [i for i in np.flatnonzero(mask) if seeds[i] is None and not self._seeded[i]]
        first = self._seed() if fresh else 0
        for i in fresh:
            seeds[i] = first + int(i)
        if "design" in options:
            design = options["design"]
            # One for all, or one for each.
            each = not isinstance(design, dict) and len(design) == n and np.ndim(design[0]) + isinstance(design[0], dict) > 0
            for i in np.flatnonzero(mask):
                self._designed(int(i), design[i] if each else design)
        self._seeded |= mask
        return self._episodes.reset(seeds, mask.tolist()), {}

    def step(
        self, actions: NDArray[Any]
    ) -> tuple[Observation, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        arrays = self._new_arrays() if self._copy else self._arrays
        same_step = self.autoreset_mode is AutoresetMode.SAME_STEP
        ended = self._episodes.step(
            actions, self.autoreset_mode is AutoresetMode.NEXT_STEP, same_step, *arrays
        )
        infos: dict[str, Any] = {}
        for i in ended:
            told = self._episodes.ending(i)
            if same_step:
                told = {"final_obs": self._episodes.last(i), "final_info": told}
            infos = self._add_info(infos, told, i)
        if same_step and ended:
            self._episodes.go_on(ended, arrays[0])
        return (*arrays, infos)

    def close_extras(self, **kwargs: Any) -> None:
        if hasattr(self, "_episodes"):
            self._episodes.close()

    @property
    def designs(self) -> list[dict[str, float]]:
        """The design of each environment by the names of parameters, SI."""
        return [self._design_of(i) for i in range(self.num_envs)]
