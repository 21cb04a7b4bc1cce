"""Experiments and runs: the same bits as the command, and errors that say what to do."""

import json
import os
import pickle
import signal
import subprocess
import sys
import threading
import time

import hwasp
import numpy as np
import pytest

SHORT = {"train.env_steps": 20_000, "train.evaluation_episodes": 20}


def reach(**settings):
    return hwasp.Experiment.load("reach").set(SHORT).set(settings)


def test_an_experiment_is_a_name_a_file_a_dict_or_another_one(tmp_path):
    by_name = hwasp.Experiment.load("reach")
    (tmp_path / "mine.toml").write_text(str(by_name))
    assert str(hwasp.Experiment.load(tmp_path / "mine.toml")) == str(by_name)
    assert str(hwasp.Experiment.load("mine.toml")) == str(by_name)
    assert str(hwasp.Experiment.load(by_name.to_dict())) == str(by_name)
    assert str(hwasp.Experiment.load(by_name)) == str(by_name)
    assert str(pickle.loads(pickle.dumps(by_name))) == str(by_name)
    small = hwasp.Experiment.load({"name": "small", "task": {"problem": "reach"}, "train": {"env_steps": np.int64(5000)}})
    assert (small.name, small.method, small.seed) == ("small", "hwasp", 0)
    assert "reach" in repr(by_name) and "hwasp" in repr(by_name)


def test_set_gives_another_one():
    first = hwasp.Experiment.load("reach")
    other = first.set({"task.goal": "30 cm", "controller.hidden": [8, 8]}, seed=3, method="minimal")
    assert (first.seed, other.seed, other.method) == (0, 3, "minimal")
    assert other.to_dict()["controller"]["hidden"] == [8, 8]
    assert first.to_dict()["task"]["goal"] != other.to_dict()["task"]["goal"]


@pytest.mark.parametrize(
    ("experiment", "says"),
    [
        (lambda: hwasp.Experiment.load("raech"), "did you mean `reach`"),
        (lambda: hwasp.Experiment.load("nowhere.toml"), "cannot be read"),
        (lambda: hwasp.Experiment.load({"task": {"problem": "reach"}}).name, "name is missing"),
        (lambda: hwasp.Experiment.load("reach").set({"ppo.clip_ration": 0.1}).check(), "clip_ratio"),
        (lambda: hwasp.Experiment.load("reach").set({"ppo.clip_ratio": 7}).check(), "clip_ratio"),
        (lambda: hwasp.Experiment.load("reach").set(method="hwaps").check(), "hwasp"),
        (lambda: hwasp.Experiment.load("reach").set(seed=2**70), "64 bits"),
        (lambda: reach().train(threads=0), "threads"),
        (lambda: reach().train(checkpoint_every=-1), "checkpoint_every"),
        (lambda: hwasp.Run.open("nowhere"), "does not exist"),
        (lambda: hwasp.compare("reach", ["hwaps"]), "hwasp"),
        (lambda: hwasp.compare("reach", [], seeds=1), "nothing to compare"),
    ],
)
def test_what_is_wrong_is_told_before_anything_begins(experiment, says):
    with pytest.raises(hwasp.InputError, match=says) as told:
        experiment()
    assert isinstance(told.value, ValueError) and not str(told.value).startswith("error")
    assert not os.path.exists("runs")


@pytest.mark.parametrize("value", [None, object(), {1: 2}, {"a": {"b": None}}])
def test_a_setting_of_another_type_is_refused(value):
    with pytest.raises(TypeError):
        hwasp.Experiment.load("reach").set({"train": value})


def test_another_method_is_not_half_set():
    """A complete experiment kept the placement of its old method, without a word."""
    complete = hwasp.Experiment.load(hwasp.Experiment.load("mass-spring").to_dict())
    with pytest.raises(hwasp.InputError, match='design.placement = "graph"'):
        complete.set(method="minimal")
    with pytest.raises(hwasp.InputError, match="alike"):
        hwasp.compare(complete, ["hwasp", "minimal"])
    both = complete.set({"method": "minimal", "design.placement": "action"})
    assert both.to_dict()["design"]["placement"] == "action"


def test_check_tells_what_is_in_it():
    told = hwasp.Experiment.load("reach").check()
    assert "is sound" in told and "gear" in told and repr(told) == str(told)


def test_python_and_the_command_give_the_same_bits():
    run = reach().train("python", seed=4, threads=2, progress=False)
    words = ["train", "reach", "--seed", "4", "--out", "command", "--quiet"]
    words += [f"--set={key}={value}" for key, value in SHORT.items()]
    subprocess.run([sys.executable, "-m", "hwasp", *words], check=True)
    command = hwasp.Run.open("command")
    assert np.array_equal(run.params, command.params)
    for file in ["policy.safetensors", "design.toml", "experiment.toml"]:
        assert (run.path / file).read_bytes() == (command.path / file).read_bytes()
    clock = {"wall_s", "steps_per_s"}
    assert {k: v for k, v in run.summary.items() if k not in clock} == {
        k: v for k, v in command.summary.items() if k not in clock
    }


def test_a_run_has_design_curve_policy_and_figures():
    run = reach().train("run", progress=False)
    [gear] = run.design.values()
    assert gear.unit == "" and gear.limits[0] < gear.values[0] < gear.limits[1] and "gear" in repr(run)
    metrics = run.metrics
    assert (metrics["episodes"] > 0).all() and (metrics["episode_steps"] > 0).all() and (metrics["noise.command"] > 0).all()
    assert metrics["env_steps"][-1] == run.summary["env_steps"] and len(metrics["return"]) == len(metrics["learner.kl"])
    assert list(metrics.to_pandas().columns) == list(metrics)
    assert run.finished and (run.path / "experiment.toml").read_text().endswith(str(run.experiment))
    evaluated = run.evaluate()
    assert evaluated == run.summary["evaluation"]
    assert run.evaluate(7, seed=1, threads=2)["episodes"] == 7
    with pytest.raises(hwasp.InputError, match="episodes"):
        run.evaluate(0)
    assert run.evaluate(3, settings={"task.goal": "40 cm"}, threads=1024)["return"] != run.evaluate(3)["return"]
    with pytest.raises(hwasp.InputError, match="threads"):
        run.evaluate(3, threads=1025)
    assert np.array_equal(pickle.loads(pickle.dumps(run)).params, run.params)
    with pytest.raises(hwasp.InputError, match="gear|another machine|law"):
        run.evaluate(settings={"controller.hidden": [3]})
    files = run.export("exported", ["safetensors", "onnx"])
    assert files and all(file.is_file() for file in files)
    with pytest.raises(hwasp.InputError, match="nothing that can be exported"):
        run.export(kinds="gold")
    assert run.report().read_text().startswith("<!") and "iframe" in run._repr_html_()
    assert hwasp.Run.open(run).path == run.path


def test_a_policy_takes_one_observation_or_many():
    run = reach().train("run", progress=False)
    policy = run.policy
    seen = np.linspace(-1, 1, 7).reshape(7, 1)
    commands = policy(seen)
    assert commands.shape == (7, 1) and policy(seen[3]).shape == (1,) and policy([0.0]).dtype == np.float64
    assert np.array_equal(policy(seen[3]), commands[3])
    (_, _, low, high), = policy.commands
    assert (commands >= low).all() and (commands <= high).all()
    for wrong in [[1.0, 2.0], np.zeros((2, 3)), np.zeros((1, 1, 1)), np.nan, [np.inf], "far", None, [[None]]]:
        with pytest.raises((hwasp.InputError, TypeError)):
            policy(wrong)
    weights = policy.state_dict()
    assert sum(array.size for array in weights.values()) == run.params.size
    torch = pytest.importorskip("torch")
    same = policy.to_torch()(torch.from_numpy(seen).float()).detach().numpy()
    assert same == pytest.approx(commands, abs=1e-5)


def test_a_callback_hears_each_iteration_and_stops_the_training():
    rows = []
    run = reach().train("all", progress=False, callback=rows.append)
    assert len(rows) == len(run.metrics["return"])
    assert [row["return"] for row in rows] == run.metrics["return"].tolist()
    stopped = reach().train("part", progress=False, callback=lambda row: row["iteration"] < 2)
    assert not stopped.finished and "not finished" in repr(stopped)
    assert stopped.design and stopped.policy([0.0]).shape == (1,)
    resumed = stopped.resume(progress=False)
    assert resumed.finished and np.array_equal(resumed.params, run.params)
    with pytest.raises(hwasp.InputError, match="finished|came to its end|evaluates it"):
        resumed.resume(progress=False)


def test_a_callback_stops_at_once_and_has_to_be_one():
    run = reach().train("run", progress=False, callback=lambda row: False)
    assert len(run.metrics["return"]) == 1
    with pytest.raises(TypeError, match="callback"):
        reach().train("other", callback=3)
    assert not os.path.exists("other") and hwasp.Run("run").path == run.path and hwasp.Experiment("reach").seed == 0


def test_an_exception_of_a_callback_is_raised_and_nothing_is_lost():
    def callback(row):
        if row["iteration"] == 3:
            raise ZeroDivisionError("mine")

    with pytest.raises(ZeroDivisionError, match="mine"):
        reach().train("run", progress=False, callback=callback)
    resumed = hwasp.Run.open("run").resume(progress=False)
    assert np.array_equal(resumed.params, reach().train("whole", progress=False).params)


def test_ctrl_c_keeps_a_checkpoint():
    def interrupt(row):
        if row["iteration"] == 2:
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        reach(**{"train.env_steps": 2_000_000}).train("run", progress=False, callback=interrupt)
    run = hwasp.Run.open("run")
    assert not run.finished and run.design


def test_ctrl_c_does_not_wait_for_an_evaluation():
    run = reach().train("run", progress=False)
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        run.evaluate(3_000_000)
    assert time.monotonic() - began < 2.0


def test_trainings_of_two_threads_do_not_meet():
    runs, errors = {}, []

    def work(i):
        try:
            runs[i] = reach().train(f"run{i}", seed=i, progress=False)
        except Exception as error:  # noqa: BLE001
            errors.append(error)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(3)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert not errors
    assert np.array_equal(runs[1].params, reach().train("alone", seed=1, progress=False).params)


def test_a_training_begins_with_what_another_one_learned():
    first = reach().train("first", progress=False)
    further = reach(**{"train.env_steps": 4000}).train("second", begin_with=first, progress=False)
    assert further.finished
    with pytest.raises(hwasp.InputError, match="does not exist"):
        reach().train("third", begin_with="nowhere", progress=False)


def test_a_folder_that_is_there_is_not_touched():
    run = reach().train("run", progress=False)
    before = (run.path / "summary.json").read_bytes()
    with pytest.raises(hwasp.InputError, match="exists|is there"):
        reach().train("run", progress=False)
    assert (run.path / "summary.json").read_bytes() == before


def test_a_comparison_is_a_table_and_figures():
    experiment = hwasp.Experiment.load("reach").set(SHORT)
    compared = hwasp.compare(experiment, ["hwasp", "fixed"], seeds=2, out="compared", threads=2)
    assert "hwasp" in compared.table and "fixed" in repr(compared) and compared._repr_markdown_()
    assert json.dumps(compared.figures)
    again = hwasp.compare(experiment, ["hwasp", "fixed"], seeds=2, out="compared", threads=1)
    assert again.table == compared.table


def test_tensorboard_and_warnings_go_where_python_looks(caplog):
    run = reach(**{"train.env_steps": 4000}).train("run", tensorboard=True, progress=False)
    assert list((run.path / "tensorboard").iterdir())
    damaged = run.path / "tensorboard"
    assert damaged.is_dir()
    stopped = reach().train("part", progress=False, callback=lambda row: False)
    with caplog.at_level("WARNING", logger="hwasp"):
        stopped.policy  # noqa: B018
    assert any("did not come to its end" in record.message for record in caplog.records)


def test_progress_is_shown_as_lines_where_there_is_no_terminal(capsys):
    reach().train("run")
    told = capsys.readouterr().err.splitlines()
    assert told[0].startswith("training into run") and "return" in told[-1] and "(discounted" in told[-1] and 10 < len(told) < 30
