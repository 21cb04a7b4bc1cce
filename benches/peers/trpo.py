"""One TRPO update on 20,000 rows of an 11-128-128-2 controller under the tendons' law: hwasp and sb3-contrib."""
import statistics
import tempfile

from contest import Contest
from document import aim
from programs import call, example

# Log-probabilities reach a hundred, and both compute them in 32 bits.
NEAR = 1e-3


def compare(peers, turns, scale):
    updates = max(1, int(3 * scale))
    with tempfile.TemporaryDirectory() as folder:
        call([example("trpo_update"), 1, 1, "1.0", folder])

        def ours(threads, share):
            return 1.0 / statistics.median(call([example("trpo_update"), updates, threads, share])["seconds"])

        def theirs(threads):
            found = peers.call("trpo_sb3.py", folder, updates, threads=threads)
            if found["off"] > NEAR:
                raise SystemExit(f"sb3-contrib's log-probabilities are off by {found['off']}: not the same policy")
            return 1.0 / statistics.median(found["seconds"])

        contest = Contest({
            "hwasp": {f"{n} thread{'s' * (n > 1)}": lambda n=n: ours(n, "1.0") for n in (2, 1)},
            "sb3-contrib": {f"{n} thread{'s' * (n > 1)}": lambda n=n: theirs(n) for n in (2, 1)},
            "hwasp, curvature of a tenth of the rows": {"2 threads": lambda: ours(2, "0.1")},
        }, turns)
    ratio = contest.median("hwasp") / contest.median("sb3-contrib")
    return contest.table("Updates per second, the fit of the value network among them.", "updates/s") + \
        ["", *aim([("times sb3-contrib", ratio, 1)])]
