#!/usr/bin/env python3
"""Compares this project's speed with its peers', and writes docs/performance.md. Python 3.11, Linux, 6 GB of disk.

    python3 benches/peers/run.py                     # all of it, half an hour on two quiet cores
    python3 benches/peers/run.py grasp trpo          # some: mass-spring, grasp, trpo, sac, cmaes, cmaes-evaluations
    python3 benches/peers/run.py --quick             # a tenth of the work, one turn, printed and not written

The peers come from PyPI in the versions of requirements.txt beside this file, into target/peers (--venv for another
folder). Everything runs in turns on the same machine; leave the machine alone meanwhile.
"""
import argparse
from pathlib import Path

import cmaes
import cmaes_evaluations
import document
import grasp
import mass_spring
import sac
import trpo
from programs import TARGET, Peers, build

COMPARISONS = {"mass-spring": mass_spring, "grasp": grasp, "trpo": trpo, "sac": sac, "cmaes": cmaes,
               "cmaes-evaluations": cmaes_evaluations}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help="comparisons to make: " + ", ".join(COMPARISONS))
    parser.add_argument("--quick", action="store_true", help="one turn of a tenth of the work, nothing is written")
    parser.add_argument("--turns", type=int, default=5, help="how often each program runs (default 5)")
    parser.add_argument("--venv", type=Path, default=TARGET / "peers", help="where the peers are or shall be")
    parser.add_argument("--built", action="store_true", help="this project is built already")
    asked = parser.parse_args()
    unknown = [name for name in asked.names if name not in COMPARISONS]
    if unknown:
        parser.error(f"there is no comparison {unknown[0]!r}; there are {', '.join(COMPARISONS)}")
    if asked.turns < 1:
        parser.error(f"--turns = {asked.turns} is less than 1")
    peers = Peers(asked.venv)
    if not asked.built:
        build()
    turns, scale = (1, 0.1) if asked.quick else (asked.turns, 1.0)
    for name in asked.names or COMPARISONS:
        print(f"{name}:", flush=True)
        lines = COMPARISONS[name].compare(peers, turns, scale)
        print("\n".join(lines), flush=True)
        if not asked.quick:
            document.replace(name, [*lines, "", *document.about(peers.python)])


if __name__ == "__main__":
    main()
