"""Steps per second of Gymnasium's vector environments, of the program on the same robots, and of the bare engine.

    python benches/gym/speed.py        (needs the packages gymnasium[mujoco] and mujoco, the latter of the engine's release)
"""

import argparse
import json
import pathlib
import shutil
import subprocess
import tempfile
import time

import gymnasium

from robots import HERE, ROBOTS


def vector(name, kind, environments, steps):
    """Steps per second of all environments together."""
    env = gymnasium.make_vec(name, num_envs=environments, vectorization_mode=kind)
    env.reset(seed=0)
    env.action_space.seed(0)
    actions = [env.action_space.sample() for _ in range(64)]
    began = time.perf_counter()
    for number in range(steps // environments):
        env.step(actions[number % len(actions)])
    rate = steps / (time.perf_counter() - began)
    env.close()
    return rate


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=20_000)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        gym = {}
        for robot, name in ROBOTS.items():
            model = pathlib.Path(gymnasium.make(name).unwrapped.fullpath)
            shutil.copy(model, folder / model.name)
            shutil.copy(HERE / f"{robot}.toml", folder)
            kinds = [("sync", 1), ("sync", 8), ("async", 2), ("async", 8)]
            gym[robot] = {f"{kind} {count}": vector(name, kind, count, options.steps) for kind, count in kinds}
        command = ["cargo", "run", "--release", "-p", "hwasp-builtin", "--example", "robot_throughput", "--", str(folder)]
        output = subprocess.run(command, cwd=HERE, capture_output=True, text=True, check=True).stdout
    for ours in json.loads(output.splitlines()[-1]):
        robot, one, all_cores = ours["robot"], ours["steps_per_s"], ours["all_cores_steps_per_s"]
        kind, best = max(gym[robot].items(), key=lambda item: item[1])
        print(f"{robot}: {one:,.0f} steps/s on one thread, {one / ours['bare_steps_per_s']:.3f} of the bare engine, {all_cores:,.0f} on "
              f"all cores; Gymnasium's fastest ({kind}) {best:,.0f}: {one / best:.1f} and {all_cores / best:.1f} times")


if __name__ == "__main__":
    main()
