"""`python -m stlspec`, and the `stlspec` command."""

import sys


def run() -> None:
    """Run the command line and leave with its exit code."""
    try:
        # Here and not above, so that Ctrl-C while modules load ends like any other.
        from stlspec.cli import main

        sys.exit(main.run())
    except KeyboardInterrupt:
        sys.exit(130)


if __name__ == "__main__":
    run()
