#!/usr/bin/env python3
"""Kills trainings at random moments and resumes them, until they are done; then compares them with twins that nobody killed.

    cargo build --release
    python3 scripts/kills.py runs/kills                          # 100 kills of mass-spring trainings, 10 of z-grasp: 15 min
    python3 scripts/kills.py runs/kills --kills 9 --grasp-kills 0

Python 3.9 or newer, nothing else. Ends with status 1 if a run has other bits than its twin, or lost more time than it should.
"""
import argparse
import random
import shutil
import subprocess
import sys
import time
from pathlib import Path

PROGRAM = Path(__file__).resolve().parent.parent / "target" / "release" / "hwasp"
# Experiment and its arguments, seconds between checkpoints, what an iteration and the writing may add to that on a loaded
# machine, and the longest life of a process, s.
TOYS = [
    (["mass-spring"], 0.2, 2.0, 1.5),
    (["mass-spring", "--method", "cmaes"], 0.2, 2.0, 1.5),
    (["mass-spring", "--method", "cmaes-rl"], 0.2, 2.0, 1.5),
]
GRASPS = [(["z-grasp", "--env-steps", "400000", "--set", "train.evaluation_episodes=40"], 3.0, 15.0, 20.0)]


def start(arguments, every, threads):
    command = [PROGRAM, "train", *arguments, "--quiet", "--checkpoint-every", str(every), "--threads", str(threads)]
    return subprocess.Popen([str(word) for word in command])


def newest(run):
    """When its newest checkpoint was written; 0 if there is none."""
    files = list((run / "checkpoints").glob("iteration-*.safetensors"))
    return max((file.stat().st_mtime for file in files), default=0.0)


def results(run):
    """The bits of a result: everything but the time it took."""
    rows = [line.split(",") for line in (run / "metrics.csv").read_text().splitlines()]
    untimed = [row[:2] + row[3:] for row in rows]
    return [(run / name).read_bytes() for name in ("policy.safetensors", "design.toml", "experiment.toml")], untimed


def survive(arguments, every, longest, run, draw):
    """Trains into a folder under fire; returns how often it was killed, and the longest time that a kill cost."""
    kills, lost, begun = 0, 0.0, False
    while True:
        what = ["--resume", run] if begun else [*arguments, "--out", run]
        process, started = start(what, every, draw.choice([1, 2])), time.time()
        try:
            code = process.wait(timeout=draw.uniform(0.0, longest))
            if code != 0:
                sys.exit(f"{run}: the program ended with status {code} after {kills} kills")
            return kills, lost
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        kills += 1
        # Before its first checkpoint a process has nothing to lose but its own time.
        lost = max(lost, time.time() - max(newest(run), started))
        begun = (run / "experiment.toml").exists()
        if run.exists() and not begun:
            shutil.rmtree(run)


def campaign(root, cases, wanted, draw):
    """Kills until there were as many as wanted. Returns kills, runs, runs with other bits, and whether time was lost."""
    kills, runs, differing, late = 0, 0, 0, False
    while kills < wanted:
        arguments, every, slack, longest = cases[runs % len(cases)]
        name = "-".join(word for word in arguments if not word.startswith("--") and "=" not in word)
        seed = runs // len(cases)
        arguments = [*arguments, "--seed", str(seed)]
        twin, run = root / f"{name}-{seed}-twin", root / f"{name}-{seed}"
        if not (twin / "summary.json").exists() and start([*arguments, "--out", twin], 30, 2).wait() != 0:
            sys.exit(f"{twin}: the training failed")
        shutil.rmtree(run, ignore_errors=True)
        count, lost = survive(arguments, every, longest, run, draw)
        same = results(run) == results(twin)
        kills, runs, differing, late = kills + count, runs + 1, differing + (not same), late or lost > every + slack
        verdict = "the same bits" if same else "OTHER BITS"
        print(f"{run.name}: {count} kills, at most {lost:.1f} s lost, {verdict}", flush=True)
    return kills, runs, differing, late


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--kills", type=int, default=100, help="of mass-spring trainings: PPO, CMA-ES, cmaes-rl")
    parser.add_argument("--grasp-kills", type=int, default=10, help="of z-grasp trainings: PPO")
    parser.add_argument("--seed", type=int, default=0, help="of the moments")
    asked = parser.parse_args()
    asked.folder.mkdir(parents=True, exist_ok=True)
    draw, wrong = random.Random(asked.seed), False
    for title, cases, wanted in [("mass-spring", TOYS, asked.kills), ("z-grasp", GRASPS, asked.grasp_kills)]:
        kills, runs, differing, late = campaign(asked.folder, cases, wanted, draw)
        print(f"{title}: {kills} kills over {runs} runs, {differing} with other bits than their twins")
        wrong = wrong or differing > 0 or late
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
