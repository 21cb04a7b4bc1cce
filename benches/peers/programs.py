"""The programs that are compared: the peers in a virtual environment of their own, and those of this repository."""
import json
import os
import subprocess
import venv
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
# Libraries that would otherwise start a thread for every core they see.
THREADS = ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"]


class Peers:
    """The virtual environment with the packages of requirements.txt, made where it is missing or of another list."""

    def __init__(self, folder):
        self.python = folder / "bin" / "python"
        wanted, stamp = (HERE / "requirements.txt").read_text(), folder / "requirements.txt"
        if stamp.exists() and stamp.read_text() == wanted:
            return
        print(f"installing the peers into {folder} (6 GB)", flush=True)
        venv.create(folder, with_pip=True)
        requirements = ["-r", str(HERE / "requirements.txt")]
        subprocess.run([self.python, "-m", "pip", "install", "-q", "--no-cache-dir", *requirements], check=True)
        stamp.write_text(wanted)

    def call(self, script, *arguments, threads=1, **variables):
        """The answer of one of the scripts beside this file."""
        return call([self.python, HERE / script, *arguments], threads, **variables)


def call(command, threads=1, **variables):
    """Runs a command that ends with a line of JSON, and returns what that says."""
    environment = {**os.environ, **dict.fromkeys(THREADS, str(threads)), **variables}
    words = [str(word) for word in command]
    done = subprocess.run(words, capture_output=True, text=True, env=environment, cwd=ROOT)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(words)} failed:\n{done.stderr[-3000:]}")
    return json.loads(done.stdout.splitlines()[-1])


def build():
    """Builds the program and the examples that are timed."""
    for what in [
        ["-p", "hwasp-cli"],
        ["-p", "hwasp-builtin", "--example", "grasp_rollouts", "--example", "grasp_throughput", "--example", "trpo_update", "--example", "sac_update"],
        ["-p", "hwasp-algos", "--example", "cmaes_evaluations"],
    ]:
        subprocess.run(["cargo", "build", "--release", "--quiet", *what], check=True, cwd=ROOT)


def program():
    """The program `hwasp`."""
    return TARGET / "release" / "hwasp"


def example(name):
    """An example of this repository."""
    return TARGET / "release" / "examples" / name
