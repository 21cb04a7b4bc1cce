"""What trainings on Gymnasium's robots come to in a million steps, beside Tianshou's published benchmark.

    python benches/gym/learning.py [--algorithm ppo] [--robots hopper reacher] [--seeds 100 101 102 103 104]

Needs the packages gymnasium[mujoco] and mujoco. Tianshou's figures are means of ten seeds, each point of the curve ten episodes, and
of the curve's points up to a million steps the best; `their way` is the same here. `at the end` is the deterministic policy of the
last step on 100 starts of its own: nothing was chosen.
"""

import argparse
import json
import pathlib
import statistics
import subprocess
import tempfile

from robots import HERE, LEARNER, ROBOTS, write

# https://tianshou.org, benchmark of MuJoCo: v3 and v2 of the robots, mean and deviation of ten seeds.
TIANSHOU = {
    "ppo": {"half_cheetah": (5784, 1244), "hopper": (2609, 701), "reacher": (-4.1, 0.3), "inverted_double_pendulum": (9231, 270)},
    "trpo": {"half_cheetah": (4471, 805), "hopper": (2046, 1038), "reacher": (-5.1, 0.8), "inverted_double_pendulum": (8435, 1073)},
}
EVERY, EPISODES = 30_000, 10


def spread(values):
    return statistics.mean(values), statistics.stdev(values) if len(values) > 1 else 0.0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--algorithm", choices=LEARNER, default="ppo")
    parser.add_argument("--robots", nargs="*", choices=ROBOTS, default=list(ROBOTS))
    parser.add_argument("--seeds", nargs="*", type=int, default=[100, 101, 102, 103, 104])
    parser.add_argument("--out", type=pathlib.Path, help="a file that the curves are added to, a line of JSON for each training")
    options = parser.parse_args()
    example = ["cargo", "run", "--release", "-p", "hwasp-builtin", "--example", "robot_learning", "--"]
    with tempfile.TemporaryDirectory() as folder:
        for robot in options.robots:
            path = write(robot, options.algorithm, folder)
            command = example + [str(word) for word in [path, EVERY, EPISODES, *options.seeds]]
            output = subprocess.run(command, cwd=HERE, capture_output=True, text=True, check=True).stdout
            lines = [json.loads(line) for line in output.splitlines()]
            if options.out:
                with options.out.open("a") as file:
                    file.writelines(json.dumps({"robot": robot, "algorithm": options.algorithm, **line}) + "\n" for line in lines)
            points = [spread(values) for values in zip(*([value for _, value in line["curve"]] for line in lines))]
            theirs = "{:.6g} ± {:.4g}".format(*TIANSHOU[options.algorithm][robot])
            best, end = ("{:.6g} ± {:.4g}".format(*pair) for pair in (max(points), spread([line["final"] for line in lines])))
            print(f"{robot}, {options.algorithm}, {len(lines)} seeds: their way {best}, at the end {end}; Tianshou {theirs}", flush=True)


if __name__ == "__main__":
    main()
