"""What a person sees of a training that is under way."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

#: Seconds between two pictures of a bar.
EVERY = 0.2
#: Lines of a training where there is neither terminal nor notebook.
LINES = 20


def watcher(progress: bool, callback: Callable[[dict[str, float]], object] | None) -> _Watcher:
    """Calls `callback` with each row, and shows how far the training is."""
    if callback is not None and not callable(callback):
        raise TypeError(f"callback is a function that is called with each row, not {callback!r}")
    shows: _Terminal | _Lines | _Notebook | None = None
    if progress:
        display = _notebook()
        if display is not None:
            shows = _Notebook(display)
        elif sys.stderr is not None and sys.stderr.isatty():
            shows = _Terminal()
        else:
            shows = _Lines()
    return _Watcher(shows, callback)


class _Watcher:
    def __init__(
        self, shows: _Terminal | _Lines | _Notebook | None, callback: Callable[[dict[str, float]], object] | None
    ) -> None:
        self._shows, self._callback, self._total = shows, callback, 1

    def __call__(self, row: dict[str, Any]) -> object:
        if "total_env_steps" in row:
            self._total = max(row["total_env_steps"], 1)
            if self._shows is not None:
                self._shows.begin(f"training into {row['path']}")
            return None
        if self._shows is not None:
            self._shows.row(min(row["env_steps"] / self._total, 1.0), _words(row, self._total))
        return None if self._callback is None else self._callback(row)

    def close(self) -> None:
        if self._shows is not None:
            self._shows.close()


def _words(row: dict[str, Any], total: int) -> str:
    mean, discounted = row["return"], row["discounted_return"]
    worth = "no return" if mean != mean else f"return {mean:.1f} (discounted {discounted:.1f})"
    rate = row["env_steps"] / max(row["wall_s"], 1e-9)
    left = max(total - row["env_steps"], 0) / max(rate, 1e-9)
    known = ("iteration", "env_steps", "wall_s", "discounted_return", "return", "episodes", "episode_steps")
    others = ("noise.", "learner.", "reward.")
    totals = [f"{k} {v:.4g}" for k, v in row.items() if k not in known and not k.startswith(others)]
    return "  ".join([worth, *totals[:3], f"{rate / 1e3:.0f}k steps/s" if rate >= 1e4 else f"{rate:.0f} steps/s", f"{left:.0f} s left"])


class _Terminal:
    def __init__(self) -> None:
        self._last = 0.0

    def begin(self, text: str) -> None:
        print(text, file=sys.stderr)

    def row(self, share: float, words: str) -> None:
        now = time.monotonic()
        if now - self._last >= EVERY or share >= 1.0:
            self._last = now
            bar = "█" * round(20 * share)
            print(f"\r\x1b[2K{share:4.0%} {bar:·<20} {words}"[:110], end="", file=sys.stderr, flush=True)

    def close(self) -> None:
        print("\r\x1b[2K", end="", file=sys.stderr, flush=True)


class _Lines:
    def __init__(self) -> None:
        self._told = 0

    def begin(self, text: str) -> None:
        print(text, file=sys.stderr, flush=True)

    def row(self, share: float, words: str) -> None:
        if int(share * LINES) > self._told:
            self._told = int(share * LINES)
            print(f"{share:4.0%}  {words}", file=sys.stderr, flush=True)

    def close(self) -> None:
        pass


class _Notebook:
    def __init__(self, display: Callable[..., Any]) -> None:
        self._display, self._handle, self._last = display, None, 0.0

    def begin(self, text: str) -> None:
        self._handle = self._display({"text/plain": text}, raw=True, display_id=True)

    def row(self, share: float, words: str) -> None:
        now = time.monotonic()
        if self._handle is not None and (now - self._last >= EVERY or share >= 1.0):
            self._last = now
            page = f'<progress max="1" value="{share:.3f}"></progress> {share:.0%}&emsp;{words}'
            self._handle.update({"text/html": page, "text/plain": f"{share:.0%} {words}"}, raw=True)

    def close(self) -> None:
        pass


def _notebook() -> Callable[..., Any] | None:
    """What shows things in a notebook; None elsewhere."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    if shell is None or not hasattr(shell, "kernel"):
        return None
    from IPython.display import display

    return display
