"""What the Python package costs: the native vector environment beside the program's own rollouts and beside Gymnasium's vector
environments, and what a Python environment costs in episodes of ours beside its own steps.

    python benches/python/speed.py [--steps 60000] [--robots hopper half_cheetah]

Needs the packages hwasp, gymnasium[mujoco] and mujoco. All of a robot is measured in turns, five times; medians count, and ratios
are of figures of one turn.
"""

import argparse
import pathlib
import statistics
import sys
import tempfile
import time

import gymnasium
import hwasp
import numpy as np

sys.path.append(str(pathlib.Path(__file__).parents[1] / "gym"))
from robots import HERE, ROBOTS, copy_model

TURNS, LANES = 5, 64
# Of the range of an action.
NOISE = 0.3


def experiment(robot, folder):
    copy_model(ROBOTS[robot], folder)
    path = pathlib.Path(folder) / f"{robot}.toml"
    path.write_text((HERE / f"{robot}.toml").read_text() + "\n[train]\nevaluation_episodes = 1\n")
    return hwasp.Experiment.load(path)


def stepped(env, steps):
    """Steps per second of a vector environment under the actions that an untrained controller of ours takes: noise."""
    env.reset(seed=0)
    chance, shape = np.random.default_rng(0), env.action_space.shape
    half = env.action_space.high
    actions = [np.clip(2 * NOISE * half * chance.standard_normal(shape), -half, half).astype(np.float32) for _ in range(256)]
    count = max(steps // env.num_envs, 1)
    began = time.perf_counter()
    for i in range(count):
        env.step(actions[i % 256])
    rate = count * env.num_envs / (time.perf_counter() - began)
    env.close()
    return rate


def rollouts(mine, steps, folder, threads):
    """Steps per second of the program's own: a random controller, in one iteration of many episodes; the update apart."""
    short = {"method": "fixed", "controller.hidden": [1], "controller.output_gain": 0.01, "noise.command": NOISE,
             "train.steps_per_iteration": steps, "train.episodes_per_iteration": LANES,
             "train.env_steps": 2 * steps, "learner.algorithm": "ppo", "ppo.epochs": 1, "ppo.minibatch_rows": steps, "baseline.epochs": 1,
             "baseline.hidden": [1], "baseline.minibatch_rows": steps}
    run = mine.set(short).train(tempfile.mkdtemp(dir=folder), threads=threads, progress=False)
    return 2 * steps / run.summary["wall_s"]


def python_cost(name, steps):
    """Time of an environment's steps and starts alone, and in episodes of an untrained controller of ours: µs a step."""
    env = gymnasium.make(name)
    low, high = env.action_space.low, env.action_space.high
    hwasp.register_problem("bench", name)
    short = {"method": "fixed", "controller.hidden": [1], "train.env_steps": 20_000, "train.evaluation_episodes": 1}
    mine = hwasp.Experiment.load({"name": "bench", "task": {"problem": "bench"}}).set(short)
    with tempfile.TemporaryDirectory() as folder:
        run = mine.train(f"{folder}/run", progress=False)
        policy = run.policy
        # Like actions on both sides: others have other contacts.
        seen, _ = env.reset(seed=0)
        constant = np.clip(policy(seen), low, high).astype(env.action_space.dtype)
        began, taken = time.perf_counter(), 0
        while taken < steps:
            env.reset(seed=taken)
            over = False
            while not over:
                *_, terminated, truncated, _ = env.step(constant.copy())
                over, taken = terminated or truncated, taken + 1
        alone = (time.perf_counter() - began) / taken
        # None of these environments ends before its time.
        length = run.experiment.to_dict()["task"]["horizon"]
        took = []
        # As many environments are made for both, and the difference is steps and starts alone.
        for episodes in (32, 32 + max(steps // length, 1)):
            began = time.perf_counter()
            run.evaluate(episodes)
            took.append(time.perf_counter() - began)
        ours = (took[1] - took[0]) / (max(steps // length, 1) * length)
    return 1e6 * alone, 1e6 * ours


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=60_000)
    parser.add_argument("--robots", nargs="*", choices=ROBOTS, default=["hopper", "half_cheetah"])
    options = parser.parse_args()
    steps = options.steps
    middle = lambda rows, i: statistics.median(row[i] for row in rows)
    with tempfile.TemporaryDirectory() as folder:
        for robot in options.robots:
            mine, name, rows = experiment(robot, folder), ROBOTS[robot], []
            for _ in range(TURNS):
                native = {t: stepped(hwasp.make_vec(mine, LANES, threads=t), steps) for t in (1, 2)}
                own = {t: rollouts(mine, steps, folder, t) for t in (1, 2)}
                theirs = {}
                for kind, count in [("sync", 1), ("sync", 64), ("async", 2), ("async", 8), ("async", 64)]:
                    theirs[f"{kind} {count}"] = stepped(gymnasium.make_vec(name, num_envs=count, vectorization_mode=kind), steps // 4)
                best = max(theirs, key=theirs.get)
                rows.append((native[1], native[2], own[1], own[2], native[1] / own[1], native[2] / own[2], theirs[best],
                             max(native.values()) / theirs[best], best))
            print(f"{robot}: {LANES} environments {middle(rows, 0):,.0f} and {middle(rows, 1):,.0f} steps/s on 1 and 2 threads; the program's "
                  f"rollouts {middle(rows, 2):,.0f} and {middle(rows, 3):,.0f}: {middle(rows, 4):.2f} and {middle(rows, 5):.2f} of them; "
                  f"Gymnasium's fastest ({rows[-1][8]}) {middle(rows, 6):,.0f}: {middle(rows, 7):.1f} times", flush=True)
    for name in ["Pendulum-v1", "HalfCheetah-v5"]:
        rows = [python_cost(name, steps) for _ in range(TURNS)]
        ratio = statistics.median(ours / alone for alone, ours in rows)
        print(f"{name} in Python: a step {middle(rows, 0):.1f} µs, in episodes of ours {middle(rows, 1):.1f} µs: {ratio:.3f} times", flush=True)


if __name__ == "__main__":
    main()
