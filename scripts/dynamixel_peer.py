#!/usr/bin/env python3
"""Asks the emulated motor by ROBOTIS' own client, by rustypot and by our driver, and compares what they are told. Python 3.10 or
newer; needs the network.

    cargo build -p hwasp-emulators --bin hwasp-bench && cargo build -p hwasp-drivers --example motor_probe
    python3 scripts/dynamixel_peer.py

The clients are installed into a virtual environment in a temporary folder, where this Python does not have them. Each gets a motor
of its own, as it leaves the factory, and does the same with it: reads every register, writes what must be refused, goes to
positions of both signs, reads currents of both signs, is told of heat. All answers have to be equal. Prints a table; exit status 1
if anything differs.
"""
import json
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PINNED = ["dynamixel-sdk==4.1.0", "rustypot==1.13.1"]
ROOT = Path(__file__).resolve().parent.parent
BUILT = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "debug"

try:
    import dynamixel_sdk
    import rustypot
except ImportError:
    if sys.argv[1:] == ["installed"]:
        raise
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        subprocess.run([f"{folder}/bin/pip", "install", "--quiet", "--disable-pip-version-check", *PINNED], check=True)
        sys.exit(subprocess.run([f"{folder}/bin/python", __file__, "installed"]).returncode)


class Bench:
    def __init__(self):
        self.process = subprocess.Popen([BUILT / "hwasp-bench"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.port = json.loads(self.process.stdout.readline())["motor"]["port"]

    def ask(self, line):
        print(line, file=self.process.stdin, flush=True)
        return json.loads(self.process.stdout.readline())

    def close(self):
        self.process.stdin.close()
        self.process.wait(10)


def signed(value, size):
    """A value with a sign, as the longer registers have it: the vendor's client returns none."""
    bits = 8 * size
    return value - (1 << bits) if size > 1 and value >= 1 << (bits - 1) else value


class Vendor:
    """ROBOTIS' own client."""

    def __init__(self, port):
        # It waits for twice this. On a busy machine it takes an answer that is later for the next one's, and never finds back.
        dynamixel_sdk.port_handler.LATENCY_TIMER = 500
        self.port = dynamixel_sdk.PortHandler(port)
        assert self.port.openPort() and self.port.setBaudRate(1_000_000)
        self.packets = dynamixel_sdk.PacketHandler(2.0)

    def result(self, comm, error):
        if comm != dynamixel_sdk.COMM_SUCCESS:
            return self.packets.getTxRxResult(comm)
        return error & 0x7F

    def ping(self):
        model, comm, error = self.packets.ping(self.port, 1)
        return model, self.result(comm, error)

    def read(self, at, size):
        data, comm, error = self.packets.readTxRx(self.port, 1, at, size)
        return signed(int.from_bytes(bytes(data), "little"), size), self.result(comm, error)

    def write(self, at, size, value):
        data = list((value % (1 << 8 * size)).to_bytes(size, "little"))
        return None, self.result(*self.packets.writeTxRx(self.port, 1, at, size, data))

    def close(self):
        self.port.closePort()


class Rustypot:
    """A client of others. It has no XM430; the definition of its XL430 covers its sisters XM430-W350 and others."""

    def __init__(self, port):
        self.bus = rustypot.Bus(port, 1_000_000, 1.0, {1: rustypot.Xl430PyController.definition()})

    def ping(self):
        return self.read(0, 2)

    def read(self, at, size):
        if (at, size) not in NAMES:
            return None
        value, error = self.bus.read_register_with_error(1, NAMES[at, size])
        return value, error & 0x7F

    def write(self, at, size, value):
        # It lets nobody write what it knows to be read-only, or to be no value.
        if (at, size) not in NAMES or at in READ_ONLY:
            return None
        return None, self.bus.write_register_with_error(1, NAMES[at, size], value) & 0x7F

    def close(self):
        self.bus.close()


class Ours:
    """Our driver."""

    def __init__(self, port):
        self.process = subprocess.Popen(
            [BUILT / "examples" / "motor_probe", port], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def ask(self, line):
        print(line, file=self.process.stdin, flush=True)
        answer = json.loads(self.process.stdout.readline())
        if "error" not in answer:
            return answer, 0
        number = re.search(r"\(error (\d+)\)", answer["error"])
        return {}, int(number[1]) if number else answer["error"]

    def value(self, line):
        answer, error = self.ask(line)
        return answer.get("value"), error

    def ping(self):
        return self.value("ping")

    def read(self, at, size):
        return self.value(f"read {at} {size}")

    def write(self, at, size, value):
        return self.value(f"write {at} {size} {value}")

    def close(self):
        self.process.stdin.close()
        self.process.wait(10)


# The control table as rustypot has it: whoever wrote it read the manual apart from us.
TABLE = rustypot.Xl430PyController.registers()
NAMES = {(register.addr, register.size): register.name for register in TABLE}
READ_ONLY = {register.addr for register in TABLE if str(register.access).endswith("Read")}
# What time alone changes.
PASSING = {120}


def script(client, bench):
    """What every client does. Yields what was done, the value that was read, and the number of the error."""

    def read(what, at, size):
        return what, client.read(at, size)

    def write(what, at, size, value):
        return what, client.write(at, size, value)

    def until(what, at, size, wanted):
        for _ in range(500):
            answer = client.read(at, size)
            if answer == (wanted, 0):
                break
            time.sleep(0.01)
        return what, answer

    yield "ping", client.ping()
    for (at, size), name in NAMES.items():
        if at not in PASSING:
            yield read(f"read {name}", at, size)
    yield read("read a gap", 66, 1)
    yield write("write a gap", 66, 1, 1)
    yield write("write what is read-only", 132, 4, 0)
    yield write("half of a register", 116, 2, 0)
    yield write("goal beyond a turn in mode 3", 116, 4, 4096)
    yield write("a mode that is none", 11, 1, 2)
    yield write("a current limit beyond the motor's", 38, 2, 1194)
    yield write("mode 5", 11, 1, 5)
    yield write("a current limit", 38, 2, 446)
    yield write("a current beyond it", 102, 2, 447)
    yield write("a current backwards beyond it", 102, 2, -447)
    yield write("a current", 102, 2, 300)
    yield write("torque on", 64, 1, 1)
    yield write("a mode while torque is on", 11, 1, 4)
    yield write("a watchdog that is none", 98, 1, 200)
    yield write("goal beyond 256 turns", 116, 4, 1_048_576)
    for goal in (5000, -3000):
        yield write(f"goal {goal}", 116, 4, goal)
        yield until(f"position {goal}", 132, 4, goal)
        yield until("speed 0", 128, 4, 0)
    yield write("torque off", 64, 1, 0)
    # 0xFF 0xFF 0xFD within: stuffed on the way there and back.
    for goal in (-131_073, -259, 65_533):
        yield write(f"goal {goal}", 116, 4, goal)
        yield read(f"goal {goal} again", 116, 4)
    for amperes in (0.8, -0.5):
        bench.ask(f"fault motor over-current {amperes}")
        yield read(f"current {amperes} A", 126, 2)
    bench.ask("fault motor voltage 11.1")
    yield read("voltage 11.1 V", 144, 2)
    bench.ask("fault motor heat 85")
    yield read("temperature 85 °C", 146, 1)
    yield read("hardware error", 70, 1)
    yield write("torque on while it is too hot", 64, 1, 1)
    yield read("torque", 64, 1)


def main():
    clients = {"dynamixel-sdk": Vendor, "rustypot": Rustypot, "ours": Ours}
    told = {}
    for name, kind in clients.items():
        bench = Bench()
        client = kind(bench.port)
        told[name] = list(script(client, bench))
        client.close()
        bench.close()
    asked = differ = answers = 0
    print(f"{'':36}" + "".join(f"{name:>18}" for name in clients))
    for step in zip(*told.values()):
        seen = [answer for _, answer in step if answer is not None]
        # Where an error is told, there is no value to speak of.
        seen = {(error, None if error else value) for value, error in seen}
        equal = len(seen) == 1
        asked, answers, differ = asked + 1, answers + sum(answer is not None for _, answer in step), differ + (not equal)
        texts = ["-" if answer is None else f"error {answer[1]}" if answer[1] else "ok" if answer[0] is None else str(answer[0])
                 for _, answer in step]
        print(f"{step[0][0]:36}" + "".join(f"{text:>18}" for text in texts) + ("" if equal else "   DIFFERENT"))
    print(f"{asked} questions, {answers} answers, {differ} different")
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
