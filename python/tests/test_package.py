"""What is in the package, and how it lives beside others."""

import os
import subprocess
import sys
import time

import hwasp
import pytest


def python(code, **options):
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, **options)


def test_it_has_a_version_names_and_docs():
    assert hwasp.__version__.count(".") == 2
    assert "mass-spring" in hwasp.experiments() and "model" in hwasp.problems()
    for name in hwasp.__all__:
        assert getattr(hwasp, name) is not None
        assert name.startswith("__") or (getattr(hwasp, name).__doc__ or "").strip(), name


def test_its_import_takes_less_than_a_tenth_of_a_second_and_brings_nothing_heavy():
    code = "import sys, time; began = time.perf_counter(); import hwasp; took = time.perf_counter() - began\nprint(took, *sys.modules)"
    times = []
    for _ in range(5):
        took, *modules = python(code).stdout.split()
        times.append(float(took))
    assert min(times) < 0.1
    assert not {"numpy", "gymnasium", "torch", "pandas", "IPython"} & set(modules)


@pytest.mark.parametrize("order", ["import hwasp, gymnasium", "import gymnasium, hwasp", "import hwasp, importlib.util; importlib.util.find_spec('gymnasium'); import gymnasium"])
def test_gymnasium_knows_it_in_either_order(order):
    pytest.importorskip("gymnasium")
    assert python(f"{order}\nprint(gymnasium.make('hwasp/Reach-v0').reset(seed=0)[0])").returncode == 0


def test_the_command_is_the_program():
    def command(*words):
        return subprocess.run([sys.executable, "-m", "hwasp", *words], capture_output=True, text=True)

    assert command("--version").stdout.split() == ["hwasp", hwasp.__version__]
    assert "Usage: hwasp" in command("--help").stdout
    wrong = command("train", "raech")
    assert wrong.returncode == 2 and "did you mean `reach`" in wrong.stderr
    assert command("list").returncode == 0


def test_another_version_of_the_engine_lives_in_the_same_process():
    mujoco = pytest.importorskip("mujoco")
    model = "<mujoco><worldbody><body><joint type='slide'/><geom size='.1' mass='1'/></body></worldbody></mujoco>"

    def fall():
        data = mujoco.MjData(mujoco.MjModel.from_xml_string(model))
        for _ in range(50):
            mujoco.mj_step(data.model if hasattr(data, "model") else None, data)
        return data.qpos.copy()

    try:
        before = fall()
    except TypeError:
        pytest.skip("this mujoco keeps no model in its data")
    env = hwasp.make("hopper")
    first, _ = env.reset(seed=0)
    env.step(env.action_space.high)
    assert (fall() == before).all() and (env.reset(seed=0)[0] == first).all()


def test_an_abort_of_the_engine_is_none_of_ours():
    """Text that no model could be made of is an exception."""
    with open("robot.xml", "w") as file:
        file.write("<mujoco><worldbody><body><geom size='-1'/></body></worldbody></mujoco>")
    with pytest.raises(hwasp.InputError, match="robot.xml"):
        hwasp.Experiment.load({"name": "mine", "task": {"problem": "model", "model": "robot.xml"}}).check()


def test_a_training_leaves_signals_as_they_were():
    code = """
import hwasp, signal, os
hwasp.Experiment.load("reach").set({"train.env_steps": 4000}).train("run", progress=False)
try:
    os.kill(os.getpid(), signal.SIGINT)
    import time; time.sleep(5)
except KeyboardInterrupt:
    print("interrupted")
"""
    assert python(code).stdout.strip() == "interrupted"


def test_a_process_that_ends_while_it_trains_does_not_hang():
    code = """
import hwasp, threading, time, os
threading.Thread(target=lambda: hwasp.Experiment.load("mass-spring").train("run", progress=False), daemon=True).start()
time.sleep(1.0)
"""
    began = time.monotonic()
    python(code, timeout=60)
    assert time.monotonic() - began < 30 and os.path.isdir("run")
