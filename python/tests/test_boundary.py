"""Whatever comes from Python is taken, or refused by an exception: never an abort."""

import hwasp
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

gymnasium = pytest.importorskip("gymnasium")

# Of ours, of Python's, of Gymnasium's and of numpy's, which here warns by an exception that it drops imaginary parts.
REFUSED = (hwasp.HwaspError, TypeError, ValueError, OverflowError, gymnasium.error.Error, np.exceptions.ComplexWarning)
FUZZED = settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))

scalars = st.one_of(
    st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=12), st.binary(max_size=4), st.just(object())
)
keys = st.one_of(st.sampled_from(["name", "method", "seed", "task", "train", "ppo", "problem", "env_steps", "task.goal"]), st.text(max_size=8))
values = st.recursive(
    st.one_of(scalars, st.just("reach"), st.just("hwasp")),
    lambda inner: st.one_of(st.lists(inner, max_size=4), st.dictionaries(keys, inner, max_size=4)),
    max_leaves=12,
)
arrays = hnp.arrays(
    dtype=st.sampled_from([np.float32, np.float64, np.int64, np.uint8, np.bool_, np.complex128, object, "U3", "datetime64[s]"]),
    shape=hnp.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=5),
)


def refused_or_done(work):
    try:
        work()
    except REFUSED:
        pass


@FUZZED
@given(st.dictionaries(keys, values, max_size=6))
def test_any_dict_is_an_experiment_or_refused(table):
    refused_or_done(lambda: hwasp.Experiment.load(table).check() and None)


@FUZZED
@given(st.one_of(values, arrays))
def test_anything_may_be_loaded_opened_and_registered(value):
    refused_or_done(lambda: hwasp.Experiment.load(value).name)
    if not isinstance(value, int):  # a number is an open file, for Python's paths
        refused_or_done(lambda: hwasp.Run.open(value))
    refused_or_done(lambda: hwasp.make(value))
    refused_or_done(lambda: hwasp.register_problem(value, value))


@FUZZED
@given(keys, values)
def test_any_setting_is_taken_or_refused(key, value):
    refused_or_done(lambda: str(hwasp.Experiment.load("reach").set({key: value})))


@pytest.fixture(scope="module")
def steps():
    single, many = hwasp.make("reach"), hwasp.make_vec("reach", 3, threads=2)
    single.reset(seed=0), many.reset(seed=0)

    def call(action):
        refused_or_done(lambda: single.step(action))
        refused_or_done(lambda: many.step(action))
        # They go on as if nothing had been.
        single.reset(seed=0)
        assert np.isfinite(single.step(np.zeros(2))[0]).all() and np.isfinite(many.step(np.zeros((3, 2)))[0]).all()

    return call


@FUZZED
@given(action=st.one_of(arrays, values))
def test_any_action_is_taken_or_refused(steps, action):
    steps(action)


@FUZZED
@given(action=arrays, order=st.sampled_from(["C", "F"]), step=st.sampled_from([1, -1, 2]))
def test_any_layout_of_an_array_is_read_right(steps, action, order, step):
    steps(np.asarray(action, order=order)[..., ::step] if action.ndim else action)


def test_strided_and_transposed_actions_are_the_same():
    one, two = (hwasp.make_vec("mass-spring", 4, threads=1) for _ in range(2))
    one.reset(seed=0), two.reset(seed=0)
    for dtype in (np.float32, np.float64, np.float16):
        action = np.random.default_rng(0).uniform(-1, 1, (4, len(one.action_names))).astype(dtype)
        strange = np.asfortranarray(np.repeat(action, 2, axis=1))[:, ::2]
        for a, b in zip(one.step(action)[:4], two.step(strange)[:4]):
            assert np.array_equal(a, b)


@FUZZED
@given(options=values, seed=st.one_of(st.none(), st.integers(-(2**70), 2**70), st.floats(), st.text(max_size=3)))
def test_any_reset_is_taken_or_refused(options, seed):
    env = hwasp.make("reach", method="fixed")
    refused_or_done(lambda: env.reset(seed=seed, options=options if isinstance(options, dict) else None))
    refused_or_done(lambda: env.reset(options={"design": options}))
    many = hwasp.make_vec("reach", 2, threads=1)
    refused_or_done(lambda: many.reset(seed=seed, options={"reset_mask": options}))
    assert env.reset(seed=1)[0].shape == (1,) and many.reset(seed=1)[0].shape == (2, 1)


@FUZZED
@given(design=values, command=st.one_of(arrays, values), state=st.one_of(arrays, values))
def test_any_input_of_a_law_is_taken_or_refused(design, command, state):
    law = hwasp.law(design={"k": (1, 2)}, command=["u"], state=["x"], effort="f")(lambda d, c, s: c.u - d.k * s.x)
    refused_or_done(lambda: law.effort(design, command, state))
    refused_or_done(lambda: law.effort([1.5], command, state))
    refused_or_done(lambda: law.vjp([1.5], command, state, command))


@FUZZED
@given(text=st.text(max_size=30), operand=values)
def test_any_formula_is_taken_or_refused(text, operand):
    refused_or_done(lambda: hwasp.formula(text, operand))
    refused_or_done(lambda: hwasp.formula(f"a0 {text} a0", 1.0))


@FUZZED
@given(
    design=st.dictionaries(st.text(max_size=4), st.one_of(values, st.tuples(st.floats(), st.floats())), max_size=3),
    command=values,
    effort=values,
    gives=values,
)
def test_any_law_is_traced_or_refused(design, command, effort, gives):
    refused_or_done(lambda: hwasp.law(design=design, command=command, effort=effort)(lambda d, c, s: gives))
