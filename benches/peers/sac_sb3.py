"""sac_sb3.py STEPS THREADS: seconds of a gradient step of Stable-Baselines3's SAC with its default settings."""
import json
import sys
import time

import gymnasium
import numpy as np
import torch
from stable_baselines3 import SAC
from stable_baselines3.common.logger import configure

STEPS, THREADS = (int(word) for word in sys.argv[1:])
ROWS, SEEN, COMMANDS = 4000, 11, 2
torch.set_num_threads(THREADS)


class Spaces(gymnasium.Env):
    """No world: what the learner wants to know of one."""

    observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (SEEN,), np.float32)
    action_space = gymnasium.spaces.Box(-1.0, 1.0, (COMMANDS,), np.float32)


sac = SAC("MlpPolicy", Spaces(), device="cpu", seed=0)
sac.set_logger(configure(None, []))
chance = np.random.default_rng(0)
for _ in range(ROWS):
    seen, after = chance.standard_normal((2, 1, SEEN), np.float32)
    action, reward = chance.uniform(-1.0, 1.0, (1, COMMANDS)), chance.standard_normal(1)
    sac.replay_buffer.add(seen, after, action, reward, np.zeros(1, bool), [{}])
sac.train(50, 256)
began = time.perf_counter()
sac.train(STEPS, 256)
print(json.dumps({"seconds_a_step": (time.perf_counter() - began) / STEPS}))
