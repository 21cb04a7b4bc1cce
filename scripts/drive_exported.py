#!/usr/bin/env python3
"""Grasps with an exported hand in PyPI's MuJoCo, from the exported files alone. Python 3.10 or newer.

    hwasp export results/z-grasp --onnx --mjcf --out exported
    pip install mujoco onnxruntime numpy
    python3 scripts/drive_exported.py exported --episodes 100

It shares no code and no number with hwasp: what it needs to know, contract.json says. Change it for a robot of your own;
exported_scene.py beside it has the objects.
"""
import argparse
import json
from pathlib import Path
from types import SimpleNamespace

import mujoco
import numpy as np
import onnxruntime
from exported_scene import clearance, compile_scene, draw_object

DRAWN = ("torque_gain", "limit_gain", "motor_friction", "slack", "arm_lag", "delay")  # once an episode


def read_contract(path):
    """Ports and control as they stand there, and what is listed by subject as `contract.start.palm_height`."""
    told = json.loads(path.read_text())
    value = lambda fact: next(fact[key] for key in ("value", "range", "text", "names") if key in fact)
    topics = {t["name"]: SimpleNamespace(**{f["name"]: value(f) for f in t["facts"]}) for t in told["manual"]}
    return SimpleNamespace(**{key: told[key] for key in ("control", "observation", "command")}, **topics)


def spool(wound, lengths, stiffness, limit):
    """The travel that the motor can hold, and the tension of all tendons there."""
    pull = lambda travel: stiffness * sum(max(travel - length, 0.0) for length in lengths)
    low, high = 0.0, wound
    for _ in range(50 if pull(wound) > limit else 0):
        middle = (low + high) / 2
        low, high = (middle, high) if pull(middle) <= limit else (low, middle)
    return high, pull(high)


class Sensors:
    """What the controller is told: readings with noise, an object that nobody may follow, and all of it late."""

    def __init__(self, contract, late, rng):
        self.ports, self.bench, self.late, self.rng = contract.observation, contract.bench, late, rng
        self.told, self.first, self.grip = [], None, None

    def read(self, seen):
        reading = {port["name"]: seen[port["name"]] + self.rng.normal(0, port["noise_std"]) for port in self.ports}
        palm, thing = (np.array([reading[f"{what}_{axis}"] for axis in "xyz"]) for what in ("palm", "object"))
        self.first = thing if self.first is None else self.first
        if self.bench.object_sensed == "carried" and self.grip is None and reading["motor_torque"] >= self.bench.grasp_felt:
            self.grip = self.first - palm
        if self.bench.object_sensed != "tracked":
            thing = self.first if self.grip is None else palm + self.grip
        if any(port["name"] == "object_x" and port["frame"] == "palm" for port in self.ports):
            thing = thing - palm
        reading |= {f"object_{axis}": value for axis, value in zip("xyz", thing)}
        assert np.isfinite(list(reading.values())).all(), f"a sensor does not work: {reading}"
        self.told.append([reading[port["name"]] for port in self.ports])
        return np.array(self.told[max(0, len(self.told) - 1 - self.late)], "float32")


def grasp(path, contract, controller, rng):
    """One episode: the object's shape, and whether it was held."""
    names, start, motor, bench = contract.model, contract.start, contract.transmission, vars(contract.bench)
    thing, period, asked = draw_object(contract.objects, rng), contract.control["period_s"], contract.success
    push = np.repeat([contract.disturbance.force, contract.disturbance.torque], 3)
    model = compile_scene(path, names, thing)
    data = mujoco.MjData(model)
    palm, pose = [data.joint(joint) for joint in names.palm_joints], data.joint(names.object_joint).qpos
    tendons, winches = [data.tendon(name) for name in names.tendons], [data.actuator(name) for name in names.winches]
    # The object lies on the floor, the palm is above it, and every target is where the robot stands.
    box, yaw, tip = thing.size[[2, 1, 0]] if thing.lies else thing.size, rng.uniform(*start.object_yaw), np.pi / 2 * thing.lies
    pose[:3] = rng.uniform(*start.object_x), rng.uniform(*start.object_y), box[2] / 2
    turned, tipped = [np.cos(yaw / 2), 0, 0, np.sin(yaw / 2)], [np.cos(tip / 2), 0, np.sin(tip / 2), 0]
    mujoco.mju_mulQuat(pose[3:], turned, tipped)
    target = {"palm_x": start.palm_x, "palm_y": start.palm_y, "palm_z": box[2] + rng.uniform(*start.palm_height), "motor": 0.0}
    for slide, value in zip(palm, target.values()):
        slide.qpos[:] = value
    mujoco.mj_forward(model, data)
    # The bench of this episode.
    gain, weak, friction, slack, lag, delay = (rng.uniform(*bench[name]) for name in DRAWN)
    sensors, follow = Sensors(contract, round(delay / period), rng), dict(target)
    most = max(weak * motor.tension_limit - friction / motor.spool_radius, 0.0)
    torque, rubbed, held, moments, grasped = 0.0, 0.0, 0.0, [], model.geom(names.object_geom).id
    thumb, fingers = ({model.geom(geom).id for geom in part} for part in (names.thumb, names.fingers))
    for _ in range(contract.control["horizon_steps"]):
        travel = target["motor"] if bench["travel_sensed"] == "commanded" else held
        seen = {"motor_travel": travel, "motor_torque": gain * (torque + rubbed), "motor_travel_target": target["motor"]}
        for axis, slide, *values in zip("xyz", palm, pose, box):
            seen |= zip((f"palm_{axis}", f"object_{axis}", f"size_{axis}"), (slide.qpos[0], *values))
        commands = controller.run(["command"], {"observation": sensors.read(seen)[None]})[0][0].astype(float)
        speed = np.linalg.norm(commands[:-1]) / period
        commands[:-1] *= min(1.0, bench.get("palm_speed", np.inf) / max(speed, 1e-9))
        reached = dict(target)
        for port, command in zip(contract.command, commands):
            name, about = port["name"], port["target"]
            target[name] = float(np.clip(target[name] + command, *about["limits"]))
            follow[name] += (target[name] - follow[name]) * (1 - np.exp(-period / lag) if lag and name != "motor" else 1)
            reached[name] = follow[name] + rng.normal(0, about["noise_std"])
        for axis, actuator in zip("xyz", names.palm_actuators):
            data.actuator(actuator).ctrl[:] = reached[f"palm_{axis}"]
        for body in (names.palm, names.object):
            data.body(body).xfrc_applied[:] = rng.normal(0, push)
        wound = min(max(reached["motor"], 0.0), motor.travel) - slack
        for _ in range(round(period / model.opt.timestep)):
            lengths = [float(tendon.length[0]) for tendon in tendons]
            travel, tension = spool(wound, lengths, motor.tendon_stiffness, most)
            for winch in winches:
                winch.ctrl[:] = travel
            mujoco.mj_step(model, data)
        torque, held = motor.spool_radius * tension, travel + slack
        if commands[-1]:  # friction is against the spool, which winds, is held back, or pays out
            rubbed = friction if commands[-1] > 0 or wound + slack > held else -friction
        touched = {int(geom) for contact in data.contact for geom in contact.geom if grasped in contact.geom}
        held_at = pose[:3] - [slide.qpos[0] for slide in palm]
        moments.append((clearance(thing, pose), bool(touched & thumb and touched & fingers), held_at))
    heights, touches, places = zip(*moments[-int(asked.hold_steps) :])
    drift = np.linalg.norm(np.subtract(places, places[0]), axis=1).max()
    return thing.shape, min(heights) >= asked.hold_height and np.mean(touches) >= asked.touch_share and drift <= asked.drift


def told(won, count, z=1.959964):
    """A share with Wilson's interval, 95 %."""
    share, more = won / count, z * z / count
    half = z * np.sqrt(share * (1 - share) / count + more / (4 * count))
    low, high = ((share + more / 2 + sign * half) / (1 + more) for sign in (-1, 1))
    return f"{won:4} of {count:4} held: {share:.1%}, 95 % interval {low:.1%} to {high:.1%}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="where the export is")
    parser.add_argument("--episodes", type=int, default=100, help="objects to grasp")
    parser.add_argument("--at-least", type=float, default=0.0, help="fail where fewer than this share are held")
    args = parser.parse_args()
    contract = read_contract(args.folder / "contract.json")
    controller = onnxruntime.InferenceSession(args.folder / "controller.onnx")
    streams = (np.random.default_rng(number) for number in range(args.episodes))
    grasps = [grasp(args.folder / "hand.xml", contract, controller, rng) for rng in streams]
    for kind in ("all", *contract.objects.shapes):
        won = [success for shape, success in grasps if kind in ("all", shape)]
        print(f"{kind:10}", told(sum(won), len(won)) if won else "none was drawn")
    return int(sum(success for _, success in grasps) < args.at_least * len(grasps))


if __name__ == "__main__":
    raise SystemExit(main())
