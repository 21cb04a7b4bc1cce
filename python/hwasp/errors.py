"""Exceptions: a small family, with the texts of the program."""


class HwaspError(Exception):
    """Anything that goes wrong in hwasp."""


class InputError(HwaspError, ValueError):
    """What was asked for is wrong: an experiment, a setting, a shape, a path. Nothing was begun, and nothing was changed."""


class RunError(HwaspError, RuntimeError):
    """Something failed on the way: physics, a disk. The run folder has what it takes to go on."""


class ClosedError(HwaspError, RuntimeError):
    """An environment that was closed is asked to go on."""
