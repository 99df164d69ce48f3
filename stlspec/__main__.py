"""`python -m stlspec`, and the `stlspec` command."""

import sys

from stlspec.cli import main


def run() -> None:
    """Run the command line and leave with its exit code."""
    sys.exit(main.run())


if __name__ == "__main__":
    run()
