"""The recorded episodes of z-grasp, as MuJoCo's own objects."""
import copy
import json
from pathlib import Path

import mujoco
import numpy as np

TYPES = {"sphere": mujoco.mjtGeom.mjGEOM_SPHERE, "box": mujoco.mjtGeom.mjGEOM_BOX,
         "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER, "ellipsoid": mujoco.mjtGeom.mjGEOM_ELLIPSOID}


class Episodes:
    """What `grasp_rollouts` wrote: `controls` [E × T × U], `wrenches` [E × T × 2 × 6] on palm and object, `rewards` [E × T]."""

    def __init__(self, folder):
        folder = Path(folder)
        about = json.loads((folder / "episodes.json").read_text())
        self.substeps, self.names, self.episodes = about["substeps"], about["names"], about["episodes"]
        self.model = mujoco.MjModel.from_xml_path(str(folder / "model.xml"))
        shape = len(self.episodes), self.episodes[0]["steps"]
        self.controls = np.fromfile(folder / "controls.f64").reshape(*shape, self.model.nu)
        self.wrenches = np.fromfile(folder / "wrenches.f64").reshape(*shape, 2, 6)
        self.rewards = np.fromfile(folder / "rewards.f64").reshape(shape)
        self.bodies = [self.model.body(self.names[body]).id for body in ("palm", "object")]
        self.objects = [self.model.geom(self.names[geom]).id for geom in ("object_geom", "floor")]

    def edit(self, model, data, index):
        """Gives a model the object of an episode, and brings the data to its start."""
        episode, (geom, floor), (_, body) = self.episodes[index], self.objects, self.bodies
        half = 0.5 * np.array(episode["size"])
        sizes = {"sphere": [half[0], 0, 0], "cylinder": [half[0], half[2], 0]}
        model.geom_type[geom] = TYPES[episode["kind"]]
        model.geom_size[geom] = sizes.get(episode["kind"], half)
        model.body_mass[body], model.body_inertia[body] = episode["mass"], episode["inertia"]
        model.geom_friction[[geom, floor], 0] = episode["friction"]
        mujoco.mj_setConst(model, data)
        mujoco.mj_resetData(model, data)
        data.qpos[:] = episode["start"]

    def models(self):
        """A model for each episode, and the full states that they start from."""
        signature = mujoco.mjtState.mjSTATE_FULLPHYSICS
        models, starts = [], []
        for index in range(len(self.episodes)):
            model = copy.copy(self.model)
            data = mujoco.MjData(model)
            self.edit(model, data, index)
            start = np.empty(mujoco.mj_stateSize(model, signature))
            mujoco.mj_getState(model, data, start, signature)
            models.append(model)
            starts.append(start)
        return models, np.array(starts)
