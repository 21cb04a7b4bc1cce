"""A queue, workers and coordinators of one try of `cluster_faults.py`: processes, networks of their own, and a client of NATS."""
import json
import os
import random
import re
import signal
import socket
import subprocess
import threading
import time
from pathlib import Path

# Whoever breaks the script off ends all that it started.
OVER = threading.Event()
RUNNING, NETWORKS, GUARD = set(), set(), threading.Lock()


class Lost(Exception):
    """A run ended with a failure, or a part of a try did not come up."""


class Hang(Exception):
    """Something took longer than its stated limit."""


def start(command, log):
    with GUARD:
        if OVER.is_set():
            raise KeyboardInterrupt
        with open(log, "ab") as file:
            # Ctrl-C is for the script alone.
            process = subprocess.Popen([str(word) for word in command], stdin=subprocess.DEVNULL, stdout=file, stderr=file,
                                       start_new_session=True)
        RUNNING.add(process)
    return process


def kill(process):
    if process.poll() is None:
        process.kill()
        process.wait()
    with GUARD:
        RUNNING.discard(process)


def ip(*words):
    subprocess.run(["ip", *words], check=True, capture_output=True, text=True)


def clean():
    """Ends all processes and removes all networks."""
    OVER.set()
    for process in list(RUNNING):
        kill(process)
    for name in list(NETWORKS):
        subprocess.run(["ip", "netns", "del", name], capture_output=True)
        NETWORKS.discard(name)


def wait_until(true, limit, what):
    began = time.monotonic()
    while not true():
        if OVER.is_set():
            raise KeyboardInterrupt
        if time.monotonic() - began > limit:
            raise Hang(f"{what} after {limit:.0f} s")
        time.sleep(0.02)


class Networks:
    """The server's network and two others, each on a cable of its own to it, and none of them to anywhere else."""

    def __init__(self, number):
        self.names = {side: f"hwasp-{os.getpid()}-{number}-{side}" for side in "swc"}
        for name in self.names.values():
            NETWORKS.add(name)
            ip("netns", "add", name)
        for line, side in enumerate("wc", 1):
            here, there = self.names["s"], self.names[side]
            ip("-n", here, "link", "add", f"to-{side}", "type", "veth", "peer", "name", "to-s", "netns", there)
            for name, cable, last in [(here, f"to-{side}", 1), (there, "to-s", 2)]:
                ip("-n", name, "addr", "add", f"10.77.{line}.{last}/30", "dev", cable)
                ip("-n", name, "link", "set", cable, "up")

    def address(self, side):
        return "10.77.2.1" if side == "c" else "10.77.1.1"

    def inside(self, side):
        return ["ip", "netns", "exec", self.names[side]]

    def plug(self, side, state):
        ip("-n", self.names["s"], "link", "set", f"to-{side}", state)

    def remove(self):
        for name in self.names.values():
            subprocess.run(["ip", "netns", "del", name], capture_output=True)
            NETWORKS.discard(name)


class Site:
    """A server with its store, and whoever is connected to it."""

    def __init__(self, folder, program, nats, networks=None, most=1 << 30):
        folder.mkdir(parents=True)
        self.folder, self.program, self.nats, self.networks = folder, program, nats, networks
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.host = "0.0.0.0" if networks else "127.0.0.1"
        (folder / "nats.conf").write_text(
            f'listen: "{self.host}:{self.port}"\nping_interval: "5s"\nping_max: 2\n'
            f'jetstream {{\n  store_dir: "{folder}/store"\n  max_file_store: {most}\n}}\n')
        self.server, self.crew, self.others, self.begun = None, [], [], 0
        self.start_server()

    def inside(self, side):
        return self.networks.inside(side) if self.networks else []

    def url(self, side):
        host = self.networks.address(side) if self.networks else "127.0.0.1"
        return f"nats://{host}:{self.port}"

    def start_server(self):
        self.server = start([*self.inside("s"), self.nats, "-c", self.folder / "nats.conf"], self.folder / "server.log")
        ready = lambda: b"Server is ready" in (self.folder / "server.log").read_bytes()
        if not self.begun:
            wait_until(ready, 20, "the server is not ready")

    def kill_server(self):
        kill(self.server)

    def worker(self, program=None, wait=True):
        self.begun += 1
        log = self.folder / f"worker-{self.begun}.log"
        process = start([*self.inside("w"), program or self.program, "worker", "--server", self.url("w"), "--name",
                         f"w{self.begun}", "--threads", 1, "--log-level", "debug"], log)
        self.crew.append(process)
        if wait:
            wait_until(lambda: b" takes jobs from " in log.read_bytes() or process.poll() is not None, 60, "a worker is not ready")
        return process

    def coordinator(self, arguments):
        process = start([*self.inside("c"), self.program, *arguments, "--server", self.url("c"), "--patience", 100,
                         "--log-level", "debug"], self.folder / "coordinator.log")
        self.others.append(process)
        return process

    def status(self):
        command = [*self.inside("c"), self.program, "cluster", "status", "--json", "--server", self.url("c")]
        told = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=60)
        return json.loads(told.stdout) if told.returncode == 0 else {"error": told.stderr}

    def logs(self, names):
        return "".join(file.read_text(errors="replace") for file in sorted(self.folder.glob(names)))

    def end(self):
        for process in [*self.others, *self.crew, self.server]:
            kill(process)
        if self.networks:
            self.networks.remove()


class Client:
    """As much of a client of NATS as faults need: it subscribes, publishes and asks."""

    def __init__(self, port):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=10)
        self.buffer, self.number = b"", 0
        self.send(b'CONNECT {"verbose":false,"pedantic":false,"headers":true,"no_responders":true}\r\nPING\r\n')

    def send(self, data):
        self.socket.sendall(data)

    def subscribe(self, subject):
        self.number += 1
        self.send(f"SUB {subject} {self.number}\r\n".encode())

    def publish(self, subject, payload, reply=""):
        self.send(f"PUB {subject} {reply} {len(payload)}\r\n".encode() + payload + b"\r\n")

    def message(self):
        """The first message of what was received, whole; none as long as it is not."""
        while b"\r\n" in self.buffer:
            line, rest = self.buffer.split(b"\r\n", 1)
            words = line.split()
            if words[:1] in ([b"MSG"], [b"HMSG"]):
                size = int(words[-1])
                if len(rest) < size + 2:
                    return None
                self.buffer = rest[size + 2:]
                return words[1].decode(), rest[int(words[-2]) if words[0] == b"HMSG" else 0:size]
            self.buffer = rest
            if words[:1] == [b"PING"]:
                self.send(b"PONG\r\n")
        return None

    def read(self, seconds):
        """The next message: its subject and payload; none where none comes in so many seconds."""
        end = time.monotonic() + seconds
        while True:
            if (message := self.message()) or (left := end - time.monotonic()) <= 0:
                return message
            self.socket.settimeout(left)
            try:
                data = self.socket.recv(1 << 20)
            except TimeoutError:
                return None
            if not data:
                raise Lost("the server ended the connection of the script")
            self.buffer += data

    def ask(self, subject, payload, seconds=10):
        inbox = f"_INBOX.faults.{random.getrandbits(64):x}"
        self.subscribe(inbox)
        self.publish(subject, payload, inbox)
        while message := self.read(seconds):
            if message[0] == inbox:
                return json.loads(message[1] or b"{}")
        raise Hang(f"no answer from {subject} in {seconds} s")


def disguised(program, sources, out):
    """A copy of the program that says it was made of other sources."""
    data = Path(program).read_bytes()
    if not (sources and re.fullmatch("[0-9a-f]{12}", sources) and sources.encode() in data):
        raise Lost("the hash of the sources is not to be found in the program")
    out.write_bytes(data.replace(sources.encode(), sources[::-1].encode()))
    out.chmod(0o755)
    return out


def pause(process):
    process.send_signal(signal.SIGSTOP)


def go_on(process):
    if process.poll() is None:
        process.send_signal(signal.SIGCONT)
