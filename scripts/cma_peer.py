#!/usr/bin/env python3
"""CMA-ES beside Hansen's own program, `cma` from PyPI, at its defaults: evaluations to 1e-9 and seconds per generation.

    cargo build --release -p hwasp-algos --example cmaes_evaluations
    python3 scripts/cma_peer.py [FOLDER]       # of the built examples; default target/release/examples

Python 3.11 or newer. The packages go into a virtual environment in a temporary folder. Both start at 1 (at 0 for
Rosenbrock's function) with a step of 0.5 and the default population. numpy runs on one thread, as this library does.
"""
import os
import statistics
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

RUNS = 20
COSTS = [(12, 2000), (1300, 240)]  # dimensions and generations
COST_REPEATS = 2
WIDENED = 0.10
PEER = """
import sys, time, warnings
warnings.simplefilter("ignore")
import cma, numpy as np
function, n, count = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
scales = 1e6 ** (np.arange(n) / (n - 1))
sphere = lambda x: float(np.sum(x * x))
f = {"sphere": sphere, "cost": sphere, "ellipsoid": lambda x: float(np.sum(scales * x * x)),
     "rosenbrock": lambda x: float(np.sum(100 * (x[1:] - x[:-1] ** 2) ** 2 + (1 - x[:-1]) ** 2))}[function]
if function == "cost":
    es = cma.CMAEvolutionStrategy(np.ones(n), 0.5, {"seed": 1, "verbose": -9})
    start = time.perf_counter()
    for _ in range(count):
        candidates = es.ask()
        es.tell(candidates, [f(x) for x in candidates])
    print((time.perf_counter() - start) / count)
else:
    for seed in range(1, count + 1):
        start = np.full(n, 0.0 if function == "rosenbrock" else 1.0)
        es = cma.CMAEvolutionStrategy(start, 0.5, {"seed": seed, "verbose": -9, "ftarget": 1e-9, "maxfevals": 1000000})
        while not es.stop():
            candidates = es.ask()
            es.tell(candidates, [f(x) for x in candidates])
        print(es.countevals if es.best.f <= 1e-9 else "failed")
"""


def call(command):
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    return subprocess.run(command, check=True, capture_output=True, text=True, env=environment).stdout.split()


def main():
    root = Path(__file__).resolve().parent.parent
    examples = Path(sys.argv[1]) if len(sys.argv) > 1 else root / "target" / "release" / "examples"
    ours = [str(examples / "cmaes_evaluations")]
    with tempfile.TemporaryDirectory() as folder:
        venv.create(folder, with_pip=True)
        python = str(Path(folder) / "bin" / "python")
        subprocess.run([python, "-m", "pip", "install", "-q", "cma==4.5.0", "numpy==2.4.6"], check=True)
        peer = [python, "-c", PEER]
        print("| function | n | evaluations, median | cma 4.5.0 | ratio | solved, of 20 | cma |\n|---|---|---|---|---|---|---|")
        far = []
        for function in ["sphere", "ellipsoid", "rosenbrock"]:
            for n in [10, 40]:
                found = [call([*p, function, str(n), str(RUNS)]) for p in (ours, peer)]
                solved = [[int(v) for v in values if v != "failed"] for values in found]
                medians = [statistics.median(values) for values in solved]
                ratio = medians[0] / medians[1]
                print(f"| {function} | {n} | {medians[0]:.0f} | {medians[1]:.0f} | {ratio:.3f} "
                      f"| {len(solved[0])} | {len(solved[1])} |", flush=True)
                if abs(ratio - 1) > WIDENED:
                    far.append(f"{function} {n}")
        # In turns, so that a busy machine is busy for both.
        print("\n| n | generations | ms per generation | cma 4.5.0 | ratio |\n|---|---|---|---|---|")
        for n, generations in COSTS:
            turns = [[float(call([*p, "cost", str(n), str(generations)])[0]) for p in (ours, peer)]
                     for _ in range(COST_REPEATS)]
            seconds = [min(turn[i] for turn in turns) for i in (0, 1)]
            print(f"| {n} | {generations} | {1e3 * seconds[0]:.3g} | {1e3 * seconds[1]:.3g} "
                  f"| {seconds[0] / seconds[1]:.2g} |", flush=True)
    if far:
        sys.exit(f"more than {WIDENED:.0%} apart: {', '.join(far)}")


if __name__ == "__main__":
    main()
