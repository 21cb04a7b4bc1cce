#!/usr/bin/env python3
"""Does what a person does on the bench, from `check` to `replay`, on the emulated one, with a hand that differs from its description.

    scripts/deploy_rehearsal.py HWASP RUN [--object INDEX] [--may-fail]

HWASP is the program, RUN a run folder of z-grasp or 3d-grasp. In real time, about a minute. Exit status 1 where a command does not end well, where
the calibration does not find what was planted, where --shadow moves anything, or where the object is not held; the last is let
pass with --may-fail.
"""

import argparse
import json
import pathlib
import pty
import os
import shlex
import subprocess
import tempfile
import tomllib

PLANTED = {"slack": 0.002, "friction": 0.02, "zero": 1.5}
SPOOL_RADIUS = 0.008


class Bench:
    """The emulated bench, and what is typed to it."""

    def __init__(self, hwasp, run, folder):
        plant = [word for name, value in PLANTED.items() for word in ("--plant", f"{name}={value}")]
        pipe = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        self.process = subprocess.Popen([hwasp, "deploy", "rehearse", run, *plant], cwd=folder, **pipe)
        self.until("quit")

    def until(self, word):
        for line in self.process.stdout:
            if word in line:
                return line
        raise SystemExit("the bench has ended")

    def order(self, line, word):
        self.process.stdin.write(f"{line}\n")
        self.process.stdin.flush()
        return self.until(word)

    def state(self):
        return json.loads(self.order("state", "{"))

    def quit(self):
        self.process.communicate("quit\n", timeout=10)
        return self.process.returncode


def do(command, folder, typed=None):
    """Runs a command of a person, who answers lines on a terminal: `typed` has what a line contains, and who says what to type."""
    print("$", shlex.join(map(str, command)), flush=True)
    mine, its = pty.openpty()
    process = subprocess.Popen(command, cwd=folder, stdin=its, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    os.close(its)
    told = []
    for line in process.stdout:
        print(line, end="", flush=True)
        told.append(line)
        for word, answer in (typed or {}).items():
            if word in line:
                os.write(mine, f"{answer()}\n".encode())
    os.close(mine)
    print(flush=True)
    if process.wait() != 0:
        raise SystemExit(f"it ended with {process.returncode}")
    return "".join(told)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("hwasp", type=pathlib.Path)
    parser.add_argument("run", type=pathlib.Path)
    parser.add_argument("--object", type=int, default=0)
    parser.add_argument("--may-fail", action="store_true", help="whether an object that is not held is let pass")
    args = parser.parse_args()
    hwasp, run = str(args.hwasp.resolve()), str(args.run.resolve())
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(hwasp, run, folder)
        rig, calibration = ["--rig", "rehearsal.toml"], pathlib.Path(folder, "rehearsal.calibration.toml")
        do([hwasp, "deploy", "check", *rig], folder)
        do([hwasp, "deploy", "calibrate", run, *rig, "--out", calibration.name], folder)
        found = tomllib.loads(calibration.read_text())
        onset = PLANTED["zero"] + PLANTED["slack"] / SPOOL_RADIUS
        off = (found["zero_rad"] - onset) * SPOOL_RADIUS
        print(f"tendons begin to pull {1e3 * off:+.2f} mm off where they do\n", flush=True)
        assert abs(off) < 5e-4, "the calibration did not find where the tendons begin to pull"
        grasp = shlex.split(bench.order(f"object {args.object}", "deploy run"))[1:]
        before = bench.state()["hand"]
        do([hwasp, *grasp, "--shadow"], folder)
        after = bench.state()["hand"]
        moved = max(abs(a - b) for a, b in zip(before["palm"], after["palm"]))
        assert moved < 1e-4 and abs(after["wound"] - before["wound"]) < 1e-4, f"--shadow moved the palm by {moved} m"
        look = lambda: "y" if bench.state()["hand"]["success"] else "n"
        told = do([hwasp, *grasp, "--log", "logs"], folder, {"press Enter": str, "does it hold": look})
        assert args.may_fail or "felt, held" in told, "the object is not held"
        do([hwasp, "deploy", "trials", "--table", "logs/trials.csv"], folder)
        (log,) = pathlib.Path(folder, "logs").glob("*.mcap")
        do([hwasp, "deploy", "replay", log], folder)
        assert bench.quit() == 0 and not pathlib.Path(folder, "rehearsal.toml").exists()
    print("all commands did what they should")


if __name__ == "__main__":
    main()
