"""Rollouts of z-grasp: hwasp, `mujoco.rollout`, Gymnasium's vector environments. The same episodes to the bit."""
import statistics
import tempfile

from contest import Contest
from document import aim
from programs import call, example

EPISODES = 40
# Gymnasium's rewards, which are computed by other formulas, and states of `mujoco.rollout`, which are not.
NEAR = {"grasp_gymnasium.py": 1e-9, "grasp_rollout.py": 0.0}


def training(turns, iterations):
    """Rows of a table: a training of z-grasp, and where its time goes."""
    found = [call([example("grasp_throughput"), 2, iterations]) for _ in range(turns)]

    def median(what):
        return statistics.median(one[what] for one in found)

    shares = sorted(one["share"] for one in found)
    return median("share"), [
        "| training of z-grasp by TRPO on 2 threads, medians | |",
        "|---|---|",
        f"| steps per second, everything included | {median('training'):,.0f} |",
        f"| the same physics alone | {median('physics'):,.0f} |",
        f"| share of the time in physics | {100 * median('share'):.1f} % ({100 * shares[0]:.1f} to {100 * shares[-1]:.1f}, "
        f"{turns} runs) |",
        f"| controller, law, and waiting for the slower thread | {100 * median('acting'):.1f} % |",
        f"| updates | {100 * median('updates'):.1f} % |",
    ]


def compare(peers, turns, scale):
    episodes = max(4, int(scale * EPISODES))
    last = {}
    with tempfile.TemporaryDirectory() as folder:
        call([example("grasp_rollouts"), episodes, 1, folder])

        def ours():
            last.update(call([example("grasp_rollouts"), episodes, 2]))
            return last["steps"] / last["rollout_s"]

        def theirs(script, *arguments, exact=True):
            found = peers.call(script, folder, *arguments)
            if exact and found["off"] > NEAR[script]:
                raise SystemExit(f"{script} is off by {found['off']}: not the same episodes")
            return found["rate"]

        contest = Contest({
            "hwasp": {"2 threads": ours},
            # The program times both.
            "hwasp, physics alone": {"2 threads": lambda: last["steps"] / last["physics_s"]},
            "mujoco.rollout": {
                "2 threads, whole episodes": lambda: theirs("grasp_rollout.py", "open", 2, 0),
                "2 threads, whole episodes one by one": lambda: theirs("grasp_rollout.py", "open", 2, 1),
            },
            "mujoco.rollout, a call for each step": {
                "2 threads": lambda: theirs("grasp_rollout.py", "closed", 2, 0, exact=False),
            },
            "Gymnasium": {
                "SyncVectorEnv of 4": lambda: theirs("grasp_gymnasium.py", "sync", 4),
                "AsyncVectorEnv of 2": lambda: theirs("grasp_gymnasium.py", "async", 2),
                "AsyncVectorEnv of 4": lambda: theirs("grasp_gymnasium.py", "async", 4),
            },
        }, turns)
    rate = contest.median("hwasp")
    share, table = training(turns, max(1, int(2 * scale)))
    text = (f"{episodes} episodes of 500 steps, each ten of the physics. `hwasp` is everything: physics, noise, observation, "
            "reward, controller and law.")
    return [*contest.table(text, "environment steps/s"), "", *table, "", *aim([
        ("times `mujoco.rollout`", rate / contest.median("mujoco.rollout"), 1.15),
        ("times Gymnasium", rate / contest.median("Gymnasium"), 2.5),
        ("of the physics alone in training", share, 0.9),
    ])]
