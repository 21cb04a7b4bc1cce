"""Evaluations that CMA-ES and Hansen's own program, `cma`, take to 1e-9. No clock is looked at: any machine will do.

Both start at 1 (at 0 for Rosenbrock's function) with a step of 0.5 and the default population.
"""
import statistics

from programs import call, example

RUNS = 20
WIDENED = 0.10


def compare(peers, _turns, scale):
    lines = ["| function | n | evaluations, median | cma | ratio | solved, of 20 | cma |", "|---|---|---|---|---|---|---|"]
    furthest = 0.0
    for function in ["sphere", "ellipsoid", "rosenbrock"]:
        for n in [10, 40] if scale >= 1 else [10]:
            found = [call([example("cmaes_evaluations"), function, n, RUNS]),
                     peers.call("cmaes_peer.py", function, n, RUNS)]
            solved = [[v for v in values if v is not None] for values in found]
            medians = [statistics.median(values) for values in solved]
            ratio = medians[0] / medians[1]
            furthest = max(furthest, abs(ratio - 1))
            lines.append(f"| {function} | {n} | {medians[0]:.0f} | {medians[1]:.0f} | {ratio:.3f} "
                         f"| {len(solved[0])} | {len(solved[1])} |")
    inside = "yes" if furthest <= WIDENED else "no"
    return [*lines, "", "| aim | measured | reached |", "|---|---|---|",
            f"| evaluations within {WIDENED:.0%} of those of `cma` | {furthest:.0%} apart at most | {inside} |"]
