"""Hansen's own program, `cma`, doing what crates/algos/examples/cmaes_evaluations.rs does, with the same arguments.

cmaes_peer.py FUNCTION N RUNS: evaluations to 1e-9 of each run, null where it failed
cmaes_peer.py cost N GENERATIONS: seconds per generation on the sphere
"""
import json
import sys
import time
import warnings

warnings.simplefilter("ignore")
import cma  # noqa: E402, it warns of what it does not find
import numpy as np  # noqa: E402

# As in the other program.
GENERATIONS = 200


def main():
    function, n, count = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    scales = 1e6 ** (np.arange(n) / (n - 1))

    def sphere(x):
        return float(np.sum(x * x))

    f = {"sphere": sphere, "cost": sphere, "ellipsoid": lambda x: float(np.sum(scales * x * x)),
         "rosenbrock": lambda x: float(np.sum(100 * (x[1:] - x[:-1] ** 2) ** 2 + (1 - x[:-1]) ** 2))}[function]
    if function == "cost":
        spent = 0.0
        for first in range(0, count, GENERATIONS):
            es = cma.CMAEvolutionStrategy(np.ones(n), 0.5, {"seed": first + 1, "verbose": -9})
            start = time.perf_counter()
            for _ in range(first, min(count, first + GENERATIONS)):
                candidates = es.ask()
                es.tell(candidates, [f(x) for x in candidates])
            spent += time.perf_counter() - start
        print(json.dumps(spent / count))
        return
    found = []
    for seed in range(1, count + 1):
        start = np.full(n, 0.0 if function == "rosenbrock" else 1.0)
        es = cma.CMAEvolutionStrategy(start, 0.5, {"seed": seed, "verbose": -9, "ftarget": 1e-9, "maxfevals": 1000000})
        while not es.stop():
            candidates = es.ask()
            es.tell(candidates, [f(x) for x in candidates])
        found.append(es.countevals if es.best.f <= 1e-9 else None)
    print(json.dumps(found))


if __name__ == "__main__":
    main()
