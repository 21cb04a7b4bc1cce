"""The problems as Gymnasium environments."""

import gc
import multiprocessing
import pickle
import warnings

import hwasp
import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")
from gymnasium.utils.env_checker import check_env  # noqa: E402
from gymnasium.vector import AutoresetMode, SyncVectorEnv  # noqa: E402

SHIPPED = [name for name in hwasp.experiments() if not name.startswith("paper/")]
FAST = ["mass-spring", "reach", "pendulum", "bar-length"]


def actions(env, count, seed=0):
    """So many actions of a vector environment, or of a single one."""
    space = env.action_space
    space.seed(seed)
    return [np.where(np.isfinite(a := space.sample()), a, 0.0).astype(np.float32) for _ in range(count)]


@pytest.mark.parametrize("experiment", SHIPPED)
def test_gymnasium_finds_no_fault(experiment):
    env = hwasp.make(experiment)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of unbounded observations
        check_env(env, skip_render_check=True)
    env.close()


@pytest.mark.parametrize("experiment", SHIPPED)
def test_stable_baselines3_finds_no_fault(experiment):
    checker = pytest.importorskip("stable_baselines3.common.env_checker")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        checker.check_env(hwasp.make(experiment))


@pytest.mark.parametrize("experiment", SHIPPED)
def test_many_are_the_same_as_one_by_one(experiment):
    """Gymnasium's own vector of single environments, and ours, for one thread and for three."""
    count, steps = 6, 25
    singles = SyncVectorEnv([lambda: hwasp.make(experiment)] * count, autoreset_mode=AutoresetMode.NEXT_STEP)
    vectors = [hwasp.make_vec(experiment, count, threads=threads) for threads in (1, 3)]
    starts = [env.reset(seed=7)[0] for env in [singles, *vectors]]
    for start in starts[1:]:
        assert np.array_equal(starts[0], start)
    for action in actions(vectors[0], steps):
        wanted = singles.step(action)
        for env in vectors:
            for one, other in zip(wanted[:4], env.step(action)[:4]):
                assert np.array_equal(one, other)
    [env.close() for env in vectors]


@pytest.mark.parametrize("mode", list(AutoresetMode))
def test_autoreset_is_gymnasiums(mode):
    """Episodes of five steps, four times over; of two experiments, one of which ends by itself."""
    options = {"horizon": 5}
    singles = SyncVectorEnv([lambda: hwasp.make("hopper", **options)] * 3, autoreset_mode=mode)
    ours = hwasp.make_vec("hopper", 3, autoreset_mode=mode, threads=2, **options)
    assert ours.metadata["autoreset_mode"] is mode
    first, second = singles.reset(seed=11)[0], ours.reset(seed=11)[0]
    assert np.array_equal(first, second)
    for action in actions(ours, 20):
        wanted, given = singles.step(action), ours.step(action)
        for one, other in zip(wanted[:4], given[:4]):
            assert np.array_equal(one, other)
        assert set(given[4]) >= set(wanted[4]) - {"_kind"}
        over = wanted[2] | wanted[3]
        if mode is AutoresetMode.SAME_STEP and over.any():
            assert (given[4]["_final_obs"] == over).all()
            for i in np.flatnonzero(over):
                assert np.array_equal(given[4]["final_obs"][i], wanted[4]["final_obs"][i])
                assert not np.array_equal(given[4]["final_obs"][i], given[0][i])
        if mode is AutoresetMode.DISABLED and over.any():
            with pytest.raises(hwasp.InputError, match="is over: call reset"):
                ours.step(action)
            again = {"options": {"reset_mask": over}}
            assert np.array_equal(singles.reset(**again)[0], ours.reset(**again)[0])


def test_ids_are_registered_and_made_single_or_many():
    env = gymnasium.make("hwasp/MassSpring-v0", method="episode")
    assert env.unwrapped.experiment.method == "episode"
    env.reset(seed=0)
    env.step(env.action_space.sample())
    many = gymnasium.make_vec("hwasp/ZGrasp-v0", num_envs=2, vectorization_mode="vector_entry_point")
    assert isinstance(many, hwasp.envs.VectorEnv) and many.num_envs == 2
    many.close()


def test_where_the_design_is():
    names = {m: hwasp.make("mass-spring", method=m).action_names for m in ["minimal", "episode", "fixed", "hwasp"]}
    assert len(names["minimal"]) == len(names["episode"]) == len(names["fixed"]) + 10
    assert names["hwasp"] != names["fixed"]
    # Drawn once an episode: only the first action counts.
    env = hwasp.make("mass-spring", method="episode")
    env.reset(seed=1)
    design = []
    for action in actions(env, 4):
        env.step(action)
        design.append(env.design)
    assert design[0] == design[3]
    low_and_high = np.full((2, len(env.action_names)), [[-1.0], [1.0]], np.float32)
    for action, edge in zip(low_and_high, [1, 2]):
        env.reset()
        env.step(action)
        for name, *limits in env._episodes.parameters():
            assert env.design[name] == pytest.approx(limits[edge - 1], rel=1e-6)


def test_a_world_that_the_design_shapes_is_made_anew_for_it():
    def stepped(length):
        env = hwasp.make("hopper", method="episode")
        env.reset(seed=3)
        action = np.zeros(len(env.action_names), np.float32)
        action[env.action_names.index("shank")] = length
        return env.step(action)[0], env.design["shank"]

    (short, a), (long, b) = stepped(-1.0), stepped(1.0)
    assert a < b and not np.allclose(short, long)


def test_hardware_is_built_to_a_design():
    env = hwasp.make("reach", method="fixed")
    name, low, high = env._episodes.parameters()[0]
    seen = []
    for value in (low, high):
        env.reset(seed=2, options={"design": {name: value}})
        assert env.design == {name: value}
        seen.append(env.step(np.ones(1, np.float32))[0])
    assert not np.array_equal(*seen)
    env.reset(options={"design": [0.5 * (low + high)]})
    for wrong in [{"nothing": 1.0}, [1.0, 2.0], {name: np.nan}]:
        with pytest.raises((hwasp.InputError, ValueError)):
            env.reset(options={"design": wrong})


def test_each_environment_may_be_built_to_a_design_of_its_own():
    env = hwasp.make_vec("reach", 3, method="fixed")
    for designs in [[{"gear": 0.2}, {"gear": 0.4}, {"gear": 0.6}], np.array([[0.2], [0.4], [0.6]])]:
        env.reset(seed=0, options={"design": designs})
        assert [design["gear"] for design in env.designs] == [0.2, 0.4, 0.6]
    env.reset(options={"design": {"gear": 0.5}})
    assert env.designs == [{"gear": 0.5}] * 3
    for wrong, says in [({"gear": 5.0}, "outside of its limits, 0.1 to 2"), ([0.1, 0.2], "2 were given"), ({"gear": [1, 2]}, "2 were given")]:
        with pytest.raises(hwasp.InputError, match=says):
            env.reset(options={"design": wrong})
    with pytest.raises(hwasp.InputError, match="desing"):
        env.reset(options={"desing": {}})


def test_the_design_of_an_action_is_told():
    env = hwasp.make("reach", method="minimal")
    env.reset(seed=0)
    for action, gear in [(-1.0, 0.1), (1.0, 2.0)]:
        env.step(np.array([action, 0.0], np.float32))
        assert env.design["gear"] == pytest.approx(gear)


def test_learners_that_ask_for_pictures_go_without():
    with pytest.raises(TypeError):
        hwasp.make("reach", render_mode="rgb_array")
    assert hwasp.make_vec("reach", 2, autoreset_mode="SAME_STEP").autoreset_mode is AutoresetMode.SAME_STEP


def test_episodes_are_those_of_a_training():
    """reset(seed) and its successors are episodes 0, 1, 2 of a first iteration: others than those of another seed."""
    env = hwasp.make("mass-spring", method="fixed")
    starts = [env.reset(seed=5)[0], env.reset()[0], env.reset()[0]]
    assert not np.array_equal(starts[0], starts[1]) and not np.array_equal(starts[1], starts[2])
    again = [env.reset(seed=5)[0], env.reset()[0], env.reset()[0]]
    assert np.array_equal(starts, again)


def test_lanes_without_a_seed_have_seeds_of_their_own():
    """They started alike."""
    for seed, options in [([None] * 4, None), (None, None), (None, {"reset_mask": [True, True, True, True]})]:
        start, _ = hwasp.make_vec("mass-spring", 4).reset(seed=seed, options=options)
        assert len({tuple(row) for row in start}) == 4
    env = hwasp.make_vec("mass-spring", 4, method="fixed")
    env.reset(options={"reset_mask": [True, False, False, True], "design": {"stiffness": 3.0}})
    assert [design["stiffness[0]"] == 3.0 for design in env.designs] == [True, False, False, True]
    assert len({tuple(row) for row in env.reset(options={"reset_mask": [False, True, True, False]})[0]}) == 4


def test_scales_are_those_of_the_experiment():
    scaled, si = (hwasp.make("mass-spring", method="fixed", scale_observations=s, scale_actions=s) for s in (True, False))
    assert (scaled.action_space.high == 1).all() and not (si.action_space.high == 1).all()
    si.reset(seed=0), scaled.reset(seed=0)
    one, two = scaled.step(scaled.action_space.high), si.step(si.action_space.high)
    assert one[1] == two[1] and not np.array_equal(one[0], two[0])
    assert set(si.state) and si.dt > 0


@pytest.mark.parametrize(
    "action",
    [np.zeros(3, np.float32), np.zeros((1, 1), np.float32), np.full(1, np.nan), np.full(1, np.inf), ["a"], None, [[1], [2, 3]], "far"],
)  # fmt: skip
def test_a_wrong_action_is_an_exception(action):
    env = hwasp.make("reach", method="fixed")
    env.reset(seed=0)
    with pytest.raises((hwasp.InputError, TypeError, ValueError)):
        env.step(action)
    env.step(np.zeros(1))


def test_what_cannot_be_is_told():
    for wrong in [
        lambda: hwasp.make("reahc"),
        lambda: hwasp.make("reach", method="hwaps"),
        lambda: hwasp.make("reach", world="mars"),
        lambda: hwasp.make("reach", progress=2.0),
        lambda: hwasp.make("reach", render_mode="human"),
        lambda: hwasp.make("reach", settings={"task.goal": "5 kg"}),
        lambda: hwasp.make_vec("reach", 0),
        lambda: hwasp.make_vec("reach", 2, threads=0),
        lambda: hwasp.make_vec("reach", 2, autoreset_mode="Sometimes"),
    ]:
        with pytest.raises(ValueError):
            wrong()
    env = hwasp.make_vec("reach", 2)
    with pytest.raises(hwasp.InputError, match="has not begun"):
        env.step(np.zeros((2, 2)))
    with pytest.raises(hwasp.InputError):
        env.reset(seed=[1, 2, 3])
    env.reset(seed=[1, 1])
    env.close()
    for call in [lambda: env.step(np.zeros((2, 2))), lambda: env.reset(seed=0), lambda: env.designs]:
        with pytest.raises(hwasp.ClosedError, match="closed"):
            call()
    env.close()


def test_an_episode_that_is_over_goes_on_only_after_a_reset():
    env = hwasp.make("reach", horizon=3, method="fixed")
    env.reset(seed=0)
    ends = [env.step(np.zeros(1, np.float32))[2:4] for _ in range(3)]
    assert ends == [(False, False), (False, False), (False, True)]
    with pytest.raises(hwasp.InputError, match="is over"):
        env.step(np.zeros(1, np.float32))


def test_a_complete_experiment_is_the_same_environment():
    """One of a run kept its placement, and its environment had efforts for actions."""
    run = hwasp.Experiment.load("mass-spring").set({"train.env_steps": 20_000}).train("run", progress=False)
    assert hwasp.make(run.experiment).action_names == hwasp.make("mass-spring").action_names


def test_buffers_are_new_unless_asked_otherwise():
    for copy in (True, False):
        env = hwasp.make_vec("reach", 2, copy=copy)
        env.reset(seed=0)
        one, two = (env.step(np.zeros((2, 2), np.float32)) for _ in range(2))
        assert (one[0] is two[0]) != copy and (one[1] is two[1]) != copy


def test_an_episode_tells_what_came_of_it():
    env = hwasp.make("z-grasp", horizon=4)
    env.reset(seed=0)
    for _ in range(4):
        *_, over, info = env.step(np.zeros(len(env.action_names), np.float32))
    assert over and info["is_success"] is False and info["kind"]
    hopper = hwasp.make("hopper")
    hopper.reset(seed=0)
    over = False
    while not over:
        *_, terminated, truncated, info = hopper.step(hopper.action_space.high)
        over = terminated or truncated
    assert set(info["terms"])


def test_an_environment_is_pickled_as_it_was_asked_for():
    env = hwasp.make("hopper", method="episode", world="deployment", scale_actions=False)
    again = pickle.loads(pickle.dumps(env))
    assert np.array_equal(env.reset(seed=4)[0], again.reset(seed=4)[0])
    action = env.action_space.sample()
    assert np.array_equal(env.step(action)[0], again.step(action)[0])


def _stepped(seed, queue):
    env = hwasp.make_vec("reach", 16, threads=2)
    env.reset(seed=seed)
    queue.put(env.step(np.zeros((16, 2), np.float32))[0])


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_other_processes_have_environments_of_their_own(method):
    env = hwasp.make_vec("reach", 16, threads=2)
    env.reset(seed=3)
    wanted = env.step(np.zeros((16, 2), np.float32))[0]
    context = multiprocessing.get_context(method)
    queue = context.Queue()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a fork of a process with threads
        process = context.Process(target=_stepped, args=(3, queue))
        process.start()
    given = queue.get(timeout=60)
    process.join(60)
    assert process.exitcode == 0 and np.array_equal(given, wanted)


def _goes_on(env, queue):
    queue.put(env.step(np.zeros((16, 2), np.float32))[0])
    env.close()


def test_an_environment_goes_on_after_a_fork():
    env = hwasp.make_vec("reach", 16, threads=2)
    env.reset(seed=3)
    env.step(np.zeros((16, 2), np.float32))
    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        process = context.Process(target=_goes_on, args=(env, queue))
        process.start()
    given = queue.get(timeout=60)
    process.join(60)
    assert process.exitcode == 0 and np.array_equal(given, env.step(np.zeros((16, 2), np.float32))[0])


def _memory():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * 4096


def test_a_thousand_constructions_and_many_steps_leave_no_memory_behind():
    def work(count):
        for _ in range(count):
            env = hwasp.make_vec("reach", 4, threads=1)
            env.reset(seed=0)
            env.step(np.zeros((4, 2), np.float32))
            env.close()

    work(100)
    gc.collect()
    before = _memory()
    work(1000)
    env = hwasp.make_vec("reach", 64, threads=1, horizon=20)
    env.reset(seed=0)
    action = np.zeros((64, 2), np.float32)
    for _ in range(16_000):  # a million steps
        env.step(action)
    env.close()
    gc.collect()
    assert _memory() - before < 8 << 20
