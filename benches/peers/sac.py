"""Gradient steps of SAC, 256 rows of 11 observations and 2 commands, 256-256 throughout: hwasp, Stable-Baselines3 and JAX."""
from contest import Contest
from document import aim
from programs import call, example


def compare(peers, turns, scale):
    steps = max(100, int(1000 * scale))

    def ours(threads):
        return 1.0 / call([example("sac_update"), steps, threads])["seconds_a_step"]

    def theirs(script, threads):
        return 1.0 / peers.call(script, steps, threads, threads=threads)["seconds_a_step"]

    def each(run):
        return {f"{n} thread{'s' * (n > 1)}": lambda n=n: run(n) for n in (2, 1)}

    contest = Contest({
        "hwasp": each(ours),
        "Stable-Baselines3": each(lambda n: theirs("sac_sb3.py", n)),
        "JAX, one jitted function": each(lambda n: theirs("sac_jax.py", n)),
    }, turns)
    times = {name: contest.median("hwasp") / contest.median(name) for name in contest.rates}
    return contest.table("Gradient steps of both critics, policy and temperature per second.", "steps/s") + \
        ["", *aim([("times Stable-Baselines3", times["Stable-Baselines3"], 3),
                   ("times JAX", times["JAX, one jitted function"], 1)])]
