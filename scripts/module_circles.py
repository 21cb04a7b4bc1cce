#!/usr/bin/env python3
"""Looks for circles among the modules of each crate, and for crates that have grown too large.

    scripts/module_circles.py [REPOSITORY]

A module is a file or folder directly below a crate's `src`; what is deeper counts as a part of it. One module uses another
where a path in it begins with `crate::` or leaves it by `super::`; a name that `lib.rs` re-exports counts for the module that it
comes from, one that `lib.rs` defines for `lib`. Modules of tests are left out. Modules use each other in a circle where none of
them can be read, tested or moved alone; a crate of more than MOST lines is to be split. Prints what it finds; exit status 1 if
that is anything.
"""

import re
import sys
from pathlib import Path

MOST = 6000
PATH = re.compile(r"\b(crate|super(?:::super)*)::(?=[\w{])")
ITEM = re.compile(r"^(?:pub(?:\([^)]*\))? )?(?:(?:const|unsafe|async) )*(?:fn|struct|enum|trait|type|const|static) (\w+)", re.M)


TESTS = r"#\[cfg\(test\)\]\n(?:#\[[^\n]*\]\n)*mod \w+"


def program(file):
    """The text of a file without its modules of tests; those in braces end it."""
    return re.split(TESTS + r" \{", re.sub(TESTS + ";\n", "", file.read_text()))[0]


def code(file):
    """The same without comments."""
    return re.sub(r"//[^\n]*", "", program(file))


def heads(text, at):
    """The first names of what a path goes on with: one, or those of a list in braces."""
    if text[at] != "{":
        return [re.match(r"\w+", text[at:]).group()]
    depth, names, fresh = 0, [], True
    for word in re.findall(r"\w+|[{},]|::", text[at:]):
        if word == "{":
            depth, fresh = depth + 1, depth == 0
        elif word == "}":
            depth -= 1
            if depth == 0:
                return names
        elif word == ",":
            fresh = depth == 1
        elif fresh and word != "::":
            names.append(word)
            fresh = False
    return names


def exported(root):
    """What `lib.rs` hands on, by name: the module that it comes from."""
    names = {}
    for module, items in re.findall(r"pub(?:\([^)]*\))? use (?:self::|crate::)?(\w+)::([^;]*);", root):
        for item in re.findall(r"(\w+)(?: as (\w+))?\s*(?=[,}]|$)", items):
            names[item[1] or item[0]] = module
    return names


def sources(src):
    """The files of a crate that are no tests."""
    return [f for f in src.rglob("*.rs") if f.name != "tests.rs" and "tests" not in f.relative_to(src).parts]


def uses(src):
    """The modules of a crate, and of each the others that it uses."""
    files = sources(src)
    lib = src / "lib.rs"
    root = code(lib) if lib.exists() else ""
    graph = {f.relative_to(src).parts[0].removesuffix(".rs"): set() for f in files}
    source = {**exported(root), **dict.fromkeys(ITEM.findall(root), "lib")}
    for module in set(re.findall(r"\b(\w+)::", root)) & graph.keys():
        graph["lib"].add(module)
    for file in files:
        parts = list(file.relative_to(src).with_suffix("").parts)
        module = parts[0]
        if module in ("lib", "main"):
            continue
        depth = len(parts) - (parts[-1] == "mod")
        text = code(file)
        for path in PATH.finditer(text):
            begin = path.group(1)
            if begin == "crate" or begin.count("super") == depth:
                for name in heads(text, path.end()):
                    graph[module].add(name if name in graph else source.get(name, module))
    return {module: {other for other in others if other in graph and other != module} for module, others in graph.items()}


def reached(graph, start):
    """All that a module uses, directly or through others."""
    seen, left = set(), list(graph[start])
    while left:
        module = left.pop()
        if module not in seen:
            seen.add(module)
            left += graph[module]
    return seen


def circles(graph):
    """Sets of modules each of which uses all of them."""
    below = {module: reached(graph, module) for module in graph}
    found = {frozenset(other for other in graph if other in below[m] and m in below[other]) for m in graph if m in below[m]}
    return sorted(sorted(circle) for circle in found)


def main():
    repository = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent.parent
    faults = []
    crates = sorted(repository.glob("crates/*/src"))
    for src in crates:
        name = src.parent.name
        faults += [f"{name}: a circle of modules: {', '.join(circle)}" for circle in circles(uses(src))]
        lines = sum(len(program(file).splitlines()) for file in sources(src))
        if lines > MOST:
            faults.append(f"{name}: {lines} lines in src, more than {MOST}")
    if not crates:
        faults.append(f"{repository} has no crates")
    print("\n".join(faults) if faults else f"{len(crates)} crates: no circle among modules, none too large")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
