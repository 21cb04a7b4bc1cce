"""PPO on the mass-spring problem: hwasp, a jitted JAX program, Stable-Baselines3."""
import json
import statistics
import subprocess
import tempfile
from pathlib import Path

from contest import Contest
from document import aim
from programs import program

# What the authors' code does on one thread, quoted: /docs/performance.md says from where.
AUTHORS = 6000
STEPS = {"hwasp": 4_000_000, "jax": 1_000_000, "sb3": 40_000}


def hwasp(threads, steps):
    """Steps per second of a training, and the total stiffness that it ends with."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "run"
        settings = ["--env-steps", str(steps), "--set", "train.evaluation_episodes=1"]
        command = [program(), "train", "mass-spring", "--quiet", "--threads", str(threads), "--out", out, *settings]
        subprocess.run(command, check=True, capture_output=True)
        return json.loads((out / "summary.json").read_text())["steps_per_s"]


def compare(peers, turns, scale):
    steps = {name: int(scale * count) for name, count in STEPS.items()}

    def jax(threads, unroll):
        flags = f"--xla_cpu_multi_thread_eigen={'true' if threads > 1 else 'false'}"
        script = ["mass_spring_jax.py", steps["jax"], unroll]
        return lambda: peers.call(*script, threads=threads, XLA_FLAGS=flags)["rate"]

    def sb3(kind, environments, threads):
        script = ["mass_spring_sb3.py", kind, environments, steps["sb3"]]
        return lambda: peers.call(*script, threads=threads)["rate"]

    contest = Contest({
        "hwasp": {f"{n} thread{'s' * (n > 1)}": lambda n=n: hwasp(n, steps["hwasp"]) for n in (2, 1)},
        "JAX": {"two threads": jax(2, 1), "one thread": jax(1, 1), "two threads, steps unrolled by 8": jax(2, 8)},
        "Stable-Baselines3": {
            "DummyVecEnv of 20, one thread": sb3("dummy", 20, 1),
            "DummyVecEnv of 20, two threads": sb3("dummy", 20, 2),
            "SubprocVecEnv of 20, one thread": sb3("subproc", 20, 1),
            "SubprocVecEnv of 4, one thread": sb3("subproc", 4, 1),
        },
    }, turns)
    ours = contest.median("hwasp")
    one = statistics.median(contest.rates["hwasp"]["1 thread"])
    return contest.table("Simulator steps per second of training, updates included.", "steps/s") + ["", *aim([
        ("times Stable-Baselines3", ours / contest.median("Stable-Baselines3"), 40),
        ("times the JAX program", ours / contest.median("JAX"), 3),
        (f"times the authors' code (about {AUTHORS:,} steps per processor second, quoted), on one thread",
         one / AUTHORS, 120),
    ])]
