"""The learner of the robots whose bodies are designed: SAC, a controller that sees the design, and a design that is drawn once an
episode (Schaff et al. 2019) and moved by the critics' gradient."""

LEARNER = """
[controller]
hidden = [128, 128]
activation = "relu"
sees_design = true

[design]
learning_rate_scale = 0.3 # with 1 all goes to a limit within 5,000 gradient steps, while critics know little

[noise]
command = 0.5
design = 0.2
design_final = 0.02
anneal = [0.3, 0.8]
train = false

[learner]
algorithm = "sac"

[sac]
warmup_steps = 10_000
design_start = 0.3 # critics see many designs before the first moves
critic_hidden = [128, 128]
updates_per_step = 0.5
learning_rate = 1e-3
critic_learning_rate = 1e-3
learning_rate_final = 0.1

[train]
env_steps = 150_000
steps_per_iteration = 500
episodes_per_iteration = 2
episode_steps = 250
evaluation_episodes = 40
"""
