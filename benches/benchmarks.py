#!/usr/bin/env python3
"""Repeats the comparisons of docs/benchmarks.md by `hwasp compare`, and prints their tables.

    python3 benches/benchmarks.py                      # all of them: some hours on two cores
    python3 benches/benchmarks.py springs pendulum     # some
    python3 benches/benchmarks.py --quick              # two seeds of a few thousand steps each, to see that it runs

A comparison that was stopped goes on. Those of Gymnasium's robots need the packages gymnasium[mujoco] and mujoco; without them they are
left out and named.
"""
import argparse
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE / "gym"))


def designed(name):
    """The experiment of one of Gymnasium's robots whose body is designed; none without its package."""
    def write(folder):
        try:
            import robots
        except ImportError:
            return None
        return robots.write_designed(name, folder)
    return write


# By name: experiment, methods, steps.
COMPARISONS = {
    "springs": ("mass-spring-td3", "hwasp,minimal", 20_000),
    "springs-longer": ("mass-spring-td3", "hwasp,minimal", 40_000),
    "bar": ("bar-length-td3", "hwasp,minimal", 100_000),
    "pendulum": ("pendulum-sac", "fixed", 20_000),
    "cheetah-legs": (designed("half_cheetah_legs"), "hwasp,fixed", 150_000),
    "walker-lengths": (designed("walker2d_lengths"), "hwasp,fixed", 150_000),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help="comparisons: " + ", ".join(COMPARISONS))
    parser.add_argument("--quick", action="store_true", help="two seeds of 3,000 steps, to see that it runs")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("runs/benchmarks"), help="where the folders go")
    parser.add_argument("--hwasp", nargs="+", default=["cargo", "run", "--release", "--quiet", "--"], help="the program")
    asked = parser.parse_args()
    unknown = [name for name in asked.names if name not in COMPARISONS]
    if unknown:
        parser.error(f"there is no comparison {unknown[0]!r}; there are {', '.join(COMPARISONS)}")
    for name in asked.names or COMPARISONS:
        experiment, methods, steps = COMPARISONS[name]
        folder = asked.out / (f"{name}-quick" if asked.quick else name)
        if callable(experiment):
            (asked.out / "models").mkdir(parents=True, exist_ok=True)
            experiment = experiment(asked.out / "models")
        if experiment is None:
            print(f"{name} is left out: it needs the packages gymnasium[mujoco] and mujoco", flush=True)
            continue
        seeds, steps = (2, 3_000) if asked.quick else (5, steps)
        command = [*asked.hwasp, "compare", experiment, "--methods", methods, "--seeds", seeds, "--env-steps", steps, "--out", folder]
        subprocess.run([str(word) for word in command], check=True)


if __name__ == "__main__":
    main()
