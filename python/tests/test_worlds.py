"""Gymnasium's environments as problems of this program."""

import os
import threading

import hwasp
import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")

SHORT = {"train.env_steps": 4000, "train.evaluation_episodes": 4}


def experiment(problem, **settings):
    return hwasp.Experiment.load({"name": "mine", "task": {"problem": problem}}).set(SHORT).set(settings)


class Point(gymnasium.Env):
    """A point on a line, pushed; how much the push does may be the design's."""

    observation_space = gymnasium.spaces.Box(-10, 10, (2,), np.float64)
    action_space = gymnasium.spaces.Box(-1, 1, (1,), np.float32)
    metadata = {"render_fps": 20}

    def __init__(self, fails=None):
        self.fails, self.gain = fails, 1.0

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.x, self.v, self.taken = self.np_random.uniform(-1, 1), 0.0, 0
        return np.array([self.x, self.v]), {}

    def step(self, action):
        self.taken += 1
        if self.fails is not None and self.taken == 7:
            self.fails()
        self.v += 0.05 * (self.gain * float(action[0]) - 0.1 * self.v)
        self.x = float(np.clip(self.x + 0.05 * self.v, -10, 10))
        return np.array([self.x, self.v]), -self.x**2, abs(self.x) > 5, False, {}


def spring(**limits):
    @hwasp.law(
        design={"stiffness": hwasp.Parameter((0.1, 5.0), "N/m"), **limits},
        command={"push": (-1, 1)}, state=["obs[0]"], effort="force",
    )  # fmt: skip
    def law(design, command, state):
        return 0.2 * command.push - design.stiffness * state[0]

    return law


def vector(count, kind="Sync"):
    made = getattr(gymnasium.vector, f"{kind}VectorEnv")
    return made([Point] * count, autoreset_mode=gymnasium.vector.AutoresetMode.DISABLED)


@pytest.fixture(autouse=True)
def nothing_stays_registered():
    before = set(hwasp.problems())
    yield
    for name in set(hwasp.problems()) - before:
        hwasp.forget_problem(name)


def test_a_controller_alone_learns_in_it():
    hwasp.register_problem("point", Point, horizon=40)
    mine = experiment("point", **{"train.env_steps": 40_000})
    assert "is sound" in mine.check() and mine.method
    run = mine.set(method="fixed").train("run", progress=False)
    assert run.metrics["return"][-3:].mean() > run.metrics["return"][:3].mean()
    assert run.policy.commands[0][2:] == (-1, 1) and not run.design


@pytest.mark.parametrize("method", ["hwasp", "minimal", "episode", "fixed", "cmaes"])
def test_a_law_and_a_design_stand_in_front_of_it(method):
    hwasp.register_problem("sprung", Point, law=spring(), horizon=40, about="A point with a spring.")
    run = experiment("sprung", method=method, **{"train.env_steps": 12_000}).train("run", progress=False)
    assert 0.1 < run.design["stiffness"].values[0] < 5.0 and run.design["stiffness"].unit == "N/m"
    assert hwasp.Run.open("run").evaluate(3)["episodes"] == 3
    two = experiment("sprung", method=method, **{"train.env_steps": 12_000}).train("two", threads=2, progress=False)
    assert np.array_equal(run.params, two.params)


def test_a_state_may_be_computed_and_a_world_may_be_built():
    law = hwasp.law(
        design={"gain": (0.5, 2.0)}, command={"push": (-1, 1)}, state=["energy"], effort="force"
    )(lambda design, command, state: command.push - 0.1 * state.energy)
    built = []

    def build(env, design):
        env.unwrapped.gain = design[0]
        built.append(float(design[0]))

    hwasp.register_problem(
        "built", Point, law=law, horizon=40, state=lambda env, obs: [0.5 * obs[1] ** 2], build=build, shaped_by=["gain"]
    )
    run = experiment("built", method="episode").train("run", progress=False)
    assert len(set(built)) > 20 and all(0.5 <= gain <= 2.0 for gain in built)
    assert run.finished


@pytest.mark.parametrize("train", [{"episodes_per_iteration": 8}, {"episodes_per_iteration": 5, "steps_per_iteration": 300}])
@pytest.mark.parametrize(("count", "kind"), [(4, "Sync"), (3, "Sync"), (4, "Async")])
def test_a_vector_environment_gives_the_bits_of_single_ones(count, kind, train):
    asked = {"train": {"env_steps": 1500, "episode_steps": 40, "evaluation_episodes": 3, **train}, "method": "hwasp"}
    runs = []
    for name, make in [("single", Point), ("vector", lambda: vector(count, kind))]:
        hwasp.register_problem("point", make, law=spring(), horizon=40)
        experiment("point").check()
        runs.append(experiment("point", **asked).train(name, threads=2 if kind == "Sync" else 1, progress=False))
    assert np.array_equal(runs[0].params, runs[1].params) and runs[0].summary["evaluation"] == runs[1].summary["evaluation"]


def test_an_exception_in_a_vector_environment_is_raised():
    def fails():
        raise ZeroDivisionError("physics")

    make = lambda: gymnasium.vector.SyncVectorEnv(
        [Point, lambda: Point(fails)], autoreset_mode=gymnasium.vector.AutoresetMode.DISABLED
    )
    hwasp.register_problem("failing", make, horizon=40)
    with pytest.raises(ZeroDivisionError, match="physics"):
        experiment("failing").train("run", progress=False)


def test_it_is_an_environment_again():
    """Out and in again: the same numbers as the environment itself."""
    hwasp.register_problem("point", Point, horizon=40)
    env = hwasp.make(experiment("point"), scale_observations=False)
    env.reset(seed=1)
    direct = Point()
    direct.reset(seed=0)
    direct.x, direct.v = (float(x) for x in env.reset()[0])
    for action in np.linspace(-1, 1, 20, dtype=np.float32):
        one, two = env.step(np.array([action])), direct.step(np.array([action]))
        assert one[0] == pytest.approx(two[0], rel=1e-5) and one[1] == pytest.approx(two[1], rel=1e-5)


def test_its_exception_ends_the_training_and_is_raised():
    def fails():
        raise ZeroDivisionError("physics")

    hwasp.register_problem("failing", lambda: Point(fails), horizon=40)
    with pytest.raises(ZeroDivisionError, match="physics"):
        experiment("failing").train("run", progress=False)
    with pytest.raises(ZeroDivisionError, match="physics"):
        env = hwasp.make(experiment("failing"))
        env.reset(seed=0)
        for _ in range(8):
            env.step(np.zeros(1))
    hwasp.register_problem("failing", Point, horizon=40)
    assert experiment("failing").train("again", progress=False).finished


def test_an_environment_that_cannot_be_made_is_told():
    count = []

    def make():
        count.append(1)
        if len(count) > 1:
            raise OSError("no licence")
        return Point()

    hwasp.register_problem("once", make, horizon=40)
    with pytest.raises(OSError, match="no licence"):
        experiment("once").train("run", progress=False)


@pytest.mark.parametrize(
    ("make", "options", "says"),
    [
        (Point, {}, "horizon"),
        (Point, {"horizon": 0}, "from 1 to"),
        (Point, {"horizon": 40, "time_step": 0.0}, "more than 0"),
        (Point, {"horizon": 40, "time_step": float("nan")}, "more than 0"),
        (lambda: gymnasium.make_vec("Pendulum-v1", 2), {}, "AutoresetMode.DISABLED"),
        (lambda: vector(2), {"horizon": 40, "build": lambda env, design: None}, "single"),
        ("CartPole-v1", {}, "Discrete"),
        (Point, {"horizon": 40, "law": spring(), "state": [7]}, "places"),
        (Point, {"horizon": 40, "law": spring(), "state": [0, 1]}, "reads 1"),
        (Point, {"horizon": 40, "law": hwasp.law(command=["a"], effort="f")(lambda d, c, s: c.a)}, "no limits"),
        (Point, {"horizon": 40, "law": hwasp.law(command={"a": (0, 1)}, effort=["f", "g"])(lambda d, c, s: [c.a, c.a])}, "one effort for each"),
        (Point, {"horizon": 40, "law": hwasp.law(command={"a": (0, 1)}, state=["x"], effort="f")(lambda d, c, s: c.a)}, "say where"),
    ],
)
def test_what_does_not_fit_is_told(make, options, says):
    with pytest.raises(hwasp.InputError, match=says):
        hwasp.register_problem("mine", make, **options)


def test_what_was_raised_is_nobody_elses():
    """An exception that waited was raised by the next call, whatever it was."""

    def fails():
        raise ZeroDivisionError("physics")

    hwasp.register_problem("failing", lambda: Point(fails), horizon=40)
    with pytest.raises(ZeroDivisionError):
        experiment("failing").check()
    assert "is sound" in hwasp.Experiment.load("reach").check()
    hwasp.register_problem("point", Point, horizon=40)
    errors = []

    def trains():
        try:
            experiment("failing").train("failing", progress=False)
        except ZeroDivisionError as error:
            errors.append(error)

    thread = threading.Thread(target=trains)
    thread.start()
    env = hwasp.make(experiment("point"))
    for _ in range(200):
        env.reset()
    thread.join()
    assert len(errors) == 1


def test_environments_are_closed():
    opened = []

    class Closing(Point):
        def __init__(self):
            super().__init__()
            opened.append(self)

        def close(self):
            opened.remove(self)

    hwasp.register_problem("closing", Closing, horizon=40)
    experiment("closing").train("run", progress=False)
    hwasp.make_vec(experiment("closing"), 5).close()
    assert not opened


def test_names_are_checked():
    for name in ["Upper Case", "reach", ""]:
        with pytest.raises(hwasp.InputError):
            hwasp.register_problem(name, Point, horizon=40)
    with pytest.raises(TypeError):
        hwasp.register_problem("mine", 7)
    with pytest.raises(TypeError, match="groups of parameters"):
        hwasp.register_problem("mine", Point, horizon=40, shaped_by="gain")


def test_what_is_no_environment_is_told():
    class Old(Point):
        def step(self, action):
            return super().step(action)[:4]

    class Changing(Point):
        def step(self, action):
            return (np.zeros(3), *super().step(action)[1:])

    for name, make, says in [("old", Old, "terminated"), ("changing", Changing, "3 numbers")]:
        hwasp.register_problem(name, make, horizon=40)
        with pytest.raises(hwasp.InputError, match=says):
            experiment(name).train(name, progress=False)


def test_a_run_of_a_problem_that_is_not_registered_says_so():
    hwasp.register_problem("point", Point, horizon=40)
    run = experiment("point").train("run", progress=False)
    hwasp.forget_problem("point")
    with pytest.raises(hwasp.InputError, match="point"):
        hwasp.Run.open(run)


def test_pendulum_is_the_same_problem_as_natively():
    """One step after another, Gymnasium's Pendulum-v1 behind the program is Gymnasium's."""
    hwasp.register_problem("gym-pendulum", "Pendulum-v1")
    told = experiment("gym-pendulum").check()
    assert "3: obs" in told or "obs" in told
    assert "action -2" in told and os.getcwd()
