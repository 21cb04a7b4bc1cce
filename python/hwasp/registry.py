"""The problems as Gymnasium environments: `make`, `make_vec`, and names for `gymnasium.make`."""

from __future__ import annotations

import importlib.abc
import importlib.util
import sys
from typing import TYPE_CHECKING

from . import _hwasp

if TYPE_CHECKING:
    from collections.abc import Sequence
    from importlib.machinery import ModuleSpec
    from types import ModuleType
    from typing import Any

    from .envs import Env, VectorEnv
    from .runs import Loadable

__all__ = ["make", "make_vec"]


def make(experiment: Loadable, **options: Any) -> Env:
    """A Gymnasium environment of an experiment: its name, its file, a dict, or an `Experiment`. Options: those of `hwasp.envs.Env`."""
    from .envs import Env

    return Env(experiment, **options)


def make_vec(experiment: Loadable, num_envs: int, **options: Any) -> VectorEnv:
    """Many of them, stepped in Rust: a `gymnasium.vector.VectorEnv`. Options: those of `hwasp.envs.VectorEnv`."""
    from .envs import VectorEnv

    return VectorEnv(experiment, num_envs, **options)


def env_id(experiment: str) -> str:
    """The name for `gymnasium.make` of an experiment that comes along: `z-grasp` is `hwasp/ZGrasp-v0`."""
    words = experiment.replace("/", "-").split("-")
    return f"hwasp/{''.join(word[:1].upper() + word[1:] for word in words)}-v0"


def register_gymnasium() -> None:
    """Lets Gymnasium know the environments: now where it is there, or as soon as somebody imports it."""
    if sys.modules.get("gymnasium") is not None:
        _register()
    else:
        sys.meta_path.insert(0, _WhenImported())


def _register() -> None:
    from gymnasium.envs.registration import register, registry

    for experiment in _hwasp.experiments():
        if env_id(experiment) not in registry:
            register(
                id=env_id(experiment),
                entry_point="hwasp.envs:Env",
                vector_entry_point="hwasp.envs:VectorEnv",
                kwargs={"experiment": experiment},
            )


class _WhenImported(importlib.abc.MetaPathFinder):
    """Waits for Gymnasium, whose import takes longer than ours. Whether it is there may be asked before."""

    _asking = False

    def find_spec(self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None) -> ModuleSpec | None:
        if name != "gymnasium" or self._asking:
            return None
        self._asking = True
        try:
            spec = importlib.util.find_spec(name)
        finally:
            self._asking = False
        if spec is not None and spec.loader is not None:
            load = spec.loader.exec_module

            def exec_module(module: ModuleType) -> None:
                load(module)
                if self in sys.meta_path:
                    sys.meta_path.remove(self)
                    _register()

            spec.loader.exec_module = exec_module  # type: ignore[method-assign]
        return spec
