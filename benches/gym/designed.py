"""The learner of the robots whose bodies are designed: SAC and a controller that sees the design, which is drawn once an episode from a
distribution that moves (Schaff et al. 2019)."""

COMMON = """
[controller]
hidden = [128, 128]
activation = "relu"
sees_design = true

[learner]
algorithm = "sac"

[sac]
warmup_steps = 10_000
critic_hidden = [128, 128]
updates_per_step = 0.5
learning_rate = 1e-3
critic_learning_rate = 1e-3
learning_rate_final = 0.1
{sac}

[noise]
command = 0.5
design = 0.5 # of its range: controller and critics see all kinds of bodies
design_final = 0.02
anneal = {anneal}
train = false

[design]
learning_rate_scale = {rate}

[train]
env_steps = 150_000
{iterations}
episode_steps = 250
evaluation_episodes = 40
"""

# By robot. A walker falls after 250 steps, which no episode of a training tells: critics know more of what is to come.
LEARNERS = {
    "half_cheetah_legs": COMMON.format(
        sac="design_start = 0.2\ndesign_returns = 60", anneal=[0.25, 0.6], rate=4.0, iterations="episodes_per_iteration = 2"
    ),
    "walker2d_lengths": COMMON.format(
        sac="design_start = 0.3",
        anneal=[0.3, 0.8],
        rate=0.3,
        iterations="steps_per_iteration = 500\nepisodes_per_iteration = 2",
    ),
}
