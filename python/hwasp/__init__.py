"""Design a robot's body and its controller together, at the speed of the program `hwasp`.

    import hwasp

    run = hwasp.Experiment.load("mass-spring").train()
    print(run.design)

- Experiments and runs: `Experiment`, `Run`, `Policy`, `compare`.
- Its problems in Gymnasium: `make`, `make_vec`, and `gymnasium.make("hwasp/ZGrasp-v0")`.
- Gymnasium's environments in it, with a law and a design in front: `register_problem`.
- Laws of the hardware, written in Python: `law`, `Parameter`, `sin`, `where` and the like.

Everything is in SI units: m, kg, s, N, rad. Errors are `hwasp.HwaspError` and its kinds.
"""

from . import functions, laws
from ._hwasp import __version__, experiments, problems
from .errors import ClosedError, HwaspError, InputError, RunError
from .runs import Comparison, Experiment, Run, compare
from .functions import *  # noqa: F403 - the functions of laws, by name
from .laws import Law, Parameter, law
from .policy import Policy
from .registry import make, make_vec, register_gymnasium as _register_gymnasium
from .worlds import forget_problem, register_problem

__all__ = [
    "ClosedError",
    "Comparison",
    "Experiment",
    "HwaspError",
    "InputError",
    "Law",
    "Parameter",
    "Policy",
    "Run",
    "RunError",
    "__version__",
    "compare",
    "experiments",
    "forget_problem",
    "functions",
    "law",
    "laws",
    "make",
    "make_vec",
    "problems",
    "register_problem",
    *functions.__all__,
]

_register_gymnasium()
