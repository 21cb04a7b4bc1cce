"""A generation of CMA-ES beside one of Hansen's own program, `cma`, both at their defaults and on one thread."""
from contest import Contest
from document import aim
from programs import call, example

COST = {12: 4_000, 1300: 200}  # generations


def compare(peers, turns, scale):
    lines, aims = [], []
    for n, generations in COST.items():
        count = int(scale * generations)
        contest = Contest({
            "hwasp": {"one thread": lambda: 1.0 / call([example("cmaes_evaluations"), "cost", n, count])},
            "cma": {"one thread": lambda: 1.0 / peers.call("cmaes_peer.py", "cost", n, count)},
        }, turns)
        lines += [*contest.table(f"A full covariance of {n} parameters, the sphere.", f"generations/s, n = {n}"), ""]
        aims.append((f"times `cma` at n = {n}", contest.median("hwasp") / contest.median("cma"), 1))
    return [*lines, *aim(aims)]
