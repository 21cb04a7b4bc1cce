"""CMA-ES beside Hansen's own program, `cma`, at its defaults: time of a generation, and evaluations to 1e-9.

Both start at 1 (at 0 for Rosenbrock's function) with a step of 0.5 and the default population, on one thread.
"""
import statistics

from contest import Contest
from document import aim
from programs import call, example

COST = {12: 20_000, 1300: 200}  # generations
RUNS = 20
WIDENED = 0.10


def compare(peers, turns, scale):
    lines, aims = [], []

    def ours(*arguments):
        return call([example("cmaes_evaluations"), *arguments])

    def theirs(*arguments):
        return peers.call("cmaes_peer.py", *arguments)

    for n, generations in COST.items():
        generations = int(scale * generations)
        contest = Contest({
            "hwasp": {"one thread": lambda: 1.0 / ours("cost", n, generations)},
            "cma": {"one thread": lambda: 1.0 / theirs("cost", n, generations)},
        }, turns)
        lines += [*contest.table(f"A full covariance of {n} parameters, the sphere.", f"generations/s, n = {n}"), ""]
        aims.append((f"times `cma` at n = {n}", contest.median("hwasp") / contest.median("cma"), 1))
    lines += ["| function | n | evaluations, median | cma | ratio | solved, of 20 | cma |", "|---|---|---|---|---|---|---|"]
    furthest = 0.0
    for function in ["sphere", "ellipsoid", "rosenbrock"]:
        for n in [10, 40] if scale >= 1 else [10]:
            solved = [[v for v in who(function, n, RUNS) if v is not None] for who in (ours, theirs)]
            medians = [statistics.median(values) for values in solved]
            ratio = medians[0] / medians[1]
            furthest = max(furthest, abs(ratio - 1))
            lines.append(f"| {function} | {n} | {medians[0]:.0f} | {medians[1]:.0f} | {ratio:.3f} "
                         f"| {len(solved[0])} | {len(solved[1])} |")
    inside = "yes" if furthest <= WIDENED else "no"
    rows = [*aim(aims), f"| evaluations to 1e-9 within {WIDENED:.0%} of `cma` | {furthest:.0%} | {inside} |"]
    return [*lines, "", *rows]
