#!/usr/bin/env python3
"""Reads our event file with TensorBoard itself and compares it with metrics.csv and summary.json. Python 3.10 or newer;
needs the network.

    cargo build --release
    python3 scripts/tensorboard_peer.py
    python3 scripts/tensorboard_peer.py --fixture     # prints records that TensorBoard wrote, for the Rust tests

TensorBoard is installed into a virtual environment in a temporary folder.
"""
import csv
import json
import os
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release" / "hwasp"
PINNED = ["tensorboard==2.21.0"]

# Runs inside the environment: every scalar of a folder, as {tag: [[step, value], …]}.
READ = """
import json, sys
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator
events = EventAccumulator(sys.argv[1], size_guidance={"scalars": 0})
events.Reload()
print(json.dumps({tag: [[e.step, e.value] for e in events.Scalars(tag)] for tag in events.Tags()["scalars"]}))
"""

# A file of two records, of an event with the version and one with two scalars, both at fixed times.
WRITE = """
import io
from tensorboard.compat.proto.event_pb2 import Event
from tensorboard.compat.proto.summary_pb2 import Summary
from tensorboard.summary.writer.record_writer import RecordWriter
kept = io.BytesIO()
writer = RecordWriter(kept)
writer.write(Event(wall_time=1.5, file_version="brain.Event:2").SerializeToString())
values = [Summary.Value(tag="train/return", simple_value=-0.25), Summary.Value(tag="design/gear", simple_value=1.0)]
writer.write(Event(wall_time=2.5, step=100000, summary=Summary(value=values)).SerializeToString())
print(kept.getvalue().hex())
"""

COLUMNS = {name: f"train/{name}" for name in ("return", "discounted_return")} | {"gear": "design/gear"}


def columns(header):
    """The tag of each column that TensorBoard has: the learner's metrics too, by their own names."""
    return COLUMNS | {name: "train/" + name.removeprefix("learner.") for name in header if name.startswith("learner.")}


def inside(python, program, *arguments):
    printed = subprocess.run([python, "-c", program, *arguments], check=True, capture_output=True, text=True)
    return printed.stdout


def single(text):
    """As a 32-bit number."""
    return struct.unpack("<f", struct.pack("<f", float(text)))[0]


def main():
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, "-m", "venv", f"{folder}/venv"], check=True)
        python = f"{folder}/venv/bin/python"
        subprocess.run([python, "-m", "pip", "install", "--quiet", *PINNED], check=True)
        if sys.argv[1:] == ["--fixture"]:
            print(inside(python, WRITE), end="")
            return
        run = Path(folder) / "run"
        subprocess.run([PROGRAM, "train", "reach", "--quiet", "--tensorboard", "--out", run], check=True)
        read = json.loads(inside(python, READ, str(run / "tensorboard")))
        with open(run / "metrics.csv") as file:
            rows = list(csv.DictReader(file))
        evaluation = json.loads((run / "summary.json").read_text())["evaluation"]

    wanted = {tag: [[int(r["env_steps"]), single(r[name])] for r in rows] for name, tag in columns(rows[0]).items()}
    last = int(rows[-1]["env_steps"])
    for name in ("return", "discounted_return"):
        wanted[f"evaluation/{name}"] = [[last, single(evaluation[name]["mean"])]]
    for name in ("median_discounted_return", "worst_discounted_return"):
        wanted[f"evaluation/{name}"] = [[last, single(evaluation[name])]]
    for tag in sorted(wanted.keys() | read.keys()):
        if wanted.get(tag) != read.get(tag):
            sys.exit(f"{tag}: the files say {wanted.get(tag)}, TensorBoard reads {read.get(tag)}")
    scalars = sum(map(len, read.values()))
    print(f"{PINNED[0]} reads {scalars} scalars of {len(read)} tags over {len(rows)} iterations, all as the folder has them")


if __name__ == "__main__":
    main()
