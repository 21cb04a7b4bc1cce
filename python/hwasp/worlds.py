"""Environments in Python as problems: a law and a design in front of them, this program's learners behind."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import _hwasp
from .errors import InputError
from .laws import Law

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from typing import Any, TypeAlias

    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    #: Places in the observation, or a function of environment and observation.
    State: TypeAlias = Sequence[int] | Callable[[Any, NDArray[Any]], ArrayLike]

#: Steps of an episode, at most.
MOST_STEPS = 100_000

__all__ = ["forget_problem", "register_problem"]


def register_problem(name: str, make: str | Callable[[], Any], *, law: Law | None = None, state: State | None = None,
                     build: Callable[[Any, NDArray[np.float64]], object] | None = None, shaped_by: Iterable[str] = (),
                     time_step: float | None = None, horizon: int | None = None, about: str = "") -> None:  # fmt: skip
    """Registers a problem whose world is a Gymnasium environment; experiments name it as `{"task": {"problem": name}}`.

    - `name`: lower-case letters, digits and hyphens. A problem of this name that was registered before is replaced.
    - `make`: a function that makes an environment, or the id of one, `"Pendulum-v1"`. Observations and actions are boxes of
      numbers. The same seed has to give the same episode.
    - `law`: a `hwasp.Law` between the controller and the environment: its commands are the controller's, its efforts are the
      components of the action, in order. Its commands need limits, `command={"torque": (-1, 1)}`. Without a law the controller
      acts by itself, and nothing is designed.
    - `state`: where the law's state is: places in the observation, or a function of environment and observation. Names of a law's
      state such as `"obs[2]"` say it by themselves.
    - `build`: a function of environment and design (an array, SI), called before each start, for worlds that the design shapes;
      `shaped_by` then names the groups of parameters that it reads. They cannot be in the graph: they are drawn once an episode.
    - `time_step`: s; the environment's `dt` where none is given, or that of its `render_fps`.
    - `horizon`: steps after which an episode is cut off; the environment's own where none is given.

    `make` may make a `gymnasium.vector.VectorEnv`, too, with `autoreset_mode=AutoresetMode.DISABLED` and a `reset_mask`, as
    Gymnasium's have them: its environments are stepped together. An iteration should have a multiple of as many episodes; an
    environment that has nothing to do is stepped all the same, and that is not counted. `build` is for single ones.

    An exception of the environment ends the training, with a checkpoint, and is raised.
    """
    maker = _maker(make)
    if law is not None and not isinstance(law, Law):
        raise TypeError(f"law is a hwasp.Law, and this is {law!r}: decorate the function with @hwasp.law(…)")
    env = maker()
    if not hasattr(env, "step"):
        raise InputError(f"make gives {env!r}, where an environment is needed: does it return the one that it makes?")
    try:
        told = _told(env, law, state, time_step, horizon)
    finally:
        env.close()
    if build is not None and told["lanes"] is not None:
        raise InputError("build is for single environments: those of a vector environment are not built one by one")
    if not isinstance(shaped_by, (list, tuple)):
        raise TypeError(f"shaped_by names groups of parameters, ['gain'] for one, and is {shaped_by!r}")
    _hwasp.register({
        "name": name, "about": about, "make": maker, "law": None if law is None else law._law,
        "build": build, "shaped_by": list(shaped_by), **told,
    })  # fmt: skip


def forget_problem(name: str) -> None:
    """Takes a problem out that was registered here. Those that come along stay."""
    _hwasp.forget(name)


def _maker(make: str | Callable[[], Any]) -> Callable[[], Any]:
    if isinstance(make, str):
        import gymnasium

        return lambda: gymnasium.make(make)
    if not callable(make):
        raise TypeError(f"make is a function that makes an environment, or the id of one, not {type(make).__name__}")
    return make


def _told(env: Any, law: Law | None, state: State | None, time_step: float | None, horizon: int | None) -> dict[str, Any]:
    import numpy as np

    lanes = getattr(env, "num_envs", None)
    if lanes is None:
        seen, acted = env.observation_space, env.action_space
    else:
        from gymnasium.vector import AutoresetMode

        seen, acted = env.single_observation_space, env.single_action_space
        if env.metadata.get("autoreset_mode") is not AutoresetMode.DISABLED:
            raise InputError(
                "this program starts the episodes of a vector environment itself: make it with "
                "autoreset_mode=gymnasium.vector.AutoresetMode.DISABLED"
            )
    for what, space in [("observations", seen), ("actions", acted)]:
        if type(space).__name__ != "Box":
            hint = "gymnasium.wrappers.FlattenObservation makes one of many" if what == "observations" else "only numbers are commands"
            raise InputError(f"{what} are {space}, where a Box is needed; {hint}")
    if acted.dtype not in (np.float32, np.float64):
        raise InputError(f"actions are of {acted.dtype}, where float32 or float64 is needed")
    count, size = int(np.prod(seen.shape)), int(np.prod(acted.shape))
    if not count or not size:
        raise InputError(f"an observation has {count} numbers and an action {size}: there has to be one of each, at least")
    low, high = acted.low.ravel().astype(float), acted.high.ravel().astype(float)
    if law is None:
        if not (np.isfinite(low).all() and np.isfinite(high).all()):
            raise InputError("actions have no finite limits: gymnasium.wrappers.RescaleAction or a law gives them some")
        names = ["action"] if size == 1 else [f"action[{i}]" for i in range(size)]
        command = list(zip(names, low.tolist(), high.tolist()))
        places = []
    else:
        if len(law.effort_names) != size:
            raise InputError(
                f"the efforts of the law are {', '.join(law.effort_names)} ({len(law.effort_names)}), and an action has {size} "
                "components: name one effort for each, in their order"
            )
        free = [name for name, limits in law.command_limits.items() if limits is None]
        if free:
            raise InputError(f"the commands {', '.join(free)} have no limits: command={{{free[0]!r}: (-1, 1)}}")
        command = [(name, float(lo), float(hi)) for name, (lo, hi) in law.command_limits.items()]  # type: ignore[misc]
        places = _places(law.state_names, state, count)
    spec = getattr(env, "spec", None)
    if horizon is None:
        horizon = getattr(spec, "max_episode_steps", None)
    if horizon is None:
        raise InputError("the environment says no max_episode_steps: give the horizon of an episode")
    if not 1 <= horizon <= MOST_STEPS:
        raise InputError(f"horizon = {horizon}; it is from 1 to {MOST_STEPS}")
    if time_step is None:
        time_step = getattr(env.unwrapped, "dt", None)
    if time_step is None:
        time_step = 1 / (getattr(env, "metadata", None) or {}).get("render_fps", 20)
    if not 0 < time_step < float("inf"):
        raise InputError(f"time_step = {time_step}; it is a time in s, more than 0")
    return {
        "observation": [(f"obs[{i}]", "") for i in range(count)], "state": state if callable(state) else None, "places": places,
        "command": command, "shape": list(acted.shape), "single": acted.dtype == np.float32,
        "limits": list(zip(low.tolist(), high.tolist())), "lanes": lanes, "horizon": int(horizon), "time_step": float(time_step),
    }  # fmt: skip


def _places(names: list[str], state: State | None, count: int) -> list[int]:
    if callable(state) or (state is None and not names):
        return []
    if state is None:
        try:
            state = [int(name.removeprefix("obs[").removesuffix("]")) for name in names]
        except ValueError:
            raise InputError(
                f"the law reads {', '.join(names)}: say where that is in the observation, state=[0, 2], or by a function"
            ) from None
    places = [int(place) for place in state]
    if len(places) != len(names):
        raise InputError(f"the law reads {len(names)} numbers, and state names {len(places)} places")
    if any(not 0 <= place < count for place in places):
        raise InputError(f"state names the places {places}, and an observation has {count} numbers, from 0 on")
    return places
