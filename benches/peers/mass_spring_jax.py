"""mass_spring_jax.py STEPS UNROLL: steps per second of a PPO on the mass-spring problem that is one compiled JAX program.

In the manner of PureJaxRL (Lu et al. 2022): environments, advantages and updates are all inside of one jitted `lax.scan`.
The policy is hwasp's: the springs' law between the controller and the mean of the action. Compiling is not counted.
"""
import json
import sys
import time

import jax
import jax.numpy as jnp

from mass_spring_problem import *

MINIBATCHES = EPISODES * HORIZON // MINIBATCH


def layers(key, sizes, gain):
    pairs = list(zip(sizes, sizes[1:]))
    scales = [1.0] * (len(pairs) - 1) + [gain]
    keys = jax.random.split(key, len(pairs))
    return [(scale * jax.random.normal(k, pair) / jnp.sqrt(pair[0]), jnp.zeros(pair[1]))
            for k, pair, scale in zip(keys, pairs, scales)]


def perceptron(params, x):
    for w, b in params[:-1]:
        x = jnp.tanh(x @ w + b)
    w, b = params[-1]
    return (x @ w + b)[..., 0]


def fresh(key):
    controller, design, value = jax.random.split(key, 3)
    sizes = [2, HIDDEN, HIDDEN, 1]
    policy = {"controller": layers(controller, sizes, OUTPUT_GAIN),
              "design": jax.random.uniform(design, (SPRINGS,), minval=-5.0, maxval=5.0),
              "log_std": jnp.log(jnp.array([EFFORT_STD, MOTOR_STD]))}
    return {"policy": policy, "value": layers(value, sizes, 1.0)}


def stiffness(policy):
    return LARGEST_STIFFNESS * jax.nn.sigmoid(policy["design"]).sum()


def mean(policy, seen):
    """The mean of [effort, motor force]: the controller's force through the springs' law."""
    motor = MOTOR * jnp.tanh(perceptron(policy["controller"], seen))
    position = seen[..., 0] * POSITION_SCALE + CENTRE
    return jnp.stack([motor - stiffness(policy) * position, motor], axis=-1)


def log_prob(policy, centre, action):
    z = (action - centre) * jnp.exp(-policy["log_std"])
    return -(0.5 * z * z + policy["log_std"] + 0.5 * jnp.log(2 * jnp.pi)).sum(axis=-1)


def see(state):
    return jnp.stack([(state[..., 0] - CENTRE) / POSITION_SCALE, state[..., 1] / SPEED_SCALE], axis=-1)


def advance(state, action):
    """The states after one action, and its rewards."""
    y, v = state[..., 0], state[..., 1]
    a = GRAVITY + action[..., 0] / MASS
    for _ in range(SUBSTEPS):
        y, v = y + v * TIME_STEP + a * (0.5 * TIME_STEP**2), v + a * TIME_STEP
    y, v = jnp.clip(y, 0.0, HIGHEST), jnp.clip(v, -FASTEST, FASTEST)
    error = ALPHA * jnp.abs(y + BAR - GOAL) + BETA * jnp.abs(v)
    least, most = GAMMA * jnp.minimum(jnp.abs(action[..., 1]), MOTOR), GAMMA * MOTOR
    far = jax.nn.sigmoid(SLOPE * (error - EPSILON))
    return jnp.stack([y, v], axis=-1), -error - (least + (most - least) * far)


def rollout(params, key, unroll):
    """EPISODES episodes in lock step: what was seen, done and gained [HORIZON × EPISODES], and values [HORIZON + 1 × …]."""
    start, noise = jax.random.split(key)
    low, high = jnp.array([0.0, -FASTEST]), jnp.array([HIGHEST, FASTEST])
    state = jax.random.uniform(start, (EPISODES, 2), minval=low, maxval=high)
    noise = jax.random.normal(noise, (HORIZON, EPISODES, 2))
    policy = params["policy"]
    std = jnp.exp(policy["log_std"])

    def step(state, noise):
        seen = see(state)
        centre = mean(policy, seen)
        action = centre + std * noise
        after, reward = advance(state, action)
        return after, (seen, action, log_prob(policy, centre, action), reward)

    last, (seen, action, old, reward) = jax.lax.scan(step, state, noise, unroll=unroll)
    values = perceptron(params["value"], jnp.concatenate([seen, see(last)[None]]))
    return seen, action, old, reward, values


def advantages(reward, values):
    """Generalised advantages; the episodes are truncated, so that the last state is valued."""
    delta = REWARD_SCALE * reward + DISCOUNT * values[1:] - values[:-1]

    def back(later, delta):
        here = delta + DISCOUNT * LAMBDA * later
        return here, here

    return jax.lax.scan(back, jnp.zeros(EPISODES), delta, reverse=True, unroll=8)[1]


def loss(params, rows):
    seen, action, old, advantage, target = rows
    policy = params["policy"]
    ratio = jnp.exp(log_prob(policy, mean(policy, seen), action) - old)
    clipped = jnp.clip(ratio, 1 - CLIP, 1 + CLIP)
    surrogate = jnp.minimum(ratio * advantage, clipped * advantage).mean()
    value = jnp.square(perceptron(params["value"], seen) - target).mean()
    return 0.5 * value - surrogate - ENTROPY * policy["log_std"].sum()


def clip_norm(gradient):
    norm = jnp.sqrt(sum(jnp.square(g).sum() for g in jax.tree.leaves(gradient)))
    return jax.tree.map(lambda g: g * jnp.minimum(1.0, GRADIENT_NORM / (norm + 1e-8)), gradient)


def adam(params, moments, gradient, rate):
    first, second, count = moments
    count = count + 1
    first = jax.tree.map(lambda m, g: 0.9 * m + 0.1 * g, first, gradient)
    second = jax.tree.map(lambda s, g: 0.999 * s + 0.001 * g * g, second, gradient)
    one, two = 1 - 0.9**count, 1 - 0.999**count
    step = jax.tree.map(lambda m, s: rate * (m / one) / (jnp.sqrt(s / two) + 1e-8), first, second)
    step["policy"]["design"] *= DESIGN_RATE
    step["policy"]["log_std"] *= LOG_STD_RATE
    return jax.tree.map(jnp.subtract, params, step), (first, second, count)


def iteration(carry, rate, unroll):
    params, moments, key = carry
    key, episodes, *shuffles = jax.random.split(key, 2 + EPOCHS)
    seen, action, old, reward, values = rollout(params, episodes, unroll)
    advantage = advantages(reward, values)
    target = advantage + values[:-1]
    advantage = (advantage - advantage.mean()) / (advantage.std() + 1e-8)
    flat = jax.tree.map(lambda x: x.reshape(-1, *x.shape[2:]), (seen, action, old, advantage, target))

    def minibatch(carry, rows):
        params, moments = carry
        gradient = jax.grad(loss)(params, rows)
        gradient = {part: clip_norm(gradient[part]) for part in gradient}
        return adam(params, moments, gradient, rate), None

    def epoch(carry, shuffle):
        order = jax.random.permutation(shuffle, EPISODES * HORIZON)
        parts = jax.tree.map(lambda x: x[order].reshape(MINIBATCHES, MINIBATCH, *x.shape[1:]), flat)
        return jax.lax.scan(minibatch, carry, parts)

    (params, moments), _ = jax.lax.scan(epoch, (params, moments), jnp.stack(shuffles))
    returns = jnp.tensordot(DISCOUNT ** jnp.arange(HORIZON), reward, axes=1).mean()
    return (params, moments, key), returns


def main():
    steps, unroll = int(sys.argv[1]), int(sys.argv[2])
    rates = LEARNING_RATE * jnp.linspace(1.0, 0.02, steps // (EPISODES * HORIZON))

    @jax.jit
    def train(key):
        start, key = jax.random.split(key)
        params = fresh(start)
        zeros = jax.tree.map(jnp.zeros_like, params)
        carry = (params, (zeros, zeros, 0), key)
        (params, *_), returns = jax.lax.scan(lambda c, rate: iteration(c, rate, unroll), carry, rates)
        return returns, stiffness(params["policy"])

    began = time.perf_counter()
    compiled = train.lower(jax.random.key(0)).compile()
    compiling = time.perf_counter() - began
    began = time.perf_counter()
    returns, total = jax.block_until_ready(compiled(jax.random.key(0)))
    seconds = time.perf_counter() - began
    print(json.dumps({"rate": rates.size * EPISODES * HORIZON / seconds, "compile_s": compiling,
                      "first_return": float(returns[0]), "last_return": float(returns[-11:].mean()),
                      "total": float(total)}))


if __name__ == "__main__":
    main()
