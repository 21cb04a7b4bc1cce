"""The command `hwasp`: the same program as the one that Cargo builds. `python -m hwasp` is it, too."""

import sys

from ._hwasp import main as _main


def main() -> None:
    """Runs the program with the words that were typed, and ends with its exit status."""
    sys.exit(_main(["hwasp", *sys.argv[1:]], [sys.executable, "-m", "hwasp"]))


if __name__ == "__main__":
    main()
