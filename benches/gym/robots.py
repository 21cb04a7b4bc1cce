"""The experiments of a training on Gymnasium's robots: the task of ROBOT.toml, and a learner with the settings of Tianshou's
benchmark (https://github.com/thu-ml/tianshou, examples/mujoco) wherever the program has them.

Two things differ. Lanes begin with a fresh episode in each iteration, where their environments go on: training episodes are cut at
250 steps, so that an iteration has eight starts, but for the hopper's, whose later steps are unlike the first. And TRPO's values are
fitted as PPO's are, in minibatches: with theirs, 20 steps on the whole batch, a
training of the cheetah came to 670 in a million steps.

SAC has the defaults of Stable-Baselines3, which `sac_contest.py` trains beside it.
"""

import pathlib
import shutil

import gymnasium

from designed import LEARNERS as DESIGNING

HERE = pathlib.Path(__file__).parent
ROBOTS = {
    "half_cheetah": "HalfCheetah-v5",
    "hopper": "Hopper-v5",
    "inverted_double_pendulum": "InvertedDoublePendulum-v5",
    "reacher": "Reacher-v5",
}
# Robots whose bodies are designed.
DESIGNED = {
    "half_cheetah_legs": "HalfCheetah-v5",
    "walker2d_lengths": "Walker2d-v5",
}
CONTROLLER = """
[controller]
hidden = [64, 64]
squash = false
output_gain = 0.01
normalize_observations = true
"""
# Of Stable-Baselines3's SAC: observations as they are, the last layer as torch draws it, and a spread of 1 before the squash.
SAC_CONTROLLER = """
[controller]
hidden = [256, 256]
activation = "relu"
output_gain = 0.4

[noise]
command = 0.5
"""
VALUES = """
[baseline]
hidden = [64, 64]
learning_rate = 3e-4
learning_rate_final = 0.667
epochs = 10
minibatch_rows = 64
"""
LEARNER = {
    "ppo": """
[ppo]
learning_rate = 3e-4
learning_rate_final = 0.667   # theirs falls to nothing at three million steps
epochs = 10
minibatch_rows = 64
normalize_advantages = false
recompute_advantages = true
""",
    # Defaults; warm-up as RL Baselines3 Zoo has it. Critics begin at 0 and the temperature at 1, in units of the return, like theirs.
    "sac": """
[learner]
algorithm = "sac"

[sac]
warmup_steps = 10_000
initial_value = 0.0
value_scale = 1.0
temperature = 1.0
""",
    "trpo": """
[learner]
algorithm = "trpo"

[trpo]
max_kl = 0.01
backtracks = 10
damping = 0.01
""",
}
# Steps of an iteration.
STEPS = {"ppo": 2000, "trpo": 1000}
# Steps of a training episode, at most.
EPISODE = {"half_cheetah": 250, "hopper": 1000, "inverted_double_pendulum": 250, "reacher": 50}


def train(steps, episode, env_steps):
    return f"""
[train]
env_steps = {env_steps}
steps_per_iteration = {steps}
episodes_per_iteration = {steps // episode}
episode_steps = {episode}
evaluation_episodes = 100
"""


def train_by_episodes(robot, env_steps):
    """Of SAC: after each whole episode as many gradient steps as it had steps."""
    return f"""
[train]
env_steps = {env_steps}
episodes_per_iteration = 1
episode_steps = {50 if robot == "reacher" else 1000}
evaluation_episodes = 100
"""


def copy_model(env, folder):
    """Takes the model of an environment from its package."""
    model = pathlib.Path(gymnasium.make(env).unwrapped.fullpath)
    shutil.copy(model, pathlib.Path(folder) / model.name)


def write_designed(robot, folder):
    """Writes the experiment of a robot whose body is designed, with its model; returns its path."""
    copy_model(DESIGNED[robot], folder)
    path = pathlib.Path(folder) / f"{robot}.toml"
    path.write_text((HERE / f"{robot}.toml").read_text() + DESIGNING[robot])
    return path


def write(robot, algorithm, folder, env_steps=1_000_000):
    """Writes the experiment with its model; returns its path."""
    folder = pathlib.Path(folder)
    text = (HERE / f"{robot}.toml").read_text()
    copy_model(ROBOTS[robot], folder)
    if algorithm == "sac":
        text += SAC_CONTROLLER + LEARNER["sac"] + train_by_episodes(robot, env_steps)
    else:
        text += CONTROLLER + LEARNER[algorithm] + VALUES + train(STEPS[algorithm], EPISODE[robot], env_steps)
    path = folder / f"{robot}-{algorithm}.toml"
    path.write_text(text)
    return path
