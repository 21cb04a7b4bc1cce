"""The objects of an exported hand in PyPI's MuJoCo: for drive_exported.py."""
from types import SimpleNamespace

import mujoco
import numpy as np


def draw_object(objects, rng):
    """Its edges are along its own axes. Without moments of inertia it is solid."""
    shape, size, moments = str(rng.choice(objects.shapes)), rng.uniform(*objects.size, 3), None
    size[: {"sphere": 3, "cylinder": 2}.get(shape, 1)] = size[0]
    while objects.inertia != "physical" and (moments is None or 2 * max(moments) > sum(moments)):
        moments = rng.uniform(*objects.inertia, 3)
    thing = SimpleNamespace(shape=shape, size=size, moments=moments, lies=shape == "cylinder" and rng.random() < objects.lying)
    thing.mass, thing.friction = rng.uniform(*objects.mass), rng.uniform(*objects.friction)
    return thing


def compile_scene(path, names, thing):
    """The hand and the floor with this object."""
    spec, half = mujoco.MjSpec.from_file(str(path)), thing.size / 2
    geom, body = spec.geom(names.object_geom), spec.body(names.object)
    geom.type = getattr(mujoco.mjtGeom, f"mjGEOM_{thing.shape.upper()}")
    geom.size = {"sphere": [half[0], 0, 0], "cylinder": [half[0], half[2], 0]}.get(thing.shape, half)
    geom.friction[0] = spec.geom(names.floor_geom).friction[0] = thing.friction
    geom.mass = body.mass = thing.mass
    body.explicitinertial, body.inertia = thing.moments is not None, np.zeros(3) if thing.moments is None else thing.moments
    return spec.compile()


def clearance(thing, pose):
    """Height of the object's lowest point above the floor."""
    matrix = np.zeros(9)
    mujoco.mju_quat2Mat(matrix, pose[3:])
    x, y, z = np.abs(matrix[6:] * thing.size / 2)  # of the vertical in the object's frame
    down = {"sphere": thing.size[0] / 2, "box": x + y + z, "cylinder": np.hypot(x, y) + z}
    return pose[2] - down.get(thing.shape, np.sqrt(x * x + y * y + z * z))
