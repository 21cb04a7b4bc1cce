"""The learner of the robots whose bodies are designed: SAC and a controller that sees the design, which is drawn once an episode from a
distribution that moves by what episodes earned (Schaff et al. 2019)."""

# A walker falls for long, and what it does after a second is unlike its start.
HALF_CHEETAH = {"start": 0.2, "window": 60, "anneal": [0.25, 0.6], "steps": 150_000, "episodes": 2, "episode": 250}
WALKER = {"start": 0.3, "window": 100, "anneal": [0.4, 0.7], "steps": 300_000, "episodes": 1, "episode": 1000}


def learner(start, window, anneal, steps, episodes, episode):
    return f"""
[controller]
hidden = [128, 128]
activation = "relu"
sees_design = true

[design]
learning_rate_scale = 4.0

[noise]
command = 0.5
design = 0.5 # of its range: controller and critics see all kinds of bodies
design_final = 0.02
anneal = {anneal}
train = false

[learner]
algorithm = "sac"

[sac]
warmup_steps = 10_000
design_start = {start}
design_returns = {window}
critic_hidden = [128, 128]
updates_per_step = 0.5
learning_rate = 1e-3
critic_learning_rate = 1e-3
learning_rate_final = 0.1

[train]
env_steps = {steps}
episodes_per_iteration = {episodes}
episode_steps = {episode}
evaluation_episodes = 40
"""


# By robot.
LEARNERS = {"half_cheetah_legs": learner(**HALF_CHEETAH), "walker2d_lengths": learner(**WALKER)}
