"""Learners and worlds of both sides, crosswise: Stable-Baselines3's PPO on our problems, and our PPO on Gymnasium's environments in
Python beside the same ones natively.

    python benches/python/learning.py theirs --problems z-grasp hopper --steps 1000000 --out curves.jsonl
    python benches/python/learning.py ours --seeds 100 101 102 --out ours.jsonl

Needs the packages hwasp, gymnasium[mujoco], mujoco and, for the first, stable-baselines3.
"""

import argparse
import json
import pathlib
import sys
import tempfile
import time

import hwasp

sys.path.append(str(pathlib.Path(__file__).parents[1] / "gym"))
from robots import write


def theirs(problem, method, steps, seed, lanes):
    """Returns and successes of the training episodes of Stable-Baselines3's PPO, a point each twentieth of the steps."""
    import numpy as np
    import torch
    from stable_baselines3 import PPO
    from stable_baselines3.common.callbacks import BaseCallback
    from stable_baselines3.common.env_util import make_vec_env

    torch.set_num_threads(1)
    env = make_vec_env(lambda: hwasp.make(problem, method=method), n_envs=lanes, seed=seed)
    points, began = [], time.perf_counter()

    class Curve(BaseCallback):
        ended = []

        def _on_step(self):
            for info in self.locals["infos"]:
                if "episode" in info:
                    self.ended.append((info["episode"]["r"], info.get("is_success", np.nan)))
            if self.num_timesteps * 20 >= (len(points) + 1) * steps and self.ended:
                returns, successes = np.array(self.ended, float).T
                points.append((self.num_timesteps, round(returns.mean(), 2), round(float(np.mean(successes)), 3)))
                self.ended.clear()
                print(problem, *points[-1], flush=True)
            return True

    PPO("MlpPolicy", env, n_steps=2048 // lanes * 4, batch_size=256, n_epochs=10, seed=seed, device="cpu").learn(steps, callback=Curve())
    return {"problem": problem, "method": method, "seed": seed, "seconds": round(time.perf_counter() - began), "curve": points}


def pendulum():
    """The pendulum of the program with its settings, and Gymnasium's behind them."""
    native = hwasp.Experiment.load("pendulum")
    table = native.to_dict()
    table["task"] = {"problem": "bench-pendulum"}
    for gone in ["design"]:
        table.pop(gone)
    table["noise"] = {"command": table["noise"]["command"]}
    hwasp.register_problem("bench-pendulum", "Pendulum-v1")
    return native, hwasp.Experiment.load(table)


def hopper(folder):
    """Hopper-v5 as an experiment of a model, and as Gymnasium's environment, with the same learner."""
    native = hwasp.Experiment.load(write("hopper", "ppo", folder))
    table = native.to_dict()
    table["task"] = {"problem": "bench-hopper"}
    table["noise"] = {"command": table["noise"]["command"]}
    table.pop("design", None)
    hwasp.register_problem("bench-hopper", "Hopper-v5")
    return native, hwasp.Experiment.load(table)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("who", choices=["theirs", "ours"])
    parser.add_argument("--problems", nargs="*", default=["z-grasp", "hopper"])
    parser.add_argument("--method", default="minimal")
    parser.add_argument("--steps", type=int, default=1_000_000)
    parser.add_argument("--seeds", nargs="*", type=int, default=[100])
    parser.add_argument("--worlds", nargs="*", choices=["pendulum", "hopper"], default=["pendulum", "hopper"])
    parser.add_argument("--lanes", type=int, default=8)
    parser.add_argument("--out", type=pathlib.Path, required=True, help="a file that gets a line of JSON for each training")
    options = parser.parse_args()

    def keep(line):
        with options.out.open("a") as file:
            file.write(json.dumps(line) + "\n")

    if options.who == "theirs":
        for problem in options.problems:
            for seed in options.seeds:
                keep(theirs(problem, options.method, options.steps, seed, options.lanes))
        return
    with tempfile.TemporaryDirectory() as folder:
        worlds = {"pendulum": pendulum, "hopper": lambda: hopper(folder)}
        for world in options.worlds:
            native, python = worlds[world]()
            for seed in options.seeds:
                for name, experiment in [("native", native), ("python", python)]:
                    run = experiment.train(f"{folder}/{world}-{name}-{seed}", seed=seed, progress=False)
                    value = run.summary["evaluation"]["return"]
                    keep({"world": world, "as": name, "seed": seed, "return": value, "seconds": round(run.summary["wall_s"], 1)})
                    print(world, name, seed, value, flush=True)


if __name__ == "__main__":
    main()
