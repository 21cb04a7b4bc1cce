"""Steps Gymnasium's robots at random and lets the program repeat it: observations, rewards and ends have to be the same.

    python benches/gym/parity.py        (needs the packages gymnasium[mujoco] and mujoco, the latter of the engine's release)
"""

import argparse
import pathlib
import shutil
import subprocess
import sys
import tempfile

import gymnasium
import mujoco
import numpy as np

from robots import HERE, ROBOTS


def numbers(values):
    """Numbers with all of their digits."""
    return " ".join(repr(float(value)) for value in np.asarray(values).ravel())


def write(name, steps, seed, path):
    """Random steps of a robot: the state of every start, then actions and what came of them."""
    env = gymnasium.make(name).unwrapped
    env.action_space.seed(seed)
    # In double precision: of actions in single precision Gymnasium would sum the squares in that, too.
    actions = [env.action_space.sample().astype(np.float64) for _ in range(steps)]
    with path.open("w") as file:
        started = False
        for number, action in enumerate(actions):
            if not started:
                env.reset(seed=seed + number)
                file.write(f"start {numbers(env.data.qpos)} | {numbers(env.data.qvel)}\n")
                started = True
            observation, reward, terminated, _, _ = env.step(action)
            file.write(f"step {numbers(action)} | {numbers(observation)} | {numbers(reward)} | {int(terminated)}\n")
            started = not terminated
    return pathlib.Path(env.fullpath)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    print(f"Gymnasium {gymnasium.__version__}, MuJoCo {mujoco.__version__}")
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for robot, name in ROBOTS.items():
            model = write(name, options.steps, options.seed, folder / f"{robot}.txt")
            shutil.copy(model, folder / model.name)
            shutil.copy(HERE / f"{robot}.toml", folder)
        command = ["cargo", "run", "--release", "-p", "hwasp-builtin", "--example", "gym_parity", "--", str(folder)]
        sys.exit(subprocess.run(command, cwd=HERE).returncode)


if __name__ == "__main__":
    main()
