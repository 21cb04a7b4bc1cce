"""grasp_rollout.py FOLDER HOW THREADS CHUNK: environment steps per second of `mujoco.rollout` on the recorded episodes.

Only the physics: controls and forces were recorded. HOW is `open`, all steps of all episodes in one call, or `closed`, a
call for each environment step, as a controller needs it that has to see where the last one led. CHUNK episodes are given
to a thread at once; 0 leaves that to it.
"""
import json
import sys
import time

import mujoco
import numpy as np
from mujoco.rollout import Rollout

from grasp_model import Episodes

SPEC = int(mujoco.mjtState.mjSTATE_CTRL | mujoco.mjtState.mjSTATE_XFRC_APPLIED)


def main():
    folder, how, threads, chunk = sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4]) or None
    episodes = Episodes(folder)
    models, starts = episodes.models()
    data = [mujoco.MjData(models[0]) for _ in range(threads)]
    count, steps, _ = episodes.controls.shape
    wrenches = np.zeros((count, steps, episodes.model.nbody, 6))
    wrenches[:, :, episodes.bodies] = episodes.wrenches
    given = np.concatenate([episodes.controls, wrenches.reshape(count, steps, -1)], axis=2)
    # The function wants what holds for ten steps of the physics ten times, and returns the state after each.
    given = np.repeat(given, episodes.substeps, axis=1)
    at_once = given.shape[1] if how == "open" else episodes.substeps
    states = np.zeros((count, at_once, starts.shape[1]))
    with Rollout(nthread=threads if threads > 1 else 0) as rollout:
        began = time.perf_counter()
        for first in range(0, given.shape[1], at_once):
            part = np.ascontiguousarray(given[:, first:first + at_once])
            rollout.rollout(models, data, starts, part, control_spec=SPEC, state=states, chunk_size=chunk)
            starts = states[:, -1].copy()
        seconds = time.perf_counter() - began
    ends = np.array([episode["end"] for episode in episodes.episodes])
    off = np.abs(starts[:, 1:1 + episodes.model.nq] - ends).max()
    print(json.dumps({"rate": count * steps / seconds, "off": off}))


if __name__ == "__main__":
    main()
