#!/usr/bin/env python3
"""Trains every case of docs/results.md and prints its tables. Python 3.9 or newer, nothing else.

    cargo build --release
    python3 scripts/results.py runs/results            # the tuned experiments: 8 cases, 5 seeds each
    python3 scripts/results.py runs/results paper      # the authors' settings against the curves of their code

A run that is there already is not trained again.
"""
import csv
import json
import subprocess
import sys
from pathlib import Path

PROGRAM = Path(__file__).resolve().parent.parent / "target" / "release" / "hwasp"
CASES = ["mass-spring", "mass-spring-50", "bar-length", "bar-length-50"]
METHODS = ["hwasp", "minimal"]
# Trailing means of the discounted return over the seeds of the authors' own code, at real steps; lowest and highest.
REFERENCE = {
    ("paper/mass-spring", "hwasp"): {0.5e6: (-904, -672), 1e6: (-632, -569), 2e6: (-579, -543), 4e6: (-560, -517)},
    ("paper/mass-spring", "minimal"): {0.5e6: (-832, -632), 1e6: (-694, -528), 2e6: (-598, -513), 4e6: (-499, -481)},
    ("paper/bar-length", "hwasp"): {0.5e6: (-958, -797), 1e6: (-676, -534), 2e6: (-344, -332), 4e6: (-314, -294)},
    ("paper/bar-length", "minimal"): {0.5e6: (-774, -740), 1e6: (-556, -487), 2e6: (-313, -257), 4e6: (-206, -199)},
}
WIDENED = 0.15


def train(root, experiment, method, seed):
    """The folder of a finished run."""
    folder = root / f"{experiment.replace('/', '-')}-{method}-seed{seed}"
    if not (folder / "summary.json").exists():
        command = [PROGRAM, "train", experiment, "--method", method, "--seed", str(seed), "--out", folder, "--quiet"]
        subprocess.run(command, check=True)
    return folder


def interquartile_mean(values):
    ordered = sorted(values)
    cut = len(ordered) // 4
    kept = ordered[cut : len(ordered) - cut]
    return sum(kept) / len(kept)


def trailing(folder, steps, window=11):
    """The mean discounted return of the iterations that end at `steps`."""
    with open(folder / "metrics.csv") as file:
        rows = [row for row in csv.DictReader(file) if int(row["env_steps"]) <= steps]
    recent = [float(row["discounted_return"]) for row in rows[-window:]]
    return sum(recent) / len(recent)


def tuned(root):
    print("| experiment | method | evaluation, interquartile mean | per seed | design total as built | steps/s |")
    print("|---|---|---|---|---|---|")
    for experiment in CASES:
        for method in METHODS:
            runs = [json.loads((train(root, experiment, method, seed) / "summary.json").read_text()) for seed in range(5)]
            returns = [run["evaluation"]["discounted_return"]["mean"] for run in runs]
            (group,) = runs[0]["design"]
            totals = [run["design"][group]["total_as_built"] for run in runs]
            speed = min(run["steps_per_s"] for run in runs) / 1e3
            digits = 2 if group == "stiffness" else 4
            print(
                f"| {experiment} | {method} | {interquartile_mean(returns):.1f} "
                f"| {', '.join(f'{r:.1f}' for r in returns)} "
                f"| {', '.join(f'{t:.{digits}f}' for t in totals)} {runs[0]['design'][group]['unit']} "
                f"| at least {speed:.0f}k |"
            )


def paper(root):
    print("| experiment | method | steps | ours, mean of 4 seeds | authors' code, seeds | widened by 15 % | inside |")
    print("|---|---|---|---|---|---|---|")
    for (experiment, method), marks in REFERENCE.items():
        folders = [train(root, experiment, method, seed) for seed in range(4)]
        for steps, (low, high) in marks.items():
            ours = sum(trailing(folder, steps) for folder in folders) / len(folders)
            wide = (low * (1 + WIDENED), high * (1 - WIDENED))
            inside = "yes" if wide[0] <= ours <= wide[1] else "no"
            print(
                f"| {experiment} | {method} | {steps / 1e6:g}M | {ours:.0f} | {low} … {high} "
                f"| {wide[0]:.0f} … {wide[1]:.0f} | {inside} |"
            )


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3) or len(sys.argv) == 3 and sys.argv[2] != "paper":
        sys.exit(__doc__)
    out = Path(sys.argv[1])
    (paper if len(sys.argv) == 3 else tuned)(out)
