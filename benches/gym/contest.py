"""Training by PPO, whole commands: the program beside Stable-Baselines3, with the same network, batch, epochs and steps.

    python benches/gym/contest.py [--robot half_cheetah] [--steps 100000]

Needs the packages gymnasium[mujoco], mujoco and stable-baselines3. Both train on all cores as they like best: Stable-Baselines3 with
one thread or all of torch's, the faster counts. Loading and building are left out on both sides: the clock starts after the first iteration.
"""

import argparse
import csv
import os
import subprocess
import tempfile
import time

import torch
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.env_util import make_vec_env

from robots import HERE, ROBOTS, STEPS, write


class Clock(BaseCallback):
    """When each iteration begins."""

    def __init__(self):
        super().__init__()
        self.starts = []

    def _on_rollout_start(self):
        self.starts.append(time.perf_counter())

    def _on_step(self):
        return True


def theirs(name, threads, steps):
    """Steps per second of Stable-Baselines3 with two environments, as many lanes as the program has."""
    torch.set_num_threads(threads)
    lanes = 2
    env = make_vec_env(name, n_envs=lanes, seed=0)
    network = dict(pi=[64, 64], vf=[64, 64])
    ppo = PPO("MlpPolicy", env, n_steps=STEPS["ppo"] // lanes, batch_size=64, n_epochs=10, learning_rate=3e-4, seed=0,
              policy_kwargs=dict(net_arch=network, activation_fn=torch.nn.Tanh), device="cpu")
    clock = Clock()
    ppo.learn(steps, callback=clock)
    env.close()
    # The last begin has its steps and its update after it.
    return (len(clock.starts) - 2) * STEPS["ppo"] / (clock.starts[-1] - clock.starts[1])


def ours(robot, threads, steps):
    """Steps per second of the program's command, by the clock of its metrics."""
    with tempfile.TemporaryDirectory() as folder:
        path = write(robot, "ppo", folder, steps)
        command = ["cargo", "run", "--release", "--", "train", path, "--threads", threads, "--seed", 0, "--out", f"{folder}/run"]
        subprocess.run([str(word) for word in command], cwd=HERE, capture_output=True, check=True)
        with open(f"{folder}/run/metrics.csv") as file:
            rows = list(csv.DictReader(file))
    number = lambda row, name: float(row[name])
    first, last = rows[0], rows[-1]
    return (number(last, "env_steps") - number(first, "env_steps")) / (number(last, "wall_s") - number(first, "wall_s"))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--robot", choices=ROBOTS, default="half_cheetah")
    parser.add_argument("--steps", type=int, default=100_000)
    options = parser.parse_args()
    cores = os.cpu_count()
    their_rates = {threads: theirs(ROBOTS[options.robot], threads, options.steps // 5) for threads in {1, cores}}
    our_rates = {threads: ours(options.robot, threads, options.steps) for threads in {1, cores}}
    for threads in their_rates:
        print(f"{options.robot}, {threads} threads: {our_rates[threads]:,.0f} steps/s, Stable-Baselines3 {their_rates[threads]:,.0f}")
    print(f"the faster of each: {max(our_rates.values()) / max(their_rates.values()):.1f} times")


if __name__ == "__main__":
    main()
