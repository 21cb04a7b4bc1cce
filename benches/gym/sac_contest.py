"""Whole trainings by SAC: the program beside Stable-Baselines3, with the same networks, batch, rates and steps, and as many threads.

    python benches/gym/sac_contest.py [--robots hopper half_cheetah] [--seeds 100 101 102] [--threads 1] [--who both] [--out FILE]

Needs the packages gymnasium[mujoco], mujoco and stable-baselines3, and the program as `cargo build --release` leaves it, or that
of --hwasp. FILE gets a line of JSON for each training; what stands there is not trained again, so that a contest that was
interrupted goes on.

`return` is the deterministic policy's of the last step, the mean of 100 whole episodes from starts that no training saw, and `curve`
that of the noisy training episodes, after every tenth of the steps. `cpu_s` is the time that processors spent on a training, `wall_s`
that of the clock, which other programs may have had a share of. Ours counts all of its process, loading and the 100 episodes included;
theirs has both left out.
"""

import argparse
import csv
import json
import pathlib
import resource
import subprocess
import tempfile
import time

from robots import HERE, ROBOTS, write

EPISODES = 100
# Seeds of their starts, of an environment of Gymnasium's.
UNSEEN = 1_000_003
POINTS = 10


def curve(ends, steps):
    """Mean return of the training episodes of each tenth, from the steps at which they ended and their returns."""
    bounds = [(steps * i // POINTS, steps * (i + 1) // POINTS) for i in range(POINTS)]
    parts = [(high, [value for at, value in ends if low < at <= high]) for low, high in bounds]
    return [(high, sum(values) / len(values)) for high, values in parts if values]


def processors(whose):
    """Seconds that processors spent so far, on this process or on those that it started."""
    used = resource.getrusage(whose)
    return used.ru_utime + used.ru_stime


def score(model, name):
    """Returns of the deterministic policy."""
    import gymnasium

    env = gymnasium.make(name)
    returns = []
    for episode in range(EPISODES):
        observation, _ = env.reset(seed=UNSEEN + episode)
        total, over = 0.0, False
        while not over:
            observation, reward, ended, cut, _ = env.step(model.predict(observation, deterministic=True)[0])
            total, over = total + float(reward), ended or cut
        returns.append(total)
    env.close()
    return sum(returns) / len(returns)


def theirs(robot, seed, steps, threads, _):
    """Stable-Baselines3 with its defaults."""
    import gymnasium
    import torch
    from stable_baselines3 import SAC
    from stable_baselines3.common.monitor import Monitor

    torch.set_num_threads(threads)
    env = Monitor(gymnasium.make(ROBOTS[robot]))
    model = SAC("MlpPolicy", env, learning_starts=10_000, device="cpu", seed=seed)
    cpu, wall = processors(resource.RUSAGE_SELF), time.perf_counter()

    def tell(*_):
        if model.num_timesteps % (steps // POINTS) == 0:
            last, spent = env.get_episode_rewards()[-10:], processors(resource.RUSAGE_SELF) - cpu
            mean = sum(last) / max(len(last), 1)
            print(f"{robot}, {model.num_timesteps:,} steps: last 10 episodes {mean:,.1f}, {spent:,.0f} s of a processor", flush=True)
        return True

    model.learn(steps, callback=tell)
    cpu, wall = processors(resource.RUSAGE_SELF) - cpu, time.perf_counter() - wall
    at, ends = 0, []
    for length, value in zip(env.get_episode_lengths(), env.get_episode_rewards()):
        at += length
        ends.append((at, value))
    env.close()
    return {"steps": steps, "return": score(model, ROBOTS[robot]), "cpu_s": cpu, "wall_s": wall, "curve": curve(ends, steps)}


def ours(robot, seed, steps, threads, program):
    """The program's command."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        path = write(robot, "sac", folder, steps)
        # No checkpoints: theirs has none.
        command = [program, "train", path, "--threads", threads, "--seed", seed, "--checkpoint-every", 86_400, "--out", folder / "run"]
        cpu = processors(resource.RUSAGE_CHILDREN)
        subprocess.run([str(word) for word in command], stdout=subprocess.DEVNULL, check=True)
        cpu = processors(resource.RUSAGE_CHILDREN) - cpu
        summary = json.loads((folder / "run" / "summary.json").read_text())
        with (folder / "run" / "metrics.csv").open() as file:
            ends = [(int(row["env_steps"]), float(row["return"])) for row in csv.DictReader(file)]
    return {"steps": summary["env_steps"], "return": summary["evaluation"]["return"]["mean"], "cpu_s": cpu, "wall_s": summary["wall_s"],
            "curve": curve(ends, steps)}


TRAININGS = {"ours": ours, "theirs": theirs}
# What tells one line from another.
KEY = ("who", "robot", "seed", "budget", "threads")


def done(path):
    """What stands in the file."""
    lines = [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []
    return {tuple(line[key] for key in KEY) for line in lines}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--robots", nargs="*", choices=ROBOTS, default=["hopper", "half_cheetah"])
    parser.add_argument("--seeds", nargs="*", type=int, default=[100, 101, 102])
    parser.add_argument("--steps", type=int, default=300_000)
    parser.add_argument("--threads", type=int, default=1, help="of each, one training at a time")
    parser.add_argument("--who", choices=[*TRAININGS, "both"], default="both")
    parser.add_argument("--hwasp", type=pathlib.Path, default=HERE.parent.parent / "target" / "release" / "hwasp")
    parser.add_argument("--out", type=pathlib.Path, default=HERE / "sac_contest.jsonl")
    options = parser.parse_args()
    who = list(TRAININGS) if options.who == "both" else [options.who]
    for key in [(one, robot, seed, options.steps, options.threads) for seed in options.seeds for robot in options.robots for one in who]:
        if key in done(options.out):
            continue
        one, *training = key
        line = json.dumps({**dict(zip(KEY, key)), **TRAININGS[one](*training, options.hwasp.resolve())})
        with options.out.open("a") as file:
            file.write(line + "\n")
        print(line, flush=True)


if __name__ == "__main__":
    main()
