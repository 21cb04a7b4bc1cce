"""What `cluster_faults.py` does to a run: each fault, and the works that it is tried on."""
import os
import signal
import time
from dataclasses import dataclass, field

from cluster_site import Client, Hang, Lost, go_on, kill, pause, wait_until
from cluster_try import LIMIT, WORKS

# How long a network is cut, s.
CUT = 30
TRAININGS = [name for name in WORKS if name != "compare"]


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
    # Whoever waits calls every 3 s.
    wait_until(lambda: t.told("worker-1.log", "somebody asks whose jobs this worker refuses"), 20, "the other worker was not told")
    t.moment()
    t.site.worker()
    t.finish()
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


def nothing(_):
    """No fault: the number of workers changes no bit."""


FAULTS = [
    Fault("one-worker", nothing, workers=1),
    Fault("seven-workers", nothing, workers=7),
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
