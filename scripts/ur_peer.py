#!/usr/bin/env python3
"""Drives the emulated arm by ur_rtde and by our own driver, and compares what they tell. Python 3.8 or newer; needs the network.

    cargo build -p hwasp-emulators --bin emulate-ur && cargo build -p hwasp-drivers --example ur_probe
    python3 scripts/ur_peer.py [ADDRESS]                     # 127.0.0.3

ur_rtde is installed into a virtual environment in a temporary folder, where this Python does not have it. For CB3 and e-Series: ur_rtde reads state, registers and dashboard, uploads its program, follows 50 poses by servoL, moves back
by moveL, stops; our driver does the same over the same emulator. Emulator, ur_rtde and our driver have to agree on every pose.
Prints a table; exit status 1 if anything differs. ur_rtde knows the vendor's ports alone, so the emulator takes those, at an
address of this machine that nobody else uses; one that is not 127.0.0.1 lets ur_rtde ask for remote control too.
"""
import json
import math
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PINNED = ["ur-rtde==1.6.5"]
ROOT = Path(__file__).resolve().parent.parent
BUILT = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "debug"

try:
    import dashboard_client
    import rtde_control
    import rtde_receive
except ImportError:
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        subprocess.run([f"{folder}/bin/pip", "install", "--quiet", *PINNED], check=True)
        sys.exit(subprocess.run([f"{folder}/bin/python", *sys.argv]).returncode)

PORTS = ["30004", "29999", "30002"]
NEAR = 2e-5  # m and rad: the last bits of the encoders tremble by 0.4 µrad in each joint


class Emulator:
    def __init__(self, program, generation, address):
        self.process = subprocess.Popen(
            [program, generation, address, "vendor"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.ports = json.loads(self.process.stdout.readline())

    def ask(self, line):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()
        return self.process.stdout.readline().strip()

    def tool(self):
        return json.loads(self.ask("tool"))

    def close(self):
        self.process.stdin.close()
        return self.process.wait(10)


def quaternion(rotation):
    angle = math.sqrt(sum(part * part for part in rotation))
    scale = math.sin(angle / 2) / angle if angle > 0 else 0.5
    return [math.cos(angle / 2)] + [part * scale for part in rotation]


def apart(a, b):
    """The larger of distance, m, and turn, rad, between two poses."""
    turn = abs(sum(x * y for x, y in zip(quaternion(a[3:]), quaternion(b[3:]))))
    return max(math.dist(a[:3], b[:3]), math.sqrt(max(0.0, 1 - turn * turn)) * 2)


class Report:
    def __init__(self):
        self.bad = self.rows = 0

    def row(self, what, good, text):
        self.rows += 1
        self.bad += not good
        print(f"| {what} | {text} | {'agrees' if good else 'DIFFERS'} |", flush=True)

    def near(self, what, difference, most=NEAR):
        self.row(what, difference <= most, f"{difference:.1e} apart, at most {most:.0e}")


def ours(probe, address, frequency, what):
    done = subprocess.run([probe, address, *PORTS, frequency, what], capture_output=True, text=True, timeout=60)
    if done.returncode:
        raise SystemExit(f"our driver: {done.stdout}{done.stderr}")
    return json.loads(done.stdout)


def compare(report, emulator, probe, address, generation):
    frequency = "125" if generation == "cb3" else "500"
    receive = rtde_receive.RTDEReceiveInterface(address)
    facts = ours(probe, address, frequency, "facts")
    report.near("pose at rest, emulator and ur_rtde", apart(emulator.tool()["tool"], receive.getActualTCPPose()))
    report.near("pose at rest, our driver and ur_rtde", apart(facts["pose"], receive.getActualTCPPose()))
    joints = max(abs(a - b) for a, b in zip(facts["joints"], receive.getActualQ()))
    report.near("joints at rest, our driver and ur_rtde", joints, 1e-6)
    modes = [receive.getRobotMode(), receive.getSafetyMode()]
    report.row("robot mode, safety mode", modes == [facts["robot_mode"], facts["safety_mode"]], str(modes))
    first, clock = receive.getTimestamp(), time.monotonic()
    time.sleep(1)
    rate = (receive.getTimestamp() - first) / (time.monotonic() - clock)
    report.row("the clock of the arm", abs(rate - 1) < 0.05, f"{rate:.3f} s a second")

    dashboard = dashboard_client.DashboardClient(address)
    dashboard.connect()
    version = dashboard.polyscopeVersion()
    report.row("version", version in facts["polyscope"], version)
    if generation == "e-series":  # ur_rtde asks no CB3 for it
        serial = dashboard.getSerialNumber()
        report.row("serial number", serial == facts["serial"], serial)
        report.row("remote control", dashboard.isInRemoteControl(), "")
    dashboard.disconnect()

    control = rtde_control.RTDEControlInterface(address)
    report.row("ur_rtde's program plays", control.isProgramRunning(), emulator.ask("messages")[-90:].replace("|", "/"))
    start = receive.getActualTCPPose()
    target, calls = list(start), []
    for step in range(1, 51):
        angle = step * 2 * math.pi / 100
        target[0] = start[0] + 0.02 * (1 - math.cos(angle))
        target[2] = start[2] + 0.02 * math.sin(angle)
        begin = time.monotonic()
        control.servoL(target, 0, 0, 0.008, 0.05, 300)
        calls.append(time.monotonic() - begin)
        time.sleep(0.008)
    report.row("50 servoL", max(calls) < 0.5, f"the longest call took {max(calls) * 1e3:.1f} ms")
    held = time.monotonic()
    while time.monotonic() - held < 0.6:
        control.servoL(target, 0, 0, 0.008, 0.05, 300)
        time.sleep(0.008)
    report.near("pose after servoL, target and ur_rtde", apart(target, receive.getActualTCPPose()), 1e-4)
    report.near("pose after servoL, emulator and ur_rtde", apart(emulator.tool()["tool"], receive.getActualTCPPose()), 1e-4)
    report.row("servoStop", control.servoStop(), "")
    moved = control.moveL(start, 0.05, 0.5)
    report.row("moveL", moved, "")
    report.near("pose after moveL, start and ur_rtde", apart(start, receive.getActualTCPPose()))
    report.near("pose after moveL, emulator and ur_rtde", apart(emulator.tool()["tool"], receive.getActualTCPPose()))
    inverse = control.getInverseKinematics(target)
    report.row("moveJ to the joints of the target", control.moveJ(inverse, 0.5, 1.0), "")
    report.near("pose after moveJ, target and ur_rtde", apart(target, receive.getActualTCPPose()))
    report.near("pose after moveJ, ur_rtde's question", apart(target, control.getForwardKinematics()))
    report.row("moveL back", control.moveL(start, 0.05, 0.5), "")
    control.setTcp([0, 0, 0.1, 0, 0, 0])
    report.near("TCP set and read by ur_rtde", apart(control.getTCPOffset(), [0, 0, 0.1, 0, 0, 0]), 1e-9)
    again = ours(probe, address, frequency, "facts")
    report.near("TCP set by ur_rtde, read by our driver", apart(again["tcp"], [0, 0, 0.1, 0, 0, 0]), 1e-9)
    control.setTcp([0] * 6)
    report.row("runtime state while it plays", receive.getRuntimeState() == again["runtime_state"] == 2, str(again["runtime_state"]))
    control.stopScript()
    control.disconnect()

    drive = ours(probe, address, frequency, "drive")
    report.near("pose after 50 of our poses, target and our driver", apart(drive["target"], drive["circle"]), 1e-4)
    report.near("pose after our straight move, ours and ur_rtde", apart(drive["back"], receive.getActualTCPPose()))
    upper = rtde_receive.RTDEReceiveInterface(address, -1.0, [], False, True)
    registers = [upper.getOutputIntRegister(at) for at in range(36, 40)]
    again = ours(probe, address, frequency, "facts")
    report.row("registers of our program, read by both", registers == again["registers"] and registers[0] == 5, str(registers))
    upper.disconnect()
    report.near("pose after both, start of ur_rtde and now", apart(start, receive.getActualTCPPose()), 5e-5)
    receive.disconnect()

    # What happens to the arm, both tell.
    for fault, mode in [("protective-stop", 3), ("clear", 1), ("emergency-stop", 7), ("clear", 1)]:
        emulator.ask(fault)
        time.sleep(0.2)
        receive = rtde_receive.RTDEReceiveInterface(address)
        both = [receive.getSafetyMode(), ours(probe, address, frequency, "facts")["safety_mode"]]
        report.row(f"safety mode after {fault}", both == [mode, mode], str(both))
        receive.disconnect()


def main():
    address = sys.argv[1] if len(sys.argv) > 1 else "127.0.0.3"
    report = Report()
    for generation in ["cb3", "e-series"]:
        print(f"\n{generation}\n\n| what | found | |\n|---|---|---|")
        emulator = Emulator(BUILT / "emulate-ur", generation, address)
        try:
            compare(report, emulator, BUILT / "examples" / "ur_probe", address, generation)
        finally:
            report.row("the emulator ends with its input", emulator.close() == 0, "")
    print(f"\n{report.rows} comparisons, {report.bad} differences")
    sys.exit(report.bad > 0)


if __name__ == "__main__":
    main()
