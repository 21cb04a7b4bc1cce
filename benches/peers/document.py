"""docs/performance.md: the parts that the comparisons write, and the machine they ran on."""
import datetime
import os
import platform
import subprocess

from programs import ROOT

PATH = ROOT / "docs" / "performance.md"


def aim(rows):
    """A table of what was aimed at; `rows` are (what, measured ratio, least ratio)."""
    lines = ["| aim | measured | reached |", "|---|---|---|"]
    for what, found, least in rows:
        lines.append(f"| at least {least:g} {what} | {found:.2f} | {'yes' if found >= least else 'no'} |")
    return lines


def replace(name, lines):
    """Puts the lines between the markers of this name, in place of what stood there."""
    text = PATH.read_text()
    begin, end = f"<!-- {name}: written by benches/peers/run.py -->", f"<!-- {name}: end -->"
    before, found, rest = text.partition(begin)
    _, closed, after = rest.partition(end)
    if not (found and closed):
        raise SystemExit(f"{PATH} has no place for {name}: the lines\n{begin}\n{end}")
    PATH.write_text("\n".join([before + begin, "", *lines, "", end + after]))


def about(python):
    """Machine, versions and date, in a sentence or two."""
    def field(path, key):
        with open(path) as file:
            return next((line.split(":", 1)[1].strip() for line in file if line.startswith(key)), "unknown")

    def said(*command):
        return subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT).stdout.strip()

    memory = int(field("/proc/meminfo", "MemTotal").split()[0]) / 2**20
    listed = dict(line.split("==") for line in said(python, "-m", "pip", "freeze").splitlines() if "==" in line)
    names = ["numpy", "jax", "torch", "stable_baselines3", "sb3_contrib", "gymnasium", "mujoco", "cma"]
    versions = ", ".join(f"{name} {listed[name]}" for name in names)
    vectors = "AVX-512" if "avx512f" in field("/proc/cpuinfo", "flags").split() else "no AVX-512"
    return [
        f"Measured on {datetime.datetime.now(datetime.timezone.utc):%-d %B %Y} at commit {said('git', 'rev-parse', '--short', 'HEAD')}: "
        f"{os.cpu_count()} cores of {field('/proc/cpuinfo', 'model name')} ({vectors}, {memory:.0f} GiB), "
        f"Linux {platform.release().split('-')[0]}, {said('rustc', '--version').rsplit(' (', 1)[0]}, "
        f"Python {said(python, '-c', 'import platform; print(platform.python_version())')}, {versions}."
    ]
