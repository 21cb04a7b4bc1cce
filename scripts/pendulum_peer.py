#!/usr/bin/env python3
"""Compares our pendulum with Gymnasium's Pendulum-v1, step by step. Python 3.10 or newer; needs the network.

    python3 scripts/pendulum_peer.py              # prints the largest differences; fails beyond 1e-12
    python3 scripts/pendulum_peer.py --fixture    # prints the numbers of crates/tasks/tests/pendulum/gymnasium.txt

Gymnasium is installed into a virtual environment in a temporary folder.
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PINNED = ["gymnasium==1.4.0"]
EPISODES, STEPS = 5, 200
FIXTURE_STEPS = 50
TOLERANCE = 1e-12

# Runs inside the environment: a list of episodes, each a list of [command, angle, speed, reward], with the state before
# the first step in front. The state is read from inside: observations are rounded to 32 bits.
INSIDE = """
import json, sys
import gymnasium, numpy
env = gymnasium.make("Pendulum-v1").unwrapped
random = numpy.random.default_rng(20)
episodes = []
for episode in range(int(sys.argv[1])):
    env.reset(seed=episode)
    rows = [[0.0, float(env.state[0]), float(env.state[1]), 0.0]]
    for _ in range(int(sys.argv[2])):
        # A few commands are beyond the motor's limits.
        command = float(random.uniform(-2.5, 2.5))
        reward = env.step(numpy.array([command]))[1]
        rows.append([command, float(env.state[0]), float(env.state[1]), float(reward)])
    episodes.append(rows)
print(json.dumps(episodes))
"""


def gymnasium(episodes, steps):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        python = Path(folder) / "bin" / "python"
        subprocess.run([python, "-m", "pip", "install", "--quiet", *PINNED], check=True)
        printed = subprocess.run(
            [python, "-c", INSIDE, str(episodes), str(steps)], check=True, capture_output=True, text=True
        )
    return json.loads(printed.stdout)


def ours(lines):
    """What our plant answers to each command among `lines`."""
    command = ["cargo", "run", "--quiet", "--release", "-p", "hwasp-tasks", "--example", "pendulum_trajectory"]
    text = "".join(line + "\n" for line in lines)
    printed = subprocess.run(command, cwd=ROOT, input=text, check=True, capture_output=True, text=True)
    return [[float(number) for number in line.split()] for line in printed.stdout.splitlines()]


def largest(answers, expected):
    assert len(answers) == len(expected), f"{len(answers)} answers to {len(expected)} steps"
    return max(abs(a - b) for answer, row in zip(answers, expected) for a, b in zip(answer, row[1:]))


def main():
    if sys.argv[1:] == ["--fixture"]:
        for row in gymnasium(1, FIXTURE_STEPS)[0]:
            print(*map(repr, row))
        return
    episodes = gymnasium(EPISODES, STEPS)
    expected = [row for rows in episodes for row in rows[1:]]
    # Each step from Gymnasium's own state, so that no difference can hide in another one or grow out of it.
    single = [
        line
        for rows in episodes
        for before, row in zip(rows, rows[1:])
        for line in (f"{before[1]!r} {before[2]!r}", repr(row[0]))
    ]
    # Whole episodes from Gymnasium's start.
    whole = [
        line
        for rows in episodes
        for line in [f"{rows[0][1]!r} {rows[0][2]!r}", *(repr(row[0]) for row in rows[1:])]
    ]
    steps, free = largest(ours(single), expected), largest(ours(whole), expected)
    print(f"{len(expected)} steps of {PINNED[0]}, angle (rad), speed (rad/s) and reward")
    print(f"largest difference of a step from the same state   {steps:.3g}")
    print(f"largest difference over episodes of {STEPS} steps      {free:.3g}")
    if not max(steps, free) < TOLERANCE:
        sys.exit(f"a difference of {max(steps, free):.3g} is not below {TOLERANCE}")


if __name__ == "__main__":
    main()
