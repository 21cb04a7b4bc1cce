"""grasp_gymnasium.py FOLDER VEC ENVIRONMENTS: environment steps per second of Gymnasium's vector environments.

VEC is `sync` or `async`. The environment is z-grasp: ten steps of the physics, observation and reward. Its controls and
forces are recorded ones, so that nobody has to compute them.
"""
import json
import math
import sys
import time

import gymnasium
import mujoco
import numpy as np
from gymnasium.vector import AsyncVectorEnv, AutoresetMode, SyncVectorEnv

from grasp_model import Episodes

HEIGHTS = [(0.1, 4.0), (0.05, 2.0), (0.02, 1.0), (0.005, 0.5)]


class Grasp(gymnasium.Env):
    """Observation: the controller's 11 numbers, then motor travel and joint angles for the law. Action: controls, forces."""

    def __init__(self, folder):
        self.episodes = Episodes(folder)
        self.model = self.episodes.model
        self.data = mujoco.MjData(self.model)
        names = self.episodes.names
        def address(joint):
            return self.model.joint(joint).qposadr[0]
        self.palm = [address(joint) for joint in names["palm_joints"]]
        self.joints = [address(joint) for joint in names["joints"]]
        self.object = address(names["object_joint"])
        self.links = {self.model.geom(link).id: index for index, link in enumerate(names["links"])}
        self.geom = self.episodes.objects[0]
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (18,), np.float64)
        self.action_space = gymnasium.spaces.Box(-np.inf, np.inf, (self.model.nu + 12,), np.float64)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        index = (options or {}).get("episode", 0)
        # An option of a vector of environments comes as one for all: each takes what is its own.
        index = index[seed] if isinstance(index, list) else index
        self.episodes.edit(self.model, self.data, index)
        self.size = np.array(self.episodes.episodes[index]["size"])
        self.taken, self.travel, self.torque = 0, 0.0, 0.0
        return self.seen(), {}

    def seen(self):
        position = self.data.qpos
        return np.concatenate([position[self.palm], position[self.object:self.object + 3], self.size,
                               [self.travel, self.torque, self.travel], position[self.joints]])

    def reach_down(self):
        """How far the object's lowest point is below its centre."""
        w, x, y, z = self.data.qpos[self.object + 3:self.object + 7].tolist()
        up = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)
        a, b, c = (u * 0.5 * s for u, s in zip(up, self.size.tolist()))
        kind = self.model.geom_type[self.geom]
        if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
            return 0.5 * self.size[0]
        if kind == mujoco.mjtGeom.mjGEOM_BOX:
            return abs(a) + abs(b) + abs(c)
        if kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
            return math.hypot(a, b) + abs(c)
        return math.sqrt(a * a + b * b + c * c)

    def step(self, action):
        data = self.data
        data.ctrl[:] = action[:self.model.nu]
        data.xfrc_applied[self.episodes.bodies] = action[self.model.nu:].reshape(2, 6)
        mujoco.mj_step(self.model, data, self.episodes.substeps)
        self.taken += 1
        position = data.qpos
        distance = math.dist(position[self.palm].tolist(), position[self.object:self.object + 3].tolist())
        clearance = position[self.object + 2] - self.reach_down()
        touching = set()
        if data.ncon:
            # One look at each array of the contacts.
            geoms, excluded = data.contact.geom.tolist(), data.contact.exclude.tolist()
            for (one, other), left_out in zip(geoms, excluded):
                if not left_out and self.geom in (one, other):
                    touching.add(self.links.get(other if one == self.geom else one))
        distal = len(touching & {1, 3, 5})
        lifted = next((worth for height, worth in HEIGHTS if clearance >= height), 0.0)
        reward = -2.0 * distance + 0.1 * distal + lifted
        return self.seen(), reward, False, self.taken >= self.episodes.controls.shape[1], {}


def main():
    folder, kind, count = sys.argv[1], sys.argv[2], int(sys.argv[3])
    episodes = Episodes(folder)
    total, steps, _ = episodes.controls.shape
    actions = np.concatenate([episodes.controls, episodes.wrenches.reshape(total, steps, -1)], axis=2)
    make = [lambda: Grasp(folder)] * count
    if kind == "sync":
        vec = SyncVectorEnv(make, autoreset_mode=AutoresetMode.DISABLED)
    else:
        vec = AsyncVectorEnv(make, context="fork", autoreset_mode=AutoresetMode.DISABLED)
    off, seconds = 0.0, 0.0
    for first in range(0, total - total % count, count):
        began = time.perf_counter()
        vec.reset(seed=list(range(count)), options={"episode": list(range(first, first + count))})
        rewards = np.empty((steps, count))
        for step in range(steps):
            _, rewards[step], *_ = vec.step(actions[first:first + count, step])
        seconds += time.perf_counter() - began
        off = max(off, np.abs(rewards.T - episodes.rewards[first:first + count]).max())
    vec.close()
    print(json.dumps({"rate": (total - total % count) * steps / seconds, "off": off}))


if __name__ == "__main__":
    main()
