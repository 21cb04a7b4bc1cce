#!/usr/bin/env python3
"""Checks licences, sources and versions of all dependencies against deny.toml, from what Cargo knows of them. Python 3.11, a second.

    python3 scripts/licences.py

cargo-deny reads deny.toml, too, and more of it (texts of licences, advisories), but takes minutes to build.
"""
import json
import re
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
REGISTRY = "registry+https://github.com/rust-lang/crates.io-index"


def granted(expression, allowed):
    """Whether an SPDX expression can be met by licences that are allowed; `a/b` is an old form of `a OR b`."""
    words = re.findall(r"\(|\)|[^\s()]+", expression.replace("/", " OR "))

    def any_of():
        met = all_of()
        while words and words[0] == "OR":
            words.pop(0)
            met |= all_of()
        return met

    def all_of():
        met = one()
        while words and words[0] == "AND":
            words.pop(0)
            met &= one()
        return met

    def one():
        word = words.pop(0)
        if word == "(":
            met = any_of()
            words.pop(0)
            return met
        if words and words[0] == "WITH":
            word += " WITH " + (words.pop(0) and words.pop(0))
        return word in allowed

    return any_of() and not words


def main():
    rules = tomllib.loads((ROOT / "deny.toml").read_text())["licenses"]
    command = ["cargo", "metadata", "--format-version=1", "--locked", "--offline", "--all-features", "--manifest-path", ROOT / "Cargo.toml"]
    packages = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)["packages"]
    faults, unused = [], {rule["crate"] for rule in rules["exceptions"]}
    for package in packages:
        name, licence = f"{package['name']} {package['version']}", package["license"]
        exceptions = [rule["allow"] for rule in rules["exceptions"] if rule["crate"] == package["name"]]
        allowed = set(rules["allow"]).union(*exceptions)
        if exceptions and not granted(licence or "none", set(rules["allow"])):
            unused.discard(package["name"])
        if not granted(licence or "none", allowed):
            faults.append(f"{name}: licence {licence}; deny.toml allows {', '.join(sorted(allowed))}")
        if package["source"] not in (None, REGISTRY):
            faults.append(f"{name}: comes from {package['source']}, not from crates.io")
        if package["source"] is None:
            loose = [of["name"] for of in package["dependencies"] if of["req"] == "*" and "path" not in of]
            faults += [f"{name}: any version of {other} would do; name one" for other in loose]
    faults += [f"{name}: its exception in deny.toml is not needed" for name in sorted(unused)]
    print("\n".join(faults) if faults else f"{len(packages)} packages: licences, sources and versions are as deny.toml has them")
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())
