"""One run of a work with workers, as `cluster_faults.py` breaks it."""
import csv
import random
import shutil
import time
from dataclasses import dataclass, field
from pathlib import Path

from cluster_site import Lost, Networks, Site, wait_until

# The longest time of a run with a fault, s: a cut of 30 s, twice the 15 s until a job of somebody silent is handed on, and the work.
LIMIT = 180
INNER = ["--env-steps", "3e6", "--set", "search.inner_env_steps=300000"]
FEW = ["--env-steps", "36000", "--set", "search.episodes=1", "--set", "train.evaluation_episodes=20"]
WORKS = {
    "trpo": ["train", "z-grasp", "--env-steps", "40000", "--set", "train.evaluation_episodes=40"],
    "ppo": ["train", "z-grasp", "--method", "hwasp", "--env-steps", "40000", "--set", "train.evaluation_episodes=40"],
    "cmaes": ["train", "z-grasp", "--method", "cmaes", *FEW, "--set", "cmaes.popsize=8"],
    "ars": ["train", "z-grasp", "--method", "ars", *FEW, "--set", "ars.directions=4"],
    "cmaes-rl": ["train", "mass-spring", "--method", "cmaes-rl", *INNER],
    "ars-rl": ["train", "mass-spring", "--method", "ars-rl", *INNER],
    "compare": ["compare", "mass-spring", "--methods", "hwasp,cmaes,ars", "--seeds", "2", "--env-steps", "800000"],
}


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
