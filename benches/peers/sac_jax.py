"""sac_jax.py STEPS THREADS: seconds of a gradient step of SAC as one jitted JAX function: a replay that lies in it, twin critics as
one batched product, Adam, target networks, temperature. Compiling is not counted."""
import json
import os
import sys

STEPS, THREADS = (int(word) for word in sys.argv[1:])
if THREADS == 1:
    os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
    os.sched_setaffinity(0, {sorted(os.sched_getaffinity(0))[0]})

import time

import jax
import jax.numpy as jnp

ROWS, SEEN, COMMANDS, BATCH, WIDTH = 4000, 11, 2, 256, 256
DISCOUNT, RATE, TAU, WANTED = 0.99, 3e-4, 0.005, -float(COMMANDS)


def layers(key, sizes):
    pairs = list(zip(sizes, sizes[1:]))
    keys = jax.random.split(key, len(pairs))
    return [(jax.random.normal(k, pair) / jnp.sqrt(pair[0]), jnp.zeros(pair[1])) for k, pair in zip(keys, pairs)]


def perceptron(params, x):
    for w, b in params[:-1]:
        x = jax.nn.relu(x @ w + b)
    w, b = params[-1]
    return x @ w + b


def act(policy, seen, noise):
    mean, log_std = jnp.split(perceptron(policy, seen), 2, axis=-1)
    log_std = jnp.clip(log_std, -20.0, 2.0)
    total = mean + jnp.exp(log_std) * noise
    log_prob = -0.5 * noise**2 - log_std - 0.5 * jnp.log(2 * jnp.pi)
    stretch = 2.0 * (jnp.log(2.0) - total - jax.nn.softplus(-2.0 * total))
    return jnp.tanh(total), (log_prob - stretch).sum(axis=-1)


def values(critics, seen, action):
    x = jnp.concatenate([seen, action], axis=-1)
    return jax.vmap(lambda critic: perceptron(critic, x)[..., 0])(critics)


def adam(state, params, gradient):
    m, v, t = state
    m = jax.tree.map(lambda m, g: 0.9 * m + 0.1 * g, m, gradient)
    v = jax.tree.map(lambda v, g: 0.999 * v + 0.001 * g * g, v, gradient)
    rate = RATE * jnp.sqrt(1.0 - 0.999 ** (t + 1)) / (1.0 - 0.9 ** (t + 1))
    return (m, v, t + 1), jax.tree.map(lambda p, m, v: p - rate * m / (jnp.sqrt(v) + 1e-8), params, m, v)


@jax.jit
def step(state, replay, key):
    """A gradient step of everything, on rows that it draws."""
    policy, critics, targets, log_temperature, (of_policy, of_critics, of_temperature) = state
    draw, now, then = jax.random.split(key, 3)
    rows = jax.random.randint(draw, (BATCH,), 0, ROWS)
    seen, action, reward, after = (column[rows] for column in replay)
    temperature = jnp.exp(log_temperature)

    following, log_prob = act(policy, after, jax.random.normal(then, (BATCH, COMMANDS)))
    wanted = reward + DISCOUNT * (values(targets, after, following).min(axis=0) - temperature * log_prob)
    gradient = jax.grad(lambda critics: 0.5 * ((values(critics, seen, action) - wanted) ** 2).mean(axis=1).sum())(critics)
    of_critics, critics = adam(of_critics, critics, gradient)

    noise = jax.random.normal(now, (BATCH, COMMANDS))

    def loss(policy):
        own, log_prob = act(policy, seen, noise)
        return (temperature * log_prob - values(critics, seen, own).min(axis=0)).mean(), log_prob.mean()

    gradient, log_prob = jax.grad(loss, has_aux=True)(policy)
    of_policy, policy = adam(of_policy, policy, gradient)
    of_temperature, log_temperature = adam(of_temperature, log_temperature, -(log_prob + WANTED))
    targets = jax.tree.map(lambda target, param: target + TAU * (param - target), targets, critics)
    return policy, critics, targets, log_temperature, (of_policy, of_critics, of_temperature)


def main():
    policy_key, critic_key, replay_key, key = jax.random.split(jax.random.key(0), 4)
    policy = layers(policy_key, [SEEN, WIDTH, WIDTH, 2 * COMMANDS])
    critics = jax.vmap(lambda key: layers(key, [SEEN + COMMANDS, WIDTH, WIDTH, 1]))(jax.random.split(critic_key, 2))
    nothing = lambda params: (jax.tree.map(jnp.zeros_like, params), jax.tree.map(jnp.zeros_like, params), 0)
    log_temperature = jnp.float32(0.0)
    state = (policy, critics, critics, log_temperature, (nothing(policy), nothing(critics), nothing(log_temperature)))
    a, b, c, d = jax.random.split(replay_key, 4)
    replay = (jax.random.normal(a, (ROWS, SEEN)), jax.random.uniform(b, (ROWS, COMMANDS), minval=-1.0),
              jax.random.normal(c, (ROWS,)), jax.random.normal(d, (ROWS, SEEN)))
    keys = jax.random.split(key, 50 + STEPS)
    for k in keys[:50]:
        state = step(state, replay, k)
    jax.block_until_ready(state)
    began = time.perf_counter()
    for k in keys[50:]:
        state = step(state, replay, k)
    jax.block_until_ready(state)
    print(json.dumps({"seconds_a_step": (time.perf_counter() - began) / STEPS}))


main()
