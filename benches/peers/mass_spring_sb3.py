"""mass_spring_sb3.py VEC ENVIRONMENTS STEPS: steps per second of Stable-Baselines3's PPO on the mass-spring problem.

VEC is `dummy` or `subproc`. The policy is hwasp's: the springs' law between the controller and the mean of the action.
"""
import json
import math
import os
import random
import sys
import time

import gymnasium
import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.vec_env import DummyVecEnv, SubprocVecEnv

from mass_spring_problem import *


class MassSpring(gymnasium.Env):
    """One action is [effort on both masses, motor force], the second for the reward alone."""

    observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (2,), np.float32)
    # Limits, which the class demands, beyond all that is ever sampled.
    action_space = gymnasium.spaces.Box(-1e3, 1e3, (2,), np.float32)

    def seen(self):
        return np.array([(self.y - CENTRE) / POSITION_SCALE, self.v / SPEED_SCALE], np.float32)

    def reset(self, *, seed=None, options=None):
        if seed is not None:
            self.random = random.Random(seed)
        self.y, self.v, self.taken = self.random.uniform(0, HIGHEST), self.random.uniform(-FASTEST, FASTEST), 0
        return self.seen(), {}

    def step(self, action):
        effort, motor = action.tolist()
        a = GRAVITY + effort / MASS
        y, v = self.y, self.v
        for _ in range(SUBSTEPS):
            y += v * TIME_STEP + a * (0.5 * TIME_STEP * TIME_STEP)
            v += a * TIME_STEP
        self.y, self.v = y, v = min(max(y, 0.0), HIGHEST), min(max(v, -FASTEST), FASTEST)
        error = ALPHA * abs(y + BAR - GOAL) + BETA * abs(v)
        least, most = GAMMA * min(abs(motor), MOTOR), GAMMA * MOTOR
        far = 1.0 / (1.0 + math.exp(-SLOPE * (error - EPSILON)))
        self.taken += 1
        reward = -error - (least + (most - least) * far)
        return self.seen(), REWARD_SCALE * reward, False, self.taken >= HORIZON, {}


class Hardware(torch.nn.Module):
    """From the controller's last hidden layer and the position to the mean of the action: the springs' law."""

    def __init__(self):
        super().__init__()
        self.motor = torch.nn.Linear(HIDDEN, 1)
        # Adam's steps do not depend on a gradient's scale: a smaller number moves faster by as much.
        self.design = torch.nn.Parameter((10.0 * torch.rand(SPRINGS) - 5.0) / DESIGN_RATE)

    def total(self):
        return LARGEST_STIFFNESS * torch.sigmoid(DESIGN_RATE * self.design).sum()

    def forward(self, hidden_and_position):
        hidden, position = hidden_and_position[:, :HIDDEN], hidden_and_position[:, HIDDEN:]
        motor = MOTOR * torch.tanh(self.motor(hidden))
        return torch.cat([motor - self.total() * position, motor], dim=1)


class Extractor(torch.nn.Module):
    """Two hidden layers each for policy and value; hands the position on to the law."""

    latent_dim_pi, latent_dim_vf = HIDDEN + 1, HIDDEN

    def __init__(self):
        super().__init__()
        def layers():
            return torch.nn.Sequential(torch.nn.Linear(2, HIDDEN), torch.nn.Tanh(),
                                       torch.nn.Linear(HIDDEN, HIDDEN), torch.nn.Tanh())
        self.policy, self.value = layers(), layers()

    def forward_actor(self, seen):
        return torch.cat([self.policy(seen), seen[:, :1] * POSITION_SCALE + CENTRE], dim=1)

    def forward_critic(self, seen):
        return self.value(seen)

    def forward(self, seen):
        return self.forward_actor(seen), self.forward_critic(seen)


class Policy(ActorCriticPolicy):
    """Stable-Baselines3's policy with the two modules above."""

    def _build_mlp_extractor(self):
        self.mlp_extractor = Extractor()

    def _build(self, schedule):
        super()._build(schedule)
        self.action_net = Hardware()
        with torch.no_grad():
            self.action_net.motor.weight *= OUTPUT_GAIN
            self.log_std.copy_(torch.log(torch.tensor([EFFORT_STD, MOTOR_STD])))
        self.optimizer = self.optimizer_class(self.parameters(), lr=schedule(1), **self.optimizer_kwargs)


class Clock(BaseCallback):
    """Starts after the first iteration, in which everything is loaded and allocated."""

    def __init__(self):
        super().__init__()
        self.starts, self.returns = [], []

    def _on_rollout_start(self):
        self.starts.append((self.num_timesteps, time.perf_counter()))

    def _on_step(self):
        return True

    def _on_rollout_end(self):
        rewards = self.model.rollout_buffer.rewards.reshape(-1, HORIZON, self.model.n_envs)
        weights = DISCOUNT ** np.arange(HORIZON)
        self.returns.append(float(np.mean(np.einsum("eth,t->eh", rewards, weights))) / REWARD_SCALE)


def main():
    kind, environments, steps = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    torch.manual_seed(0)
    torch.set_num_threads(int(os.environ["OMP_NUM_THREADS"]))
    if kind == "dummy":
        vec = DummyVecEnv([MassSpring] * environments)
    else:
        vec = SubprocVecEnv([MassSpring] * environments, start_method="fork")
    rows = EPISODES * HORIZON
    ppo = PPO(Policy, vec, n_steps=rows // environments, batch_size=MINIBATCH, n_epochs=EPOCHS, gamma=DISCOUNT,
              gae_lambda=LAMBDA, clip_range=CLIP, ent_coef=ENTROPY, vf_coef=0.5, max_grad_norm=GRADIENT_NORM,
              learning_rate=LEARNING_RATE, seed=0, device="cpu")
    clock = Clock()
    ppo.learn(steps + rows, callback=clock)
    (before, began), (after, ended) = clock.starts[1], (ppo.num_timesteps, time.perf_counter())
    vec.close()
    print(json.dumps({"rate": (after - before) / (ended - began), "first_return": clock.returns[0],
                      "last_return": clock.returns[-1], "total": ppo.policy.action_net.total().item()}))


if __name__ == "__main__":
    main()
