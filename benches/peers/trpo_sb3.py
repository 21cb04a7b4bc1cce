"""trpo_sb3.py FOLDER UPDATES: seconds of an update of sb3-contrib's TRPO on the rows that `trpo_update` wrote.

The policy is hwasp's, with its parameters: a controller, and the tendons' law between its output and the mean of the action.
"""
import json
import os
import sys
import time
from pathlib import Path

import gymnasium
import numpy as np
import torch
from sb3_contrib import TRPO
from stable_baselines3.common.logger import configure
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.vec_env import DummyVecEnv

FOLDER = Path(sys.argv[1])
ABOUT = json.loads((FOLDER / "policy.json").read_text())
SEEN, *HIDDEN, COMMANDS = ABOUT["controller"]
STATES, EFFORTS = 7, 7
# Proximal and distal joint of thumb, first and second finger, in the order of the design's four kinds.
KINDS = [0, 1, 2, 3, 2, 3]


def numbers(name, width=1):
    return torch.from_numpy(np.fromfile(FOLDER / f"{name}.f32", np.float32).reshape(-1, width))


class Hand(torch.nn.Module):
    """From the controller's last hidden layer, motor travel and joint angles to the mean of [torques, motor torque, commands]."""

    def __init__(self):
        super().__init__()
        self.command = torch.nn.Linear(HIDDEN[-1], COMMANDS)
        limits = torch.tensor(ABOUT["design_limits"])
        self.design = torch.nn.Parameter(torch.zeros(len(limits)))
        self.lowest, self.range = limits[:, 0], limits[:, 1] - limits[:, 0]
        limits = torch.tensor(ABOUT["command_limits"])
        self.middle, self.half = limits.mean(dim=1), 0.5 * (limits[:, 1] - limits[:, 0])

    def forward(self, hidden_and_state):
        hidden, state = hidden_and_state[:, :HIDDEN[-1]], hidden_and_state[:, HIDDEN[-1]:]
        command = self.command(hidden) * self.half + self.middle
        design = self.lowest + self.range * torch.sigmoid(self.design)
        radius, stiffness, preload = (design[i:i + 4][KINDS] for i in (0, 4, 8))
        travel, angles = state[:, :1], state[:, 1:]
        step = command[:, -1:].clamp(-self.half[-1], self.half[-1])
        end = (travel + step).clamp(0.0, ABOUT["travel"])
        taken_up = radius * (angles - torch.tensor(ABOUT["reference"])[KINDS])
        tension = (ABOUT["tendon_stiffness"] * (end - taken_up.view(-1, 3, 2).sum(dim=2))).clamp(min=0.0)
        limit = ABOUT["tension_limit"]
        tension = tension * (limit / tension.sum(dim=1, keepdim=True).clamp(min=limit))
        torque = tension.repeat_interleave(2, dim=1) * radius - stiffness * (angles + preload)
        motor = ABOUT["spool_radius"] * tension.sum(dim=1, keepdim=True)
        return torch.cat([torque, motor, command], dim=1)


class Extractor(torch.nn.Module):
    """Hidden layers of controller and value network; hands the state on to the law."""

    latent_dim_pi, latent_dim_vf = HIDDEN[-1] + STATES, 64

    def __init__(self):
        super().__init__()
        def layers(*sizes):
            pairs = zip((SEEN, *sizes), sizes)
            return torch.nn.Sequential(*(layer for pair in pairs for layer in (torch.nn.Linear(*pair), torch.nn.Tanh())))
        self.policy, self.value = layers(*HIDDEN), layers(64, 64)

    def forward_actor(self, seen):
        return torch.cat([self.policy(seen[:, :SEEN]), seen[:, SEEN:]], dim=1)

    def forward_critic(self, seen):
        return self.value(seen[:, :SEEN])

    def forward(self, seen):
        return self.forward_actor(seen), self.forward_critic(seen)


class Policy(ActorCriticPolicy):
    """Stable-Baselines3's policy with the two modules above and the parameters that were written."""

    def _build_mlp_extractor(self):
        self.mlp_extractor = Extractor()

    def _build(self, schedule):
        super()._build(schedule)
        self.action_net = Hand()
        params, at = numbers("params").flatten(), 0
        layers = [*self.mlp_extractor.policy[::2], self.action_net.command]
        with torch.no_grad():
            for layer in layers:
                rows, columns = layer.in_features, layer.out_features
                layer.weight.copy_(params[at:at + rows * columns].view(rows, columns).T)
                layer.bias.copy_(params[at + rows * columns:at + (rows + 1) * columns])
                at += (rows + 1) * columns
            self.action_net.design.copy_(params[slice(*ABOUT["groups"]["design"])])
            self.log_std.copy_(params[slice(*ABOUT["groups"]["log_std"])])
        self.optimizer = self.optimizer_class(self.parameters(), lr=schedule(1), **self.optimizer_kwargs)


class Spaces(gymnasium.Env):
    """Tells the shapes; the rows are there already."""

    observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (SEEN + STATES,), np.float32)
    action_space = gymnasium.spaces.Box(-1e3, 1e3, (EFFORTS + COMMANDS,), np.float32)

    def reset(self, *, seed=None, options=None):
        return np.zeros(SEEN + STATES, np.float32), {}


def main():
    torch.manual_seed(0)
    torch.set_num_threads(int(os.environ["OMP_NUM_THREADS"]))
    episodes = ABOUT["episodes"]
    obs, action = torch.cat([numbers("obs", SEEN), numbers("state", STATES)], 1), numbers("action", EFFORTS + COMMANDS)
    rows, old, reward = len(obs), numbers("log_prob").flatten(), numbers("reward").flatten()
    steps = rows // episodes
    trpo = TRPO(Policy, DummyVecEnv([Spaces] * episodes), n_steps=steps, batch_size=500, gamma=0.998, gae_lambda=0.97,
                cg_max_steps=10, cg_damping=1e-5, line_search_max_iter=15, n_critic_updates=5, target_kl=0.01,
                device="cpu")
    trpo.set_logger(configure(None, []))
    # The same function of the same parameters: else the comparison would be of different work.
    with torch.no_grad():
        off = (trpo.policy.get_distribution(obs).log_prob(action) - old).abs().max().item()
    buffer = trpo.rollout_buffer

    def by_step(x):
        return x.view(episodes, steps, *x.shape[1:]).transpose(0, 1).numpy()

    start = {name: value.clone() for name, value in trpo.policy.state_dict().items()}
    seconds = []
    # The first one, in which memory is allocated, does not count.
    for update in range(int(sys.argv[2]) + 1):
        trpo.policy.load_state_dict(start)
        buffer.reset()
        buffer.observations[:], buffer.actions[:] = by_step(obs), by_step(action)
        buffer.rewards[:], buffer.log_probs[:] = by_step(reward), by_step(old)
        buffer.pos, buffer.full = steps, True
        began = time.perf_counter()
        with torch.no_grad():
            values = trpo.policy.predict_values(obs)
        buffer.values[:] = by_step(values.flatten())
        buffer.compute_returns_and_advantage(torch.zeros(episodes), np.ones(episodes))
        trpo.train()
        seconds += [time.perf_counter() - began] if update else []
    print(json.dumps({"seconds": seconds, "off": off, "rows": rows,
                      "kl": trpo.logger.name_to_value["train/kl_divergence_loss"]}))


if __name__ == "__main__":
    main()
