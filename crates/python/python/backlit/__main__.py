"""The command line: ``python -m backlit`` or ``backlit``."""

import sys

from backlit._backlit import run_program


def main() -> None:
    """Runs the command line and ends with its exit code: 0 done, 1 an error, 2 not understood, 130 Ctrl+C."""
    sys.exit(run_program(["backlit", *sys.argv[1:]]))


if __name__ == "__main__":
    main()
