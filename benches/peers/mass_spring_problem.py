"""The mass-spring problem of the experiment `mass-spring`, as docs/experiments.md and crates/tasks/src/mass_spring have it.

Lengths in m, speeds in m/s, forces in N, stiffnesses in N/m.
"""
SPRINGS = 10
LARGEST_STIFFNESS = 100.0 / SPRINGS
MASS = 0.2  # of both
BAR = 0.1
GRAVITY = 9.8
MOTOR = 5.0
TIME_STEP = 0.002
SUBSTEPS = 5
GOAL = 0.2
HIGHEST = 0.5
FASTEST = 2.0
# Weights of distance, speed and force, threshold and slope of the reward.
ALPHA, BETA, GAMMA, EPSILON, SLOPE = 10.0, 0.5, 2.0, 0.1, 10.0
# What the controller sees: (y1 - centre)/scale, v1/scale.
CENTRE, POSITION_SCALE, SPEED_SCALE = 0.1, 0.05, 0.25

# PPO, as in experiments/mass-spring.toml.
HIDDEN = 32
EPISODES, HORIZON = 20, 200
EPOCHS, MINIBATCH = 4, 1000
DISCOUNT, LAMBDA, CLIP, ENTROPY = 0.99, 0.98, 0.3, 3e-3
LEARNING_RATE, DESIGN_RATE, LOG_STD_RATE, GRADIENT_NORM = 1e-3, 10.0, 0.5, 0.5
OUTPUT_GAIN = 0.1
EFFORT_STD, MOTOR_STD = 3.0, 3.0  # 3 N, and 0.3 of the motor's range of 10 N
# Returns reach -500; the peers' value networks learn them as they are, so rewards are made smaller for all of them.
REWARD_SCALE = 0.01
