"""Laws in Python are the same programs as laws in text."""

import copy
import math

import hwasp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st


def of_one(function):
    """The law y = function(x), as a function of plain numbers."""
    law = hwasp.law(command=["x"], effort="y")(lambda design, command, state: function(command.x))
    return lambda x: float(law.effort([], [x])[0])


@pytest.mark.parametrize("name", ["sin", "cos", "tan", "tanh", "exp", "arctan", "sqrt", "log", "sign", "arcsin", "arccos"])
def test_functions_of_the_package_and_of_numpy_agree(name):
    ours, theirs = of_one(getattr(hwasp, name)), of_one(getattr(np, name))
    for x in [0.1, 0.37, 0.9]:
        assert ours(x) == theirs(x)
        assert ours(x) == pytest.approx(float(getattr(np, name)(x)), rel=1e-14)
        assert getattr(hwasp, name)(x) == ours(x)


@pytest.mark.parametrize(
    "function",
    [
        lambda x: 2 * x + x / 3 - (1 - x) * -x,
        lambda x: x**3 - x**2 + x**-1 + x**0.5,
        lambda x: abs(-x) + (+x),
        lambda x: np.maximum(x, 0.5) + np.minimum(0.25, x) + np.square(x) + np.hypot(x, 2.0),
        lambda x: x.clip(0.2, 0.4) + np.clip(x, 0.1, 0.3),
        lambda x: 2.0**x,
        lambda x: np.arctan2(x, -0.3),
    ],
)
def test_a_law_computes_what_python_computes(function):
    for x in [0.15, 0.35, 0.8]:
        assert of_one(function)(x) == pytest.approx(float(function(np.float64(x))), rel=1e-13)


def test_arrays_of_traced_numbers_are_arrays():
    @hwasp.law(
        design={"k": hwasp.Parameter((1, 9), "N/m", count=3)}, command=["a", "b"], state=["x", "y"], effort=["f", "g"]
    )
    def law(design, command, state):
        matrix = np.array([[1.0, 2.0], [3.0, 4.0]])
        turned = matrix @ np.array([state.x, state.y], object) + np.array([0.5, -0.5]) * command[0]
        return turned * np.sum(design.k) + np.sin(np.array([command.a, command.b], object))

    design, command, state = np.array([1.0, 2.0, 4.0]), np.array([0.3, -0.4]), np.array([0.7, 0.1])
    wanted = (np.array([[1.0, 2.0], [3.0, 4.0]]) @ state + np.array([0.5, -0.5]) * 0.3) * 7.0 + np.sin(command)
    assert law.effort(design, command, state) == pytest.approx(wanted, rel=1e-13)
    assert law.effort({"k": [1, 2, 4]}, [command] * 2, [state] * 2).shape == (2, 2)
    with pytest.raises(ValueError, match="k"):
        law.effort({"q": 1.0}, command, state)


def test_derivatives_pass_and_the_way_back_sums_over_rows():
    @hwasp.law(design={"k": (1, 9), "rest": (-1, 1)}, command=["u"], state=["x", "v"], effort=["f", "g"])
    def law(design, command, state):
        pull = command.u * hwasp.tanh(design.k) - design.k * (state.x - design.rest)
        return {"g": pull * state.v, "f": hwasp.where(state.x < 0, pull, 2 * pull)}

    rng = np.random.default_rng(0)
    design, command, state = [2.0, 0.3], rng.normal(size=(5, 1)), rng.normal(size=(5, 2))
    assert law.gradcheck(design, command, state) < 1e-6
    cotangent = rng.normal(size=(5, 2))
    by_design, by_command, by_state = law.vjp(design, command, state, cotangent)
    rows = [law.vjp(design, command[i], state[i], cotangent[i]) for i in range(5)]
    assert by_design == pytest.approx(sum(row[0] for row in rows))
    assert by_command.shape == (5, 1) and by_state[3] == pytest.approx(rows[3][2])


def test_what_a_law_must_not_do_is_told():
    def tracing(function):
        return hwasp.law(command=["x"], state=["y"], effort="f")(function)

    with pytest.raises(TypeError, match="hwasp.where"):
        tracing(lambda d, c, s: c.x if c.x > 0 else 0.0)
    with pytest.raises(TypeError, match="hwasp.sin"):
        tracing(lambda d, c, s: math.sin(c.x))
    with pytest.raises(TypeError, match="floor"):
        tracing(lambda d, c, s: np.floor(c.x))
    with pytest.raises(AttributeError, match="there is no `z` here; there are x"):
        tracing(lambda d, c, s: c.z)
    with pytest.raises(TypeError, match="str"):
        tracing(lambda d, c, s: c.x + "1 N")
    with pytest.raises(hwasp.InputError, match="2 efforts, and names 1"):
        tracing(lambda d, c, s: [c.x, s.y])
    with pytest.raises(TypeError, match="no number"):
        tracing(lambda d, c, s: [None])
    kept = []
    tracing(lambda d, c, s: kept.append(c.x) or c.x)
    with pytest.raises(ValueError, match="two laws"):
        tracing(lambda d, c, s: c.x + kept[0])
    with pytest.raises(hwasp.InputError, match=r"the limits \[3, 1\]"):
        hwasp.law(design={"k": (3, 1)}, command=["x"], effort="f")(lambda d, c, s: c.x)
    with pytest.raises(hwasp.InputError, match="`furlong` is no unit"):
        hwasp.law(design={"k": hwasp.Parameter((1, 3), "furlong")}, command=["x"], effort="f")(lambda d, c, s: c.x)


def test_equality_is_a_number_too_and_arrays_come_from_either_side():
    @hwasp.law(command=["x", "y"], effort=["f", "g", "h"])
    def law(design, command, state):
        x, y = command
        array = np.array([1.0, 2.0])
        return [(x == y) + 2 * (x != y), np.sum(x < array) + np.sum(array >= x), np.sum(y**array)]

    assert law.effort([], [1.5, 1.5]).tolist() == [1.0, 2.0, 1.5 + 1.5**2]
    assert law.effort([], [1.5, 3.0])[0] == 2.0 and law([], [1.5, 3.0])[0] == 2.0
    with pytest.raises(hwasp.InputError, match="no exponent"):
        of_one(lambda x: x ** float("inf"))


def test_names_and_limits_of_a_law_are_checked():
    for names in [{"command": ["u", "u"], "effort": "f"}, {"command": ["u"], "effort": ["f", "f"]}, {"command": ["u"], "state": ["u"], "effort": "f"},
                  {"command": {"u": (1, -1)}, "effort": "f"}]:  # fmt: skip
        with pytest.raises(ValueError, match="called|interval"):
            hwasp.law(**names)(lambda d, c, s: [c[0]] * len(names["effort"]))
    law = hwasp.law(command=["u"], effort="f")(lambda d, c, s: copy.deepcopy(2.0) * c.u)
    with pytest.raises(hwasp.InputError, match="a row at least"):
        law.gradcheck([], np.zeros((0, 1)))


def test_a_group_of_parameters_goes_into_a_model_one_by_one():
    @hwasp.law(
        design={"k": hwasp.Parameter((1, 9), "N*m/rad", count=2)}, command=["shoulder"], state=["joint.shoulder.pos"], effort="shoulder"
    )
    def law(design, command, state):
        return command.shoulder - design.k[0] * state[0] - design.k[1] * state[0] ** 3

    arm = hwasp.Experiment.load("balanced-arm").set(law.settings()).set({"task.design.stiffness": {"limits": ["1 N/m", "2 N/m"]}})
    assert {"k_0", "k_1"} < set(arm.to_dict()["task"]["design"])


def test_the_library_of_laws_is_there():
    assert hwasp.formula("torsion_spring(a0, 2 N*m/rad, 0.1 rad)", 0.6) == pytest.approx(-1.0)
    spring = of_one(lambda x: hwasp.formula("torsion_spring(a0, 2 N*m/rad, 0.1 rad)", x))
    assert spring(0.6) == pytest.approx(-1.0)
    with pytest.raises(hwasp.InputError, match="sni"):
        hwasp.formula("sni(a0)", 1.0)


def test_a_law_of_an_experiment_from_a_model_is_the_same_as_text():
    @hwasp.law(
        design={"stiffness": hwasp.Parameter((100, 1000), "N/m")},
        command=["shoulder"], state=["joint.shoulder.pos"], effort="shoulder",
    )  # fmt: skip
    def spring(design, command, state):
        return command.shoulder - design.stiffness * 0.1 * 0.1 * np.sin(state["joint.shoulder.pos"])

    short = {"train.env_steps": 4000, "train.evaluation_episodes": 5}
    arm = hwasp.Experiment.load("balanced-arm").set(short)
    by_text = arm.set({"task.law": {"joint.shoulder": "command.shoulder - stiffness * 0.1 m * 0.1 m * sin(joint.shoulder.pos)"}})
    by_python = arm.set(spring.settings())
    assert "si(stiffness)" in str(by_python) and "is sound" in by_python.check()
    one, two = (e.train(out, progress=False) for e, out in [(by_text, "text"), (by_python, "python")])
    assert np.array_equal(one.params, two.params)
    assert (one.path / "policy.safetensors").read_bytes() == (two.path / "policy.safetensors").read_bytes()


@settings(max_examples=60, deadline=None)
@given(st.lists(st.sampled_from("+ - * / sin tanh min max abs neg where sq".split()), max_size=30), st.integers(0, 2**32))
def test_any_chain_of_operations_is_what_plain_numbers_give(operations, seed):
    rng = np.random.default_rng(seed)
    constants = rng.normal(size=len(operations)).tolist()

    def chain(x, y):
        for operation, c in zip(operations, constants):
            x, y = y, {
                "+": lambda: x + c * y, "-": lambda: c - x, "*": lambda: x * y, "/": lambda: x / (2 + abs(y)),
                "sin": lambda: hwasp.sin(x), "tanh": lambda: hwasp.tanh(y), "min": lambda: hwasp.minimum(x, y),
                "max": lambda: hwasp.maximum(x, c), "abs": lambda: abs(x), "neg": lambda: -y,
                "where": lambda: hwasp.where(x < y, x, c), "sq": lambda: hwasp.tanh(x) ** 2,
            }[operation]()  # fmt: skip
        return x + 2 * y

    # Plain floats are computed by the same formulas, one at a time.
    law = hwasp.law(command=["x", "y"], effort="f")(lambda d, c, s: chain(c.x, c.y))
    x, y = rng.normal(size=2).tolist()
    compare = {True: 1.0, False: 0.0}
    plain = chain(_Plain(x, compare), _Plain(y, compare))
    assert law.effort([], [x, y])[0] == pytest.approx(float(plain), rel=1e-12, abs=1e-12)


class _Plain(float):
    """A float whose comparisons are numbers, as a law's are."""

    def __new__(cls, value, _=None):
        return super().__new__(cls, value)

    def __lt__(self, other):
        return 1.0 if float(self) < float(other) else 0.0
