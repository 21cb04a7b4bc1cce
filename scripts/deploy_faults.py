#!/usr/bin/env python3
"""Orders faults of the emulated arm and motor in dry runs, and looks whether each ends in the state that docs/deploy.md states.

    scripts/deploy_faults.py HWASP RUN [--log FOLDER]

HWASP is the program, RUN a run folder of z-grasp. In real time, some minutes: for a machine that does nothing else. How long each
reaction took is tested in virtual time (crates/deploy/tests); here it is that the real drivers and the rules meet. Exit status 1 if a fault ended otherwise.
"""

import argparse
import csv
import pathlib
import re
import resource
import signal
import subprocess
import tempfile
import time

# Fault, what is found, what is done. None where the run has to go on.
STOP, FREE, DOWN, ANY = "stop the arm, hold", "stop the arm, free the motor", "set down", None
FAULTS = [
    ("arm protective-stop", "protective stop of the arm", STOP),
    ("arm emergency-stop", "emergency stop of the arm", STOP),
    ("arm silent", "the arm's data are too old", STOP),
    ("arm delay 80", "the arm's data are too old", STOP),
    ("arm cut", "the line to the arm is broken", STOP),
    ("arm idle", "the arm is not running", STOP),
    ("arm nan", "too old|no number", STOP),
    ("arm freeze", "too old|stands still|not where it was sent", STOP),
    ("arm drop 3", None, None),
    ("motor silent", "the motor's answer is too old", STOP),
    ("motor cut", "the line to the motor is broken|too old", STOP),
    ("motor wrong-crc 1", "the motor's answer is too old", STOP),
    ("motor wrong-crc 0.1", None, None),
    ("motor noise 0.1", None, None),
    ("motor delay 80", "the motor's answer is too old", STOP),
    ("motor over-current 1.4", "the motor takes too much current", FREE),
    ("motor heat 75", "the motor is too hot", DOWN),
    ("motor voltage 7", "hardware error", FREE),
    ("motor overload", "hardware error|the motor is free", FREE),
    ("motor restart", "too old|the motor is free|hardware|beyond", ANY),
    ("motor stuck present-position", "stands still|beyond", STOP),
    ("full disk", "the log cannot be written", DOWN),
    ("SIGINT", "Ctrl-C", DOWN),
    ("SIGINT twice", "Ctrl-C, twice|Ctrl-C", FREE),
]


LOG_BYTES = 500_000  # what a log has in the middle of a grasp


def full_disk():
    """From this size on files take no more."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (LOG_BYTES, LOG_BYTES))


def run(hwasp, folder, fault, log):
    command = [hwasp, "deploy", "run", folder, "--dry-run", "--episodes", "1", "--log", log]
    ordered = fault.startswith(("arm", "motor"))
    told = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    limit = full_disk if fault == "full disk" else None
    process = subprocess.Popen(command + (["--fault", fault] if ordered else []), preexec_fn=limit, **told)
    if fault.startswith("SIGINT"):
        # The loop goes once its log has steps; then it is some time into the grasp.
        while not any(len(path.read_text().splitlines()) > 700 for path in pathlib.Path(log).glob("*.csv")):
            time.sleep(0.1)
        process.send_signal(signal.SIGINT)
        if "twice" in fault:
            time.sleep(0.2)
            process.send_signal(signal.SIGINT)
    return process.communicate(timeout=120)[0]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("hwasp")
    parser.add_argument("run")
    parser.add_argument("--log")
    args = parser.parse_args()
    root = pathlib.Path(args.log or tempfile.mkdtemp())
    wrong = 0
    for number, (fault, cause, response) in enumerate(FAULTS):
        log = root / str(number)
        told = run(args.hwasp, args.run, fault, str(log))
        ended = re.search(r"ended: (.*?); (.*)", told)
        if cause is None:
            good, found = ended is None and "held" in told, ended.group(0) if ended else "went on"
        else:
            good = ended is not None and re.search(cause, ended.group(1)) and response in (None, ended.group(2).strip())
            found = ended.group(0) if ended else "went on"
        # What was decided, in the log's last line, is what was told.
        rows = list(csv.DictReader(next(log.glob("*.csv")).open()))
        last = rows[-1]["response"] if rows else "no step"
        wrong += not good
        print(f"{'ok ' if good else 'BAD'}  {fault:<30} {found}; the log ends with: {last}", flush=True)
    print(f"{len(FAULTS) - wrong} of {len(FAULTS)} as stated")
    return 1 if wrong else 0


if __name__ == "__main__":
    raise SystemExit(main())
