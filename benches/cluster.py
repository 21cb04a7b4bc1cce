"""What workers on a queue cost, and how far they scale.

    python benches/cluster.py HWASP [--pairs 3] [--out FILE.json] [--picture FILE.svg]

Needs the program as `cargo build --release` leaves it, `nats-server` on the path, and a machine on which nothing else runs. Takes about
five minutes on two cores.

Server, workers and whoever asks share this machine. Pairs of whole commands: the same training on two threads, and on two workers of one
thread. Messages and bytes are the server's own counts, in and out. The model is the sum of what was measured:

    time of an iteration = update + the largest of (episodes / workers, jobs / jobs the server hands out in a second,
                                                    bytes / bytes in a second) + one job's way there and back

where workers beyond the number of jobs have nothing to do.
"""

import argparse
import json
import math
import pathlib
import resource
import shutil
import statistics
import subprocess
import tempfile
import time
import urllib.request

JOBS = {
    "z-grasp, TRPO": ["z-grasp", "--env-steps", "200000"],
    "mass-spring, cmaes-rl": ["mass-spring", "--method", "cmaes-rl", "--env-steps", "48000000"],
    "mass-spring, PPO": ["mass-spring", "--env-steps", "400000"],
}
MONITOR, PORT = 18222, 14222
WORKERS = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000]


class Queue:
    """A server with two workers of one thread."""

    def __init__(self, program, folder):
        config = folder / "nats.conf"
        config.write_text(f'listen: "127.0.0.1:{PORT}"\nhttp: "127.0.0.1:{MONITOR}"\njetstream {{ store_dir: "{folder}" }}\n')
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        self.processes = [subprocess.Popen(["nats-server", "--config", str(config)], **quiet)]
        time.sleep(1)
        self.address = f"nats://127.0.0.1:{PORT}"
        for name in ("one", "two"):
            command = [program, "worker", "--server", self.address, "--threads", "1", "--name", name]
            self.processes.append(subprocess.Popen(command, **quiet))
        time.sleep(2)

    def counts(self):
        with urllib.request.urlopen(f"http://127.0.0.1:{MONITOR}/varz") as answer:
            told = json.load(answer)
        return [told[key] for key in ("in_msgs", "out_msgs", "in_bytes", "out_bytes")]

    def end(self):
        for process in reversed(self.processes):
            process.terminate()
            process.wait()


def train(program, words, folder, more):
    """Seconds of a whole command, and what its run says of itself."""
    shutil.rmtree(folder, ignore_errors=True)
    command = [program, "train", *words, "--set", "train.evaluation_episodes=40", "--threads", "2", "-q", "--out", str(folder), *more]
    began = time.perf_counter()
    subprocess.run(command, check=True)
    seconds = time.perf_counter() - began
    summary = json.loads((folder / "summary.json").read_text())
    return seconds, summary, (folder / "policy.safetensors").read_bytes()


def pairs(program, words, folder, queue, count):
    """Each way in turn: seconds, and messages and bytes of an iteration."""
    here, there, counts = [], [], None
    for _ in range(count):
        seconds, summary, bits = train(program, words, folder / "run", [])
        here.append(seconds)
        before = queue.counts()
        seconds, _, other = train(program, words, folder / "run", ["--server", queue.address])
        there.append(seconds)
        assert bits == other, "the same bits"
        counts = [(after - first) / summary["iterations"] for first, after in zip(before, queue.counts())]
    return {
        "iterations": summary["iterations"],
        "two_threads_s": here,
        "two_workers_s": there,
        "ratio": statistics.median(a / b for a, b in zip(here, there)),
        "messages_per_iteration": counts[0],
        "in_bytes_per_iteration": counts[2],
        "out_bytes_per_iteration": counts[3],
    }


def own_time(program, words, folder, queue):
    """Seconds of a processor that whoever asks needs for an iteration."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    _, summary, _ = train(program, words, folder, ["--server", queue.address])
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime) / summary["iterations"]


def speedup(workers, jobs, each_s, update_s, job_bytes, queue):
    """Times as fast as one worker, of iterations of so many jobs of so many seconds."""
    def iteration(n):
        waves = math.ceil(jobs / n) * each_s
        return update_s + max(waves, jobs / queue["jobs_per_s"], jobs * job_bytes / (1e6 * queue["down_mb_per_s"])) + queue["job_ms"] / 1e3
    return iteration(1) / iteration(workers)


def model(measured, queue):
    """Speedup by kind of job, for each number of workers."""
    grasp = measured["z-grasp, TRPO"]
    iteration = statistics.median(grasp["two_threads_s"]) / grasp["iterations"]
    update = grasp["update_s"]
    # Twenty episodes of 500 steps.
    episode = 2 * (iteration - update) / 20
    kept = grasp["out_bytes_per_iteration"] / 20
    kinds = {
        "z-grasp, TRPO, 20 episodes an iteration": (20, episode, update, kept),
        "the same with 1,000 episodes": (1000, episode, 50 * update, kept),
        "cmaes-rl, 11 candidates of 5 min": (11, 300.0, 0.01, 1e5),
        "a comparison of 1,000 trainings of 15 min": (1000, 900.0, 0.0, 1e6),
        "jobs of 10 ms": (100_000, 0.01, 0.0, 1e3),
    }
    return {name: [speedup(n, *kind, queue) for n in WORKERS] for name, kind in kinds.items()}


def picture(curves):
    """Speedup over workers, both in powers of ten."""
    width, height, left, bottom, top = 760, 440, 60, 50, 20
    colours = ["#0072B2", "#56B4E9", "#009E73", "#D55E00", "#CC79A7"]
    x = lambda n: left + (width - left - 20) * math.log10(n) / 3
    y = lambda s: height - bottom - (height - bottom - top) * math.log10(max(s, 1)) / 3
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="13">',
             f'<rect width="{width}" height="{height}" fill="white"/>']
    for n in (1, 10, 100, 1000):
        parts.append(f'<path d="M{x(n):.0f} {y(1):.0f}V{y(1000):.0f}M{x(1):.0f} {y(n):.0f}H{x(1000):.0f}" stroke="#ddd"/>')
        parts.append(f'<text x="{x(n):.0f}" y="{height - bottom + 18}" text-anchor="middle">{n}</text>')
        parts.append(f'<text x="{left - 8}" y="{y(n) + 4:.0f}" text-anchor="end">{n}</text>')
    parts.append(f'<path d="M{x(1):.0f} {y(1):.0f}L{x(1000):.0f} {y(1000):.0f}" stroke="#999" stroke-dasharray="4 4"/>')
    for i, ((name, speedups), colour) in enumerate(zip(curves.items(), colours)):
        line = "L".join(f"{x(n):.1f} {y(s):.1f}" for n, s in zip(WORKERS, speedups))
        parts.append(f'<path d="M{line}" fill="none" stroke="{colour}" stroke-width="2.5"/>')
        parts.append(f'<path d="M{left + 14} {top + 14 + 20 * i}h22" stroke="{colour}" stroke-width="2.5"/>')
        parts.append(f'<text x="{left + 44}" y="{top + 18 + 20 * i}">{name}</text>')
    parts.append(f'<text x="{(left + width) / 2:.0f}" y="{height - 8}" text-anchor="middle">workers of one thread</text>')
    parts.append(f'<text transform="translate(16 {height / 2:.0f}) rotate(-90)" text-anchor="middle">times as fast as one</text></svg>')
    return "\n".join(parts) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("hwasp", type=pathlib.Path)
    parser.add_argument("--pairs", type=int, default=3)
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--picture", type=pathlib.Path)
    options = parser.parse_args()
    program = str(options.hwasp.resolve())
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        queue = Queue(program, folder)
        try:
            asked = [program, "cluster", "measure", "--server", queue.address, "--json"]
            capacity = json.loads(subprocess.run(asked, check=True, capture_output=True, text=True).stdout)
            print(json.dumps(capacity))
            measured = {}
            for name, words in JOBS.items():
                measured[name] = pairs(program, words, folder, queue, options.pairs)
                print(name, json.dumps(measured[name]), flush=True)
            # What is left to do for whoever asks: updates, and reading answers.
            measured["z-grasp, TRPO"]["update_s"] = own_time(program, JOBS["z-grasp, TRPO"], folder / "run", queue)
        finally:
            queue.end()
    curves = model(measured, capacity)
    for name, speedups in curves.items():
        print(f"{name}: " + ", ".join(f"{n} {s:.1f}" for n, s in zip(WORKERS, speedups)))
    if options.out:
        options.out.write_text(json.dumps({"queue": capacity, "measured": measured, "workers": WORKERS, "speedup": curves}, indent=1) + "\n")
    if options.picture:
        options.picture.write_text(picture(curves))


if __name__ == "__main__":
    main()
